"""Small problems over symmetric matrices: least x^T Q x / 2 + c.x, affine functions of x in cones.

Symmetric matrices go as vectors of their upper triangles, column by column, what is off the diagonal times sqrt(2): so
the product of two vectors is the trace of the product of the matrices. The interior-point method is Clarabel's
(Goulart and Chen, 2024), of the extra ``exchange``.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from math import sqrt

import numpy as np

from derive.arrays import Array
from derive.errors import DeriveError, TargetError, install_extra

TOLERANCE = 1e-11  # of gap and feasibility


class Cone(Enum):
    """What the values of an affine function must be."""

    NOT_NEGATIVE = "each is not negative"
    LONGEST_FIRST = "the first is at least the length of the others"
    SEMIDEFINITE = "a matrix without a negative eigenvalue"


@dataclass(frozen=True, slots=True, eq=False)
class Limit:
    """An affine function of x, in a cone."""

    cone: Cone
    constant: Array  # its value at x = 0
    slope: Array  # a row for each value, a column for each variable


def least(linear: Array, limits: Sequence[Limit], quadratic: Array | None = None) -> tuple[Array, list[Array]]:
    """Where a function is least within limits, and for each the dual vector; Q is semidefinite, None for zero."""
    try:
        import clarabel
        from scipy import sparse
    except ImportError:
        found = "finding consistent inertias needs clarabel and SciPy, which are not installed"
        raise TargetError(found, remedy=install_extra("exchange")) from None
    kinds = {
        Cone.NOT_NEGATIVE: clarabel.NonnegativeConeT,
        Cone.LONGEST_FIRST: clarabel.SecondOrderConeT,
        Cone.SEMIDEFINITE: lambda size: clarabel.PSDTriangleConeT(round((sqrt(8 * size + 1) - 1) / 2)),
    }
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = TOLERANCE
    # Clarabel's form: least x^T Q x / 2 + c.x with A x + s = b, s in the cones, so A = -slope and b = constant.
    matrix = sparse.csc_matrix(-np.vstack([limit.slope for limit in limits]))
    square = sparse.csc_matrix(np.zeros((len(linear), len(linear))) if quadratic is None else np.triu(quadratic))
    constant = np.concatenate([limit.constant for limit in limits])
    cones = [kinds[limit.cone](len(limit.constant)) for limit in limits]
    found = clarabel.DefaultSolver(square, linear, matrix, constant, cones, settings).solve()
    x = np.array(found.x)
    if "Infeasible" in str(found.status) or not np.isfinite(x).all():
        raise DeriveError(f"the search for consistent inertias failed by rounding: {found.status}")
    return x, np.split(np.array(found.z), np.cumsum([len(limit.constant) for limit in limits])[:-1])


def packed(matrices: Array) -> Array:
    """Symmetric matrices as vectors."""
    columns, rows = np.tril_indices(matrices.shape[-1])
    return np.asarray(matrices[..., rows, columns] * np.where(rows == columns, 1.0, sqrt(2)))


def unpacked(vectors: Array) -> Array:
    """Vectors as symmetric matrices."""
    size = round((sqrt(8 * vectors.shape[-1] + 1) - 1) / 2)
    columns, rows = np.tril_indices(size)
    values = vectors / np.where(rows == columns, 1.0, sqrt(2))
    found = np.zeros((*vectors.shape[:-1], size, size))
    found[..., rows, columns] = found[..., columns, rows] = values
    return found
