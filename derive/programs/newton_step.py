"""One step of Newton's method towards a pose, for solutions of inverse kinematics that are in doubt.

With e what the wanted entries of the pose are off and G their derivatives, lengths relative to the reach of the arm,

    q' = q - (G^T G + damping)^-1 G^T e

(Levenberg, A method for the solution of certain non-linear problems in least squares, 1944). Where R is wanted whole,
the axes of the joints are enough: turned by w, the columns r_j of R, which should be t_j, move by w x r_j; two such
motions have the product 2 w.v, and that with r_j - t_j is w.(sum of t_j x r_j). The matrix is positive definite and is
factored without looking for pivots (Golub and Van Loan, Matrix Computations, ch. 4).
"""

from __future__ import annotations

from collections.abc import Sequence

from derive.mechanics.forward_kinematics import forward_kinematics, jacobian
from derive.mechanics.vectors import Vector, column, cross, dot
from derive.model.inverse.graph import SolutionGraph
from derive.programs.program import DAMPING, POSE, POSE_ENTRIES, Function, Interface
from derive.programs.tape.build import bake, cut
from derive.programs.tape.scalars import Q
from derive.programs.tape.value import Value
from derive.programs.trace import Trace

INTERFACE = Interface(
    "inverse_kinematics_step",
    (Q, POSE, DAMPING),
    ("n",),
    "q",
    "A configuration nearer to a pose, how far the first one is from it, and the unit of length.",
    "joint variables [rad, m], the error of the pose, lengths relative to the reach, and the reach [m]",
)


def newton_step(trace: Trace, graph: SolutionGraph, reach: Value) -> Function:
    """The program of one step.

    Args:
        trace: Of the robot.
        graph: Says which entries of the pose are wanted, and which joints are given.
        reach: The size of the arm and of the pose.

    Returns:
        The function; its results are the n joint variables, the error of the configuration that it is given, the
        square root of the sum of the squares of e, less what T itself is off a pose, and the unit of length.
    """
    joints = [k for k in range(trace.n) if k not in graph.given]
    unit = trace.domain.number(0).less(reach).select(reach, 1)
    fit = _Fit(trace, graph.places, unit)
    damping = trace.domain.argument(DAMPING, 0)
    matrix = [[fit.product(a, b) + (damping if a == b else 0) for b in joints[: i + 1]] for i, a in enumerate(joints)]
    results = trace.arguments(Q)
    for joint, step in zip(joints, solved(matrix, [fit.slope(k) for k in joints]), strict=True):
        results[joint] = results[joint] - (step if trace.chain.joints[joint].revolute else unit * step)
    tape = cut(*bake(trace.graph, [value.ref for value in (*results, fit.error, unit)], trace.choice.numbers))
    return Function(INTERFACE, (trace.n + 2,), tape, "damped Newton", widths={POSE: POSE_ENTRIES, DAMPING: 1})


class _Fit:
    """What the wanted entries of the pose are off, and how they change with the joints.

    Args:
        trace: Of the robot.
        places: The wanted entries, rows and columns from 0.
        unit: The unit of length.
    """

    def __init__(self, trace: Trace, places: Sequence[tuple[int, int]], unit: Value) -> None:
        self._pose = [[trace.domain.argument(POSE, 4 * i + j) for j in range(4)] for i in range(3)]
        frame = trace.shortest_pose or forward_kinematics(trace.chain)
        rows = trace.shortest_jacobian or jacobian(trace.chain)
        zero = trace.chain.zero
        self._axes: list[Vector[Value]] = [(rows[3][k], rows[4][k], rows[5][k]) for k in range(trace.n)]
        self._off, self._slopes, turned = [], list[list[Value]](), set[int]()
        whole = sum(j < 3 for _, j in places) == 9
        for i, j in places:
            if j == 3:
                self._off.append((frame.position[i] - self._pose[i][3]) / unit)
                scales = [1 / unit if joint.revolute else trace.chain.one for joint in trace.chain.joints]
                self._slopes.append([rows[i][k] * scales[k] for k in range(trace.n)])
            else:
                turned.add(j)
                self._off.append(frame.rotation[i][j] - self._pose[i][j])
                r = column(frame.rotation, j)
                self._slopes.append([zero if whole else cross(w, r)[i] for w in self._axes])
        self._torque = (zero, zero, zero)
        if whole:
            turns = [cross(self._wanted(j), column(frame.rotation, j)) for j in range(3)]
            self._torque = tuple(sum((turn[i] for turn in turns), zero) for i in range(3))  # type: ignore[assignment]
        self._whole, self._complete = whole, [j for j in turned if sum(column == j for _, column in places) == 3]

    def _wanted(self, j: int) -> Vector[Value]:
        return (self._pose[0][j], self._pose[1][j], self._pose[2][j])

    def product(self, a: int, b: int) -> Value:
        """An entry of G^T G.

        Args:
            a: A joint.
            b: Another, or the same.
        """
        total = sum((row[a] * row[b] for row in self._slopes), self._torque[0] - self._torque[0])
        return total + 2 * dot(self._axes[a], self._axes[b]) if self._whole else total

    def slope(self, joint: int) -> Value:
        """An entry of G^T e.

        Args:
            joint: The joint.
        """
        products = (row[joint] * off for row, off in zip(self._slopes, self._off, strict=True))
        return sum(products, dot(self._axes[joint], self._torque))

    @property
    def error(self) -> Value:
        """The square root of the sum of the squares of e, less what T itself is off a pose."""
        square = sum((off * off for off in self._off), self._torque[0] - self._torque[0])
        total = square.sqrt()
        for place, a in enumerate(self._complete):
            for b in self._complete[place:]:
                total = total - abs(dot(self._wanted(a), self._wanted(b)) - int(a == b))
        return total.maximum(0)


def solved(matrix: Sequence[Sequence[Value]], right: Sequence[Value]) -> list[Value]:
    """The solution of a system whose matrix is symmetric and positive definite, by M = L D L^T.

    Args:
        matrix: Its rows up to the diagonal.
        right: The right-hand side.
    """
    size = len(right)
    lower = [list(row) for row in matrix]
    pivots: list[Value] = []
    values = list(right)
    for j in range(size):
        pivots.append(lower[j][j])
        scaled = [lower[i][j] for i in range(j, size)]
        for i in range(j + 1, size):
            lower[i][j] = lower[i][j] / pivots[j]
            for k in range(j + 1, i + 1):
                lower[i][k] = lower[i][k] - lower[i][j] * scaled[k - j]
    for i in range(size):
        for j in range(i):
            values[i] = values[i] - lower[i][j] * values[j]
    values = [value / pivot for value, pivot in zip(values, pivots, strict=True)]
    for i in reversed(range(size)):
        for j in range(i + 1, size):
            values[i] = values[i] - lower[j][i] * values[j]
    return values
