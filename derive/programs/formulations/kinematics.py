"""Formulations of poses, of Jacobians, and of what joints feel of a wrench."""

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from itertools import combinations

from derive.algebra.ring import determinant, minors
from derive.mechanics import forward_kinematics as recursion
from derive.mechanics.chain import Chain
from derive.mechanics.energy import Wrench
from derive.mechanics.forward_kinematics import TILTED, analytic_jacobian, jacobian_hessian, jacobian_rate
from derive.mechanics.joint_motion import to_child, to_parent
from derive.mechanics.vectors import Frame, Vector, add, column, cross, multiply, subtract, transpose
from derive.programs.formulations.cheapest_kinematics import cheapest_end_jacobian, cheapest_links
from derive.programs.formulations.choice import Formulation
from derive.programs.formulations.trace import Trace, flat, iterated_positions
from derive.programs.optimise.improve import improved_values
from derive.programs.optimise.search_policy import POLICY
from derive.programs.tape.derivative import derivative, gradient
from derive.programs.tape.value import QD, WRENCH, Q, Value
from derive.robot.options.inverse import POSE
from derive.robot.task_rows import PARTS, task_rows

Matrix = list[list[Value]]

WORLD, END = "world", "end"  # axes of a wrench

_FROM_THE_BASE = "transforms of joint frames from the base outwards"
_SHORTEST = "the shortest ways to the world frame, turned by sums of angles of parallel joints"


def poses(trace: Trace) -> Iterator[Formulation]:
    """Formulations of T."""
    yield Formulation(_FROM_THE_BASE, lambda: _entries(trace, [recursion.forward_kinematics(trace.chain)]))
    if (pose := trace.shortest_pose) is not None:
        yield Formulation(f"columns of the pose by {_SHORTEST}", lambda: _entries(trace, [pose]))


def link_poses(trace: Trace) -> Iterator[Formulation]:
    """Formulations of T_1 ... T_n."""
    yield Formulation(_FROM_THE_BASE, lambda: _entries(trace, recursion.link_transforms(trace.chain)))
    if (stations := trace.stations) is not None:
        words = "frames turned by sums of angles of parallel joints"
        yield Formulation(words, lambda: _entries(trace, cheapest_links(stations)))


def jacobians(trace: Trace) -> Iterator[Formulation]:
    """Formulations of J."""
    yield Formulation("geometric, from axes and origins", lambda: flat(recursion.jacobian(trace.chain)))
    if (matrix := trace.shortest_jacobian) is not None:
        yield Formulation(f"geometric, columns by {_SHORTEST}", lambda: flat(matrix))


def end_jacobians(trace: Trace) -> Iterator[Formulation]:
    """Formulations of J in the axes of the end effector."""
    chain = trace.chain
    if (stations := trace.end_stations) is None:  # rotations that are none have no inverse as easy as theirs

        def _turned() -> list[Value]:
            rows, back = recursion.jacobian(chain), transpose(recursion.forward_kinematics(chain).rotation)
            both = [((vx, vy, vz), (wx, wy, wz)) for vx, vy, vz, wx, wy, wz in zip(*rows, strict=True)]
            columns = [[*multiply(back, velocity), *multiply(back, spin)] for velocity, spin in both]
            return flat(list(zip(*columns, strict=True)))

        yield Formulation("geometric Jacobian in the world frame, turned", _turned)
        return
    yield Formulation("geometric, from axes and origins", lambda: flat(recursion.jacobian_end(chain)))
    words = "the shortest ways to the end effector, turned by sums of angles of parallel joints"
    yield Formulation(f"geometric, columns by {words}", lambda: flat(cheapest_end_jacobian(stations)))


def jacobian_rates(trace: Trace) -> Iterator[Formulation]:
    """Formulations of dJ/dt."""
    if trace.passive.numbers:

        def _of_variables() -> list[Value]:
            return trace.in_time(trace.by_variables(flat(recursion.jacobian(trace.chain)), (6, trace.n), 1))

        yield Formulation("the variables' Jacobian, differentiated in time", _of_variables, is_of_variables=True)
        return
    rates = dict(zip(trace.variables(Q), trace.variables(QD), strict=True))
    yield Formulation("velocities of axes and origins", lambda: flat(jacobian_rate(trace.chain, trace.arguments(QD))))
    for words, matrix, _ in _pairs(trace):
        entries = partial(lambda matrix: derivative(improved_values(flat(matrix())), rates), matrix)
        yield Formulation(f"{words}, differentiated in time", entries)


def hessians(trace: Trace) -> Iterator[Formulation]:
    """Formulations of dJ/dq."""
    for words, matrix, _ in _pairs(trace):
        entries = partial(lambda matrix: flat(jacobian_hessian(matrix(), trace.chain.zero)), matrix)
        yield Formulation(f"products of columns of the {words}", entries)


def passive_positions(trace: Trace) -> Iterator[Formulation]:
    """Formulations of the variables of passive joints."""
    if trace.passive.is_given:
        found = partial(iterated_positions, trace.robot, trace.graph)
        yield Formulation("damped Newton from the last configuration", found)
        return
    places = [k for k, joint in enumerate(trace.robot.joints) if joint.follows]
    yield Formulation("closed form, one branch", lambda: [trace.domain.argument(Q, k) for k in places])


def manipulabilities(part: str, trace: Trace) -> Iterator[Formulation]:
    """Formulations of w, whose value is the same about any point of the last link and in any axes."""
    rows, n = task_rows(trace.robot, part, are_parallel=_are_parallel(trace)), trace.n
    if part == "all" and trace.robot.inverse.task != POSE:
        yield Formulation("volume of rows in the world", lambda: _volume(recursion.jacobian(trace.chain), rows))
        return
    at_end = set(rows) <= set(PARTS["position"])
    for k in range(1, n + 1) if n <= POLICY.most_stations else (n // 2,):
        seen = trace.jacobian_from(k, at_end=at_end)
        yield Formulation(f"volume of rows in joint frame {k}", partial(_volume, seen, rows))


def _are_parallel(trace: Trace) -> bool | None:
    """Whether all axes of an arm of a tree are; None where the table tells."""
    run, *others = trace.runs
    return not others and all(place.direction for place in run.placements) if trace.robot.is_tree else None


def manipulability_gradients(trace: Trace) -> Iterator[Formulation]:
    """Formulations of dw/dq."""
    least = min(manipulabilities("all", trace), key=lambda f: trace.choice.price([f.trace()[0].ref]).body)
    words = f"{least.words}, differentiated backwards"
    yield Formulation(words, lambda: gradient(least.trace()[0], trace.arguments(Q)))


def wrench_torques(frame: str, trace: Trace) -> Iterator[Formulation]:
    """Formulations of J^T h, with h in the axes of the world or of the end effector."""
    yield from _in_own_and_best_axes(frame, trace, recursion.wrench_torques)


def with_wrench_torques(
    frame: str, trace: Trace, values: Sequence[Value], sign: int, *, order: int = 0, beside: Sequence[Value] = ()
) -> list[list[Value]]:
    """Joints' values with J^T h (or its derivatives) times a sign, in the axes where all costs least beside others."""
    torques = partial(_slopes, frame) if order else recursion.wrench_torques
    ways = (
        [value + sign * felt for value, felt in zip(values, torques(jacobian, force, moment), strict=True)]
        for _, jacobian, force, moment in _seen(frame, trace)
    )
    return sorted(ways, key=lambda found: trace.choice.price([v.ref for v in (*found, *beside)]).body)[:2]


def wrench_at_tip(frame: str, trace: Trace, arranged: Chain[Value]) -> Wrench[Value]:
    """What the last link carries of -h: force and moment in its joint frame, not held, about its origin there."""
    f, m = _wrench(trace)
    if frame == WORLD:
        back = transpose(arranged.base.rotation)
        f, m = multiply(back, f), multiply(back, m)
        for joint in arranged.joints:
            f, m = to_child(joint, f), to_child(joint, m)
    else:
        f, m = multiply(arranged.tool.rotation, f), multiply(arranged.tool.rotation, m)
    # The origin may have gone back along the axis (`Place.BEFORE`).
    ahead = trace.chain.joints[-1].offset - arranged.joints[-1].offset
    lever = add(arranged.tool.position, (arranged.zero, arranged.zero, ahead))
    return subtract(arranged.null, f), subtract(arranged.null, add(m, cross(lever, f)))


def _wrench(trace: Trace) -> Wrench[Value]:
    fx, fy, fz, *moments = (trace.domain.argument(WRENCH, i) for i in range(6))
    return (fx, fy, fz), (moments[0], moments[1], moments[2])


def wrench_torque_derivatives(frame: str, trace: Trace) -> Iterator[Formulation]:
    """Formulations of d J^T h / dq."""
    yield from _in_own_and_best_axes(frame, trace, partial(_slopes, frame))


def _slopes(frame: str, jacobian: Matrix, force: Vector[Value], moment: Vector[Value]) -> list[Value]:
    zero = 0 * jacobian[0][0]
    return flat(recursion.wrench_torque_derivatives(jacobian, force, moment, zero, turning=frame == END))


def _in_own_and_best_axes(
    frame: str, trace: Trace, values: Callable[[Matrix, Vector[Value], Vector[Value]], list[Value]]
) -> Iterator[Formulation]:
    """What follows from J and a wrench, in the wrench's own axes and in those of the cheapest joint frame."""
    own, *others = [
        Formulation(f"Jacobian and wrench in the axes of {axes}", partial(list, values(jacobian, force, moment)))
        for axes, jacobian, force, moment in _seen(frame, trace)
    ]
    yield own
    yield from sorted(others, key=lambda f: trace.choice.price([value.ref for value in f.trace()]).body)[:1]


def _seen(frame: str, trace: Trace) -> Iterator[tuple[str, Matrix, Vector[Value], Vector[Value]]]:
    """J, force and moment in the wrench's own axes, if these are exact, and in those of joint frames."""
    chain, n = trace.chain, trace.n
    wrench = _wrench(trace)
    if frame == WORLD:
        yield "the world", trace.shortest_jacobian or recursion.jacobian(chain), *wrench
    elif trace.end_stations is not None:
        yield "the end effector", cheapest_end_jacobian(trace.end_stations), *wrench
    start = transpose(chain.base.rotation) if frame == WORLD else chain.tool.rotation
    force, moment = (multiply(start, v) for v in wrench)
    for k in range(1, n + 1) if frame == WORLD else range(n, 0, -1):
        if frame == WORLD:
            force, moment = to_child(chain.joints[k - 1], force), to_child(chain.joints[k - 1], moment)
        if n <= POLICY.most_stations or k == n // 2:
            yield f"joint frame {k}", trace.jacobian_from(k, at_end=True), force, moment
        if frame == END:
            force, moment = to_parent(chain.joints[k - 1], force), to_parent(chain.joints[k - 1], moment)


def _volume(jacobian: Matrix, rows: Sequence[int]) -> list[Value]:
    """The root of det(J J^T) of some rows of J, of det(J^T J) of more rows than columns.

    It is the sum of the squares of the largest minors (Cauchy, Binet), which are few up to one joint too many.
    """
    matrix, zero = [jacobian[row] for row in rows], 0 * jacobian[0][0]
    if len(rows) > len(jacobian[0]):
        matrix = [list(column) for column in zip(*matrix, strict=True)]
    # minors begin with the last rows, which are to be sparse
    matrix = sorted(matrix, key=lambda row: sum(map(bool, row)))[::-1]
    size, length = len(matrix), len(matrix[0]) if matrix else 2
    if length > size + 1:
        products = [[sum((x * y for x, y in zip(a, b, strict=True)), zero) for b in matrix] for a in matrix]
        return [abs(determinant(products)).sqrt() if products else zero]
    found = minors(matrix, combinations(range(length), size))
    return [abs(found[0]) if size == length else sum((minor * minor for minor in found), zero).sqrt()]


def analytic_jacobians(kind: str, trace: Trace) -> Iterator[Formulation]:
    """Formulations of J_A."""
    for words, matrix, pose in _pairs(trace):
        yield Formulation(f"{words}, and the angles' rates", partial(_in_angles, kind, matrix, pose))


def _in_angles(kind: str, matrix: Callable[[], Matrix], pose: Callable[[], Frame[Value]]) -> list[Value]:
    return flat(analytic_jacobian(kind, column(pose().rotation, TILTED[kind]), matrix()))


def _pairs(trace: Trace) -> Iterator[tuple[str, Callable[[], Matrix], Callable[[], Frame[Value]]]]:
    """Geometric Jacobian and pose, in the ways in which they may be cheapest."""
    chain = trace.chain
    yield "geometric Jacobian", lambda: recursion.jacobian(chain), lambda: recursion.forward_kinematics(chain)
    matrix, pose = trace.shortest_jacobian, trace.shortest_pose
    if matrix is not None and pose is not None:
        yield "geometric Jacobian by the shortest ways to the world frame", lambda: matrix, lambda: pose


def _entries(trace: Trace, frames: Sequence[Frame[Value]]) -> list[Value]:
    chain = trace.chain
    return [v for frame in frames for v in flat(frame.rows(chain.zero, chain.one))]
