"""Quantities of single bodies, by name: Jacobians, places and parts of B of link i or of the rotor of joint i."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from functools import cached_property
from typing import Any, NamedTuple

from derive.algebra.ring import Polynomial
from derive.mechanics.dynamic_form import DynamicForm
from derive.mechanics.dynamics import Dynamics
from derive.mechanics.model import MAX_DYNAMIC_TERMS, Model
from derive.mechanics.parts import only_link, only_rotor
from derive.mechanics.vectors import Vector
from derive.robot.robot import Robot

BODY = re.compile(r"((?:Jv|Jw|p)_(?:com|motor)|B_link|B_motor)\[([0-9]+)\]")
"""Names of these quantities: ``Jv_com[2]``, ``p_motor[1]``, ``B_link[3]``."""


class Entries(NamedTuple):
    """A matrix whose entries are counted first and written one by one.

    Attributes:
        shape: Rows and columns.
        size: Number of terms of an entry when multiplied out; indices from 1.
        write: The expression of an entry.
    """

    shape: tuple[int, int]
    size: Callable[[int, int], int]
    write: Callable[[int, int], Any]


def body_quantity(model: Model, kind: str, i: int) -> Entries:
    """The quantity of link i, or of the rotor of joint i, from 1.

    Args:
        model: The closed forms.
        kind: ``Jv_com``, ``Jw_com``, ``Jv_motor``, ``Jw_motor`` (3xn, per rate, world frame), ``p_com``, ``p_motor``
            (3x1, place in the world) or ``B_link``, ``B_motor`` (nxn, the body's part of the inertia matrix).
        i: The link or joint.
    """
    k = model.kinematics
    match kind:
        case "Jv_com":
            return _columns(model, k.linear_columns(k.com(i)))
        case "Jw_com":
            return _columns(model, k.angular_columns(i))
        case "Jv_motor":
            return _columns(model, k.linear_columns(k.motor_place(i)))
        case "Jw_motor":
            return _columns(model, k.motor_angular_columns(i))
        case "p_com":
            return _columns(model, [k.com(i)])
        case "p_motor":
            return _columns(model, [k.motor_place(i)])
    part = only_link(model.robot, i) if kind == "B_link" else only_rotor(model.robot, i)
    return _InertiaPart(model, part).entries


def derivative_quantity(model: Model, i: int, j: int, k: int) -> Entries:
    """dB_ij/dq_k, 1x1; indices from 1."""
    p, form = model.dynamics.derivative(i - 1, j - 1, k - 1), model.dynamic_form
    size = model.dynamics.expanded_size(p)
    return Entries((1, 1), lambda row, column: size, lambda row, column: form.entry(p, model.christoffel_limit))


def _columns(model: Model, columns: Sequence[Vector[Polynomial]]) -> Entries:
    return Entries(
        (3, len(columns)),
        lambda row, column: len(columns[column - 1][row - 1]),
        lambda row, column: model.form.kinematic(columns[column - 1][row - 1]),
    )


class _InertiaPart:
    """B of a robot in which one body alone has mass."""

    def __init__(self, model: Model, alone: Robot) -> None:
        self._dynamics = Dynamics(alone, model.domain, MAX_DYNAMIC_TERMS)
        self._form = DynamicForm(self._dynamics, model.form)
        self._n = alone.n

    @property
    def entries(self) -> Entries:
        size = self._dynamics.expanded_size
        return Entries(
            (self._n, self._n),
            lambda i, j: size(self._matrix[i - 1][j - 1]),
            lambda i, j: self._form.entry(self._matrix[i - 1][j - 1], self._limit),
        )

    @cached_property
    def _matrix(self) -> list[list[Polynomial]]:
        return self._dynamics.inertia_matrix

    @cached_property
    def _limit(self) -> int:
        return self._form.limit(self._matrix[i][j] for i in range(self._n) for j in range(i + 1))
