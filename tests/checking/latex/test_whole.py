"""Matrices as a whole: one cause for several wrong entries, and products of transforms as chains of frames."""

import pytest

from derive.checking.latex.left import taken_apart
from derive.checking.latex.meanings import Meanings
from derive.checking.latex.targets import Target, candidates
from derive.checking.latex.whole import chained, factors, frames_of
from derive.model.model import Model
from derive.robot.robot import Robot
from tests.checking.test_pages import ANT, checked

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
        (r"T_1^0 T_3^2", None),
        (r"T_1^0", None),
    ],
)
def test_a_product_of_transforms_leads_from_its_first_frame_to_its_last(
    text: str, frames: tuple[int, int] | None
) -> None:
    meanings, lefts = Meanings(Model(ANT)), factors(text)
    assert (chained(meanings, lefts, 3) if lefts else None) == frames


def test_a_product_alone_is_compared_and_one_that_skips_a_frame_is_not() -> None:
    assert checked(ANT, r"$$T_3^0 = T_1^0 T_2^1 T_3^2$$").equal == 1
    skipping = checked(ANT, r"$$T_3^0 = T_1^0 T_3^2$$ $$p_z = d_1 + a_2 s_2 + a_3 s_{23}$$")
    assert (skipping.equal, len(skipping.unread)) == (1, 1)


def test_frames_are_those_of_transforms_and_rotations_only() -> None:
    assert frames_of(Target("A[2]"), 3) == (1, 2)
    assert frames_of(Target("T"), 3) == (0, 3)
    assert frames_of(Target("T[1,3]", (1, 2, 3), (4,)), 3) is None
    assert frames_of(Target("B"), 3) is None


def test_a_partial_derivative_is_an_entry_of_the_jacobian() -> None:
    left = taken_apart(r"\frac{\partial y}{\partial \theta_2}")
    assert left is not None
    assert Target("J", (2,), (2,)) in candidates(left, 2)
    planar = Robot.load("planar-2r-perugia")
    report = checked(planar, r"$$\frac{\partial x}{\partial \theta_2} = -a_2 \sin(\theta_1 + \theta_2)$$")
    assert (report.equal, report.wrong) == (1, ())
