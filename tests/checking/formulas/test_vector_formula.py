"""Printed vector equations: reading, values, and the change that repairs one."""

from __future__ import annotations

import numpy as np
import pytest

from derive.checking.formulas.edits import SlipKind
from derive.checking.formulas.vector_formula import MAX_LENGTH, Vector, diagnose_vector, names_in, read_vector, value_of
from derive.errors import CheckError, Location

HERE = Location("notes.yaml", 3, 5)
RNG = np.random.default_rng(1)
VALUES = {name: RNG.normal(size=3) for name in ("w", "wd", "p", "w_prev")} | {"I": RNG.normal(size=(3, 3)), "m": 2.5}
EQUATIONS = ["cross(wd, p) + cross(w, cross(w, p))", "-m*(w - 2*wd)", "I @ wd + cross(w, I @ w)", "w", "-w - (p - wd)"]


def read(text: str) -> Vector:
    return read_vector(text, HERE)


@pytest.mark.parametrize("text", EQUATIONS)
def test_what_is_written_reads_as_the_same_equation(text: str) -> None:
    assert read(str(read(text))) == read(text)


def test_the_value_is_that_of_numpy() -> None:
    w, wd, inertia = (VALUES[name] for name in ("w", "wd", "I"))
    expected = inertia @ wd + np.cross(w, inertia @ w) - 2.5 * w
    assert value_of(read("I @ wd + cross(w, I @ w) - m*w"), VALUES) == pytest.approx(expected)


@pytest.mark.parametrize("text", ["w + m", "cross(m, w)", "cross(I, w)"])
def test_shapes_that_do_not_fit_are_refused(text: str) -> None:
    with pytest.raises(ValueError, match="vectors"):
        value_of(read(text), VALUES)


@pytest.mark.parametrize("text", ["w +", "cross(w)", "w & p", "w" * (MAX_LENGTH + 1), ""])
def test_what_is_no_equation_is_refused_at_its_place(text: str) -> None:
    with pytest.raises(CheckError) as caught:
        read(text)
    assert caught.value.location is not None
    assert caught.value.location.line == 3


@pytest.mark.parametrize(
    ("wrong", "kinds"),
    [
        ("cross(wd, p) - cross(w, cross(w, p))", (SlipKind.SIGN,)),
        ("cross(wd, p) + cross(w, cross(w_prev, p))", (SlipKind.INDEX,)),
        ("cross(wd, p) + cross(w, cross(w, wd))", (SlipKind.SYMBOL,)),
        ("cross(wd, p) + (w + cross(w, p))", (SlipKind.SYMBOL,)),
        ("cross(wd, p) + cross(w_prev, cross(w_prev, p))", (SlipKind.INDEX, SlipKind.INDEX)),
    ],
)
def test_a_slip_is_found(wrong: str, kinds: tuple[SlipKind, ...]) -> None:
    right = value_of(read("cross(wd, p) + cross(w, cross(w, p))"), VALUES)

    def holds(e: Vector) -> bool:
        try:
            value = value_of(e, VALUES)
        except ValueError:
            return False
        return np.shape(value) == (3,) and bool(np.allclose(value, right))

    repair = diagnose_vector(read(wrong), list(VALUES), holds)
    assert repair is not None
    assert repair.kinds == kinds
    assert holds(read(repair.formula.name))


def test_names_come_in_order() -> None:
    assert list(names_in(read("I @ wd + cross(w, I @ w)"))) == ["I", "wd", "w", "I", "w"]
