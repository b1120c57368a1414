"""Arms with special geometry, and where their Jacobians lose rank in the numbers of the independent recursion."""

import random
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt
import sympy

from derive.lecture.sympy_conversion import expression_to_sympy
from derive.mechanics.exact import Reference
from derive.model.kinematic_model import KinematicModel
from derive.model.singularities.determinant import ALL
from derive.model.singularities.singularities import Condition, Outcome
from derive.robot.names import robot_symbols
from derive.robot.options.inverse import POSE
from derive.robot.robot import Robot
from derive.verification.oracle.frames import forward_kinematics, jacobian
from derive.verification.oracle.functions import Oracle
from tests.evaluate import evaluate

Array = npt.NDArray[Any]

SINGULAR = 1e-9
"""A singular value below this part of the largest is zero."""


def arm_text(rng: random.Random, n: int, share: float) -> str:
    """A robot file: revolute and prismatic joints, axes that are parallel, intersect or are perpendicular."""
    rows = []
    for _ in range(n):
        slides = rng.random() < 0.2
        special = rng.random() < share
        cells = {
            "type": "prismatic" if slides else "revolute",
            "a": _length(rng),
            "alpha": rng.choice(["0", "0", "pi/2", "pi/2", "-pi/2", "pi"]) if special else f"{rng.uniform(-2, 2):.2f}",
            ("theta" if slides else "d"): rng.choice(["0", "pi/2", "0.3"]) if slides else _length(rng),
        }
        rows.append("  - {" + ", ".join(f"{key}: {cell}" for key, cell in cells.items()) + "}")
    convention = rng.choice(["standard", "modified"])
    return "\n".join(["name: arm", "title: Arm", f"convention: {convention}", "joints:", *rows, ""])


def _length(rng: random.Random) -> str:
    return "0" if rng.random() < 0.5 else f"{rng.uniform(-0.6, 0.6):.2f}"


class SingularArm:
    """An arm, numbers for its symbols, and what the model says of its singularities."""

    def __init__(self, robot: Robot, seed: int = 1) -> None:
        self.model = KinematicModel(robot)
        self.rng = np.random.default_rng(seed)
        known = {name: float(expression_to_sympy(value)) for name, value in dict(robot.parameters).items()}
        free = {name: float(self.rng.uniform(0.3, 1.7)) for name in robot_symbols(robot) if name not in known}
        self.arm = Oracle.of(robot, free).arm
        self.values = known | free
        self.numbers = {sympy.Symbol(name): value for name, value in self.values.items()}
        self.found = self.model.singularities

    def random(self, count: int) -> Array:
        """Configurations, (count, n)."""
        return self.rng.uniform(-np.pi, np.pi, (count, self.model.n))

    def ratios(self, q: Array) -> Array:
        """The singular value that is zero where the rank is less than usual, as a part of the largest, (k,)."""
        return np.asarray(np.linalg.svd(self._jacobian(q), compute_uv=False)[:, self._rank - 1] / self._size)

    @cached_property
    def _size(self) -> float:
        return float(np.median(np.linalg.svd(self._jacobian(self.random(64)), compute_uv=False)[:, 0]))

    @property
    def _rank(self) -> int:
        return min(self.found.shape) if self.found.rank is None else self.found.rank

    def _jacobian(self, q: Array) -> Array:
        """Of the stated task; the linear rows for the position in space or in a plane; else all of J."""
        return self._task(q, jacobian(self.arm, q))

    def _task(self, q: Array, of_arm: Array) -> Array:
        stated, block = self.model.robot.inverse.task, next(iter(self.found.blocks), None)
        if stated == POSE:
            is_position = block and self.found.task and max(block.rows) <= 3 and not block.others_are_zero
            return of_arm[:, :3] if is_position else of_arm
        turn, rows = forward_kinematics(self.arm, q)[:, :3, :3], []
        spin = np.swapaxes(of_arm[:, 3:], 1, 2)
        for word in stated:
            if word in "xyz":
                rows.append(of_arm[:, ["xyz".index(word)]])
            elif word == "orientation":
                rows.append(of_arm[:, 3:])
            elif word == "approach":
                rows.append(np.einsum("kij,knj->kin", np.swapaxes(turn, 1, 2)[:, :2], spin))
            else:
                rate = np.cross(spin, turn[:, None, :, 0])
                rows.append((turn[:, None, 0, 0] * rate[..., 1] - turn[:, None, 1, 0] * rate[..., 0])[:, None])
        return np.concatenate(rows, axis=1)

    def check_determinant(self) -> None:
        """It is that of J by the recursion, or of the printed block where that is taken elsewhere."""
        (q,) = self.random(1)
        values = self.values | dict(zip(map(str, self.model.q), q, strict=True))
        of_arm, found = jacobian(self.arm, q), self.found
        if found.outcome is Outcome.EVERYWHERE:
            assert found.rank == np.linalg.matrix_rank(of_arm, tol=1e-9) < min(found.shape)
        elif found.outcome is not Outcome.UNSOLVED and found.blocks:
            block, *others = found.blocks
            is_whole = bool(others) or self.model.n == 6
            if is_whole or block.reference == Reference():
                rows = ALL if is_whole else block.rows
                ours = [found.determinant, self.model.det_J(rows)]
                theirs = np.linalg.det(of_arm[[row - 1 for row in rows]])
            else:
                ours, theirs = [found.determinant], np.linalg.det(evaluate(block.matrix, values))
            for determinant in ours:
                assert abs(evaluate(determinant, values) - theirs) <= 1e-9 * max(1.0, abs(theirs))

    def minimisers(self, starts: int, steps: int = 150) -> Array:
        """Configurations to which descent on that singular value leads, by steps that make a cone zero at once."""
        n, rank = self.model.n, self._rank
        q = self.random(starts)
        for _ in range(steps):
            left, values, right = np.linalg.svd(self._jacobian(q), full_matrices=False)
            u, v, size = left[:, :, rank - 1], right[:, rank - 1], values[:, rank - 1]
            steps_in_j = [self._jacobian(q + 1e-30j * row).imag * 1e30 for row in np.eye(n)]
            slopes = np.stack([np.einsum("ki,kij,kj->k", u, step, v) for step in steps_in_j], axis=-1)
            way = slopes * (size / np.maximum(np.sum(slopes**2, axis=-1), 1e-12))[:, None]
            q = q - way * np.minimum(1.0, 0.5 / np.maximum(np.linalg.norm(way, axis=-1), 1e-12))[:, None]
        return q

    @cached_property
    def _families(self) -> list[Any]:
        variables = list(self.model.q)
        slides = {q for q, joint in zip(variables, self.model.robot.joints, strict=True) if not joint.is_revolute}

        def zero(c: Condition) -> Any:  # angles are equal up to full turns
            is_angle = c.is_solution and not c.variable.free_symbols & slides
            return (sympy.sin(c.expression / 2) if is_angle else c.expression).xreplace(self.numbers)

        return [sympy.lambdify([variables], [zero(c) for c in family], "numpy") for family in self.found.families]

    def zero(self, family: int, q: Array) -> Array | None:
        """The zero of all conditions of a family to which Gauss and Newton's method leads; None if to none."""
        n = self.model.n
        for _ in range(40):
            value = np.array([complex(x).real for x in self._families[family](list(q))])
            if np.abs(value).max() < 1e-13:
                return q
            steps = (self._families[family](list(q + 1e-30j * row)) for row in np.eye(n))
            slope = np.array([[complex(x).imag * 1e30 for x in step] for step in steps]).T
            way = np.linalg.lstsq(slope, value, rcond=1e-12)[0]
            q = q - way * min(1.0, 1.0 / max(float(np.linalg.norm(way)), 1e-12))
        return q if np.abs(value).max() < 1e-9 else None

    def check(self, places: int, starts: int) -> None:
        """The rank is less in every family, and nowhere else where the set is said to be complete."""
        if self.found.rank == 0:
            assert np.abs(self._jacobian(self.random(8))).max() < 1e-12
            return
        for family in range(len(self.found.families)):
            zeros = [zero for q in self.random(4) if (zero := self.zero(family, q)) is not None]
            assert not zeros or self.ratios(np.array(zeros)).max() < 1e-5, self.found.families[family]
        assert self.ratios(self.random(places)).max() > SINGULAR, "the usual rank"
        if self.found.complete:
            found = self.minimisers(starts)
            for q in found[self.ratios(found) < SINGULAR]:
                near = [self.zero(family, q) for family in range(len(self.found.families))]
                assert any(zero is not None and self._apart(zero, q) < 0.02 for zero in near), list(q)

    def _apart(self, q: Array, other: Array) -> float:
        """The distance of two configurations, angles up to full turns."""
        turns = np.array([joint.is_revolute for joint in self.model.robot.joints]) * 2 * np.pi
        way = q - other
        return float(np.linalg.norm(way - turns * np.round(way / np.where(turns > 0, turns, 1.0))))
