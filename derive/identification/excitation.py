"""Motions that tell the base parameters of an arm: Fourier series, the best within what its joints may do, as plans.

A joint variable starts and ends at rest (Swevers, Ganseman, Tukel, De Schutter and Van Brussel, IEEE Trans. Robotics
and Automation 13(5), 1997):

    q(t) = c + sum_k a_k cos(k w t) + b_k sin(k w t),   w = 2 pi/T,   k = 1 ... K

At 0 and T the speed is w sum k b_k and the acceleration -w^2 sum k^2 a_k; both vanish where a_1 and b_1 are minus the
sums of the others, which alone are free.

With W the base regressors of all samples one above the other, the parameters follow from torques with noise of
deviation sigma with the covariance (W^T W)^-1 sigma^2. Either its determinant is made small (D-optimal, ibid.), or the
condition number of W with columns of unit length (Gautier and Khalil, Int. J. Robotics Research 11(4), 1992).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from decimal import Decimal
from enum import StrEnum
from functools import cached_property
from math import radians
from typing import Any

import casadi
import numpy as np

from derive.arrays import Array
from derive.errors import QuantityError
from derive.identification.standard import Unknowns
from derive.programs.build import build_program
from derive.programs.optimise.search_policy import Effort
from derive.robot.evaluate import evaluate, parameter_values
from derive.robot.expression import ZERO, to_text
from derive.robot.inertial_parameters import FRICTION_PARTS
from derive.robot.robot import Robot
from derive.targets.casadi import casadi_function

CENTRES = 400  # configurations among which motions have their middle
DRAWN = 60  # random motions of which the best are where the search starts
FINE = 10  # how many times finer the grid of the last check is
SHRUNK = 0.98  # factor of amplitudes from one try to the next
STANDING = 0.01  # factor below which the middle of a motion is where the arm cannot stand
SLOW = 0.05  # part of a joint's largest speed within which the search smooths the jump of Coulomb friction
CENTRAL = 0.8  # of the way from the middle of a joint's range to its ends, within which motions have their middle
SPARE = 0.01  # of torques, and [m] above the floor, where the arm stands in the middle of a motion
ROUNDED = 1 - 1e-6  # what limits lose to the digits of a plan
SINGULAR = 1e7  # condition number from which on parameters are not told apart
POWER = 3  # condition numbers are searched by tr(R^8) and tr(R^-8): 2^3
STEPS = 150  # of the search from one start
DIGITS = Decimal("1e-8")  # of the coefficients of a plan, in the units of the robot file
HEAD = ("parameter", "value", "sigma", "groups")
IPOPT: dict[str, Any] = {
    "print_time": False,
    "ipopt": {"print_level": 0, "sb": "yes", "hessian_approximation": "limited-memory", "max_iter": STEPS, "tol": 1e-3},
}


# Of a trigonometric polynomial of degree K the largest magnitude is at most 1/cos(pi K/N) times that at N > 2 K evenly
# spaced times of its period (M. Riesz 1914): about the maximum it falls no faster than its cosine of degree K.
TIMES = 12  # of the grid for each harmonic: 3.5 % between
BETWEEN = float(np.cos(np.pi / TIMES))  # what part of its largest magnitude a series reaches at one of these at least


@dataclass(frozen=True, slots=True)
class FourierSeries:
    """All series of a period [s] with so many harmonics; one of them is a row c, a_2 ... a_K, b_2 ... b_K a joint."""

    period: float
    harmonics: int

    @property
    def width(self) -> int:
        """How many numbers a row has."""
        return 2 * self.harmonics - 1

    @property
    def times(self) -> Array:
        """Evenly spaced times of a period [s], on which bounds within `BETWEEN` of one hold everywhere."""
        count = TIMES * self.harmonics
        return self.period / count * np.arange(count, dtype=float)

    @property
    def sizes(self) -> Array:
        """The coefficients for which each term moves about as fast, (width,)."""
        k = np.arange(2.0, self.harmonics + 1)
        return np.concatenate([[1.0], 1 / k**2, 1 / k])

    def basis(self, times: Array) -> Array:
        """Positions, speeds and accelerations at times (t,) [s] per unit of each coefficient, (3, t, width)."""
        k = np.arange(1, self.harmonics + 1)
        rates = 2j * np.pi / self.period * k
        waves = np.exp(np.outer(times, rates)) * np.stack([np.ones(len(k)), rates, rates**2])[:, None]
        first, others, k = waves[..., :1], waves[..., 1:], k[1:]
        still = np.repeat([1.0, 0.0, 0.0], len(times)).reshape(3, -1, 1)
        return np.concatenate([still, (others - k**2 * first).real, (others - k * first).imag], axis=-1)

    def formula(self, row: Sequence[Decimal]) -> str:
        """The series of a row as the text of a cell; decimals are exact, so it is exactly at rest at its ends."""
        centre, cosines, sines = row[0], list(row[1 : self.harmonics]), list(row[self.harmonics :])
        cosines.insert(0, -sum((k**2 * a for k, a in enumerate(cosines, start=2)), Decimal(0)))
        sines.insert(0, -sum((k * b for k, b in enumerate(sines, start=2)), Decimal(0)))
        terms = [f"{centre:f}"]
        for k, pair in enumerate(zip(cosines, sines, strict=True), start=1):
            angle = f"{2 * k}*pi*t/{Decimal(repr(self.period)).normalize():f}"
            terms += [f"{value:+f}*{name}({angle})" for name, value in zip(("cos", "sin"), pair, strict=True) if value]
        return " ".join(terms)


# What is made small.
Criterion = StrEnum("Criterion", {"DETERMINANT": "determinant", "CONDITION": "condition"})


@dataclass(frozen=True, slots=True, eq=False)
class Room:
    """What the joints may do: (n,) each, infinite where nothing limits."""

    middle: Array  # of the positions [rad or m]
    half: Array  # how far they go to either side of it
    speed: Array  # either way [rad/s or m/s]
    acceleration: Array  # either way [rad/s^2 or m/s^2]
    torque: Array  # either way [N m or N]
    floor: float  # above which the origins of all frames stay [m]


@dataclass(frozen=True, eq=False)
class Design:
    """The search for a motion."""

    unknowns: Unknowns
    series: FourierSeries
    room: Room
    criterion: Criterion
    noise: Callable[[Array], Array]  # deviations of the torques, (n,), by largest torques, (n,)

    @cached_property
    def fine(self) -> Array:
        """Many times of a period [s]."""
        return np.linspace(0.0, self.series.period, FINE * len(self.series.times))

    # -- the arm

    @cached_property
    def _function(self) -> Any:
        """Function of q, qd, qdd and the signs of speeds: Y_b, torques without Coulomb friction, heights."""
        robot, n = self.unknowns.robot, self.unknowns.robot.dof
        q, qd, qdd, signs = (casadi.SX.sym(name, n) for name in ("q", "qd", "qdd", "signs"))
        regressor = _functions(self.unknowns.wide, "base_regressor")["base_regressor"](q, qd, qdd)
        for k, parameter in enumerate(self.unknowns.base.parameters):
            if parameter.part in FRICTION_PARTS[1:]:
                sign = signs[i := parameter.joint - 1]
                ahead = (sign + sign**2) / 2
                regressor[i, k] = {"f": sign, "fp": ahead, "fm": sign - ahead}[parameter.part]
        smooth = replace(robot, links=tuple(replace(link, coulomb=ZERO) for link in robot.links), runtime=())
        given = _functions(smooth, "inverse_dynamics", "link_transforms", "forward_kinematics")
        torque = given.pop("inverse_dynamics")(q, qd, qdd)
        poses = casadi.horzcat(*(function(q) for function in given.values()))
        heights = [z for z in casadi.horzsplit(poses[2, 3::4]) if not z.is_constant() and self.room.floor > -np.inf]
        outputs = [casadi.densify(regressor), casadi.densify(torque), casadi.vertcat(*heights)]
        return casadi.Function("arm", [q, qd, qdd, signs], outputs)

    @cached_property
    def dry(self) -> Array:
        """Coulomb friction of each joint, the larger of both directions, (n,) [N m or N]."""
        links, values = self.unknowns.robot.links, parameter_values(self.unknowns.robot)
        return np.array([max(abs(evaluate(cell, values)) for cell in link.dry) for link in links])

    def samples(self, rows: Array, times: Array) -> tuple[Array, Array, Array]:
        """Regressors (t, n, p), torques without Coulomb friction (t, n) and heights of frames at times (t,) [s]."""
        q, qd, qdd = np.einsum("otw,nw->ont", self.series.basis(times), rows)
        signs = np.where(np.abs(qd) > 1e-9 * np.abs(qd).max(), np.sign(qd), 0.0)
        regressor, torque, height = (x.full() for x in self._function.map(len(times))(q, qd, qdd, signs))
        return np.moveaxis(regressor.reshape(len(q), len(times), -1), 1, 0), torque.T, height.T

    # -- what is allowed

    def use(self, torque: Array, height: Array) -> Array:
        """How much of torques and of the room above the floor is used, (t, n + frames), allowed up to 1."""
        return np.hstack([(np.abs(torque) + self.dry) / self.room.torque, 1 + self.room.floor - height])

    def fitted(self, rows: Array, *, grown: bool) -> Array:
        """A motion whose joints keep positions, speeds and accelerations at all times, as large as it may be or not."""
        room, series = self.room, self.series
        moved, speeds, accelerations = np.einsum("otw,nw->ont", series.basis(series.times)[..., 1:], rows[:, 1:])
        ways = np.abs(moved) / (BETWEEN * room.half[:, None] - np.sign(moved) * (rows[:, :1] - room.middle[:, None]))
        rates = np.abs(speeds) / room.speed[:, None], np.abs(accelerations) / room.acceleration[:, None]
        used = np.max([ways, *(rate / BETWEEN for rate in rates)], axis=(0, 2))
        return scaled(rows, ROUNDED / np.maximum(used, 0.0 if grown else ROUNDED)[:, None])

    def shrunk(self, rows: Array, times: Array) -> tuple[Array, float]:
        """A motion with amplitudes so much smaller that it keeps torques and floor at these times, and the factor."""
        factor = 1.0
        while self.use(*self.samples(found := scaled(rows, factor), times)[1:]).max() > ROUNDED and factor > STANDING:
            factor *= SHRUNK
        return found, factor

    # -- where the search starts

    def centres(self, rng: np.random.Generator) -> Array:
        """Positions at which the arm can stand, (c, n)."""
        room, robot = self.room, self.unknowns.robot
        places = np.vstack([np.zeros(robot.dof), rng.uniform(-CENTRAL, CENTRAL, (CENTRES, robot.dof))])
        drawn = room.middle + room.half * places
        still = np.zeros_like(drawn.T)
        use = self.use(*(x.full().T for x in self._function.map(len(drawn))(drawn.T, still, still, still)[1:]))
        if (standing := use.max(axis=1) < 1 - SPARE).any():
            return np.asarray(drawn[standing])
        joints, frames = np.split(use[use.max(axis=1).argmin()], [robot.dof])
        if frames.max(initial=0) > joints.max():
            found = f"no position of {robot.name} found with all frames above the floor, z = {room.floor:.6g} m"
            raise QuantityError(found, remedy="give a lower --floor, or --floor none")
        found = f"{robot.variables[int(joints.argmax())].variable} of {robot.name} found too weak to hold it anywhere"
        raise QuantityError(found, remedy="give a larger --torque")

    def drawn(self, rng: np.random.Generator, centres: Array) -> Array:
        """A random motion that uses all that its joints may do."""
        centre, series = centres[rng.integers(len(centres))], self.series
        terms = rng.standard_normal((len(centre), series.width - 1)) * series.sizes[1:]
        return self.shrunk(self.fitted(np.column_stack([centre, terms]), grown=True), series.times)[0]

    def score(self, rows: Array, weights: Array) -> float:
        """What is made small, with weights of the torques (n,)."""
        blocks = self.samples(rows, self.fine)[0]
        if self.criterion is Criterion.CONDITION:
            return condition(blocks)
        return -float(np.linalg.slogdet(information(blocks, weights))[1])

    # -- the search

    def improved(self, rows: Array, weights: Array, criterion: Criterion) -> Array:
        """A better motion, by IPOPT, that keeps to all limits at the times of the grid, or the same one."""
        series, room, n = self.series, self.room, len(rows)
        # In units in which all terms of a joint move it alike, and about as far as it may go.
        w = 2 * np.pi / series.period
        reach = np.min([room.half, room.speed / w, room.acceleration / w**2], axis=0)
        sizes = np.column_stack([room.half, np.outer(reach, series.sizes[1:])])
        offset = np.column_stack([room.middle, np.zeros((n, series.width - 1))])
        x = casadi.MX.sym("x", n, series.width)
        terms, times = offset + sizes * x, series.times
        q, qd, qdd = (casadi.mtimes(terms, casadi.DM(table.T)) for table in series.basis(times))
        slow = casadi.DM(SLOW * np.repeat(room.speed[:, None], len(times), axis=1))
        regressor, torque, height = self._function.map(len(times))(q, qd, qdd, qd / casadi.sqrt(qd**2 + slow**2))
        _, still, standing = self._function(terms[:, 0], *[np.zeros(n)] * 3)
        moved = casadi.horzcat((q - room.middle) / room.half, qd / room.speed, qdd / room.acceleration) / BETWEEN
        pulls = casadi.horzcat(torque, still * (1 + SPARE)) / (room.torque - self.dry)
        sides = casadi.horzcat(moved, pulls)  # from -1 to 1
        above = casadi.horzcat(height, standing - SPARE) - room.floor if height.numel() else casadi.MX()
        objective = self._objective(regressor, weights, criterion)
        problem = {"x": casadi.vec(x), "f": objective, "g": casadi.veccat(sides, above)}
        solver = casadi.nlpsol("excitation", "ipopt", problem, IPOPT)
        start, counts = ((rows - offset) / sizes).T.reshape(-1), [sides.numel(), above.numel()]
        most = np.repeat([CENTRAL, *[np.inf] * (series.width - 1)], n)
        lows, highs = np.repeat([-1.0, 0.0], counts), np.repeat([1.0, np.inf], counts)
        found = solver(x0=start, lbx=-most, ubx=most, lbg=lows, ubg=highs)["x"].full()
        better, factor = self.shrunk(self.fitted(offset + sizes * found.reshape(series.width, n).T, grown=False), times)
        return better if factor > STANDING else rows

    def _objective(self, regressor: Any, weights: Array, criterion: Criterion) -> Any:
        """What is made small, of regressors of all times of the grid side by side."""
        n, p, times = len(weights), len(self.unknowns.base.parameters), len(self.series.times)
        w = casadi.reshape(casadi.reshape(regressor, n * p, times).T, times * n, p)  # joint by joint
        if criterion is Criterion.DETERMINANT:
            w = w * np.repeat(np.sqrt(weights), times)
        lengths = casadi.sqrt(casadi.sum1(w**2))
        unit = w / casadi.repmat(lengths, times * n, 1)
        moments = casadi.mtimes(unit.T, unit)
        symbol = casadi.SX.sym("M", p, p)
        factor = casadi.solve(casadi.chol(symbol).T, casadi.SX.eye(p))  # of the inverse
        inverse_factor = casadi.Function("inverse_factor", [symbol], [factor])(moments)
        if criterion is Criterion.DETERMINANT:
            return -2 * casadi.sum1(casadi.log(lengths.T)) + 2 * casadi.sum1(casadi.log(casadi.diag(inverse_factor)))
        # cond(W)^2 = l_max / l_min of M, nearly (tr M^r tr M^-r)^(1/r).
        large, small = moments, casadi.mtimes(inverse_factor.T, inverse_factor)
        for _ in range(POWER - 1):
            large, small = casadi.mtimes(large, large), casadi.mtimes(small, small)
        return (casadi.log(casadi.sumsqr(large)) + casadi.log(casadi.sumsqr(small))) / 2**POWER

    def best(self, starts: int, seed: int) -> Array:
        """The best of the motions that are found from so many random ones."""
        rng = np.random.default_rng(seed)
        centres = self.centres(rng)
        drawn = [self.drawn(rng, centres) for _ in range(DRAWN)]
        noise = self.noise(np.abs(self.samples(drawn[0], self.series.times)[1]).max(axis=0))
        if not noise.all():
            still = self.unknowns.robot.variables[int(noise.argmin())].variable
            raise QuantityError(f"noise in per cent, and {still} has no torque", remedy="give --noise in N m")
        weights = noise**-2.0
        drawn.sort(key=lambda rows: self.score(rows, weights))
        found = drawn[:1]
        for rows in drawn[:starts]:
            found.append(self.improved(rows, weights, Criterion.DETERMINANT))
            if self.criterion is Criterion.CONDITION:  # not as smooth: from a motion that is good already
                found.append(self.improved(found[-1], weights, Criterion.CONDITION))
        return min(found, key=lambda rows: self.score(rows, weights))


def scaled(rows: Array, factors: Any) -> Array:
    """A motion with the same middle and other amplitudes."""
    return np.hstack([rows[:, :1], rows[:, 1:] * factors])


def information(blocks: Array, weights: Array) -> Array:
    """W^T W with weights of the torques (n,), of regressors (times, n, p)."""
    return np.asarray(np.einsum("tip,tiq,i->pq", blocks, blocks, weights))


def condition(blocks: Array) -> float:
    """The condition number of regressors (times, n, p) one above the other, their columns of unit length."""
    stacked = blocks.reshape(-1, blocks.shape[-1])
    return float(np.linalg.cond(stacked / np.linalg.norm(stacked, axis=0)))


@dataclass(frozen=True, slots=True, eq=False)
class Excitation:
    """A motion that excites the base parameters of a robot, p of n joints, in SI units."""

    text: str  # the plan of the motion
    condition: float  # condition number of the regressors of all samples, with columns of unit length
    names: tuple[str, ...]  # of the base parameters, each that of the parameter that takes others over
    formulas: tuple[str | None, ...]  # what each groups, ``Izz1 + a2**2*m3``; None where that is no polynomial
    values: Array  # (p,) their values by the robot file
    deviations: Array  # (p,) standard deviations with which they follow from one period by least squares
    noise: Array  # (n,) standard deviation of the noise of each torque [N m or N]
    torques: Array  # (n,) largest torque of each joint by the robot file, without Coulomb friction [N m or N]
    notes: tuple[str, ...]  # what a reader should know, in sentences

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


def written(rows: Array, robot: Robot) -> tuple[list[list[Decimal]], Array]:
    """Coefficients as a plan has them, in the units of the robot file, and the same in SI units, (n, width)."""
    angle, length = radians(1) if robot.units.degrees else 1.0, 1e-3 if robot.units.millimetres else 1.0
    units = np.array([[angle if joint.is_revolute else length] for joint in robot.variables])
    cells = [[Decimal(value).quantize(DIGITS) for value in row] for row in rows / units]
    return cells, np.array(cells, dtype=float) * units


def _functions(robot: Robot, *names: str) -> dict[str, Any]:
    """Generated functions of a robot whose symbols have numbers, in CasADi."""
    program = build_program(robot, Effort.QUICK, names=frozenset(names))
    return {function.name: casadi_function(function, robot.dof, 0) for function in program}
