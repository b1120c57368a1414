"""A workspace in formulas reads as text, LaTeX, Python and JSON."""

from derive.handouts.notation.notation import Notation
from derive.handouts.notation.workspace import workspace_lines, workspace_parts
from derive.inverse.words.reach import Reach
from derive.model.model import Model
from derive.robot.robot import Robot


def lines(name: str, form: str) -> list[str]:
    robot = Robot.load(name)
    return workspace_lines(Model(robot).workspace, form, Notation.of(robot))


def test_a_ring_is_written_with_its_radii() -> None:
    assert lines("planar-2r-perugia", "text") == [
        "reachable region, if no joint has limits:",
        "   abs(a1 - a2) <= sqrt(px**2 + py**2) <= a1 + a2: between two circles, q2 is real",
        "2 solutions inside",
    ]
    (_, row, _) = lines("planar-2r-perugia", "latex")
    assert row == r"  \lvert a_{1} - a_{2} \rvert \le \sqrt{p_{x}^{2} + p_{y}^{2}} \le a_{1} + a_{2} \\"


def test_python_can_run_what_is_written_for_it() -> None:
    code = "\n".join(lines("planar-3r", "python"))
    for px, wanted in ((1.05, True), (0.25, False), (1.3, False)):  # the tool points along x: the wrist is at px - 0.2
        values = {"a1": 0.5, "a2": 0.4, "a3": 0.2, "px": px, "py": 0.0, "r11": 1.0, "r21": 0.0}
        exec("from math import sqrt\n" + code, values)
        assert values["reached"] is wanted


def test_numbers_alone_are_decimals() -> None:
    (bound,) = [line for line in lines("kuka-kr5", "text") if "<=" in line]
    assert bound.strip() == ("0.0384234 <= sqrt(wz**2 + (rho - 0.075)**2) <= 0.578423: between two tori, q3 is real")


def test_json_has_every_bound() -> None:
    found: Reach = Model(Robot.load("puma560-corke")).workspace
    parts = workspace_parts(found)
    assert [bound["shape"] for bound in parts["bounds"]] == ["outside of a cylinder", "between two spheres"]
    assert (parts["whole"], parts["count"]) == (True, 8)


def test_an_arm_without_bounds_says_what_to_do() -> None:
    assert lines("thumb", "text")[-1] == "the boundary: derive plot --workspace"
    assert lines("spherical-wrist", "text")[0].startswith("no bound")
