"""Printed inverse kinematics against a robot."""

import math
from fractions import Fraction
from functools import cache

import pytest

from derive.api.robots import load
from derive.checking.comparison import POSE_NAMES, check_file
from derive.checking.files import corpus_from_bytes
from derive.checking.formulas.findings import Finding, Outcome, Role, judge
from derive.checking.formulas.printed import InverseText, PrintedText
from derive.checking.inverse.check import check_inverse, shown
from derive.checking.inverse.ours import OurSolution
from derive.checking.inverse.poses import PoseNames, places
from derive.checking.inverse.printed import PrintedInverse
from derive.errors import CheckError, Location
from derive.model.model import Model
from derive.robot.expression import Call, Name, Pi, add, multiply, negate, number
from tests.checking.inverse.test_reading import solution

PLANAR = """\
D = (x**2 + y**2 - a1**2 - a2**2)/(2*a1*a2)
theta2 = atan2(+-sqrt(1 - D**2), D)
theta1 = atan2(y, x) - atan2(a2*s2, a1 + a2*c2)
"""


@cache
def model(robot: str) -> Model:
    return Model(load(robot))


def checked(robot: str, text: str, *, latex: bool = False) -> tuple[Finding, ...]:
    where = Location("notes")
    return check_inverse(model(robot), InverseText((PrintedText(text, where),), where, latex=latex))[0]


def outcomes(findings: tuple[Finding, ...]) -> dict[str, Outcome]:
    return {finding.quantity: judge(finding).outcome for finding in findings}


def change(findings: tuple[Finding, ...]) -> str:
    wrong = [judge(finding) for finding in findings if not finding.verdict.equal and finding.role is Role.SOLUTION]
    (verdict,) = wrong
    return verdict.repair.text


def test_all_branches_are_right_and_in_our_form() -> None:
    found = checked("planar-2r-perugia", PLANAR)
    assert outcomes(found) == {"q2": Outcome.SAME_FORM, "q1": Outcome.SAME_FORM, "inverse": Outcome.EQUAL}
    assert found[-1].text == "all 2 solutions"


@pytest.mark.first(5)
@pytest.mark.parametrize(
    "text",
    [
        "theta1 = atan2(y, x) - atan2(a2*s2, a1 + a2*c2); D = (x**2 + y**2 - a1**2 - a2**2)/2/a1/a2; "
        "theta2 = atan2(±sqrt(1 - D**2), D)",
        "c2 = (px**2 + py**2 - a1**2 - a2**2)/(2*a1*a2); s2 = +-sqrt(1 - c2**2); q2 = atan2(s2, c2)\n"
        "q1 = atan2((a1 + a2*c2)*py - a2*s2*px, (a1 + a2*c2)*px + a2*s2*py)",
        "r = sqrt(x**2 + y**2); beta = arccos((a1**2 + a2**2 - r**2)/(2*a1*a2))\n"
        "alpha = acos((r**2 + a1**2 - a2**2)/(2*a1*r)); theta1 = atan2(y, x) -+ alpha; theta2 = +-(pi - beta)",
        "q2 = 2*atan(+-sqrt(((a1 + a2)**2 - x**2 - y**2)/(x**2 + y**2 - (a1 - a2)**2)))\n"
        "q1 = atan2(y, x) - atan2(a2*sin(q2), a1 + a2*cos(q2))",
        "c2 = (x**2 + y**2 - a1**2 - a2**2)/(2*a1*a2), s2 = sqrt(1 - c2**2) or -sqrt(1 - c2**2)\n"
        "theta2 = arctan2(s2, c2)\ns1 = ((a1 + a2*c2)*y - a2*s2*x)/(x**2 + y**2)\n"
        "c1 = ((a1 + a2*c2)*x + a2*s2*y)/(x**2 + y**2)\ntheta1 = arctan2(s1, c1)",
        "theta2 = +-acos((x**2 + y**2 - a1**2 - a2**2)/(2*a1*a2))\ntheta1 = atan2(y, x) - atan2(a2*s2, a1 + a2*c2)",
        "K = x**2 + y**2 - a1**2 - a2**2; theta2 = atan2(sgn*sqrt(4*a1**2*a2**2 - K**2), K)\n"
        "theta1 = atan2(y, x) - atan2(a2*sin(theta2), a1 + a2*cos(theta2))",
        r"D = \frac{x^2 + y^2 - a_1^2 - a_2^2}{2 a_1 a_2}, \quad"
        r"\theta_2 = \operatorname{atan2}\left(\pm\sqrt{1 - D^2}, D\right) \\"
        r"\theta_1 = \operatorname{atan2}(y, x) - \operatorname{atan2}(a_2 s_2, a_1 + a_2 c_2)",
        r"\cos\theta_2 = \frac{p_x^2 + p_y^2 - a_1^2 - a_2^2}{2 a_1 a_2} \\"
        r"\sin\theta_2 = \pm\sqrt{1 - \cos^2\theta_2} \\"
        r"\theta_2 = \text{Atan2}(\sin\theta_2, \cos\theta_2) \\"
        r"\theta_1 = \text{Atan2}(p_y, p_x) - \text{Atan2}(a_2 \sin\theta_2, a_1 + a_2\cos\theta_2)",
        r"\begin{align} \theta_2 &= \pm\cos^{-1}\frac{x^2 + y^2 - a_1^2 - a_2^2}{2 a_1 a_2} \\"
        r"\theta_1 &= \mathrm{atan2}(y, x) - \mathrm{atan2}(a_2 \sin\theta_2, a_1 + a_2\cos\theta_2) \end{align}",
        r"c_2 = \frac{x^2 + y^2 - a_1^2 - a_2^2}{2 a_1 a_2} \\ \theta_2 = A\tan(c_2, \pm\sqrt{1 - c_2^2}) \\"
        r"\theta_1 = A\tan(x, y) - A\tan(a_1 + a_2 c_2, a_2 s_2)",
    ],
)
def test_other_writings_are_equal_in_plain_text_and_as_books_set_them(text: str) -> None:
    found = checked("planar-2r-perugia", text, latex="\\" in text)
    assert all(finding.verdict.equal for finding in found)
    turned = " (its arctangent takes the cosine first)" if r"A\tan" in text else ""
    assert found[-1].text == f"all 2 solutions{turned}"


@pytest.mark.first(5)
@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("1 - D**2", "1 - D", "exponent: D**2 instead of D"),
        ("atan2(y, x)", "atan2(x, y)", "order of the arguments: atan2(y, x)"),
        (" - atan2", " + atan2", "sign of the 2nd term"),
        ("a2*s2", "a1*s2", "index: a2 instead of a1"),
        ("x**2 + y**2", "x**2 + y", "exponent: y**2 instead of y"),
        ("a1 + a2*c2", "a1 + a2*c1", "index: c2 instead of c1"),
        ("/(2*a1*a2)", "/(a1*a2)", "number"),
        ("- a2**2)", ")", "missing term: a2**2"),
        ("atan2(y, x)", "atan(y/x)", "atan2: atan2(y, x) instead of atan(y/x)"),
        ("atan2(+-sqrt(1 - D**2), D)", "atan(+-sqrt(1 - D**2)/D)", "atan2: atan2(+-sqrt(1 - D**2), D)"),
    ],
)
def test_a_slip_is_named_with_what_repairs_it_and_shown_where_it_fails(old: str, new: str, said: str) -> None:
    assert old in PLANAR
    found = checked("planar-2r-perugia", PLANAR.replace(old, new))
    assert said in change(found)
    wrong = next(finding for finding in found if not finding.verdict.equal)
    assert wrong.verdict.counter_example.values
    assert all(f.role is not Role.BRANCHES for f in found)


def test_a_lost_plus_minus_loses_a_branch_that_has_its_name() -> None:
    found = checked("planar-2r-perugia", PLANAR.replace("+-", ""))
    assert outcomes(found)["q2"] is Outcome.SOME
    assert change(found) == "+- missing: +-sqrt(1 - D**2) instead of sqrt(1 - D**2)"
    assert found[-1].missing == ("elbow up",)
    assert found[-1].text == "1 of 2 solutions"


def test_signs_that_belong_together_are_judged_together_and_circles_refused() -> None:
    text = "r = +-sqrt(px**2 + py**2 - d2**2); theta1 = atan2(py, px) - atan2(d2, {0}); theta2 = atan2({1}, pz)"
    right = "c1*px + s1*py"
    assert all(
        f.verdict.equal for f in checked("spherical-arm", text.format("r", right) + "; d3 = s2*(c1*px + s1*py) + c2*pz")
    )
    with pytest.raises(CheckError, match="given by each other"):
        checked(
            "planar-2r-perugia", "theta1 = atan2(y - a2*s12, x - a2*c12); theta2 = atan2(y - a1*s1, x - a1*c1) - theta1"
        )


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("c2 = (x**2 + y**2 - a1**2 - a2**2)/(2*a1*a2); c2 = +-sqrt(1 - c2**2)", "left side: s2 instead of c2"),
        (PLANAR.splitlines()[0] + "; theta1 = atan2(+-sqrt(1 - D**2), D)", "left side: q2 instead of q1"),
    ],
)
def test_another_left_side_may_be_meant(text: str, said: str) -> None:
    assert change(checked("planar-2r-perugia", text)) == said


def test_an_alternative_or_a_sign_that_never_holds_is_wrong_by_itself() -> None:
    found = checked("planar-2r-perugia", PLANAR.replace("+-sqrt(1 - D**2), D)", "sqrt(1 - D**2), D) or q2 + 1"))
    assert outcomes(found)["q2"] is Outcome.SOME
    right, wrong = checked("planar-2r-perugia", "theta2 = atan2(r21, r11) - theta1 or atan2(r21, r11) + theta1")
    assert (right.verdict.equal, wrong.verdict.equal) == (True, False)
    text = "theta2 = atan2(r21, r11) - theta1"
    assert change(checked("planar-2r-perugia", text.replace("= atan2", "= +-atan2"))) == (
        "+- that is not needed: atan2(r21, r11) - q1"
    )
    assert "+- that is not needed" in change(checked("planar-2r-perugia", PLANAR.replace("atan2(y", "+-atan2(y")))
    assert all(finding.verdict.equal for finding in checked("planar-2r-perugia", PLANAR.replace("a1 + a2", "a1 - -a2")))


WRIST = """\
theta5 = atan2(sqrt(1 - r33**2), r33)
theta4 = atan2(r23, r13)
theta6 = atan2(r32, -r31)
theta4' = theta4 + pi
theta5' = -theta5
theta6' = theta6 + pi
"""


def test_a_second_solution_may_be_given_by_primes() -> None:
    found = checked("spherical-wrist", WRIST)
    assert all(finding.verdict.equal for finding in found)
    assert [finding.quantity for finding in found] == ["q5", "q4", "q6", "q4'", "q5'", "q6'", "inverse"]
    assert found[-1].text == "all 2 solutions"
    latex = r"\theta_4' = \theta_4 + 180^\circ, \quad \theta_5^\prime = -\theta_5 \\ \theta_6' = \theta_6 + \pi"
    first = r"\theta_5 = \arccos r_{33} \\ \theta_4 = \operatorname{atan2}(r_{23}, r_{13}) \\"
    last = r"\theta_6 = \operatorname{atan2}(r_{32}, -r_{31}) \\"
    assert all(finding.verdict.equal for finding in checked("spherical-wrist", first + last + latex, latex=True))


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("= -theta5", "= theta5", "sign"),
        ("theta6 + pi", "theta6", "missing term: pi"),
        ("theta4 + pi", "theta6 + pi", "index"),
    ],
)
def test_a_slip_in_a_primed_line_is_named(old: str, new: str, said: str) -> None:
    found = checked("spherical-wrist", WRIST.replace(old, new))
    primed = [finding for finding in found if finding.quantity.endswith("'") and not finding.verdict.equal]
    (wrong,) = map(judge, primed)
    assert said in wrong.repair.text


def test_primes_are_second_solutions_of_joints_and_signs_are_written_as_in_notes() -> None:
    with pytest.raises(CheckError, match="prime"):
        checked("spherical-wrist", "D' = r33; theta5 = +-acos(r33)")
    assert shown("a + ±1*sqrt(b)") == "a +- sqrt(b)"
    assert shown("±1*sqrt(b)") == "+-sqrt(b)"


def test_an_o_is_the_position_unless_columns_stand_beside_it_and_names_of_the_robot_are_none_of_the_pose() -> None:
    robot = load("scara-perugia")
    assert PoseNames.of(robot, ["ox", "r11"]).entries == {"ox": (1, 4), "r11": (1, 1)}
    assert PoseNames.of(robot, ["ox", "nx", "px"]).entries["ox"] == (1, 2)
    assert PoseNames.of(robot, ["ox", "sx"]).entries["ox"] == (1, 4)
    assert not PoseNames.of(load("skeleton-root"), ["Tx"]).entries
    assert not PoseNames.of(load("thumb"), ["xc"]).meanings


@pytest.mark.parametrize(
    ("word", "entry"),
    {"p_x": (1, 4), "T14": (1, 4), "r_23": (2, 3), "az": (3, 3), "s_y": (2, 2), "nz": (3, 1), "y": (2, 4)}.items(),
)
def test_entries_have_the_names_of_books(word: str, entry: tuple[int, int]) -> None:
    assert PoseNames.of(load("puma560-corke"), [word]).entries == {word: entry}


def test_the_wrist_is_where_the_last_axes_meet_and_that_of_a_planar_arm_its_last_joint() -> None:
    names = PoseNames.of(load("stanford-laschi"), ["xc", "pWy", "w_z", "px", "az"])
    assert names.wrist == {"xc": 0, "pWy": 1, "w_z": 2}
    for place in places(names, {}):
        along = place.values["w_z"] - place.pose[2][3]
        assert abs(along) < 1e-12 or math.isclose(abs(along), abs(place.values.get("d6", 0) * place.values["az"]))
    names = PoseNames.of(load("planar-3r"), ["phi", "cphi", "x", "pWx"])
    assert names.rows == ("x", "phi")
    for place in places(names, {}):
        values = place.values
        total = values["q1"] + values["q2"] + values["q3"]
        assert abs(math.remainder(values["(phi)"] - total, math.tau)) < 1e-12
        assert math.isclose(values["pWx"], values["x"] - values["a3"] * math.cos(total), abs_tol=1e-12)


def test_negative_slides_need_not_be_given_unless_limits_allow_them() -> None:
    free = places(PoseNames.of(load("spherical-arm"), []), {})
    assert {place.required for place in free} == {True, False}
    assert all(place.required is (place.values["q3"] > 0) for place in free)


JOINTS = PrintedInverse(load("planar-3r"), (), {"q23": add(Name("q2"), Name("q3"))})


def test_combinations_are_sums_of_angles_and_what_is_needed_are_their_functions() -> None:
    e = add(Name("q23"), negate(Name("q1")), Pi())
    assert JOINTS.combination(e) == (-1, 1, 1)
    assert JOINTS.combination(multiply(number("1/2"), Name("q1"))) == (Fraction(1, 2), 0, 0)
    assert JOINTS.combination(Pi()) is None
    assert JOINTS.combination(multiply(Name("q1"), Name("q2"))) is None
    e = add(multiply(Name("a1"), Call("cos", (Name("q23"),))), Name("q1"))
    assert list(JOINTS.needed(e)) == [("cos", (0, 1, 1)), ("", (1, 0, 0))]
    assert JOINTS.meaning(Call("sqrt", (Name("q1"),))) is None


TEXT = "D = (x**2 + y**2 - a1**2 - a2**2)/(2*a1*a2); theta2 = atan2(+-sqrt(1 - D**2), D); theta1 = atan2(y, x)"


def ours(task: tuple[str, ...] | None = None) -> tuple[OurSolution, tuple]:
    printed, vocabulary = solution("planar-2r-perugia", TEXT)
    tried = places(vocabulary.pose, vocabulary.sums)
    return OurSolution(Model(printed.robot), printed, vocabulary.pose, task, tried), (printed, vocabulary)


def test_our_formula_stands_with_what_it_names_for_the_task_of_the_text() -> None:
    assert ours()[0].count == 2
    assert ours(("x", "y", "z", "orientation"))[0].count == 1
    found, (printed, _) = ours()
    assert found.text(printed.given[0]) == ("atan2(+-sqrt(1 - D**2), D), D = (px**2 + py**2 - a1**2 - a2**2)/(2*a1*a2)")
    assert found.has_form(printed.given[0].formulas[0])
    assert not found.has_form(printed.given[1].formulas[0])


def test_branches_that_are_met_nowhere_are_missing() -> None:
    found, (_, vocabulary) = ours()
    tried = places(vocabulary.pose, vocabulary.sums)
    assert found.met(tried, lambda place: place.values["q2"] < 0) == (1, ("elbow down",))
    assert found.met(tried, lambda place: True) == (2, ())
    assert found.met(tried, lambda place: place.values["q1"] < 0) == (0, ())


@pytest.mark.parametrize("name", POSE_NAMES[:-1])
def test_every_entry_of_a_pose_has_a_name_in_formulas_of_a_corpus(name: str) -> None:
    text = f"""\
robot: {{name: polar, convention: standard, joints: [{{type: revolute, alpha: -pi/2}}, {{type: prismatic, theta: pi}}]}}
inverse_kinematics: {{formulas: [{{unknown: q1, value: q1, printed: q1 + 2*{name} - {name}*2}}]}}
"""
    (found,) = check_file(corpus_from_bytes(text.encode(), "notes.yaml")).findings
    assert found.verdict.equal
