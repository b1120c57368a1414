"""Quantities by name: ``T[1,4]``, ``A[2]``, ``christoffel[1,1,2]``, ``J_11[1,2]``."""

from __future__ import annotations

import difflib
import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from derive.errors import QuantityError
from derive.mechanics.vectors import subtract
from derive.model.dynamic_model import DynamicModel
from derive.model.matrices import columns_matrix

Expr = Any

_NAME = re.compile(r"\s*([A-Za-z][A-Za-z0-9_]*)\s*(?:\[([^\]]*)\])?\s*(?:\[([^\]]*)\])?\s*")


@dataclass(frozen=True)
class Quantity:
    """One row of the registry.

    Attributes:
        name: As the user writes it.
        indices: How many indices it takes (alternatives allowed); further ones pick an entry.
        value: The function of the model and the indices.
        summary: What it is, for lists.
        dynamic: Whether it needs links.
    """

    name: str
    indices: tuple[int, ...]
    value: Callable[..., Expr]
    summary: str
    dynamic: bool = False


def _frame(model: DynamicModel, *indices: int) -> Expr:
    match len(indices):
        case 0:
            return model.T
        case 1:
            return model.frame(*indices)
        case _:
            return model.transform(*indices)


def _determinant(model: DynamicModel) -> Expr:
    return model.det_J()


def _reduced_block(model: DynamicModel) -> Expr:
    """J_11 with its second column subtracted from the first: the same determinant, shorter entries."""
    if model.n < 2:
        raise QuantityError("J_11_reduced of one joint", allowed="two joints or more")
    first, second, *others = model.kinematics.linear_columns(model.kinematics.end.position)[:3]
    return columns_matrix([subtract(first, second), second, *others], write=model.form.kinematic)


REGISTRY = {
    q.name: q
    for q in (
        Quantity("A", (1,), lambda m, i: m.A(i), "DH transform of row i"),
        Quantity("T", (0, 1, 2), _frame, "end effector in the world; T[i] frame i there; T[i,j] frame j in frame i"),
        Quantity("p", (0,), lambda m: m.p, "position of the end effector"),
        Quantity("R", (0,), lambda m: m.R, "orientation of the end effector"),
        Quantity("rpy", (0,), lambda m: m.rpy, "roll, pitch, yaw"),
        Quantity("euler_zyz", (0,), lambda m: m.euler_zyz, "Euler angles ZYZ"),
        Quantity("J", (0,), lambda m: m.J, "geometric Jacobian, world frame"),
        Quantity("J_end", (0,), lambda m: m.J_end, "geometric Jacobian, end-effector frame"),
        Quantity("J_dot", (0,), lambda m: m.J_dot, "rate of change of J, world frame"),
        Quantity("J_rpy", (0,), lambda m: m.J_analytic("rpy"), "analytic Jacobian for roll, pitch, yaw"),
        Quantity("J_zyz", (0,), lambda m: m.J_analytic("zyz"), "analytic Jacobian for Euler ZYZ"),
        Quantity("J_11", (0,), lambda m: m.J[:3, :3], "rows 1-3, columns 1-3 of J"),
        Quantity("J_11_reduced", (0,), _reduced_block, "J_11, its second column subtracted from the first"),
        Quantity("J_12", (0,), lambda m: m.J[:3, 3:], "rows 1-3, the other columns of J"),
        Quantity("J_21", (0,), lambda m: m.J[3:, :3], "rows 4-6, columns 1-3 of J"),
        Quantity("J_22", (0,), lambda m: m.J[3:, 3:], "rows 4-6, the other columns of J"),
        Quantity("detJ", (0,), _determinant, "determinant of J, or of its first three rows for three joints"),
        Quantity("Jv_com", (1,), lambda m, i: m.Jv_com(i), "velocity of the centre of mass of link i", True),
        Quantity("Jw_com", (1,), lambda m, i: m.Jw_com(i), "angular velocity of link i", True),
        Quantity("Jv_motor", (1,), lambda m, i: m.Jv_motor(i), "velocity of rotor i", True),
        Quantity("Jw_motor", (1,), lambda m, i: m.Jw_motor(i), "angular velocity of rotor i", True),
        Quantity("kinetic", (0,), lambda m: m.energy.kinetic, "kinetic energy", True),
        Quantity("potential", (0,), lambda m: m.energy.potential, "potential energy", True),
        Quantity("B", (0,), lambda m: m.B, "inertia matrix", True),
        Quantity("B_link", (1,), lambda m, i: m.B_link(i), "part of B that link i contributes", True),
        Quantity("Bdot", (0,), lambda m: m.Bdot, "time derivative of B", True),
        Quantity("christoffel", (3,), lambda m, i, j, k: m.christoffel(i, j, k), "Christoffel symbol c_ijk", True),
        Quantity("C", (0,), lambda m: m.C, "Coriolis matrix", True),
        Quantity("coriolis_vector", (0,), lambda m: m.coriolis_vector, "Coriolis and centrifugal torques C qd", True),
        Quantity("N", (0,), lambda m: m.N, "Bdot - 2C", True),
        Quantity("g", (0,), lambda m: m.g, "gravity vector", True),
        Quantity("friction", (0,), lambda m: m.friction, "joint friction", True),
        Quantity("tau", (0,), lambda m: m.tau, "equations of motion", True),
        Quantity("regressor", (0,), lambda m: m.regressor, "Y with tau = Y pi, standard parameters pi", True),
        Quantity("standard_parameters", (0,), lambda m: m.standard_parameters, "the standard parameters pi", True),
        Quantity("regressor_base", (0,), lambda m: m.regressor_base, "Y with tau = Y beta", True),
        Quantity("base_parameters", (0,), lambda m: m.base_parameters, "the base parameters beta", True),
    )
}


def evaluate(model: DynamicModel, text: str) -> Expr:
    """A quantity, or an entry of it, by name.

    ``T[2]`` is frame 2; ``T[1,4]`` is the entry in row 1, column 4 where j = 4 is no frame of this robot, and frame 4
    in frame 1 where it is: an entry is always meant by a second bracket, ``T[][1,4]`` or ``T[0,2][1,4]``.

    Raises:
        QuantityError: Unknown name, wrong number of indices or an entry outside.
    """
    quantity, indices, entry = parse(model, text)
    value = quantity.value(model, *indices)
    return value if entry is None else pick(value, entry, text)


def parse(model: DynamicModel, text: str) -> tuple[Quantity, tuple[int, ...], tuple[int, ...] | None]:
    """The registry row, its indices and the entry, if one is asked for."""
    match = _NAME.fullmatch(text)
    if match is None:
        raise QuantityError(
            f"quantity {text!r}", allowed="a name with indices, such as T, A[2], B[1,2], christoffel[1,1,2]"
        )
    quantity = _lookup(match[1])
    first = _integers(match[2], text)
    if match[3] is not None:
        return quantity, first, _integers(match[3], text)
    if len(first) in quantity.indices and not _is_entry(quantity, first, model.n):
        return quantity, first, None
    for count in sorted(quantity.indices):
        if len(first) - count in (1, 2):
            return quantity, first[:count], first[count:]
    counts = " or ".join(map(str, quantity.indices))
    raise QuantityError(
        f"{len(first)} indices in {text!r}", allowed=f"{counts} for {quantity.name}, and an entry behind them"
    )


def _is_entry(quantity: Quantity, indices: tuple[int, ...], n: int) -> bool:
    """Whether two indices of T can only be a row and a column, for the arm has no such frame."""
    return quantity.name == "T" and len(indices) == 2 and max(indices) > n


def _lookup(name: str) -> Quantity:
    if name in REGISTRY:
        return REGISTRY[name]
    near = difflib.get_close_matches(name, REGISTRY, n=3, cutoff=0.5)
    hint = f"did you mean {', '.join(near)}?" if near else ""
    raise QuantityError(f"quantity {name!r}", allowed=", ".join(REGISTRY), remedy=hint)


def _integers(text: str | None, whole: str) -> tuple[int, ...]:
    if text is None or not text.strip():
        return ()
    parts = [part.strip() for part in text.split(",")]
    if not all(part.isascii() and part.isdigit() and len(part) < 4 for part in parts):
        raise QuantityError(f"indices in {whole!r}", allowed="whole numbers from 1, separated by commas")
    return tuple(int(part) for part in parts)


def pick(value: Expr, entry: tuple[int, ...], text: str) -> Expr:
    """One entry of a matrix, indices from 1; a vector takes one index."""
    shape = getattr(value, "shape", None)
    if shape is None:
        raise QuantityError(f"an entry of {text!r}", allowed="no entry, for it is a scalar")
    row, column = (entry[0], 1) if len(entry) == 1 else (entry[0], entry[1])
    vector = len(entry) == 1 and shape[1] != 1
    if vector or not (1 <= row <= shape[0] and 1 <= column <= shape[1]):
        raise QuantityError(
            f"entry {list(entry)} in {text!r}", allowed=f"rows 1 to {shape[0]}, columns 1 to {shape[1]}"
        )
    return value[row - 1, column - 1]
