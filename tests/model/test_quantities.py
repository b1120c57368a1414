"""The registry of quantities says what the model gives, and names are read with their indices."""

from __future__ import annotations

import pytest

from derive.errors import QuantityError
from derive.model.model import Model
from derive.model.quantities import REGISTRY, Quantity, evaluate, parse
from derive.robot.robot import Robot


@pytest.fixture(scope="module")
def model() -> Model:
    """Four joints with axes in all directions, and links."""
    joints = ["a: a1, alpha: pi/2", "a: a2", "d: d3, alpha: -pi/2", "alpha: pi/2"]
    link = "{mass: m, com: [0, 0, l], inertia: {zz: I}}"
    rows = [f"  - {{type: revolute, {cells}}}" for cells in joints]
    text = [
        "name: arm",
        "convention: standard",
        "joints:",
        *rows,
        "gravity: [0, 0, -g]",
        "links:",
        *4 * [f"  - {link}"],
    ]
    return Model(Robot.from_text("\n".join(text) + "\n"))


@pytest.mark.parametrize("quantity", REGISTRY.values(), ids=REGISTRY.keys())
def test_a_quantity_has_the_shape_of_its_row(quantity: Quantity, model: Model) -> None:
    value = quantity.value(model, *[1] * min(quantity.indices))
    sizes = {"n": model.n, "m": model.n - 3}
    sizes |= {"p": len(model.standard_parameter_names), "b": len(model.base_parameter_names)}
    if not quantity.shape:
        assert not hasattr(value, "shape")
    else:
        assert value.shape == tuple(sizes[size] if size in sizes else int(size) for size in quantity.shape.split("x"))


def test_two_indices_of_T_are_frames_where_the_arm_has_them_and_else_an_entry(model: Model) -> None:
    assert evaluate(model, "T[1,4]") == model.transform(1, 4)
    assert evaluate(model, "T[1,4][2,3]") == model.transform(1, 4)[1, 2]
    assert evaluate(model, "T[][1,4]") == model.T[0, 3]
    assert parse(Model(Robot.load("planar-2r-perugia")), "T[1,4]")[2] == (1, 4)


@pytest.mark.parametrize("text", ["M", "T[1,2,3,4,5]", "A[x]", "A", "B[9,1]", "kinetic[1,1]"])
def test_what_is_not_there_is_refused(text: str, model: Model) -> None:
    with pytest.raises(QuantityError):
        evaluate(model, text)
