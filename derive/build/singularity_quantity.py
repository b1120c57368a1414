"""The singularities of a model as the emitters ask for them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from derive.emit.quantity import Quantity
from derive.emit.singularity import SingularBlock, SingularFactor, SingularityQuantity
from derive.mechanics import singularities as mechanics
from derive.mechanics.model import Model

AsQuantity = Callable[[Any], Quantity]


def singularity_quantity(model: Model, as_quantity: AsQuantity, count: Callable[[Any], int]) -> SingularityQuantity:
    """Plain data of ``model.singularities``.

    Args:
        model: The model.
        as_quantity: Makes a quantity of a matrix.
        count: Counts the terms of an expression.
    """
    found = model.singularities
    return SingularityQuantity(
        outcome=found.outcome.value,
        blocks=tuple(_block(block, as_quantity) for block in found.blocks),
        factors=tuple(_factor(factor, count) for factor in found.factors),
        determinant=found.determinant,
        budget=mechanics.MAX_TERMS,
    )


def _block(block: mechanics.Block, as_quantity: AsQuantity) -> SingularBlock:
    reference = block.reference
    matrix = as_quantity(block.matrix)
    return SingularBlock(block.name, block.rows, reference.frame, reference.point, block.others_are_zero, matrix)


def _factor(factor: mechanics.SingularFactor, count: Callable[[Any], int]) -> SingularFactor:
    condition = factor.condition
    return SingularFactor(
        expression=factor.expression,
        exponent=factor.exponent,
        terms=count(factor.expression),
        moving=condition is not None,
        variable=condition.variable if condition else None,
        values=condition.values if condition else (),
        posture=condition.posture.value if condition and condition.posture else "",
    )
