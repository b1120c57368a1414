"""The way of the end effector on lines, arcs and splines, and where an arm cannot go on since it loses a direction.

On a spline through points its place and its orientation are cubic splines of time. The orientation is
R(t) = exp(w(t)^) R_0 with a spline w through the rotation vectors of the points. Its angular velocity is omega = V w'
with V = 1 + a w^ + b w^ w^, a = (1 - cos x)/x^2, b = (x - sin x)/x^3, x = |w|, the left Jacobian of the exponential
(Murray, Li and Sastry, A Mathematical Introduction to Robotic Manipulation, 1994, 2.4).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import factorial
from typing import TYPE_CHECKING

import numpy as np
from sympy import Expr, Float, Symbol, sstr

from derive.arrays import Array
from derive.errors import DeriveError, Location, RobotFileError
from derive.inverse.numeric.chain import cross_matrix
from derive.motion.curves.trajectory import Trajectory
from derive.motion.torques.functions import Functions
from derive.plans.profile import Piece, spline
from derive.robot.robot import Robot

if TYPE_CHECKING:
    from derive.model.singularities.singularities import Condition

NODES = (64, 128, 256, 512)  # places of a way at which the arm is put exactly; more where it is off between them
NEAR = 1e-9  # largest distance of the end effector from its way between these [m or rad]
CLOSED = 1e-12  # error of a pose that is reached, relative to the arm's size
ITERATIONS = 20  # Newton steps from one place to the next
SINGULAR = 1e-6  # smallest singular value of J, relative to the largest, below which the hand cannot follow a line
TERMS = 24  # of the power series of a and b, which are exact to rounding up to a whole turn
VANISHING = 0.25  # of what a factor is elsewhere: below it a singularity is near
PROBES = 8  # configurations at which the rank of J is looked at
ROWS = {"x": (0,), "y": (1,), "z": (2,), "phi": (5,), "orientation": (3, 4, 5)}  # of a twist, by what a task asks for


def rotation_vector(rotation: Array) -> Array:
    """The axis of a rotation times its angle, from 0 to pi."""
    # R - R^T = 2 sin(phi) a^, trace R = 1 + 2 cos(phi) (Siciliano et al., 2.5).
    skew = np.array([rotation[2, 1] - rotation[1, 2], rotation[0, 2] - rotation[2, 0], rotation[1, 0] - rotation[0, 1]])
    sine, cosine = np.linalg.norm(skew) / 2, (np.trace(rotation) - 1) / 2
    angle = np.arctan2(sine, cosine)
    if sine > 1e-6:
        return np.asarray(skew * (angle / (2 * sine)))
    # Next to no rotation sin(phi) = phi.
    if cosine > 0:
        return np.asarray(skew / 2)
    square = (rotation + np.eye(3)) / 2  # half a turn: R = 2 a a^T - 1
    column = square[:, int(np.argmax(np.diag(square)))]
    side = 1.0 if column @ skew >= 0 else -1.0
    return np.asarray(side * angle * column / np.linalg.norm(column))


def rotation_of(vector: Array) -> Array:
    """The rotation about an axis by an angle (Rodrigues), of the axis times the angle, (3,) [rad]."""
    angle = float(np.linalg.norm(vector))
    cross = cross_matrix(vector / angle if angle else vector)
    return np.asarray(np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross)


@dataclass(frozen=True)
class Way:
    """A way of the end effector by its fraction s from 0 to 1."""

    place: Callable[[float], tuple[Array, Array, Array]]  # position at s, and its first and second derivative
    turned: Callable[[float], tuple[Array, Array, Array]]  # rotation (3, 3), and in the world omega, omega' by s (3,)

    @classmethod
    def line(cls, a: Array, b: Array) -> Way:
        """The straight line between two poses."""
        p, way = a[:3, 3], b[:3, 3] - a[:3, 3]
        return cls(lambda s: (p + s * way, way, np.zeros(3)), _about_one_axis(a, b))

    @classmethod
    def arc(cls, a: Array, through: Array, b: Array) -> Way:
        """The arc of the circle through three positions; the orientation of the middle pose does not count."""
        p, m, q = a[:3, 3], through[:3, 3] - a[:3, 3], b[:3, 3] - a[:3, 3]
        # The centre of the circle through 0, m, q: c = ((m.m) q - (q.q) m) x n / (2 n.n), n = m x q.
        normal = np.cross(m, q)
        square = float(normal @ normal)
        if square <= 1e-18 * float(m @ m) * float(q @ q) or square == 0:
            raise ValueError("the three positions lie on one line")
        to_centre = np.cross((m @ m) * q - (q @ q) * m, normal) / (2 * square)
        centre, radius = p + to_centre, -to_centre
        normal = normal / np.sqrt(square)
        # p(s) = c + r cos(s phi) + (n x r) sin(s phi), from r towards the middle point; n makes phi positive.
        side = np.cross(normal, radius)
        end = b[:3, 3] - centre
        angle = float(np.arctan2(end @ side, end @ radius)) % (2 * np.pi)

        def _place(s: float) -> tuple[Array, Array, Array]:
            c, z = np.cos(s * angle), np.sin(s * angle)
            outwards = c * radius + z * side
            return centre + c * radius + z * side, angle * (c * side - z * radius), -(angle**2) * outwards

        return cls(_place, _about_one_axis(a, b))

    def pose(self, s: float) -> Array:
        """The pose at a fraction of the way."""
        found = np.eye(4)
        found[:3, :3], found[:3, 3] = self.turned(s)[0], self.place(s)[0]
        return found


def _about_one_axis(a: Array, b: Array) -> Callable[[float], tuple[Array, Array, Array]]:
    start, turn = a[:3, :3], rotation_vector(b[:3, :3] @ a[:3, :3].T)
    return lambda s: (rotation_of(s * turn) @ start, turn, np.zeros(3))


def spline_way(times: Sequence[Expr], poses: Sequence[Array]) -> Way:
    """The way through poses, by time; they are passed at rational times from 0 on [s]."""
    start = poses[0][:3, :3]
    turns = [np.zeros(3)]
    for pose in poses[1:]:
        turn = rotation_vector(pose[:3, :3] @ start.T)
        angle = float(np.linalg.norm(turn))
        # Of the same rotation the vector that is nearest to the one before.
        axis = turn / angle if angle >= 1e-12 else np.zeros(3)
        turns.append(turn + 2 * np.pi * np.round((turns[-1] - turn) @ axis / (2 * np.pi)) * axis)
    rows = np.array([[*pose[:3, 3], *turn] for pose, turn in zip(poses, turns, strict=True)])
    trajectory = Trajectory.of(tuple(spline(times, [Float(value) for value in column]) for column in rows.T))

    def _place(t: float) -> tuple[Array, Array, Array]:
        p, v, a = (value[:3] for value in trajectory(t))
        return p, v, a

    def _turned(t: float) -> tuple[Array, Array, Array]:
        w, rate, bend = (value[3:] for value in trajectory(t))
        return rotation_of(w) @ start, *angular_motion(w, rate, bend)

    return Way(_place, _turned)


def angular_motion(w: Array, rate: Array, bend: Array) -> tuple[Array, Array]:
    """Angular velocity omega = V w' and acceleration V w'' + V' w', (3,) each, by the rotation vector w [rad]."""
    # With x = |w|^2: V = 1 + a w^ + b w^ w^ and V' by the product rule, a' = (da/dx) x', x' = 2 w.w'.
    x, slope = float(w @ w), 2 * float(w @ rate)  # the square of the angle, and its rate
    cross, turning = cross_matrix(w), cross_matrix(rate)
    square, squared = cross @ cross, turning @ cross + cross @ turning
    # a = sum (-x)^k / (2k + 2)!, b = sum (-x)^k / (2k + 3)!: no division by an angle that is zero.
    series = [[(-1) ** k / factorial(2 * k + least) for k in range(TERMS)] for least in (2, 3)]
    a, b = (float(np.polyval(terms[::-1], x)) for terms in series)
    da, db = (float(np.polyval([k * term for k, term in enumerate(terms)][:0:-1], x)) for terms in series)
    jacobian = np.eye(3) + a * cross + b * square
    drift = da * slope * cross + a * turning + db * slope * square + b * squared
    return jacobian @ rate, jacobian @ bend + drift @ rate


@dataclass(frozen=True)
class Follower:
    """Moves an arm along a way of its end effector."""

    functions: Functions  # ``forward_kinematics``, ``jacobian`` and ``jacobian_dot``
    robot: Robot  # the arm
    values: Mapping[str, float]  # numbers of its symbols
    location: Location  # where the plan asks for it
    held: tuple[int, ...] = ()  # its joints that stand on the way

    @cached_property
    def rows(self) -> tuple[int, ...]:
        """Rows of the twist that the task asks for."""
        return tuple(sorted({row for word in self.robot.inverse.task for row in ROWS.get(word, ROWS["orientation"])}))

    def factor(self, q: Array) -> str:
        """Which formula vanishes at a singular configuration."""
        return vanishing_factor(self.robot, self.values, q)

    def pieces(
        self, way: Way, q: Array, times: Array, fractions: tuple[Array, Array, Array, Array]
    ) -> tuple[tuple[Piece, ...], ...]:
        """The pieces of each joint from q, (n,), by times [s] and s, sd, sdd before and after each node, (nodes,)."""
        befores: list[tuple[Array, ...]] = []
        afters: list[tuple[Array, ...]] = []
        for t, s, sd, before, after in zip(times, *fractions, strict=True):
            passed = float(t - times[0])
            # The configuration on the way nearest to that of the node before, by Newton's method.
            q = self._put(way.pose(float(s)), q, passed)
            # nu = V sd, nu' = V sdd + V' sd^2: velocity and bend of the way by its fraction, of place and rotation.
            (_, *rates), (_, *spins) = way.place(float(s)), way.turned(float(s))
            twist, bend = (np.concatenate(parts) for parts in zip(rates, spins, strict=True))
            jacobian = self._jacobian(q)
            if self.regularity(q) <= SINGULAR:
                inside = f"leads through a singular configuration {passed:.4g} s after its start"
                where = inside if passed else "starts at a singular configuration"
                factor = self.factor(q)
                raise self._error(f"the way {where}" + (f", where {factor} = 0" if factor else ""))
            # J qd = nu; J qdd = nu' - J' qd, before and after a node at which sdd jumps (Siciliano et al., 3.7).
            qd = self._solve(jacobian, twist * sd, passed)
            drift = self.functions("jacobian_dot", q, qd) @ qd
            for sdd, states in ((before, befores), (after, afters)):
                states.append((q, qd, self._solve(jacobian, twist * sdd + bend * sd**2 - drift, passed)))
        when = [Float(t) for t in times]

        def _piece(k: int, j: int) -> Piece:
            first, second = (tuple(Float(value[j]) for value in state) for state in (afters[k], befores[k + 1]))
            return Piece(when[k], when[k + 1] - when[k], (first, second))

        return tuple(tuple(_piece(k, j) for k in range(len(when) - 1)) for j in range(q.size))

    def farthest(self, way: Way, pieces: Sequence[Sequence[Piece]], s: Array) -> float:
        """How far the end effector is from its way between the nodes [m or rad]."""
        middles = np.array([float(piece.start + piece.duration / 2) for piece in pieces[0]])
        rows = Trajectory.of(tuple(map(tuple, pieces)))(middles)[0]
        return max(float(np.abs(self._off(way.pose(float(at)), q)).max()) for at, q in zip(s, rows, strict=True))

    def arrived(self, way: Way, q: Array) -> bool:
        """Whether the end effector is where its way ends."""
        end = way.pose(1.0)
        return bool(np.abs(self._off(end, q)).max() <= CLOSED * (1 + np.abs(end[:3, 3]).max()))

    def _off(self, pose: Array, q: Array) -> Array:
        """How a pose differs from that of a configuration, in what the task asks for."""
        now = self.functions("forward_kinematics", q)
        error = np.concatenate([pose[:3, 3] - now[:3, 3], rotation_vector(pose[:3, :3] @ now[:3, :3].T)])
        return error[list(self.rows)]

    def _put(self, pose: Array, q: Array, after: float) -> Array:
        """The configuration near another one at which the end effector has a pose."""
        for _ in range(ITERATIONS):
            wanted = self._off(pose, q)
            if np.abs(wanted).max() <= CLOSED * (1 + np.abs(pose[:3, 3]).max()):
                return q
            # Newton: q + J^+ e, the least step where the arm has more joints than the task has rows.
            q = q + self._least(self._jacobian(q), wanted)
        raise self._error(f"the arm does not reach the way {after:.4g} s after its start")

    def _jacobian(self, q: Array) -> Array:
        """Rows of the task; columns of joints that stand are zero."""
        found = self.functions("jacobian", q)[list(self.rows)]
        found[:, list(self.held)] = 0.0
        return found

    def _least(self, jacobian: Array, wanted: Array) -> Array:
        found = np.asarray(np.linalg.lstsq(jacobian, wanted, rcond=None)[0], dtype=float)
        found[list(self.held)] = 0.0
        return found

    @cached_property
    def _rank(self) -> int:
        return usual_rank(self.functions, self.rows, self.held)

    def regularity(self, q: Array) -> float:
        """The smallest singular value of J in what the task asks for, relative to the largest."""
        # Of rows that are never independent the last singular values are zero everywhere: the usual rank counts.
        values = np.linalg.svd(self._jacobian(q), compute_uv=False)
        return float(values[self._rank - 1] / values[0]) if self._rank else 1.0

    def _solve(self, jacobian: Array, twist: Array, after: float) -> Array:
        wanted = twist[list(self.rows)]
        found = self._least(jacobian, wanted)
        if np.abs(jacobian @ found - wanted).max() > 1e-8 * (1 + np.abs(wanted).max()):
            raise self._error(f"the arm cannot follow the way {after:.4g} s after its start")
        return found

    def _error(self, found: str) -> RobotFileError:
        remedy = "go there by joints: leave out line, through and spline: hand, or choose another point"
        return RobotFileError(found, remedy=remedy, location=self.location)


# -- where an arm loses a direction of its end effector, and which of its singularities that is


def usual_rank(functions: Functions, rows: Sequence[int], held: Sequence[int] = ()) -> int:
    """In how many directions the end effector moves where the arm is not singular, some joints standing."""
    moving = (np.delete(jacobian[list(rows)], held, axis=1) for jacobian in _jacobians(functions))
    return max(int(np.linalg.matrix_rank(jacobian, tol=1e-9)) for jacobian in moving)


def all_directions(functions: Functions) -> int:
    """How many directions the twists of the end effector have over all configurations."""
    return int(np.linalg.matrix_rank(np.hstack(_jacobians(functions)), tol=1e-9))


def _jacobians(functions: Functions) -> list[Array]:
    return [functions("jacobian", q) for q in np.random.default_rng(0).uniform(-1, 1, (PROBES, functions.n))]


def vanishing_factor(robot: Robot, values: Mapping[str, float], q: Array) -> str:
    """What vanishes at the singularity that is nearest: a factor of det J, or factors that are zero together."""
    from derive.model.kinematic_model import KinematicModel  # closed forms are needed for this message alone

    try:
        families = KinematicModel(robot).singularities.families
    except DeriveError:
        return ""
    numbers = {Symbol(name): value for name, value in values.items()}
    variables = [Symbol(joint.variable) for joint in robot.joints]
    # The size of a factor counts relative to its largest one at random configurations.
    places = [q, *np.random.default_rng(0).uniform(-3, 3, (PROBES, len(q)))]

    def _size(family: tuple[Condition, ...]) -> float:
        """How near it is, as a part of how far it is elsewhere."""
        at = [numbers | dict(zip(variables, map(float, place), strict=True)) for place in places]
        here, *elsewhere = ([abs(float(c.expression.subs(known))) for c in family] for known in at)
        return max(float(size / max(sizes)) for size, sizes in zip(here, zip(*elsewhere, strict=True), strict=True))

    nearest = min(families, key=_size, default=())
    return " = 0 and ".join(sstr(c.expression) for c in nearest) if nearest and _size(nearest) < VANISHING else ""
