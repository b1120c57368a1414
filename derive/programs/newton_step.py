"""One step of Newton's method towards a pose, for solutions of inverse kinematics that are in doubt.

With e what the wanted entries of the pose are off and G their derivatives, lengths relative to the reach of the arm,

    q' = q - (G^T G + damping)^-1 G^T e

(Levenberg, A method for the solution of certain non-linear problems in least squares, 1944), but G^T G is not formed,
which squares the singular values: the step is that of least squares with rows of the damping below those of G.
Where R is wanted whole, the axes of the joints are enough: turned by w, the columns r_j of R, which should be t_j,
move by w x r_j; two such motions have the product 2 w.v, and that with r_j - t_j is w.(sum of t_j x r_j), as if w were
three rows of weight 2.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from functools import reduce

from derive.inverse.closed.graph import SolutionGraph
from derive.mechanics.forward_kinematics import forward_kinematics, jacobian
from derive.mechanics.vectors import Vector, column, cross, dot
from derive.programs.formulations.trace import Trace
from derive.programs.program import DAMPING, POSE, POSE_ENTRIES, Function, Interface
from derive.programs.tape.build import bake, cut
from derive.programs.tape.scalars import Q
from derive.programs.tape.value import Value

INTERFACE = Interface(
    "inverse_kinematics_step",
    (Q, POSE, DAMPING),
    ("n",),
    "q",
    "A configuration nearer to a pose, how far the first one is from it, and the unit of length.",
    "joint variables [rad, m], the error of the pose, lengths relative to the reach, and the reach [m]",
)


def newton_step(trace: Trace, graph: SolutionGraph, reach: Value) -> Function:
    """The program of one step."""
    joints = [k for k in range(trace.n) if k not in graph.given]
    unit = trace.domain.number(0).less(reach).select(reach, 1)
    fit = _Fit(trace, graph.places, unit)
    damping = trace.domain.argument(DAMPING, 0)
    rows = fit.rows
    zero, one = trace.chain.zero, trace.chain.one
    columns = [[slopes[k] for slopes, _, _ in rows] + [one if k == i else zero for i in joints] for k in joints]
    weights: list[Value | int] = [weight for _, _, weight in rows]
    weights += [damping] * len(joints)
    steps = least_squares(columns, weights, [off for _, off, _ in rows] + [zero] * len(joints))
    results = trace.arguments(Q)
    for joint, step in zip(joints, steps, strict=True):
        results[joint] = results[joint] - (step if trace.chain.joints[joint].revolute else unit * step)
    tape = cut(*bake(trace.graph, [value.ref for value in (*results, fit.error, unit)], trace.choice.numbers))
    return Function(INTERFACE, (trace.n + 2,), tape, "damped Newton", widths={POSE: POSE_ENTRIES, DAMPING: 1})


class _Fit:
    """What the wanted entries of the pose are off, and how they change with the joints."""

    def __init__(self, trace: Trace, places: Sequence[tuple[int, int]], unit: Value) -> None:
        self._places = places
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

    @property
    def rows(self) -> Sequence[tuple[Sequence[Value], Value, int]]:
        """Rows of G with what is off and a weight, such that the normal equations are those of all wanted entries."""
        found = [(slopes, off, 1) for slopes, off in zip(self._slopes, self._off, strict=True)]
        if not self._whole:
            return found
        turned = [([axis[i] for axis in self._axes], self._torque[i] * Fraction(1, 2), 2) for i in range(3)]
        return [row for row, (_, j) in zip(found, self._places, strict=True) if j == 3] + turned

    @property
    def error(self) -> Value:
        """The square root of the sum of the squares of e, less what T itself is off a pose."""
        square = sum((off * off for off in self._off), self._torque[0] - self._torque[0])
        total = square.sqrt()
        for place, a in enumerate(self._complete):
            for b in self._complete[place:]:
                total = total - abs(dot(self._wanted(a), self._wanted(b)) - int(a == b))
        return total.maximum(0)


def least_squares(
    columns: Sequence[Sequence[Value]], weights: Sequence[Value | int], right: Sequence[Value]
) -> list[Value]:
    """The x for which the weighted sum of the squares of A x - b is least, by the modified method of Gram and Schmidt.

    It loses the digits of the condition of A, not of its square (Bjorck, Numerical Methods for Least Squares Problems,
    section 2.4), and without square roots.
    """
    rest = [list(column) for column in (*columns, right)]
    factors: list[list[Value]] = []
    for j in range(len(columns)):
        weighted = [weight * value for weight, value in zip(weights, rest[j], strict=True)]
        square = dot_product(weighted, rest[j])
        factors.append([dot_product(weighted, other) / square for other in rest[j + 1 :]])
        for other, factor in zip(rest[j + 1 :], factors[j], strict=True):
            other[:] = [value - factor * own for value, own in zip(other, rest[j], strict=True)]
    found: list[Value] = []
    for row in reversed(factors):
        found.insert(0, row[-1] - dot_product(row[:-1], found) if found else row[-1])
    return found


def dot_product(a: Sequence[Value], b: Sequence[Value]) -> Value:
    """The sum of the products of two rows of values."""
    return reduce(Value.__add__, map(Value.__mul__, a, b))
