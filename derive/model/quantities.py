"""The registry of quantities, and how they are asked for: ``T[1,4]``, ``A[2]``, ``christoffel[1,1,2]``."""

from __future__ import annotations

import difflib
import re
from collections.abc import Callable
from dataclasses import dataclass

from derive.errors import QuantityError
from derive.lecture.sympy_conversion import Expr, Matrix
from derive.mechanics.vectors import subtract
from derive.model.dynamic_model import DynamicModel
from derive.model.matrices import columns_matrix

_NAME = re.compile(r"\s*([A-Za-z][A-Za-z0-9_]*)\s*(?:\[([^\]]*)\])?\s*(?:\[([^\]]*)\])?\s*")


@dataclass(frozen=True)
class Quantity:
    """One row of the registry.

    Attributes:
        name: As the user writes it.
        symbol: As notes write it, in LaTeX; i, j, k stand for its indices.
        shape: Rows and columns, ``6xn``; n joints, m = n - 3, p standard, b base parameters; empty for a scalar.
        unit: SI unit of its entries; empty where these differ or have none.
        summary: What it is, for lists.
        indices: How many indices it takes (alternatives allowed); further ones pick an entry.
        formula: The function of the model and the indices; by default the model's attribute or method of that name.
    """

    name: str
    symbol: str
    shape: str
    unit: str
    summary: str
    indices: tuple[int, ...] = (0,)
    formula: Callable[..., Expr] | None = None

    @property
    def dynamic(self) -> bool:
        """Whether it needs links."""
        return self in _DYNAMIC

    def value(self, model: DynamicModel, *indices: int) -> Expr:
        """The quantity of a model.

        Args:
            model: The closed forms.
            indices: As many as the quantity takes, from 1.

        Returns:
            The matrix or expression.

        Raises:
            QuantityError: No such link, joint or frame, or a quantity that this robot has not.
        """
        if self.formula is not None:
            return self.formula(model, *indices)
        found = getattr(model, self.name)
        return found(*indices) if indices else found


def _frame(model: DynamicModel, *indices: int) -> Matrix:
    match len(indices):
        case 0:
            return model.T
        case 1:
            return model.frame(*indices)
        case _:
            return model.transform(*indices)


def _reduced_block(model: DynamicModel) -> Matrix:
    """J_11 with its second column subtracted from the first: the same determinant, shorter entries."""
    if model.n < 2:
        raise QuantityError("J_11_reduced of one joint", allowed="two joints or more")
    first, second, *others = model.kinematics.linear_columns(model.kinematics.end.position)[:3]
    return columns_matrix([subtract(first, second), second, *others], write=model.form.kinematic)


_ANY = "end effector in the world; T[i] frame i there; T[i,j] frame j in frame i"
_DETERMINANT = "determinant of J, or of its first three rows for three joints"
_REDUCED = "J_11, its second column subtracted from the first"

_KINEMATIC = (
    Quantity("A", r"\mathbf{A}_i^{i-1}", "4x4", "", "DH transform of row i", (1,)),
    Quantity("T", r"\mathbf{T}_j^i", "4x4", "", _ANY, (0, 1, 2), _frame),
    Quantity("p", r"\mathbf{p}", "3x1", "m", "position of the end effector"),
    Quantity("R", r"\mathbf{R}", "3x3", "", "orientation of the end effector"),
    Quantity("rpy", r"\boldsymbol{\phi}", "3x1", "rad", "roll, pitch, yaw"),
    Quantity("euler_zyz", r"\boldsymbol{\phi}", "3x1", "rad", "Euler angles ZYZ"),
    Quantity("J", r"\mathbf{J}", "6xn", "", "geometric Jacobian, world frame"),
    Quantity("J_end", r"\mathbf{J}^n", "6xn", "", "geometric Jacobian, end-effector frame"),
    Quantity("J_dot", r"\dot{\mathbf{J}}", "6xn", "", "rate of change of J, world frame"),
    Quantity(
        "J_rpy",
        r"\mathbf{J}_A",
        "6xn",
        "",
        "analytic Jacobian for roll, pitch, yaw",
        (0,),
        lambda m: m.J_analytic("rpy"),
    ),
    Quantity(
        "J_zyz", r"\mathbf{J}_A", "6xn", "", "analytic Jacobian for Euler ZYZ", (0,), lambda m: m.J_analytic("zyz")
    ),
    Quantity("J_11", r"\mathbf{J}_{11}", "3x3", "", "rows 1-3, columns 1-3 of J", (0,), lambda m: m.J[:3, :3]),
    Quantity("J_11_reduced", r"\mathbf{J}_{11}", "3x3", "", _REDUCED, (0,), _reduced_block),
    Quantity("J_12", r"\mathbf{J}_{12}", "3xm", "", "rows 1-3, the other columns of J", (0,), lambda m: m.J[:3, 3:]),
    Quantity("J_21", r"\mathbf{J}_{21}", "3x3", "", "rows 4-6, columns 1-3 of J", (0,), lambda m: m.J[3:, :3]),
    Quantity("J_22", r"\mathbf{J}_{22}", "3xm", "", "rows 4-6, the other columns of J", (0,), lambda m: m.J[3:, 3:]),
    Quantity("detJ", r"\det \mathbf{J}", "", "", _DETERMINANT, (0,), lambda m: m.det_J()),
)

_DYNAMIC = (
    Quantity("Jv_com", r"\mathbf{J}_v^{l_i}", "3xn", "", "velocity of the centre of mass of link i", (1,)),
    Quantity("Jw_com", r"\mathbf{J}_w^{l_i}", "3xn", "", "angular velocity of link i", (1,)),
    Quantity("Jv_motor", r"\mathbf{J}_v^{m_i}", "3xn", "", "velocity of rotor i", (1,)),
    Quantity("Jw_motor", r"\mathbf{J}_w^{m_i}", "3xn", "", "angular velocity of rotor i", (1,)),
    Quantity("kinetic", r"\mathcal{T}", "", "J", "kinetic energy", (0,), lambda m: m.energy.kinetic),
    Quantity("potential", r"\mathcal{U}", "", "J", "potential energy", (0,), lambda m: m.energy.potential),
    Quantity("B", r"\mathbf{B}", "nxn", "", "inertia matrix"),
    Quantity("B_link", r"\mathbf{B}^{l_i}", "nxn", "", "part of B that link i contributes", (1,)),
    Quantity("Bdot", r"\dot{\mathbf{B}}", "nxn", "", "time derivative of B"),
    Quantity("christoffel", "c_{ijk}", "", "", "Christoffel symbol c_ijk", (3,)),
    Quantity("C", r"\mathbf{C}", "nxn", "", "Coriolis matrix"),
    Quantity(
        "coriolis_vector", r"\mathbf{C}\dot{\mathbf{q}}", "nx1", "N m or N", "Coriolis and centrifugal torques C qd"
    ),
    Quantity("N", r"\mathbf{N}", "nxn", "", "Bdot - 2C"),
    Quantity("g", r"\mathbf{g}", "nx1", "N m or N", "gravity vector"),
    Quantity("friction", r"\boldsymbol{\tau}_f", "nx1", "N m or N", "joint friction"),
    Quantity("tau", r"\boldsymbol{\tau}", "nx1", "N m or N", "equations of motion"),
    Quantity("regressor", r"\mathbf{Y}", "nxp", "", "Y with tau = Y pi, standard parameters pi"),
    Quantity("standard_parameters", r"\boldsymbol{\pi}", "px1", "", "the standard parameters pi"),
    Quantity("regressor_base", r"\mathbf{Y}", "nxb", "", "Y with tau = Y beta"),
    Quantity("base_parameters", r"\boldsymbol{\beta}", "bx1", "", "the base parameters beta"),
)

REGISTRY = {quantity.name: quantity for quantity in (*_KINEMATIC, *_DYNAMIC)}
"""Every quantity that can be asked for by name, in the order of lists."""


def evaluate(model: DynamicModel, text: str) -> Expr:
    """A quantity, or an entry of it, by name.

    ``T[2]`` is frame 2; ``T[1,4]`` is the entry in row 1, column 4 where j = 4 is no frame of this robot, and frame 4
    in frame 1 where it is: an entry is always meant by a second bracket, ``T[][1,4]`` or ``T[0,2][1,4]``.

    Args:
        model: The closed forms.
        text: The name, with indices from 1.

    Returns:
        The matrix or expression.

    Raises:
        QuantityError: Unknown name, wrong number of indices or an entry outside.
    """
    quantity, indices, entry = parse(model, text)
    value = quantity.value(model, *indices)
    return value if entry is None else pick(value, entry, text)


def parse(model: DynamicModel, text: str) -> tuple[Quantity, tuple[int, ...], tuple[int, ...] | None]:
    """What a name with indices asks for.

    Args:
        model: Says how many frames there are.
        text: The name, with indices from 1.

    Returns:
        The registry row, its indices and the entry, if one is asked for.

    Raises:
        QuantityError: Unknown name or wrong number of indices.
    """
    match = _NAME.fullmatch(text)
    if match is None:
        raise QuantityError(
            f"quantity {text!r}", allowed="a name with indices, such as T, A[2], B[1,2], christoffel[1,1,2]"
        )
    name = match[1]
    if name not in REGISTRY:
        near = difflib.get_close_matches(name, REGISTRY, n=3, cutoff=0.5)
        hint = f"did you mean {', '.join(near)}?" if near else ""
        raise QuantityError(f"quantity {name!r}", allowed=", ".join(REGISTRY), remedy=hint)
    quantity, first = REGISTRY[name], _integers(match[2], text)
    if match[3] is not None:
        return quantity, first, _integers(match[3], text)
    # two indices of T can only be a row and a column where the arm has no such frame
    is_entry = name == "T" and len(first) == 2 and max(first) > model.n
    if len(first) in quantity.indices and not is_entry:
        return quantity, first, None
    for count in sorted(quantity.indices):
        if len(first) - count in (1, 2):
            return quantity, first[:count], first[count:]
    counts = " or ".join(map(str, quantity.indices))
    raise QuantityError(f"{len(first)} indices in {text!r}", allowed=f"{counts} for {name}, and an entry behind them")


def _integers(text: str | None, whole: str) -> tuple[int, ...]:
    if text is None or not text.strip():
        return ()
    parts = [part.strip() for part in text.split(",")]
    if not all(part.isascii() and part.isdigit() and len(part) < 4 for part in parts):
        raise QuantityError(f"indices in {whole!r}", allowed="whole numbers from 1, separated by commas")
    return tuple(int(part) for part in parts)


def pick(value: Expr, entry: tuple[int, ...], text: str) -> Expr:
    """One entry of a matrix.

    Args:
        value: The matrix.
        entry: Row and column from 1; a vector takes one index.
        text: What was asked for, for messages.

    Raises:
        QuantityError: A scalar, or no such entry.
    """
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
