"""Arms as plain rows of numbers, and their solutions by damped Newton from random starts, without derive."""

from dataclasses import dataclass

import numpy as np

from derive.arrays import Array
from derive.robot.robot import Robot

TURN = 2.0 * np.pi
PI = np.pi


@dataclass(frozen=True)
class NumericArm:
    """Rows of a standard table: length a, offset d and twist [m, rad], whether it slides, limits [rad or m]."""

    name: str
    rows: tuple[tuple[float, float, float, bool, tuple[float, float] | None], ...]
    entries: tuple[tuple[int, int], ...]  # of the pose that the task has
    speeds: tuple[int, ...]  # rows of the Jacobian that the task has
    postures: int  # at most

    @property
    def text(self) -> str:
        lines = [f"name: {self.name}", "convention: standard", "joints:"]
        for a, d, alpha, slides, limits in self.rows:
            offset = "" if slides else f", d: {d!r}"
            bounds = f", limits: [{limits[0]!r}, {limits[1]!r}]" if limits else ""
            kind = "prismatic" if slides else "revolute"
            lines.append(f"  - {{type: {kind}, a: {a!r}{offset}, alpha: {alpha!r}{bounds}}}")
        return "\n".join(lines)

    @property
    def robot(self) -> Robot:
        return Robot.from_text(self.text)

    def pose_and_jacobian(self, q: Array) -> tuple[Array, Array]:
        """T (..., 4, 4) and J (..., 6, n), by the product of the matrices of the rows."""
        pose = np.broadcast_to(np.eye(4), (*q.shape[:-1], 4, 4))
        axes, places = [], []
        for (a, d, alpha, slides, _), value in zip(self.rows, np.moveaxis(q, -1, 0), strict=True):
            axes.append(pose[..., :3, 2])
            places.append(pose[..., :3, 3])
            theta, height = (0.0 * value, value) if slides else (value, d + 0.0 * value)
            c, s, ca, sa, no = np.cos(theta), np.sin(theta), np.cos(alpha), np.sin(alpha), 0.0 * theta
            rows = [c, -s * ca, s * sa, a * c, s, c * ca, -c * sa, a * s]
            rows += [no, no + sa, no + ca, height, no, no, no, no + 1.0]
            pose = pose @ np.stack(rows, axis=-1).reshape(*no.shape, 4, 4)
        columns = []
        for (*_, slides, _), axis, place in zip(self.rows, axes, places, strict=True):
            arm = pose[..., :3, 3] - place
            columns.append(np.concatenate([axis, 0 * axis] if slides else [np.cross(axis, arm), axis], axis=-1))
        return pose, np.stack(columns, axis=-1)

    def errors(self, q: Array, goal: Array) -> tuple[Array, Array]:
        """How far the entries of the task are from the goal (..., m), and the derivatives (..., m, n)."""
        pose, jacobian = self.pose_and_jacobian(q)
        slopes = np.concatenate(
            [np.cross(jacobian[..., None, 3:, :], pose[..., :3, :3].swapaxes(-1, -2)[..., None], axis=-2),
             jacobian[..., None, :3, :]], axis=-3)  # (..., columns of T, rows of T, n)  # fmt: skip
        rows, columns = zip(*self.entries, strict=True)
        return (pose - goal)[..., rows, columns], slopes[..., columns, rows, :]

    def solutions(self, goals: Array, starts: int, seed: int = 0) -> list[Array]:
        """Of each pose (k, 4, 4) the different solutions that are found and lie within the limits, full turns apart."""
        n = len(self.rows)
        low, high = np.array([limits if limits and slides else (-PI, PI) for *_, slides, limits in self.rows]).T
        q = np.random.default_rng(seed).uniform(low, high, (len(goals), starts, n))
        damping = np.full(q.shape[:2], 1e-2)
        error, slope = self.errors(q, goals[:, None])
        for _ in range(60):
            normal = np.swapaxes(slope, -1, -2) @ slope + damping[..., None, None] * np.eye(n)
            step = np.linalg.solve(normal, np.swapaxes(slope, -1, -2) @ error[..., None])[..., 0]
            tried_error, tried_slope = self.errors(q - step, goals[:, None])
            better = np.linalg.norm(tried_error, axis=-1) < np.linalg.norm(error, axis=-1)
            damping = np.clip(np.where(better, damping * 0.1, damping * 8.0), 1e-12, 1e3)
            q = np.where(better[..., None], q - step, q)
            error = np.where(better[..., None], tried_error, error)
            slope = np.where(better[..., None, None], tried_slope, slope)
        done = np.abs(error).max(axis=-1) < 1e-9
        return [self._apart(values[found]) for values, found in zip(q, done, strict=True)]

    def _apart(self, q: Array) -> Array:
        found: list[Array] = []
        turns = np.array([not slides for *_, slides, _ in self.rows]) * TURN
        for row in q[self.margins(q) >= 0.0]:
            gaps = [row - other for other in found]
            if all(np.abs(gap - turns * np.round(gap / TURN)).max() > 1e-4 for gap in gaps):
                found.append(row)
        return np.array(found).reshape(-1, len(self.rows))

    def margins(self, q: Array) -> Array:
        """The least margin of configurations over the joints with limits, at their best full turns."""
        worst = np.ones(q.shape[:-1])
        for (*_, slides, limits), value in zip(self.rows, np.moveaxis(q, -1, 0), strict=True):
            if limits:
                value = value if slides else value - TURN * np.round(value / TURN)  # Newton's method may go far
                turns = value[..., None] + (0.0 if slides else TURN) * np.arange(-4, 5)
                nearer = np.minimum(turns - limits[0], limits[1] - turns).max(axis=-1)
                worst = np.minimum(worst, 2.0 * nearer / (limits[1] - limits[0]))
        return worst

    def jacobian(self, q: Array) -> Array:
        return self.pose_and_jacobian(q)[1][..., self.speeds, :]

    def manipulability(self, q: Array) -> Array:
        rows = self.jacobian(q)
        return np.sqrt(np.maximum(np.linalg.det(rows @ np.swapaxes(rows, -1, -2)), 0.0))


def _rows(*table: tuple[float, ...]) -> tuple[tuple[float, float, float, bool, tuple[float, float] | None], ...]:
    """Rows of joints that turn, by length, offset, twist and, of those with limits, these."""
    return tuple((a, d, alpha, False, (limits[0], limits[1]) if limits else None) for a, d, alpha, *limits in table)


_POSE = tuple((i, j) for i in range(3) for j in range(4))
_POSITION = ((0, 3), (1, 3), (2, 3))
_ANGLE = ((0, 0), (1, 0))
_ALL = (0, 1, 2, 3, 4, 5)
_SIZES = ((0, 0.1625, PI / 2), (-0.425, 0, 0), (-0.3922, 0, 0))
_SIZES += ((0, 0.1333, PI / 2), (0, 0.0997, -PI / 2), (0, 0.0996, 0))

UR5E = NumericArm("ur5e", _rows(*((*row, -TURN, TURN) for row in _SIZES)), _POSE, _ALL, 8)
_SIX = _rows((0, 0, -PI / 2, -2.7, 2.7), (0.4318, 0.15, 0, -3.9, 0.8), (-0.02, 0, PI / 2, -0.9, 3.9))
_SIX += _rows((0, 0.43, -PI / 2, -1.9, 2.9), (0, 0, PI / 2, -1.7, 1.7), (0, 0.06, 0, -4.6, 4.6))
PUMA = NumericArm("puma-like", _SIX, _POSE, _ALL, 8)
_THREE = _rows((0.5, 0, 0, -1.5, 1.5), (0.4, 0, 0, -2.4, 2.0), (0.2, 0, 0))
PLANAR = NumericArm("planar", _THREE, ((0, 3), (1, 3), *_ANGLE), (0, 1, 5), 2)
_SLIDE = (0, 0, 0, True, (0.05, 0.3))
_FOUR = (*_rows((0.5, 0, 0, -2.0, 2.0), (0.4, 0, PI, -2.5, 7.0)), _SLIDE, *_rows((0, 0.1, 0, -3.0, 3.0)))
SCARA = NumericArm("scara", _FOUR, (*_POSITION, *_ANGLE), (0, 1, 2, 5), 2)
_BENT = _rows((0.1, 0.3, PI / 2, -1.0, 4.0), (0.4, 0, 0), (0.3, 0.05, 0, 0.0, 3.0))
ELBOW = NumericArm("elbow", _BENT, _POSITION, (0, 1, 2), 4)
