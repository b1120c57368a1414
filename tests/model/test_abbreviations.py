"""Names for what repeats stand for what was there: put back, they give the quantity."""

from __future__ import annotations

import pytest

from derive.model import abbreviations, dynamic_form
from derive.model.dynamic_model import DynamicModel
from derive.model.model import Model
from derive.robot.robot import Robot

ROBOTS = ["planar-2r-perugia", "scara-perugia"]


@pytest.mark.parametrize("name", ROBOTS)
@pytest.mark.parametrize(
    ("quantity", "by"),
    [*((q, "christoffel") for q in abbreviations.BY_RATES), *((q, "coefficients") for q in abbreviations.BY_CONSTANTS)],
)
def test_definitions_put_back_give_the_quantity(name: str, quantity: str, by: str) -> None:
    model = Model(Robot.load(name))
    written, names = model.abbreviated(quantity, by)
    difference = written.subs(dict(names)) - getattr(model, quantity)
    assert all(entry.expand(trig=True).equals(0) for entry in difference)


@pytest.mark.parametrize("name", ROBOTS)
def test_every_name_is_used_and_defined_before_it_is(name: str) -> None:
    model = Model(Robot.load(name))
    written, names = model.abbreviated("B", "coefficients")
    assert set(names) <= written.free_symbols


def test_long_entries_are_not_expanded() -> None:
    """The budget of `DynamicForm` is what decides."""
    model = DynamicModel(Robot.load("planar-2r-perugia"))
    form = model.dynamic_form
    assert isinstance(form, dynamic_form.DynamicForm)
    entry = model.dynamics.inertia_matrix[0][0]
    long, short = form.entry(entry, 10**6), form.entry(entry, 0)
    assert short != long
    assert len(short.free_symbols) <= len(long.free_symbols)
