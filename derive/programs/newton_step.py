"""One step of Newton's method towards a pose, for solutions of inverse kinematics that are in doubt.

With e what the wanted entries of the pose are off and G their derivatives, lengths relative to the reach of the arm,

    q' = q - (G^T G + damping)^-1 G^T e

(Levenberg, A method for the solution of certain non-linear problems in least squares, 1944), but G^T G is not formed,
which squares the singular values: the step is that of least squares with rows of the damping below those of G.
Where R is wanted whole, the axes of the joints are enough: turned by w, the columns r_j of R, which should be t_j,
move by w x r_j; two such motions have the product 2 w.v, and that with r_j - t_j is w.(sum of t_j x r_j), as if w were
three rows of weight 2.
"""

from collections.abc import Callable, Sequence
from fractions import Fraction

from derive.inverse.closed.graph import SolutionGraph
from derive.mechanics.forward_kinematics import forward_kinematics, jacobian
from derive.mechanics.vectors import Vector, column, cross, dot
from derive.programs.formulations.trace import Trace
from derive.programs.program import DAMPING, POSE, POSE_ENTRIES, Function, Interface
from derive.programs.tape.build import bake, cut
from derive.programs.tape.value import Q, Value, least_squares

Row = tuple[Sequence[Value], Value, Value | int]  # of G, with what is off and a weight
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
    rows, error = _fit(trace, graph, unit)
    columns = [[slopes[k] for slopes, _, _ in rows] for k in joints]
    steps = least_squares(columns, [weight for _, _, weight in rows], [off for _, off, _ in rows])
    results = trace.arguments(Q)
    for joint, step in zip(joints, steps, strict=True):
        results[joint] = results[joint] - (step if trace.chain.joints[joint].revolute else unit * step)
    tape = cut(*bake(trace.graph, [value.ref for value in (*results, error(), unit)], trace.choice.numbers))
    return Function(INTERFACE, (trace.n + 2,), tape, "damped Newton", widths={POSE: POSE_ENTRIES, DAMPING: 1})


def _fit(trace: Trace, graph: SolutionGraph, unit: Value) -> tuple[list[Row], Callable[[], Value]]:
    """Rows of G and the damping, whose normal equations are those of all wanted entries; and what these are off."""
    places = graph.places
    zero, one = trace.chain.zero, trace.chain.one
    pose = [[trace.domain.argument(POSE, 4 * i + j) for j in range(4)] for i in range(3)]
    wanted: list[Vector[Value]] = [(pose[0][j], pose[1][j], pose[2][j]) for j in range(3)]
    frame = trace.shortest_pose or forward_kinematics(trace.chain)
    slopes = trace.shortest_jacobian or jacobian(trace.chain)
    axes: list[Vector[Value]] = [(slopes[3][k], slopes[4][k], slopes[5][k]) for k in range(trace.n)]
    whole = sum(j < 3 for _, j in places) == 9
    rows, turned = list[Row](), set[int]()
    for i, j in places:
        if j == 3:
            off = (frame.position[i] - pose[i][3]) / unit
            scales = [1 / unit if joint.revolute else one for joint in trace.chain.joints]
            rows.append(([slopes[i][k] * scales[k] for k in range(trace.n)], off, 1))
        else:
            turned.add(j)
            off = frame.rotation[i][j] - pose[i][j]
            r = column(frame.rotation, j)
            rows.append(([zero if whole else cross(w, r)[i] for w in axes], off, 1))
    # Where R is wanted whole: the torque that turns its columns to those that are wanted.
    turns = [cross(wanted[j], column(frame.rotation, j)) for j in range(3)] if whole else []
    torque = [sum((turn[i] for turn in turns), zero) for i in range(3)]
    damping = trace.domain.argument(DAMPING, 0)
    taken = rows
    if whole:
        taken = [row for row, (_, j) in zip(rows, places, strict=True) if j == 3]
        taken += [([axis[i] for axis in axes], torque[i] * Fraction(1, 2), 2) for i in range(3)]

    def _error() -> Value:
        """The square root of the sum of the squares of e, less what T itself is off a pose."""
        total = sum((off * off for _, off, _ in rows), torque[0] - torque[0]).sqrt()
        complete = [j for j in turned if sum(column == j for _, column in places) == 3]
        for place, a in enumerate(complete):
            for b in complete[place:]:
                total = total - abs(dot(wanted[a], wanted[b]) - int(a == b))
        return total.maximum(0)

    free = [i for i in range(trace.n) if i not in graph.given]
    return [*taken, *(([one if k == i else zero for k in range(trace.n)], zero, damping) for i in free)], _error
