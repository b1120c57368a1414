"""Left sides and the values that a robot gives them."""

from __future__ import annotations

import pytest

from derive.checking.latex.left import taken_apart
from derive.checking.latex.matrices import Entry, Table
from derive.checking.latex.meanings import EntryNames, Meanings
from derive.lecture.sympy_conversion import expression_from_sympy
from derive.model.model import Model
from derive.robot.expression import ZERO
from derive.robot.robot import Robot

MODEL = Model(Robot.load("planar-2r-perugia"))
MEANINGS = Meanings(MODEL)


def values(text: str) -> list[object]:
    left = taken_apart(text)
    assert left is not None
    return [right.value for target in MEANINGS.targets(left) if (right := MEANINGS.right(target))]


def test_a_left_side_has_the_value_of_its_quantity() -> None:
    assert MODEL.quantity("B") in values(r"\mathbf{B}(\mathbf{q})")
    assert MODEL.quantity("B").extract([0], [1]) in values("b_{12}")


def test_names_of_entries_stand_for_the_derived_ones() -> None:
    names = EntryNames(MEANINGS)
    assert names["b12"] == expression_from_sympy(MODEL.quantity("B")[0, 1])
    for name in ("b19", "a1b"):
        with pytest.raises(KeyError):
            names[name]


def test_what_is_asked_about_agrees_with_its_entries_only() -> None:
    (whole,) = (right for right in MEANINGS.asked("B") if right.rows == (1, 2))
    assert whole.shown == "B"
    entry, of_gravity = (
        next(r for t in MEANINGS.targets(left) if (r := MEANINGS.right(t)))
        for left in map(taken_apart, ("b_{12}", "g_1"))
        if left
    )
    assert entry.shown == "B[1,2]"
    assert entry.agrees(whole)
    assert not of_gravity.agrees(whole)


def test_a_vector_fits_as_a_row_too() -> None:
    (gravity, *_) = MEANINGS.asked("g")
    row = Table(((Entry(ZERO), Entry(ZERO)),))
    assert gravity.fitting(row) == row.transposed
    assert gravity.fitting(Table(((Entry(ZERO),),))) is None
