"""What a file says and hardly means is remarked on at its place; what is meant is not."""

from fractions import Fraction
from math import pi

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from derive.robot.load import catalogue_names, robot_file_bytes
from derive.robot.reading.document import read_document
from derive.robot.robot import Robot
from derive.robot.validate import missing_moment, remarks_on, remarks_on_bodies

HEAD = "name: arm\nconvention: standard\n"


def remarks(row: str, units: str = "", tail: str = "") -> list[str]:
    text = f"{HEAD}{units}joints:\n  - {{type: revolute, {row}}}\n{tail}"
    return [str(remark) for remark in Robot.from_text(text, "arm.yaml").remarks]


@pytest.mark.parametrize(
    ("row", "words"),
    [
        ("alpha: 90", "yaml:4:29: joints row 1, alpha: 90 rad is more than a turn; if degrees are meant write pi/2"),
        ("theta: q1 - 45", "-45 rad is more than a turn; if degrees are meant write -pi/4"),
        ("theta: 2*b - 135 - q1", "write -3*pi/4"),
        ("alpha: 1.5708", "1.5708 rad is nearly pi/2, but not exactly; did you mean pi/2?"),
        ("alpha: -0.785", "did you mean -pi/4?"),
        ("theta: q1 + 3.14", "did you mean pi?"),
        ("alpha: 6.2832", "did you mean 2*pi?"),
        ("limits: [-180, 1]", "joints row 1, limits entry 1: -180 rad is more than two turns"),
        ("a: 2*cos(30)", "joints row 1, a: 30 rad is more than a turn"),
        ("a: b*sin(0.5236)", "did you mean pi/6?"),
        ("alpha: PI/2", "'PI' is a name like any other; the constant is written pi"),
    ],
)
def test_a_slip_in_radians_is_remarked_on_at_its_place(row: str, words: str) -> None:
    (remark,) = remarks(row)
    assert words in remark


@pytest.mark.parametrize(
    "row",
    [
        "alpha: pi/2", "alpha: -90*pi/180", "theta: q1 + 3*pi", "alpha: 0.0005", "alpha: 1.2", "alpha: beta",
        "alpha: 90*beta", "limits: [-2.8973, 2.8973]", "limits: [-1.5708, 1.5708]", "limits: [-6.98, 6.98]", "a: 90",
        "d: 431.8", "theta: pi/2 - q1",
    ],
)  # fmt: skip
def test_what_is_meant_is_not(row: str) -> None:
    assert remarks(row) == []


def test_parameters_that_stand_for_angles_are_angles_in_every_file() -> None:
    tail = "parameters: {beta: 30, a1: 30}\n"
    for units in ("", "units: {angle: deg}\n"):
        (remark,) = remarks("alpha: -beta, a: a1", units, tail)
        assert "parameters, beta: 30 rad" in remark
        assert "write pi/6" in remark
    assert remarks("alpha: -beta", tail="parameters: {beta: pi/6}\n") == []


def test_radians_among_degrees_are_remarked_on_and_drawn_configurations_too() -> None:
    units = "units: {angle: deg}\n"
    (remark,) = remarks("alpha: -1.5708", units)
    assert "angles of this file are in degrees; if radians are meant write -90" in remark
    assert remarks("alpha: 90, limits: [-360, 360], a: cos(60)", units) == []
    assert remarks("alpha: 0.52", units) == []
    (remark,) = remarks("a: 1", tail="figure: {q: [90]}\n")
    assert "figure, q entry 1: 90 rad is more than two turns" in remark
    assert remarks("a: 1", tail="figure: {q: [1.5708]}\n") == []


def test_remarks_come_in_the_order_of_the_file_and_as_plain_data() -> None:
    text = (
        f"{HEAD}parameters: {{b: 45}}\njoints:\n  - {{type: revolute, alpha: 90}}\n  - {{type: revolute, alpha: b}}\n"
    )
    robot = Robot.from_text(text, "arm.yaml")
    assert remarks_on(read_document(text.encode(), "arm.yaml"), robot) == robot.remarks
    assert [remark.location.line for remark in robot.remarks] == [3, 5]
    first = robot.remarks[0].as_dict()
    assert list(first) == ["file", "line", "column", "found", "remedy"]
    assert (first["file"], first["line"], first["column"]) == ("arm.yaml", 3, 17)


def test_built_in_robots_need_no_remark_but_of_bodies() -> None:
    """They are cited as published, with links that no body can be."""
    for name in catalogue_names():
        assert all(remark.is_of_bodies for remark in Robot.load(name).remarks), name


@given(st.integers(1, 24), st.floats(-9e-4, 9e-4))
def test_every_rounded_multiple_of_a_twelfth_of_pi_is_seen(twelfths: int, error: float) -> None:
    (remark,) = remarks(f"alpha: {twelfths * pi / 12 + error:.6f}")
    assert "did you mean" in remark


def of_tensor(inertia: str, tail: str = "") -> list[str]:
    text = (
        "name: arm\nconvention: standard\njoints:\n  - {type: revolute, a: 1}\ngravity: [0, 0, -9.81]\nlinks:\n"
        f"  - mass: 1\n    inertia: {{{inertia}}}\n{tail}"
    )
    robot = Robot.from_text(text, "arm.yaml")
    assert remarks_on_bodies(read_document(text.encode(), "arm.yaml"), robot) == robot.remarks
    return [str(remark) for remark in robot.remarks]


def test_tensors_that_no_body_has_are_remarked_on_with_the_amount_and_no_others() -> None:
    (remark,) = of_tensor("xx: 0.1, yy: 0.02, zz: 0.2")
    assert remark.startswith("arm.yaml:8:14: links entry 1, inertia: physically inconsistent: one principal moment ")
    assert "derive export --inertia possible" in remark
    (remark,) = of_tensor("xx: i1, yy: i1, zz: 3*i1", "parameters: {i1: 0.5}\n")
    assert "other two by 0.5 kg m^2" in remark
    (remark,) = of_tensor("zz: -0.2")  # of a planar arm
    assert "one principal moment exceeds the sum of the other two by 0.2 kg m^2" in remark
    for inertia in ("xx: 0.1, yy: 0.1, zz: 0.2", "zz: 0.2", "xx: 1, yy: i1, zz: 5", "xx: 0, yy: 0.1, zz: 0.1"):
        assert of_tensor(inertia) == []


def test_several_links_are_one_remark() -> None:
    text = robot_file_bytes("puma560-corke").decode().replace("inertia: {yy: 0.35}", "inertia: {xx: 0.1, yy: 0.35}")
    (remark,) = Robot.from_text(text, "my.yaml").remarks
    expected = (
        "links entries 1, 3, inertia: physically inconsistent: one principal moment "
        "exceeds the sum of the other two by 0.25, 0.0075 kg m^2"
    )
    assert expected in remark.found


@given(st.lists(st.integers(-9, 9), min_size=6, max_size=6))
def test_the_amount_is_that_of_the_principal_moments(cells: list[int]) -> None:
    xx, yy, zz, xy, xz, yz = cells
    a, b, c = np.linalg.eigvalsh(np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]], dtype=float))
    xx, yy, zz, xy, xz, yz = map(Fraction, cells)
    assert abs(missing_moment((xx, yy, zz, xy, xz, yz)) - max(0.0, c - a - b)) <= 1e-6
