"""Sides against each other and against quantities: letters for anything, and matrices on both sides."""

import pytest

from derive.checking.latex.comparing import VAGUE
from derive.robot.robot import Robot
from tests.checking.test_pages import ANT, checked

W = r" $$w = \dot q_1 + \dot q_2$$"
ARM = Robot.load("planar-2r-perugia")

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
    is_certain = 1 - slips / 16 >= VAGUE
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
        (r"$$x' = a_2 c_2, \quad x = a_1 c_1 + x' c_1 - a_2 s_1 s_2$$", 1),
        (r"$$7.07 \cdot 2 + 1.234 = 15.374, \quad s_1 = s_1$$", 2),
    ],
)  # fmt: skip
def test_what_people_write_otherwise_is_right_all_the_same(text: str, equal: int) -> None:
    report = checked(ARM, text)
    assert (report.equal, report.wrong) == (equal, ())
