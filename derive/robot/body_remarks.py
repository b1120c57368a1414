"""Remarks on inertia tensors that no body has.

The second moments of a body about its centre of mass, tr(I)/2 - I, have no negative eigenvalue: no principal moment of
inertia is larger than the sum of the other two. Published tensors often break this; torques may be right all the same,
since they know base parameters alone, but simulators refuse such a body.
"""

from collections.abc import Iterable, Mapping
from fractions import Fraction
from math import acos, cos, pi, sqrt

from derive.robot.description import INERTIA, Description, Remark
from derive.robot.evaluate import evaluate, parameter_values
from derive.robot.expression import names
from derive.robot.reading.document import Document, KeyPath

ROUNDING = Fraction(1, 10**9)  # part of the largest principal moment that rounding may have taken from A + B - C
REMEDY = "derive export --inertia possible finds consistent inertias with the same torques"

Tensor = tuple[Fraction, Fraction, Fraction, Fraction, Fraction, Fraction]  # xx, yy, zz, xy, xz, yz


def remarks_on_bodies(document: Document, robot: Description) -> tuple[Remark, ...]:
    """Which links of a robot file have a tensor of numbers that no body has.

    A tensor with one diagonal entry alone, not negative, is that of a planar arm and not meant to be whole.
    """
    try:
        lacks = impossible_links(robot, parameter_values(robot))
    except ArithmeticError:
        return ()
    if not lacks:
        return ()
    path: KeyPath = ("links", min(lacks), "inertia")
    where = f"links {'entries' if len(lacks) > 1 else 'entry'} {', '.join(str(index + 1) for index in lacks)}"
    found = f"{where}, inertia: {too_large(lacks.values())}"
    return (Remark(document.location(path), found, REMEDY, is_of_bodies=True),)


def too_large(lacks: Iterable[float]) -> str:
    """What is wrong with tensors by `missing_moment`."""
    amounts = ", ".join(f"{lack:.3g}" for lack in lacks)
    return f"physically inconsistent: one principal moment exceeds the sum of the other two by {amounts} kg m^2"


def impossible_links(robot: Description, values: Mapping[str, Fraction | float]) -> dict[int, float]:
    """By link what `lack_of` its tensor is, where it has numbers and is physically inconsistent."""
    lacks = {}
    for index, link in enumerate(robot.links):
        cells = [getattr(link.inertia, key) for key in INERTIA]
        if any(name not in values for cell in cells for name in names(cell)):
            continue
        try:
            xx, yy, zz, xy, xz, yz = (Fraction(evaluate(cell, values)) for cell in cells)
        except ArithmeticError:
            continue
        if lack := lack_of((xx, yy, zz, xy, xz, yz)):
            lacks[index] = lack
    return lacks


def lack_of(tensor: Tensor) -> float:
    """`missing_moment` but of planar bodies, which have one moment."""
    is_planar = sum(moment != 0 for moment in tensor[:3]) < 2 and min(tensor[:3]) >= 0
    return 0.0 if is_planar else missing_moment(tensor)


def missing_moment(tensor: Tensor) -> float:
    """By how much the largest principal moment is beyond the sum of the others; 0 where a body has the tensor.

    Whether it is, is decided exactly, by the principal minors of the second moments.

    Args:
        tensor: xx, yy, zz, xy, xz, yz about the centre of mass [kg m^2].
    """
    # Second moments about the centre of mass: S = tr(I)/2 - I, with diagonal tr(I)/2 - I_xx, ... and entries -I_xy, ...
    xx, yy, zz, xy, xz, yz = tensor
    half, slack = (xx + yy + zz) / 2, ROUNDING * max(map(abs, tensor))
    a, b, c = half - xx + slack, half - yy + slack, half - zz + slack
    determinant = a * (b * c - yz * yz) - xy * (xy * c + yz * xz) - xz * (xy * yz + b * xz)
    # S is positive semidefinite if and only if all of its principal minors are not negative (Sylvester).
    minors = (a, b, c, a * b - xy * xy, a * c - xz * xz, b * c - yz * yz, determinant)
    if all(minor >= 0 for minor in minors):
        return 0.0
    # An eigenvalue s of S belongs to the principal moment tr(I)/2 - s, which exceeds the sum of the others by -2 s.
    return -2 * _least_eigenvalue(*map(float, (half - xx, half - yy, half - zz, -xy, -xz, -yz)))


def _least_eigenvalue(xx: float, yy: float, zz: float, xy: float, xz: float, yz: float) -> float:
    """Of a symmetric matrix, by Cardano's formula with cosines."""
    # A = mean 1 + spread B with tr B = 0: the eigenvalues of B are 2 cos of angle + 2 k pi/3, cos(3 angle) = det(B)/2.
    mean = (xx + yy + zz) / 3
    a, b, c = xx - mean, yy - mean, zz - mean
    spread = sqrt((a * a + b * b + c * c + 2 * (xy * xy + xz * xz + yz * yz)) / 6)
    if spread == 0:
        return mean
    determinant = a * (b * c - yz * yz) - xy * (xy * c - yz * xz) + xz * (xy * yz - b * xz)
    angle = acos(max(-1.0, min(1.0, determinant / (2 * spread**3)))) / 3
    return mean + 2 * spread * cos(angle + 2 * pi / 3)
