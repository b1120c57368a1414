"""All solutions of a pose, found without the derivation: all complex ones by monodromy, then followed to the pose.

The pairs (q, T(q)) form one irreducible variety, so a generic reachable pose has a fixed number of complex solutions,
and walking around loops of poses carries any of them into any other. All of them are collected at one complex pose of
an arm; a wanted pose is reached along a path of poses T(gamma(t)), and each solution is followed on it by a predictor
and Newton's method. Nothing here but the table's numbers comes from the package.

Sources: Tsai and Morgan, 1985, and Wampler and Morgan, 1991 (continuation for six joints); Duff et al., Solving
polynomial systems via homotopy continuation and monodromy, 2019.
"""

import math
from dataclasses import dataclass, field

import numpy as np

from derive.verification.oracle.frames import NumericArm

POSE = tuple((i, j) for i in range(3) for j in range(4))
POSITION = ((0, 3), (1, 3), (2, 3))
APART = 1e-6
"""Solutions closer than this are one."""


@dataclass(eq=False)
class Chain:
    """The table's numbers, real or complex configurations, and pose and derivatives by column operations."""

    arm: NumericArm
    entries: tuple[tuple[int, int], ...] = POSE  # entries of T that are wanted
    given: tuple[int, ...] = ()  # joints that are not solved for
    free: tuple[int, ...] = field(init=False)
    unit: float = field(init=False)  # unit of length

    def __post_init__(self):
        arm = self.arm
        self.free = tuple(i for i in range(arm.n) if i not in self.given)
        lengths = np.concatenate([arm.a, arm.d, arm.tool[:3, 3]])
        self.unit = float(np.abs(lengths).sum()) or 1.0
        self.scale = np.where(arm.revolute, 1.0, self.unit)
        self.rows, self.columns = (list(index) for index in zip(*self.entries, strict=True))
        self.weight = np.where(np.array(self.columns) == 3, 1.0 / self.unit, 1.0)

    def pose(self, q):
        """(..., 4, 4) T, and for each joint its axis and a point on it, (..., n, 3) both; no number is conjugated."""
        arm, like = self.arm, np.zeros((*q.shape[:-1], 1), dtype=q.dtype)
        x, y, z, p = (like + arm.base[:3, k] for k in range(4))
        axes, points = [], []
        for i in range(arm.n):
            moving = arm.sign[i] * q[..., i, None]
            theta = arm.theta[i] + moving if arm.revolute[i] else arm.theta[i]
            d = arm.d[i] if arm.revolute[i] else arm.d[i] + moving
            if not arm.standard:
                p = p + arm.a[i] * x
                y, z = _turned(y, z, arm.alpha[i])
            axes.append(arm.sign[i] * z)
            points.append(p)
            x, y = _turned(x, y, theta)
            p = p + d * z
            if arm.standard:
                p = p + arm.a[i] * x
                y, z = _turned(y, z, arm.alpha[i])
        columns = np.stack([x, y, z, p], axis=-1)
        last = np.zeros((*columns.shape[:-2], 1, 4), dtype=columns.dtype)
        last[..., 0, 3] = 1.0
        pose = np.concatenate([columns, last], axis=-2) @ arm.tool
        return pose, np.stack(axes, axis=-2), np.stack(points, axis=-2)

    def values(self, q):
        """(..., rows) the wanted entries, lengths in units."""
        return self.pose(q)[0][..., self.rows, self.columns] * self.weight

    def values_and_slopes(self, q):
        """The wanted entries and (..., rows, n) their derivatives, slides in units."""
        pose, axes, points = self.pose(q)
        turning = self.arm.revolute[:, None, None]
        columns = np.swapaxes(pose[..., None, :3, :], -1, -2)  # (..., 1, 4 columns, 3)
        lever = columns - np.concatenate([np.zeros_like(points[..., None, :]).repeat(3, -2), points[..., None, :]], -2)
        z = axes[..., None, :]
        slide = np.concatenate([np.zeros_like(z).repeat(3, -2), z], axis=-2)
        slope = np.where(turning, _cross(z, lever), slide)  # (..., n, 4 columns, 3)
        by_joint = slope[..., self.columns, self.rows] * self.weight * self.scale[:, None]
        return pose[..., self.rows, self.columns] * self.weight, np.swapaxes(by_joint, -1, -2)

    def folded(self, q):
        """Real parts of angles in [-pi, pi)."""
        turns = 2 * math.pi * np.floor((q.real + math.pi) / (2 * math.pi))
        return q - np.where(self.arm.revolute, turns, 0.0)

    def distance(self, a, b):
        """The largest difference of a joint variable, full turns aside, without units."""
        return np.abs(self.folded(a - b) / self.scale).max(axis=-1)

    def different(self, q):
        """Configurations without those that repeat an earlier one."""
        kept = []
        for one in q:
            if not kept or self.distance(np.array(kept), one).min() > APART:
                kept.append(one)
        return self.folded(np.array(kept).reshape(-1, q.shape[-1]))

    def newton(self, q, target, steps=3):
        """Newton steps of the free joints; the last step's size beside the result."""
        size = np.full(q.shape[:-1], np.inf)
        for _ in range(steps):
            value, slope = self.values_and_slopes(q)
            step = _least_squares(slope[..., self.free], value - target)
            size = np.abs(step).max(axis=-1)
            q = q.copy()
            q[..., self.free] -= step * self.scale[list(self.free)]
        return q, size


@dataclass(eq=False)
class AllSolutions:
    """Every complex solution at one complex configuration's pose, and how to carry them elsewhere."""

    chain: Chain
    seed: int = 0
    quiet_loops: int = 3

    def __post_init__(self):
        self.random = np.random.default_rng(self.seed)
        self.start = self._complex()
        self.solutions = self._by_newton(self.start[None, :])
        quiet = 0
        while quiet < self.quiet_loops:
            before = len(self.solutions)
            self._loop()
            quiet = quiet + 1 if len(self.solutions) == before else 0

    @property
    def count(self):
        return len(self.solutions)

    def real(self, q, tries=3):
        """All real solutions for the pose of each real configuration, (poses, n)."""
        results = [np.empty((0, self.chain.arm.n))] * len(q)
        sure = np.zeros(len(q), dtype=bool)
        open_ = np.arange(len(q))
        for _ in range(tries):
            ends = self._followed_to(q[open_])
            for i, found in zip(open_, ends, strict=True):
                different = self.chain.different(found)
                sure[i] = len(different) == self.count
                real = different[np.abs(different.imag).max(axis=1, initial=0.0) < 1e-7].real
                results[i] = self.chain.different(np.concatenate([results[i], real]))
            open_ = open_[~sure[open_]]
            if not len(open_):
                break
        return results, sure

    # -- one arm

    def _complex(self):
        arm = self.chain.arm
        return self.chain.scale * (
            self.random.uniform(-math.pi, math.pi, arm.n) * np.where(arm.revolute, 1.0, 0.3)
            + 1j * self.random.uniform(0.2, 0.6, arm.n) * self.random.choice([-1, 1], arm.n)
        )

    def _by_newton(self, known, starts=300):
        """Solutions at the start's pose from random complex starts, damped."""
        chain = self.chain
        q = np.stack([self._complex() for _ in range(starts)])
        q[:, list(chain.given)] = self.start[list(chain.given)]
        q, cost = descend(chain, q, chain.values(self.start), 60)
        return self.chain.different(np.concatenate([known, q[cost < 1e-12]]))

    def _loop(self):
        """Around a loop of poses: over a random configuration, back from another solution there to another one here."""
        middle = self._complex()
        ends, arrived = follow(self.chain, self.solutions, self.start, middle, 0.5 * self._complex())
        if not arrived.all():
            return
        back, goal = ends[self.random.integers(len(ends))], self.solutions[self.random.integers(len(ends))]
        ends, arrived = follow(self.chain, ends, back, goal, 0.5 * self._complex())
        self.solutions = self.chain.different(np.concatenate([self.solutions, ends[arrived]]))

    def _followed_to(self, q):
        poses, count = len(q), self.count
        bends = np.stack([0.5 * self._complex() for _ in range(poses)]).repeat(count, axis=0)
        starts = np.tile(self.solutions, (poses, 1))
        ends, arrived = follow(self.chain, starts, self.start, q.repeat(count, axis=0), bends)
        return [ends[k * count : (k + 1) * count][arrived[k * count : (k + 1) * count]] for k in range(poses)]


def follow(chain, q, start, end, bend, step=0.05):
    """Solutions followed along poses of the path start -> end, bent by ``bend`` in the middle."""
    q = q.astype(complex)
    start, end, bend = (np.broadcast_to(x, q.shape) for x in (start, end, bend))
    given = list(chain.given)
    t, h = np.zeros(len(q)), np.full(len(q), step)
    alive = np.ones(len(q), dtype=bool)

    def place(at, i):
        return start[i] + at[:, None] * (end[i] - start[i]) + (at * (1 - at))[:, None] * bend[i]

    def rate(at, configuration, i):
        gamma, way = place(at, i), end[i] - start[i] + (1 - 2 * at)[:, None] * bend[i]
        _, slope = chain.values_and_slopes(gamma)
        pushed = (slope @ (way / chain.scale)[..., None])[..., 0]
        _, own = chain.values_and_slopes(configuration)
        result = np.array(way)
        if given:
            pushed = pushed - (own[..., given] @ (way[:, given] / chain.scale[given])[..., None])[..., 0]
        result[:, list(chain.free)] = _least_squares(own[..., chain.free], pushed) * chain.scale[list(chain.free)]
        return result

    for _ in range(4000):
        i = np.flatnonzero(alive & (t < 1))
        if not len(i):
            break
        at, by = t[i], np.minimum(h[i], 1 - t[i])
        after = np.where(h[i] >= 1 - t[i], 1.0, at + by)
        with np.errstate(all="ignore"):
            k1 = rate(at, q[i], i)
            k2 = rate(at + by / 2, q[i] + by[:, None] / 2 * k1, i)
            k3 = rate(at + by / 2, q[i] + by[:, None] / 2 * k2, i)
            k4 = rate(after, q[i] + by[:, None] * k3, i)
            guess = q[i] + by[:, None] / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
            target = chain.values(place(after, i))
            if given:
                guess[:, given] = place(after, i)[:, given]
            once, first = chain.newton(guess, target, 1)
            twice, second = chain.newton(once, target, 1)
        good = (first < 1e-3) & (second < 1e-6) & np.isfinite(twice).all(axis=-1)
        q[i[good]], t[i[good]] = twice[good], after[good]
        h[i] = np.where(good, np.where(first < 2e-5, by * 2, by), by / 2)
        alive[i] &= ((h[i] > 1e-7) | (t[i] >= 1)) & (np.abs(q[i].imag / chain.scale).max(axis=-1) < 25)
    arrived = alive & (t >= 1)
    target = chain.values(end)
    with np.errstate(all="ignore"):
        final, size = chain.newton(np.where(arrived[:, None], q, end), target, 3)
    return final, arrived & (size < 1e-7)


def descend(chain, q, target, steps=80):
    """Damped Newton from each start, real or complex; starts that rest are left alone."""
    columns, q = list(chain.free), q.copy()
    value, slope = chain.values_and_slopes(q)
    cost, damping = np.linalg.norm(value - target, axis=-1), np.full(len(q), 1e-2)
    refused = np.zeros(len(q), dtype=int)
    for _ in range(steps):
        i = np.flatnonzero((cost > 1e-15) & (refused < 12))
        if not len(i):
            break
        j = slope[i][..., columns]
        adjoint = np.swapaxes(j.conj(), -1, -2)
        normal = adjoint @ j + (damping[i, None, None] + 1e-14) * np.eye(len(columns))
        step = np.linalg.solve(normal, adjoint @ (value[i] - target)[..., None])[..., 0]
        trial = q[i]
        trial[:, columns] -= step * chain.scale[columns]
        wild = np.abs(trial.imag / chain.scale).max(axis=-1) > 6
        trial[wild] = q[i[wild]]
        new_value, new_slope = chain.values_and_slopes(trial)
        new_cost = np.linalg.norm(new_value - target, axis=-1)
        better = (new_cost < cost[i]) & ~wild
        damping[i] = np.clip(damping[i] * np.where(better, 0.1, 5.0), 1e-15, 1e4)
        refused[i] = np.where(better, 0, refused[i] + 1)
        kept = i[better]
        q[kept], value[kept], slope[kept] = trial[better], new_value[better], new_slope[better]
        cost[kept] = new_cost[better]
    return q, cost


def by_many_starts(chain, q, seed=0, starts=400):
    """Real solutions for the pose of one real configuration by damped Newton from real starts, none twice."""
    random = np.random.default_rng(seed)
    target = chain.values(q)
    low = np.where(chain.arm.revolute, -math.pi, -1.5) * chain.scale
    at = random.uniform(low, -low, (starts, chain.arm.n))
    at[0] = q
    at[:, list(chain.given)] = q[list(chain.given)]
    at, cost = descend(chain, at, target)
    return chain.different(at[cost < 1e-12])


def smallest_singular_value(chain, q):
    """How far each configuration is from a singular one: the smallest singular value by the free joints."""
    _, slope = chain.values_and_slopes(np.asarray(q, dtype=float))
    return np.linalg.svd(slope[..., chain.free], compute_uv=False)[..., -1]


def _turned(u, v, angle):
    c, s = np.cos(angle), np.sin(angle)
    return c * u + s * v, c * v - s * u


def _cross(u, v):
    ux, uy, uz = u[..., 0], u[..., 1], u[..., 2]
    vx, vy, vz = v[..., 0], v[..., 1], v[..., 2]
    return np.stack([uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx], axis=-1)


def _least_squares(matrix, right):
    """The solution of consistent overdetermined equations, (..., columns); not a number where it is not determined."""
    usable = np.isfinite(matrix).all(axis=(-2, -1)) & np.isfinite(right).all(axis=-1)
    q, r = np.linalg.qr(np.where(usable[..., None, None], matrix, 0.0))
    diagonal = np.abs(np.diagonal(r, axis1=-2, axis2=-1))
    usable &= diagonal.min(axis=-1) > 1e-14 * diagonal.max(axis=-1)
    r = np.where(usable[..., None, None], r, np.eye(r.shape[-1]))
    result = np.linalg.solve(r, np.swapaxes(q.conj(), -1, -2) @ np.nan_to_num(right)[..., None])[..., 0]
    return np.where(usable[..., None], result, np.nan)
