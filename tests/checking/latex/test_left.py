"""What left sides mean."""

from __future__ import annotations

import pytest

from derive.checking.latex.left import Target, Turned, candidates, is_scalar, taken_apart

N = 3


def meanings(text: str, n: int = N) -> list[Target]:
    left = taken_apart(text)
    return [] if left is None else list(candidates(left, n))


@pytest.mark.parametrize(
    ("text", "quantity"),
    [
        (r"\mathbf{T}_3^0", "T[0,3]"),
        (r"T^0_2", "T[0,2]"),
        (r"^0T_2", "T[0,2]"),
        (r"^{0}_{2}T", "T[0,2]"),
        (r"T_e^b", "T"),
        (r"\mathbf{A}_2^1(q_2)", "A[2]"),
        (r"^{1}A_{2}", "A[2]"),
        ("B(q)", "B"),
        (r"\mathbf{C}(\mathbf{q}, \dot{\mathbf{q}})", "C"),
        (r"\dot{\mathbf{B}}", "Bdot"),
        (r"C(q,\dot q)\dot q", "Cqd"),
        (r"\Gamma_{1,12}", "christoffel[1,1,2]"),
        (r"\det(\mathbf{J})", "detJ"),
        (r"\mathbf{J}_v^{\ell_2}", "Jv_com[2]"),
        (r"J_{\omega_{c2}}", "Jw_com[2]"),
        (r"\boldsymbol{\phi}_{\mathrm{RPY}}", "rpy"),
    ],
)
def test_the_likeliest_meaning_comes_first(text: str, quantity: str) -> None:
    assert meanings(text)[0] == Target(quantity)


@pytest.mark.parametrize(
    ("text", "target"),
    [
        ("b_{12}", Target("B", (1,), (2,))),
        (r"\tau_2", Target("tau", (2,))),
        ("p_x", Target("p", (1,))),
        ("y", Target("p", (2,))),
        ("n_z", Target("T", (3,), (1,))),
        ("J_P", Target("J", (1, 2, 3))),
        ("T_{14}", Target("T", (1,), (4,))),
        (r"\mathbf{R}_2^0", Target("T[0,2]", (1, 2, 3), (1, 2, 3))),
    ],
)
def test_parts_of_quantities(text: str, target: Target) -> None:
    assert target in meanings(text)


def test_frames_have_the_labels_of_the_joints() -> None:
    left = taken_apart("T_6^3")
    assert left is not None
    assert candidates(left, 3, first=4)[0] == Target("T[0,3]")


def test_an_entry_is_one_formula_and_a_matrix_is_not() -> None:
    assert is_scalar(Target("B", (1,), (2,)))
    assert is_scalar(Target("g", (1,)))
    assert not is_scalar(Target("B"))


@pytest.mark.parametrize("text", ["a + b", r"\frac{a}{b}", "", "2", "T T"])
def test_what_is_no_single_symbol_names_nothing(text: str) -> None:
    assert meanings(text) == []


@pytest.mark.parametrize(
    ("text", "target"),
    [
        (r"\mathbf{J}^T", Target("J", turned=Turned.TRANSPOSED)),
        (r"(\mathbf{T}^0_2)^{-1}", Target("T[0,2]", turned=Turned.INVERTED)),
        (r"R_2^{0\top}", Target("T[0,2]", (1, 2, 3), (1, 2, 3), turned=Turned.TRANSPOSED)),
        (r"^0R_2^{-1}", Target("T[0,2]", (1, 2, 3), (1, 2, 3), turned=Turned.INVERTED)),
        (r"J^{-T}", Target("J", turned=Turned.BOTH)),
        (r"M(q)^{-1}", Target("B", turned=Turned.INVERTED)),
    ],
)
def test_transposes_and_inverses_are_those_of_what_is_known(text: str, target: Target) -> None:
    assert target in meanings(text)
    assert all(other.turned is target.turned for other in meanings(text))
