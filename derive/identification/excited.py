"""An exciting motion as a plan that ``derive move`` reads, and what it tells of the base parameters."""

from collections.abc import Sequence
from dataclasses import dataclass
from decimal import Decimal
from math import radians

import numpy as np

from derive.arrays import Array
from derive.errors import QuantityError
from derive.identification.excitation import SINGULAR, Design, condition, information
from derive.robot.expression import to_text
from derive.robot.robot import Robot

DIGITS = Decimal("1e-8")  # of the coefficients of a plan, in the units of the robot file
HEAD = ("parameter", "value", "sigma", "groups")
Rows = tuple[tuple[Decimal, ...], ...]


@dataclass(frozen=True, slots=True, eq=False)
class Excitation:
    """A motion that excites the base parameters of a robot.

    Attributes:
        text: The plan of the motion.
        condition: Condition number of the regressors of all samples, with columns of unit length.
        names: Names of the base parameters, p of them, each that of the parameter that takes others over.
        formulas: What each groups, ``Izz1 + a2**2*m3`` in the standard parameters; None where that is no polynomial.
        values: Their values by the robot file, (p,), in SI units.
        deviations: Standard deviations with which they follow from one period by least squares, (p,).
        noise: Standard deviation of the noise of each torque, (n,) [N m or N].
        torques: Largest torque of each joint by the robot file, without Coulomb friction, (n,) [N m or N].
        notes: What a reader should know, in sentences.
    """

    text: str
    condition: float
    names: tuple[str, ...]
    formulas: tuple[str | None, ...]
    values: Array
    deviations: Array
    noise: Array
    torques: Array
    notes: tuple[str, ...]

    def rows(self) -> list[tuple[str, float, float, str | None]]:
        """Of each base parameter what `HEAD` says."""
        return [*zip(self.names, self.values.tolist(), self.deviations.tolist(), self.formulas, strict=True)]

    def as_dict(self) -> dict[str, object]:
        """All but the text as plain data."""
        parameters = [dict(zip(HEAD, row, strict=True)) for row in self.rows()]
        found = {"condition": self.condition, "parameters": parameters, "noise": self.noise.tolist()}
        return found | {"torques": self.torques.tolist(), "notes": self.notes}


def excited(design: Design, starts: int, seed: int, sample: float, head: Sequence[str]) -> Excitation:
    """The best motion that is found from so many random ones, as a plan below some lines."""
    robot, series = design.unknowns.robot, design.series
    rows = design.best(starts, seed)
    rows, factor = design.shrunk(rows, design.fine)
    cells, rows = written(rows, robot)
    regressors = design.samples(rows, np.arange(0.0, series.period, sample))[0]
    torques = np.abs(design.samples(rows, design.fine)[1]).max(axis=0)
    noise, found = design.noise(torques), condition(regressors)
    if not found < SINGULAR:
        what = f"{series.harmonics} harmonics do not tell the parameters of {robot.name} apart"
        raise QuantityError(f"{what}: a condition number of {found:.3g}", remedy="raise --harmonics")
    sizes = np.linalg.norm(regressors, axis=(0, 1))
    covariance = np.linalg.inv(information(regressors / sizes, noise**-2.0))
    curves = [f"  {joint.variable}: {series.formula(row)}" for joint, row in zip(robot.variables, cells, strict=True)]
    smaller = f"amplitudes at {factor:.1%}, so that torques and floor are kept to between the times of the search, too"
    return Excitation(
        text="\n".join([*head, f"sample: {sample!r}", f"time: {series.period!r}", "curves:", *curves, ""]),
        condition=found,
        names=tuple(parameter.name for parameter in design.unknowns.base.parameters),
        formulas=tuple(None if formula is None else to_text(formula) for formula in design.unknowns.formulas),
        values=design.unknowns.prior,
        deviations=np.sqrt(np.diag(covariance)) / sizes,
        noise=noise,
        torques=torques,
        notes=(smaller,) * (factor < 1),
    )


def written(rows: Array, robot: Robot) -> tuple[Rows, Array]:
    """Coefficients as a plan has them, in the units of the robot file, and the same in SI units, (n, width)."""
    angle, length = radians(1) if robot.units.degrees else 1.0, 1e-3 if robot.units.millimetres else 1.0
    units = np.array([[angle if joint.is_revolute else length] for joint in robot.variables])
    cells = tuple(tuple(Decimal(value).quantize(DIGITS) for value in row) for row in rows / units)
    return cells, np.array(cells, dtype=float) * units
