"""How printed solutions of the inverse kinematics are read and repaired."""

import math

import pytest

from derive.api.robots import load
from derive.checking.comparison import check_file
from derive.checking.files import corpus_from_bytes
from derive.checking.formulas.branches import with_atan2
from derive.checking.formulas.edits import SlipKind
from derive.checking.formulas.findings import Finding, Outcome, judge
from derive.checking.inverse.check import names_inverse
from derive.checking.inverse.poses import places
from derive.checking.inverse.printed import PrintedInverse, determined_joints, free_joints, is_same
from derive.checking.inverse.reading import Vocabulary, assembled, gives_joints, latex_equations, text_equations
from derive.checking.inverse.repair import Repairer
from derive.checking.latex.names import plus_minus
from derive.errors import CheckError, Location
from derive.model.model import Model
from derive.robot.expression import Call, Expression, Name, to_text
from tests.refusals import one_message


def test_a_chain_of_sides_names_and_gives_whichever_side_is_the_name() -> None:
    printed, vocabulary = solution(
        "scara-perugia", "alpha = theta1 + theta2 - theta4 = atan2(r12, r11); theta1 = 0; theta2 = 0"
    )
    assert vocabulary.new == {"alpha"}
    assert [line.name for line in printed.lines if line.target is None] == ["alpha"]
    assert printed.given[0].quantity == "q1 + q2 - q4"
    assert not printed.meaning(Name("alpha"))
    printed, _ = solution("planar-2r-perugia", "r = sqrt(x**2 + y**2) = theta2*r; theta2 = r; theta1 = atan2(y, x)")
    assert [line.quantity for line in printed.given] == ["q2*r", "q2", "q1"]
    printed, vocabulary = solution("scara-perugia", "theta1 + theta2 - theta4 = alpha = atan2(r12, r11)")
    assert vocabulary.new == {"alpha"}
    assert [line.quantity for line in printed.lines] == ["alpha", "q1 + q2 - q4"]
    printed, _ = solution("planar-2r-perugia", "r = sqrt(x**2 + y**2); r*cos(theta1) = x; theta1 = atan2(y, x)")
    assert [line.quantity for line in printed.given] == ["r*c1", "q1"]


def test_joints_have_the_names_of_books() -> None:
    found = Vocabulary.of(load("scara-perugia"), ["theta1", "d3", "th_2", "q_4", "theta3", "theta12", "C2", "sgn"], [])
    assert found.meanings["theta1"] == Name("q1")
    assert found.meanings["d3"] == Name("q3")
    assert found.meanings["th_2"] == Name("q2")
    assert "theta3" not in found.meanings
    assert list(found.sums) == ["theta12"]


def test_the_same_line_twice_is_an_alternative_and_conditions_of_the_pose_give_nothing() -> None:
    printed, _ = solution("planar-2r-perugia", "theta2 = x; theta1 = atan2(y, x) or q1 + pi; theta2 = y")
    assert [len(line.formulas) for line in printed.given] == [2, 2]
    with pytest.raises(CheckError, match="no line gives a joint variable"):
        solution("planar-2r-perugia", "r13 = 0")


def solution(robot: str, text: str) -> tuple[PrintedInverse, Vocabulary]:
    arm = load(robot)
    return assembled(arm, *text_equations(text, arm, Location("notes"), plus_minus()))


def test_a_line_has_a_value_for_every_choice() -> None:
    text = "r = +-sqrt(x**2 + y**2 - a1**2); theta2 = atan2(+-r, x) or pi; theta1 = atan2(r, y)"
    printed, _ = solution("planar-2r-perugia", text)
    first, second = printed.given
    assert len(printed.choices(first)) == 3
    assert list(printed.shared((first, second))) == list(printed.choices(second))
    assert list(printed.coupled()) == [(first, second)]
    assert [line.name for line in printed.named_before(first)] == ["r"]


def test_sums_are_known_before_their_terms_and_joints_that_no_line_gives_are_known() -> None:
    text = "theta3 = theta123 - theta1 - theta2; theta123 = atan2(r21, r11)\n"
    text += "theta2 = atan2(px, py)\ntheta1 = atan2(py, px)"
    printed, _ = solution("planar-3r", text)
    assert determined_joints(printed) == ("q1", "q2", "q3")
    assert free_joints(printed) == ()
    printed, _ = solution("planar-3r", "theta23 = atan2(r21, r11) - theta1; theta2 = theta23 - theta3")
    assert free_joints(printed) == ("q1", "q3")
    assert determined_joints(printed) == ("q2",)
    assert determined_joints(solution("planar-2r-perugia", "c2 = x/a1")[0]) == ()
    assert determined_joints(solution("planar-2r-perugia", "c2 = x/a1; s2 = y/a1")[0]) == ("q2",)


def test_lines_that_need_each_other_and_too_many_signs_are_refused() -> None:
    printed, _ = solution("planar-2r-perugia", "theta1 = atan2(y, x) - theta2; theta2 = atan2(y, x) - theta1")
    with pytest.raises(CheckError, match="q1, q2 are given by each other"):
        _ = determined_joints(printed)
    with pytest.raises(CheckError, match="given by each other"):
        solution("planar-2r-perugia", "K = L + 1; L = K - 1; theta1 = K")
    with pytest.raises(CheckError, match="plus-minus signs"):
        solution("planar-2r-perugia", "theta1 = " + "".join(f"+-a{1 + k % 2}" for k in range(11)))


def test_truth_is_what_a_line_should_give_and_a_side_without_a_value_says_nothing() -> None:
    printed, vocabulary = solution("planar-2r-perugia", "theta1 = atan2(y - a2*s12, x - a2*c12)")
    (line,) = printed.given
    assert printed.is_angle(line)
    assert all(printed.hits(line, place) for place in places(vocabulary.pose, vocabulary.sums))
    printed, vocabulary = solution("planar-2r-perugia", "sqrt(c1) = x; theta1 = 0")
    hits = [printed.hits(printed.given[0], place) for place in places(vocabulary.pose, vocabulary.sums)]
    assert {True, False} == set(hits)


def test_angles_are_the_same_up_to_full_turns_and_calls_are_exchanged_everywhere() -> None:
    assert is_same(1 + 2 * math.pi, 1, True)
    assert not is_same(1 + 2 * math.pi, 1, False)
    assert not is_same(1 + math.pi, 1, True)
    x, y = Name("x"), Name("y")
    e = Call("Atan2", (Call("Atan2", (x, y)), y))
    assert with_atan2(e, "Atan2", True) == Call("atan2", (y, Call("atan2", (y, x))))


def sides(text: str) -> list[list[str]]:
    robot = load("planar-2r-perugia")
    equations, _ = text_equations(text, robot, Location("notes"), plus_minus())
    return [[part.text for part in side.parts] for equation in equations for side in equation]


def formula(text: str) -> Expression:
    robot = load("planar-2r-perugia")
    ((_, side),), _ = text_equations(f"theta1 = {text}", robot, Location("notes"), plus_minus())
    return side.parts[0].read({})


def test_lines_end_at_line_breaks_semicolons_and_commas_before_the_next_name_and_have_an_equals_sign() -> None:
    text = "where D = a1, q2 = atan2(D, a1) or -q2\nq1 = 1; c2 = 0\n\n"
    assert sides(text) == [["D"], ["a1"], ["q2"], ["atan2(D, a1)", "-q2"], ["q1"], ["1"], ["c2"], ["0"]]
    with pytest.raises(CheckError, match="notes:2:3: a line is not an equation"):
        sides("q1 = 1\n  atan2(a1, a2)")


@pytest.mark.parametrize(
    ("text", "read"),
    [
        ("+-sqrt(a1)", "±1*sqrt(a1)"), ("a1 ± a2*a1", "a1 + ±1*a2*a1"), ("a1 -+ a2", "a1 - ±1*a2"),
        ("a1 +/- a2", "a1 + ±1*a2"), ("arctan2(a1, a2)", "atan2(a1, a2)"), ("Atan2(a1, a2)", "Atan2(a1, a2)"),
        ("A tan(a1, a2)", "Atan2(a1, a2)"), ("atan(a1, a2)", "Atan2(a1, a2)"),
        ("arctan((a1 + a2)/a2)", "atan((a1 + a2)/a2)"), ("ArcCos(a1)", "acos(a1)"), ("asin(a1)", "asin(a1)"),
        ("a1 + 180°", "a1 + pi"),
    ],
)  # fmt: skip
def test_what_the_grammar_does_not_have_is_rewritten(text: str, read: str) -> None:
    assert to_text(formula(text)) == read


@pytest.mark.parametrize(
    ("text", "place"),
    [("+-sqrt(a1) + zz", "notes:1:23"), ("arctan2(a1, a2) $", "notes:1:26"), ("a1 +- (a2", "notes:1:16")],
)
def test_places_are_those_of_the_text_as_it_was_typed(text: str, place: str) -> None:
    with one_message(CheckError, place, ""):
        formula(text)


ROBOT = load("planar-2r-perugia")


@pytest.mark.parametrize(
    ("latex", "read"),
    [
        (r"\pm\sqrt{a_1}", ["±1*sqrt(a1)"]), (r"a_1 \mp a_2", ["a1 + ±1*a2"]),
        (r"\arccos\left(\frac{a_1}{a_2}\right)", ["acos(a1/a2)"]), (r"\cos^{-1} a_1", ["acos(a1)"]),
        (r"\tan^{-1}(a_1, a_2)", ["Atan2(a1, a2)"]), (r"A\tan(a_1, a_2)", ["Atan2(a1, a2)"]),
        (r"\text{Atan2}(a_1, a_2)", ["Atan2(a1, a2)"]), (r"{\rm atan2}(a_1, a_2)", ["atan2(a1, a2)"]),
        (r"\operatorname{arctan}\frac{a_1}{a_2}", ["atan(a1/a2)"]), (r"a_1 \text{ or } a_2", ["a1", "a2"]),
        (r"\begin{cases} a_1 & p_x > 0 \\ a_2 & p_x < 0 \end{cases}", ["a1", "a2"]),
    ],
)  # fmt: skip
def test_right_sides_are_read(latex: str, read: list[str]) -> None:
    text = rf"\theta_1 = {latex}"
    ((_, side),), _ = latex_equations(text, ROBOT, Location("notes"), plus_minus(), document=False)
    assert [to_text(part.read({})) for part in side.parts] == read


def test_names_stand_on_the_line_and_a_text_is_a_solution_where_a_joint_is_an_arc() -> None:
    _, words = latex_equations(r"p_{Wx} = r_{11} c_\phi + o_x", ROBOT, Location("notes"), plus_minus(), document=False)
    assert {"pWx", "r11", "cphi", "ox"} <= set(words)
    assert gives_joints(r"\theta_2 = \arccos D", ROBOT)
    assert gives_joints(r"D = 1 \\ q_{1} &= \operatorname{atan2}(y, x)", ROBOT)
    assert not gives_joints(r"\theta_2 = 0", ROBOT)
    assert not gives_joints(r"x = a_1 c_1", ROBOT)
    assert not gives_joints(r"\theta_7 = \arccos D", ROBOT)


KNOWN = ("a1", "a2", "q1", "q2", "x", "y")


def test_nothing_repairs_what_is_wrong_in_many_ways() -> None:
    found, vocabulary = solution("planar-2r-perugia", "theta1 = atan2(a1*s2, x*y - 7)")
    (line,) = found.given
    tried = places(vocabulary.pose, vocabulary.sums)
    kinds = (SlipKind.SIGN, SlipKind.INDEX)
    assert Repairer(found, [line], tried, KNOWN).first(kinds, [(line, line.formulas[0])]) is None


ARM = """\
robot:
  name: arm
  convention: standard
  joints: [{type: revolute, a: a1}, {type: revolute, a: a2}]
inverse_kinematics:
"""
LINES = """\
  lines:
    - theta1 = atan2(y, x) - atan2(a2*s2, a1 + a2*c2)
    - D = (x**2 + y**2 - a1**2 - a2**2)/(2*a1*a2)
    - theta2 = atan2(+-sqrt(1 - D**2), D)
"""
LATEX = r"""  task: [x, y]
  latex: |
    D = \frac{x^2 + y^2 - a_1^2 - a_2^2}{2 a_1 a_2}
    \theta_2 = \arccos D \\
    \theta_1 = \operatorname{atan2}(y, x) - \operatorname{atan2}(a_2 s_2, a_1 + a_2 c_2)
"""


def findings(block: str) -> tuple[Finding, ...]:
    return check_file(corpus_from_bytes((ARM + block).encode(), "notes.yaml")).findings


def test_lines_of_any_order_are_one_solution_in_plain_text_and_latex() -> None:
    assert [f.verdict.equal for f in findings(LINES)] == [True, True, True]
    block = "  lines: |\n    D = (x**2 + y**2 - a1**2 - a2**2)/(2*a1*a2)\n    theta2 = atan2(+-sqrt(1 - D), D)\n"
    (wrong,) = findings(block)
    assert (judge(wrong).outcome, str(wrong.location)) == (Outcome.WRONG, "notes.yaml:8:14")
    some, right, branches = findings(LATEX.replace("a_2}\n", "a_2} \\\\\n"))
    assert (judge(some).outcome, str(some.location)) == (Outcome.SOME, "notes.yaml:9:16")
    assert right.verdict.equal
    assert branches.missing == ("elbow up",)


def test_several_solutions_are_a_list_and_errata_are_marked() -> None:
    item = "  - lines: [{}]\n    status: {}\n"
    block = item.format("theta2 = acos(x)", "erratum") + item.format('"theta2 = atan2(r21, r11) - theta1"', "ok")
    found = findings(block)
    assert [f.erratum for f in found if not f.verdict.equal] == [True]
    assert [f.erratum for f in found if f.verdict.equal] == [False, False]


@pytest.mark.parametrize("order", ["atan2: xy\n", ""])
def test_the_cosine_may_be_the_first_argument_where_the_file_says_so(order: str) -> None:
    found = findings(f'  lines: ["theta2 = atan2(r11, r21) - theta1"]\n  {order}')
    assert found[0].verdict.equal is bool(order)


@pytest.mark.parametrize(
    ("block", "message"),
    [
        ("  note: none\n", "needs either 'lines', 'latex' or 'formulas'"),
        ("  lines: [theta2]\n", "notes.yaml:6:11: a line is not an equation"),
        ("  lines: ['']\n", "empty solution"),
        ("  lines: [theta2 = 0]\n  task: [x, w]\n", "notes.yaml:7:9"),
        ("  lines: [theta2 = 0]\n  atan2: yz\n", "allowed: yx, xy"),
    ],
)
def test_what_cannot_be_read_is_refused_with_its_place(block: str, message: str) -> None:
    with pytest.raises(CheckError, match=message):
        findings(block)


def test_an_unknown_name_leaves_the_solution_undecidable() -> None:
    for unknown in ("zz", "atan2(zz, x)"):
        (found,) = findings(f'  lines: ["theta2 = {unknown}"]\n')
        assert judge(found).outcome is Outcome.UNDECIDABLE
        assert found.location.line == 6


def test_the_quantity_has_the_names_of_books() -> None:
    model = Model(load("planar-2r-perugia"))
    assert names_inverse(model, "inverse")
    assert not names_inverse(model, "T")
    assert not names_inverse(model, "")
    assert not names_inverse(model, "nothing")
