"""What a text says as a whole: names, poses and frames, letters for anything, and matrices with one cause of slips."""

import pytest

from derive.checking.latex.comparing import VAGUE
from derive.checking.latex.conditions import ways
from derive.checking.latex.left import Scripts, taken_apart
from derive.checking.latex.poses import MARK, Poses
from derive.checking.latex.scope import Scope
from derive.checking.latex.sides import SideReading
from derive.checking.latex.targets import Target, candidates
from derive.checking.latex.whole import unused
from derive.errors import Location
from derive.model.model import Model
from derive.robot.expression import Call, Name, Pi, multiply, number, to_text
from derive.robot.robot import Robot
from tests.checking.test_pages import ANT, checked
from tests.rows import robot_of_rows

ARM = Robot.load("planar-2r-perugia")
ROTATION = r"\begin{bmatrix} c_2 & -s_2 \\ s_2 & c_2 \end{bmatrix}"


def scope(text: str) -> Scope:
    return Scope(Model(ARM), text, Location("page"), document=True)


def test_definitions_may_stand_behind_their_use_and_those_without_use_are_told() -> None:
    found = scope(r"$$x = k c_1 + h$$ $$h = k_2 c_{12}$$ $$k_2 = a_2$$ $$k = a_1$$ $$z_9 = a_1$$")
    assert sorted(found.definitions) == ["h", "k", "k2", "z9"]
    alone = {
        compared: sorted(name for name, *_ in unused(found.defined(), found.equations, {*compared}))
        for compared in ((0,), ())
    }
    assert alone == {(0,): ["z9"], (): ["h", "k", "k2", "z9"]}


def test_the_reading_is_what_most_matrices_need() -> None:
    assert scope(f"$$R^1_2 = {ROTATION}$$").meanings.reading == frozenset()
    turned = scope(f"$$R_1^2 = {ROTATION}$$")
    assert turned.meanings.reading == {Scripts.RIGHT}
    assert turned.readings == ["transforms are read as T^i_j = pose of frame i in frame j (1 of 1 matrix)"]


SPHERICAL = robot_of_rows(
    "R d: d1, alpha: pi/2 | R a: a2 | R alpha: pi/2 | R d: d4, alpha: -pi/2 | R alpha: pi/2 | R d: d6"
)
WRIST = r"""
$$\theta_4 = \text{atan2}(r_{23}, r_{13})$$
$$\theta_5 = \pm\arccos(r_{33})$$
$$\theta_6 = \text{atan2}(r_{32}, -r_{31})$$
"""


def test_rotations_are_those_of_the_wrist_where_most_equations_need_it() -> None:
    report = checked(SPHERICAL, WRIST)
    assert (report.equal, report.wrong, report.unread) == (3, (), ())
    assert "rotations from frame 3 (3 of 3 equations)" in report.readings[0]
    slipped = checked(SPHERICAL, WRIST.replace("-r_{31}", "r_{31}"))
    assert [finding.quantity for finding in slipped.wrong] == [r"\theta_6"]


@pytest.mark.parametrize("point", ["x_w", "x_c", "p_{wx}"])
def test_the_centre_of_the_wrist_has_names_of_its_own(point: str) -> None:
    other = point.replace("x", "y")
    report = checked(SPHERICAL, rf"$$\theta_1 = \text{{atan2}}({other}, {point})$$")
    assert (report.equal, report.wrong, report.unread) == (1, (), ())


def test_one_equation_that_no_pose_explains_is_not_called_wrong() -> None:
    report = checked(SPHERICAL, r"$$\theta_1 = \text{atan2}(p_x, p_y)$$ $$\theta_2 = \arccos(p_z)$$")
    assert report.wrong == ()
    assert len(report.unread) == 2
    assert "which pose p" in report.unread[0]


def test_the_usual_reading_is_the_end_effector_in_the_base() -> None:
    first, *others = Poses(Model(SPHERICAL), "p_x r_{13} x_3", {}).readings
    assert (first.position, first.reference, first.usual) == (6, 0, True)
    assert {MARK + name for name in ("px", "r13", "x3")} <= first.values.keys()
    assert not any(reading.usual for reading in others)


W = r" $$w = \dot q_1 + \dot q_2$$"

ENTRIES = (
    *("c_1 c_{23}", "-c_1 s_{23}", "s_1", "c_1 (a_2 c_2 + a_3 c_{23})"),
    *("s_1 c_{23}", "-s_1 s_{23}", "-c_1", "s_1 (a_2 c_2 + a_3 c_{23})"),
    *("s_{23}", "c_{23}", "0", "d_1 + a_2 s_2 + a_3 s_{23}"),
    *("0", "0", "0", "1"),
)


@pytest.mark.parametrize("slips", [0, 1, 5, 6, 7, 8, 12])
def test_a_letter_for_anything_names_a_matrix_of_which_most_entries_are_right(slips: int) -> None:
    entries = ["2" if k < slips else entry for k, entry in enumerate(ENTRIES)]
    rows = r" \\ ".join(" & ".join(entries[k : k + 4]) for k in (0, 4, 8, 12))
    report = checked(ANT, rf"$$H = \begin{{bmatrix}} {rows} \end{{bmatrix}}$$ $$p_z = d_1 + a_2 s_2 + a_3 s_{{23}}$$")
    is_certain = 1 - slips / 16 >= VAGUE and 2 * slips <= sum(entry not in "01" for entry in ENTRIES)
    assert len(report.wrong) == (slips if is_certain else 0)
    assert len(report.unread) == (0 if is_certain else 1)


def test_matrices_on_both_sides_are_compared_entry_by_entry() -> None:
    turn = r"\begin{bmatrix} c_1 & s_1 \\ -s_1 & c_1 \end{bmatrix}"
    place = r"\begin{bmatrix} p_x \\ p_y \end{bmatrix}"
    reach = r"\begin{bmatrix} a_2 c_2 + a_3 c_{23} \\ 0 \end{bmatrix}"
    report = checked(ANT, f"$${turn} {place} = {reach}$$")
    assert (report.equal, report.wrong, report.unread) == (2, (), ())
    slipped = checked(ANT, f"$${turn} {place} = {reach.replace('0', 'a_3')}$$ $$p_z = d_1 + a_2 s_2 + a_3 s_{{23}}$$")
    assert len(slipped.wrong) + len(slipped.unread) == 1


def test_a_name_that_is_given_two_formulas_has_two_meanings_unless_they_are_equal() -> None:
    said = r"$$D = c_3^2$$ $$D = {}$$ $$c_3 = \pm\sqrt{{D}}$$"
    assert checked(ANT, said.format("1 - s_3^2")).equal == 2
    other = checked(ANT, said.format("1 - s_2^2"))
    assert not any(finding.quantity == "D" for finding in other.findings)


def test_a_formula_may_hold_under_a_condition_that_stands_before_it() -> None:
    fixed = r"$$p_z = d_1 + a_2 s_2 + a_3 s_{23}$$ $$p_x = c_1 (a_2 c_2 + a_3 c_{23})$$"
    equation = r"$$p_z - d_1 = (a_2 + a_3) s_2$$"
    assert len(checked(ANT, f"{fixed} {equation}").wrong) == 1
    under = checked(ANT, f"{fixed} $$s_3 = 0$$ {equation}")
    assert under.wrong == ()
    assert under.findings[-1].note == ", where s_3 = 0"
    elsewhere = f"{fixed} $$s_2 = 0$$ {equation.replace('s_2', 'c_2')}"
    assert len(checked(ANT, elsewhere).wrong) == 1


@pytest.mark.parametrize(
    ("text", "equal"),
    [
        (r"$$\theta_2 = \arctan 2(\sin\theta_2, \cos\theta_2)$$", 1),
        (r"$$v = \begin{bmatrix} -a_1 s_1 \dot q_1-a_2 s_{12}w \\ a_1 c_1 \dot q_1+a_2 c_{12}w \end{bmatrix}$$" + W, 2),
        (r"$$c_{12} = \cos(360 + q_1 + q_2)$$", 1),
        (r"$$\det J = a_1 a_2 s_2 = 0$$", 1),
        (r"$$x_1 = a_1 c_1$$ $$\dot x_1 = -a_1 s_1 \dot q_1$$ $$v_1^2 = a_1^2 \dot q_1^2$$", 3),
        (r"$$J_v = \begin{bmatrix} 0 \\ 0 \\ 1 \end{bmatrix} \times \begin{bmatrix} a_2 \\ 0 \\ 0 \end{bmatrix}$$", 0),
        (r"$y = a_1 s_1$" + "\n" + r"$+ a_2 s_{12}$", 1),
        (r"$$x' = a_2 c_2, \quad x = a_1 c_1 + x' c_1 - a_2 s_1 s_2$$", 2),
        (r"$$7.07 \cdot 2 + 1.234 = 15.374, \quad s_1 = s_1$$", 2),
    ],
)  # fmt: skip
def test_what_people_write_otherwise_is_right_all_the_same(text: str, equal: int) -> None:
    report = checked(ARM, text)
    assert (report.equal, report.wrong) == (equal, ())


ROWS = (("c_1 c_{23}", "-c_1 s_{23}", "s_1"), ("s_1 c_{23}", "-s_1 s_{23}", "-c_1"), ("s_{23}", "c_{23}", "0"))


def page(rows: tuple[tuple[str, ...], ...]) -> str:
    return r"$${}^0R_3 = \begin{bmatrix} " + r" \\ ".join(" & ".join(row) for row in rows) + r" \end{bmatrix}$$"


@pytest.mark.parametrize(
    ("rows", "cause"),
    [
        (tuple(zip(*ROWS, strict=True)), "the matrix is transposed"),
        (tuple((a, f"-({b})", c) for a, b, c in ROWS), "the sign of column 2"),
        ((ROWS[0], tuple(f"-({x})" for x in ROWS[1]), ROWS[2]), "the sign of row 2"),
        (tuple((a, c, b) for a, b, c in ROWS), "columns 2 and 3 are exchanged"),
        ((ROWS[1], ROWS[0], ROWS[2]), "rows 1 and 2 are exchanged"),
    ],
)
def test_several_wrong_entries_have_one_cause(rows: tuple[tuple[str, ...], ...], cause: str) -> None:
    report = checked(ANT, page(rows))
    assert len(report.wrong) > 1
    assert {finding.cause for finding in report.wrong} == {cause}


def test_two_different_slips_have_no_common_cause() -> None:
    report = checked(ANT, page((("c_1 s_{23}", "c_1 s_{23}", "s_1"), *ROWS[1:])))
    assert {finding.cause for finding in report.wrong} == {""}


@pytest.mark.parametrize(
    ("text", "frames"),
    [
        (r"T_1^0 T_2^1 T_3^2", (0, 3)),
        (r"{}^0_1T {}^1_2T", (0, 2)),
        (r"A_1 A_2 A_3", (0, 3)),
        (r"\mathbf{A}_1(q_1) \mathbf{A}_2(q_2)", (0, 2)),
        (r"(T_1^0)^{-1} T_3^0", (1, 3)),
        (r"(R_1^0)^T R_3^0", (1, 3)),
        (r"A_1^{-1} T_3^0", (1, 3)),
        (r"T_2^1 T_3^0", None),
        (r"T_1^0 T_3^2", None),
        (r"T_1^0", None),
    ],
)
def test_a_product_of_transforms_leads_from_its_first_frame_to_its_last(
    text: str, frames: tuple[int, int] | None
) -> None:
    found = Scope(Model(ANT), f"$$ {text} = 1 $$", Location("page"), document=True)
    assert SideReading(found, "").side(found.equations[0][0], True).frames == frames


def test_a_product_alone_is_compared_where_its_frames_follow_each_other() -> None:
    assert checked(ANT, r"$$T_3^0 = T_1^0 T_2^1 T_3^2$$").equal == 1
    skipping = checked(ANT, r"$$T_3^0 = T_1^0 T_3^2$$ $$p_z = d_1 + a_2 s_2 + a_3 s_{23}$$")
    assert (skipping.equal, len(skipping.unread)) == (1, 1)


def test_a_partial_derivative_is_an_entry_of_the_jacobian() -> None:
    left = taken_apart(r"\frac{\partial y}{\partial \theta_2}")
    assert Target("J", (2,), (2,)) in candidates(left, 2)
    report = checked(ARM, r"$$\frac{\partial x}{\partial \theta_2} = -a_2 \sin(\theta_1 + \theta_2)$$")
    assert (report.equal, report.wrong) == (1, ())


def test_a_condition_says_what_stands_for_what() -> None:
    one, two, zero = Name("l1"), Name("l2"), number(0)
    assert ways([one, zero]) == ({"l1": zero},)
    assert ways([one, two]) == ({"l2": one}, {"l1": two})
    assert ways([one, two, zero]) == ({"l1": zero, "l2": zero},)
    assert ways([Call("sin", (one,)), zero]) == ({"l1": zero}, {"l1": Pi()})
    assert ways([Call("tan", (one,)), zero]) == ()
    products = [multiply(one, Name("m1")), multiply(two, two, Name("m2"))]
    by = {name: to_text(value) for way in ways(products) for name, value in way.items()}
    assert by == {"l1": "l2*l2*m2/m1", "m1": "l2*l2*m2/l1", "m2": "l1*m1/l2/l2"}
