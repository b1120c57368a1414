"""The fastest motion along a path within largest speeds, accelerations and torques of the joints.

With a path q(s) and s(t), and x = (ds/dt)^2, u = d2s/dt2,

    qd = q' sqrt(x)    qdd = q' u + q'' x    tau = (B q') u + (B q'' + C(q, q') q') x + (D q') sqrt(x) + f sign(q') + g

all of them linear in u and x but for viscous friction D. Between two places of a grid u is constant and x linear in s.
toppra (Pham and Pham, A New Approach to Time-Optimal Path Parameterization Based on Reachability Analysis, IEEE T-RO
34(3), 2018) finds the largest x within linear bounds; the root is replaced by its tangent at the x found before until
nothing changes. Bounds are held at both ends of every interval. What the motion then exceeds inside one is taken off
its bounds, and what is left after that is made good by time.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
from sympy import Expr, Float

from derive.arrays import Array, Indices
from derive.errors import QuantityError, optional
from derive.motion.curves.trajectory import ONE, Corner, Trajectory
from derive.plans.profile import MOST_PRINTED, ZERO, Piece, joined, sampled, symbolic
from derive.plans.segments import Joints

Torques = Callable[[Indices, Array, Array, Array], Array]  # of steps by index, at q, qd, qdd: (...), then (..., n)
Bounds = tuple[Array, Array, Array]  # largest speed, acceleration and torque of each joint, or infinite, (n,) each
INSIDE = 1e-9  # of an interval, from its ends: bounds are held on the right side of turns and changes of payload
SAMPLES = 24  # places of an interval at which a motion is looked at
ROUNDS = 12  # how often viscous friction and the bounds are corrected
SETTLED = 1e-6  # change of x, relative to its largest value, below which viscous friction is right
SPARE = 1e-11  # what is left of each bound, relative to it, for the rounding of who looks later
CURVED = 1e-4  # most that is left, relative to a bound, for what may lie between two samples
INTERVALS = 192  # of each segment
NOISE = 1e-9  # slope of a joint, relative to the largest of all, below which it does not move
HALVINGS = 50  # of an interval in which a joint turns back
VALUES = 3  # position, velocity and acceleration stand at both ends of each piece


@dataclass(frozen=True, slots=True)
class Rows:
    """What is at most one at an end of each interval: a u + b x + v sqrt(x) + c + dry."""

    a: Array  # (intervals, rows)
    b: Array  # (intervals, rows)
    v: Array  # (intervals, rows)
    c: Array  # (intervals, rows)
    dry: Array  # dry friction, whose sign is that of the velocity, (intervals, rows)


@dataclass(frozen=True)
class FastestMotion:
    """A path whose time is looked for."""

    path: Trajectory  # joint variables as functions of s
    grid: Array  # values of s, ascending, (nodes,)
    steps: Indices  # index of the step of each interval, (intervals,)
    bounds: Bounds  # largest speeds, accelerations and torques
    torques: Torques  # of what moves
    even: Array  # what friction of a joint that moves has more than half of what it has to the other side, (n,)

    def solve(self) -> Nodes:
        """The motion from rest to rest."""
        # Coefficients at both ends of every interval. An arm that needs more than its torques to stand has no motion.
        ends = self._ends()
        if max(ends[0].c[0].max(), ends[1].c[-1].max()) > 1:
            raise self._refused(ends)
        margins = np.zeros(ends[0].a.shape)
        # First without viscous friction, then with its tangent at the x found before, until x settles (Newton).
        x = self._largest(ends, margins, None)
        for _ in range(ROUNDS):
            before, x = x, self._largest(ends, margins, x)
            if np.abs(x - before).max() <= SETTLED * x.max():
                break
        nodes = self._nodes(x)
        for _ in range(ROUNDS):
            if (excess := self._excess(nodes)).max() <= 0:
                break
            margins += np.maximum(excess, 0) + 10 * SPARE * (excess > 0)
            x = self._largest(ends, margins, x)
            nodes = self._nodes(x)
        # In a time longer by a factor speeds fall by it, accelerations by its square: doubled until all bounds hold.
        slower, more = nodes, SPARE
        while (over := float(self._excess(slower).max())) > 0:
            if (more := max(2 * more, over / 4)) > 1:
                raise self._refused(ends)
            slower = nodes.slower(1 + more)
        return slower

    def _magnitudes(self, q: Array, qd: Array, qdd: Array, steps: Indices) -> Array:
        """Speeds squared, accelerations and torques by their bounds, (..., rows), both signs of the latter."""
        speed, acceleration, torque = self.bounds
        # Speeds are squared, since qd^2 = q'^2 x is linear in x where |qd| is not.
        parts = [(qd / speed)[..., np.isfinite(speed)] ** 2]
        signed = (qdd / acceleration)[..., np.isfinite(acceleration)]
        parts += [signed, -signed]
        if np.isfinite(torque).any():
            tau = (self.torques(np.broadcast_to(steps, q.shape[:-1]), q, qd, qdd) / torque)[..., np.isfinite(torque)]
            parts += [tau, -tau]
        return np.concatenate(parts, axis=-1)

    def _rows(self, place: float) -> Rows:
        """The coefficients near one end of each interval, from the torques at few velocities and accelerations."""
        a, b = self.grid[:-1], self.grid[1:]
        q, slope, bend = self.path(a + place * (b - a))  # q, q' and q'' by s near an end of each interval
        zero = np.zeros_like(q)

        def _at(qd: Array, qdd: Array) -> Array:
            return self._magnitudes(q, qd, qdd, self.steps)

        # tau(qd = v q', qdd = v^2 q'') = g + v^2 (B q'' + C q') + v D q' + f sign(v q') + e, e the even friction of
        # what moves, asked at v = 0, 1, -1 and 2: the even part at 1 less g and e has v^2, the odd part
        # D q' + f sign(q'), of which twice the speed tells D from f.
        most, others = self.bounds[2], [np.isfinite(bound).sum() for bound in self.bounds[:2]]
        even_torque = (self.even * (slope != 0) / most)[:, np.isfinite(most)]
        lean = np.hstack([np.zeros((len(slope), others[0] + 2 * others[1])), even_torque, -even_torque])
        still, moved = _at(zero, zero), _at(slope, bend)
        back, twice = _at(-slope, bend), _at(2 * slope, 4 * bend)
        even, odd = (moved + back) / 2 - still - lean, (moved - back) / 2
        viscous = twice - still - lean - 4 * even - odd
        return Rows(_at(zero, slope) - still, even, viscous, still, odd - viscous + lean)

    def _ends(self) -> tuple[Rows, Rows]:
        ends = self._rows(INSIDE), self._rows(1 - INSIDE)
        # Between two intervals, the larger of the dry frictions of both sides: where a motion begins or ends, or a
        # joint turns back, its velocity is zero, and dry friction may have any value between.
        none = np.zeros((1, ends[0].dry.shape[1]))
        first = np.maximum(ends[0].dry, np.concatenate([none, ends[1].dry[:-1]]))
        second = np.maximum(ends[1].dry, np.concatenate([ends[0].dry[1:], none]))
        ends = replace(ends[0], dry=first), replace(ends[1], dry=second)
        if not all(np.abs(rows.a).max(axis=1, initial=0).all() for rows in ends):
            remedy = "write acceleration: or torque: of each joint, or torque: into the robot file"
            raise QuantityError("nothing limits the acceleration of the fastest motion", remedy=remedy)
        return ends

    def _refused(self, ends: tuple[Rows, Rows]) -> QuantityError:
        """Why there is no motion: where the arm needs most of a torque to stand or to begin to move."""
        loads = [rows.c + rows.dry for rows in ends]
        most, at, row = max((float(load.max()), *divmod(int(load.argmax()), load.shape[1])) for load in loads)
        said = ""
        if most > 1:
            where = ", ".join(f"{value:.4g}" for value in self.path(float(self.grid[at]))[0])
            counts = [int(np.isfinite(bound).sum()) for bound in self.bounds]
            limited = np.flatnonzero(np.isfinite(self.bounds[2]))
            joint = int(limited[(row - counts[0] - 2 * counts[1]) % counts[2]])
            named = f"the largest torque {self.bounds[2][joint]:.6g} of joint {joint + 1}"
            said = f"; it needs {most:.4g} times {named} to stand at q = ({where})"
        remedy = "allow more torque, carry less, or go another way"
        return QuantityError(f"no motion along this way keeps to the limits{said}", remedy=remedy)

    def _largest(self, ends: tuple[Rows, Rows], margins: Array, near: Array | None) -> Array:
        """The largest x at each node; viscous friction by the tangent of the root at x found before, first without."""
        first, second = ends
        step = np.diff(self.grid)[:, None]
        scale = max(np.abs(rows.a).max() for rows in ends)
        # At the second end of an interval x is x_0 + 2 u ds, so that b x there is b x_0 + 2 ds b u: shifted into a.
        a, b, c = [], [], []
        for rows, shift, nodes in ((first, 0.0, slice(None, -1)), (second, 2 * step, slice(1, None))):
            slope, root = np.zeros((2, len(step), 1))
            if near is not None:
                # The root of x as slope x + root; at zero, where motions begin and end, it is zero.
                rates = np.sqrt(near[nodes])[:, None]
                slope, root = np.divide(0.5, rates, out=np.zeros_like(rates), where=rates > 0), rates / 2
            factor = rows.b + rows.v * slope
            a.append(rows.a + shift * factor)
            b.append(factor)
            c.append(rows.c + rows.dry + rows.v * root + margins)
        # Both ends are bounds of the first node of their interval; the last node has those of the node before.
        rest = [np.concatenate(part, axis=1) for part in (a, b, c)]
        a_all, b_all, c_all = (np.vstack([part, part[-1:]]) for part in rest)
        if (found := _by_toppra(self.grid, a_all / scale, b_all / scale, c_all)) is None:
            raise self._refused(ends)
        return np.asarray(found / scale)

    def _nodes(self, x: Array) -> Nodes:
        # With u constant ds/dt is linear in time: an interval takes 2 ds/(sqrt(x_0) + sqrt(x_1)), and u = dx/(2 ds).
        rates, steps = np.sqrt(x), np.diff(self.grid)
        times = np.append(0.0, np.cumsum(2 * steps / (rates[:-1] + rates[1:])))
        pull = (np.diff(x) / (2 * steps))[:, None]
        q, slope, bend = self.path(self.grid)
        ends = np.empty((len(steps), 2, VALUES, q.shape[1]))
        for end, nodes in enumerate((slice(None, -1), slice(1, None))):
            # qd = q' sqrt(x), qdd = q' u + q'' x, u from the interval itself: accelerations jump at nodes.
            ends[:, end, 0], ends[:, end, 1] = q[nodes], slope[nodes] * rates[nodes, None]
            ends[:, end, 2] = slope[nodes] * pull + bend[nodes] * x[nodes, None]
        return Nodes(times, ends)

    def _excess(self, nodes: Nodes) -> Array:
        """By how much each bound is exceeded in each interval, relative to it, with what may lie between samples."""
        places = np.concatenate([[0.0], np.linspace(INSIDE, 1 - INSIDE, SAMPLES + 1), [1.0]])
        found = self._magnitudes(*nodes.inside(places), self.steps[:, None])
        # A parabola through three samples rises above them by an eighth of their second difference at most.
        between = np.abs(np.diff(found[:, 1:-1], 2, axis=1)).max(axis=1) / 8
        return np.asarray(found.max(axis=1) + np.minimum(between, CURVED) + SPARE - 1)


def _by_toppra(grid: Array, a: Array, b: Array, c: Array) -> Array | None:
    """The largest x, (nodes,), from rest to rest with a u + b x + c <= 1 at each node; None where there is none."""
    load = partial(optional, what="the fastest motion needs toppra", extra="motion", kind=QuantityError)
    solver, rows = load("toppra.algorithm").TOPPRA, load("toppra.constraint").LinearConstraint()
    logging.getLogger("toppra").addHandler(logging.NullHandler())
    rows.identical = True
    count = a.shape[1]
    rows.compute_constraint_params = lambda path, grid: (a, b, c, np.eye(count), np.ones(count), None, None)
    found = solver([rows], SimpleNamespace(path_interval=grid[[0, -1]]), gridpoints=grid, solver_wrapper="seidel")
    _, rates, _ = found.compute_parameterization(0, 0)
    if rates is None or not np.isfinite(rates).all():
        return None
    # An interval at whose both ends the rate is zero would take for ever.
    return None if (rates[:-1] + rates[1:] == 0).any() else np.asarray(rates, dtype=float) ** 2


# -- paths of the joints, q(s) from s = 0 to 1, and motions along them by their values at many times


UNIFORM = Trajectory.of(((Piece(ZERO, ONE, ((ZERO, ONE), (ONE, ONE))),),))  # s itself


def smooth_path(knots: Array, corners: Array) -> Trajectory:
    """The natural cubic spline through points at s from 0 to 1, (points,); between two points a straight line."""
    from scipy.interpolate import CubicSpline

    places = [Float(s) for s in knots]
    states = np.stack([corners, CubicSpline(knots, corners, bc_type="natural")(knots, 1)], axis=-1)
    tracks = ([tuple(map(Float, node)) for node in states[:, j]] for j in range(corners.shape[1]))
    return Trajectory.of(tuple(joined(track, places) for track in tracks))


@dataclass(frozen=True, slots=True)
class Nodes:
    """A motion by polynomials of degree five between times."""

    times: Array  # ascending from 0 [s], (nodes,)
    ends: Array  # position, velocity and acceleration at both ends of each interval, (intervals, 2, 3, n)

    def slower(self, factor: float) -> Nodes:
        """The same in more time."""
        return Nodes(self.times * factor, self.ends / factor ** np.arange(VALUES)[:, None])

    def inside(self, u: Array) -> tuple[Array, Array, Array]:
        """Position, velocity and acceleration at the same places of each interval."""
        count, n = self.ends.shape[0], self.ends.shape[-1]
        lengths = np.repeat(np.diff(self.times), u.size)
        places = np.tile(u, count)
        found = np.empty((VALUES, count * u.size, n))
        for j in range(n):
            numbers = np.repeat(self.ends[..., j].reshape(count, 2 * VALUES), u.size, axis=0)
            for order in range(VALUES):
                found[order, :, j] = sampled(numbers, VALUES, places, lengths, order)
        q, qd, qdd = found.reshape(VALUES, count, u.size, n)
        return q, qd, qdd

    def pieces(self, first: int, last: int, exact: Mapping[int, Corner]) -> Joints:
        """The pieces of each joint between two nodes; of one that stands a single one."""
        number: Callable[[float], Expr] = Float if last - first <= MOST_PRINTED else float
        zero = number(0) if number is float else ZERO
        times = [number(t) if t else zero for t in self.times[first : last + 1]]

        def _end(node: int, end: int, j: int) -> tuple[Expr, ...]:
            q, *rates = self.ends[node - end, end, :, j]
            return (exact[node][j] if node in exact else number(q), *(number(rate) if rate else zero for rate in rates))

        tracks: list[tuple[Piece, ...]] = []
        for j in range(self.ends.shape[-1]):
            if self.ends[first:last, :, 1:, j].any():
                values = ((_end(i, 0, j), _end(i + 1, 1, j)) for i in range(first, last))
                spans = zip(pairwise(times), values, strict=True)
                tracks.append(tuple(Piece(a, b - a, ends) for (a, b), ends in spans))
            else:
                stands = (*map(symbolic, _end(first, 0, j)),)
                tracks.append((Piece(symbolic(times[0]), symbolic(times[-1] - times[0]), (stands, stands)),))
        return tuple(tracks)


def grid_of(path: Trajectory, knots: Array) -> Array:
    """Values of s at which a motion is computed: closer at both ends, where it is slow."""
    grid: Array = (1 - np.cos(np.linspace(0, np.pi, INTERVALS * (len(knots) - 1) + 1))) / 2
    # A joint that turns back between two places gets one of its own there, by bisection of the sign of q'.
    slopes = path(grid)[1]
    slopes[:, np.abs(slopes).max(axis=0) < NOISE * np.abs(slopes).max()] = 0
    fixed = list(knots[1:-1])
    for i, j in np.argwhere(slopes[:-1] * slopes[1:] < 0):
        low, high = float(grid[i]), float(grid[i + 1])
        for _ in range(HALVINGS):
            middle = (low + high) / 2
            low, high = (middle, high) if path(middle)[1][j] * slopes[i, j] > 0 else (low, middle)
        fixed += [low] if not fixed or np.abs(np.array(fixed) - low).min() > NOISE else []
    # Points of the path and turns take the places of the grid that are nearest to them.
    inner = grid[1:-1]
    nearest = {int(np.abs(inner - place).argmin()) for place in fixed}
    return np.array([0.0, *sorted([*np.delete(inner, sorted(nearest)), *fixed]), 1.0])
