"""Inverse kinematics as a straight-line program: a graph of solutions run over the values of a tape.

All branches stand in one program: a node is computed once for each combination of the branches that it depends on,
cosines and sines are carried as values, and every angle is taken once, at the end. What exists, what is degenerate and
what coincides are values too, 1 or 0, by which the program chooses among the formulas of a node; nothing branches.

For arms without formulas generated code finds the joints by itself, by code that is the same for every arm: an
elimination and an eigenvalue problem (`derive.inverse.general.search`), or damped Newton from many starts
(`derive.inverse.numeric.newton`). Of the arm it needs the frames between its joints, which are a tape, exact until
numbers are printed and with parameters as arguments, and which joints are eliminated.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import reduce

from derive.inverse.closed.branches import starts
from derive.inverse.closed.graph import GraphWalk, Leaf, SolutionGraph, pose_of
from derive.inverse.closed.nodes import NodeKind
from derive.inverse.closed.solve import Freedom, refusal, solve
from derive.inverse.general.rigid_motion import BESIDE
from derive.inverse.general.search import GeneralSolution
from derive.inverse.numeric.chain import POSE as WHOLE
from derive.inverse.numeric.chain import POSITION
from derive.inverse.numeric.newton import Status
from derive.inverse.words.postures import postures
from derive.mechanics.chain import build_chain
from derive.mechanics.forward_kinematics import forward_kinematics, jacobian
from derive.mechanics.vectors import Frame, Vector, column, cross, dot
from derive.programs import program
from derive.programs.formulations.choice import Formulation
from derive.programs.formulations.trace import Trace, has_exact_rotations
from derive.programs.program import DAMPING, GIVEN, NEAR, POSE, POSE_ENTRIES, Function, Interface, Inverse
from derive.programs.tape.build import bake, cut
from derive.programs.tape.field import Mask, TapeField
from derive.programs.tape.value import Q, TapeDomain, Value, least_squares
from derive.robot.options.inverse import FREEDOMS
from derive.robot.options.solution_policy import POLICY
from derive.robot.tree import is_arm

DOUBTFUL, FREE = 4, 8
"""Codes of branches that are to be checked: a status and `DOUBTFUL`, which alone is a branch that does not exist by its
nodes, or `FREE`, one that does not exist with the joints that are free where the caller has them."""

WORSE = 1000  # by this factor the error of a branch may be larger than that of the best one
# A branch whose pose is farther off than this part of the arm's reach is none: the pose is not reached.
CLOSED = Fraction(str(POLICY.closed))
# Base and tool that are rotations to so much make poses that are accepted as such, though no formula is exact.
NEARLY_EXACT = 1e-7
INTERFACE = Interface(
    "inverse_kinematics",
    (POSE, GIVEN, NEAR),
    ("branches", "n"),
    "q",
    "Joint variables of a pose of the end effector, every branch.",
    "a row for each branch [rad, m], NaN for missing branches",
)
SEARCH_INTERFACE = replace(
    INTERFACE,
    arguments=(),
    summary="Joint variables of a pose of the end effector, every solution.",
    result="a row for each solution [rad, m], sorted by the first joint, then the second and so on; NaN in unused rows",
)
FRAME_ENTRIES = 12  # of the first three rows of a frame
# Configurations that an arm of six joints can have; so many rows has the result where their number is not known.
MOST_SOLUTIONS = 16
# By which singular poses are brought beside, row by row; lengths in the unit.
MOTIONS = tuple(tuple(entry for row in motion for entry in row) for motion in BESIDE)
# A program, what finds the solutions without one, or None and the reason why there is neither.
Solved = tuple[Inverse | program.InverseSearch | None, str]


def solved(trace: Trace) -> Solved:
    """Inverse kinematics as the file asks for it: a program, what takes its place, or None and the reason."""
    robot = trace.robot
    if not is_arm(robot):
        return None, "the table is a tree"
    if not has_exact_rotations(robot):
        reason = "base or tool is a rotation only to the digits that the file gives"
        if not has_exact_rotations(robot, NEARLY_EXACT):
            return None, reason
        task, names = robot.inverse.task, robot.inverse.given
        if names is None:  # where the file does not say which joints are given, those that may be
            given = next(Freedom(robot, task).choices(), ())
        else:
            given = tuple(k for k, joint in enumerate(robot.joints) if joint.variable in names)
        return search_function(trace, refusal(robot, task, given, reason))
    graph = solve(robot)
    if not graph.is_closed or any(node.kind is NodeKind.GENERAL for node in graph.nodes):
        return search_function(trace, graph)
    return inverse_function(trace, graph), ""


def inverse_function(trace: Trace, graph: SolutionGraph) -> Inverse:
    """The program of all branches."""
    domain, n = trace.domain, trace.n
    field = TapeField(domain)
    pose = [[domain.argument(POSE, 4 * i + j) for j in range(4)] for i in range(3)]
    given = [domain.argument(GIVEN, i) for i in range(len(graph.given))]
    run = GraphWalk(graph, field, pose, given, [domain.argument(NEAR, i) for i in range(n)])
    angles, codes = list[Value](), list[Value]()
    leaves = list(run.leaves())
    existing = _existing(run, leaves)
    lost = ~reduce(Mask.__or__, [exists for exists, _ in existing])
    for leaf, (exists, ill) in zip(leaves, existing, strict=True):
        angles += run.angles(leaf)
        # The status, and whether the branch is to be checked: where none exists, every one that has lost digits.
        singular = reduce(Mask.__or__, leaf.free, field.truth(False)).value
        kind = singular.select(Status.SINGULAR, leaf.boundary.value.select(Status.BOUNDARY, Status.EXACT))
        none = singular.select(FREE, DOUBTFUL * (leaf.doubt | (ill & lost)).value)
        codes.append(exists.value.select(kind + DOUBTFUL * ill.value, none))
    angles += angles[: trace.n] * graph.spare
    codes += [field.number(Status.NONE)] * graph.spare
    words = "closed form, all branches at once"
    formulation, tape = trace.choice.cheapest([Formulation(words, lambda: [*angles, *codes])])
    interface = INTERFACE if graph.given else replace(INTERFACE, arguments=(POSE, NEAR))
    widths = {POSE: POSE_ENTRIES, **({GIVEN: len(graph.given)} if graph.given else {}), NEAR: n}
    function = Function(interface, (len(codes) * (n + 1),), tape, formulation.words, widths=widths)
    step = newton_step(trace, graph, run.reach)
    closed = POLICY.closed if graph.is_short else POLICY.reproduced
    names = postures(trace.robot, graph).names if graph.slots > 1 else ()
    branches = tuple(", ".join(part for part in name.split(", ") if not part.startswith("#")) for name in names)
    in_words = branches if all(branches) else ()
    return Inverse(function, step, len(codes), n, graph.given, count_text(graph), closed, around(graph), in_words)


def around(graph: SolutionGraph) -> program.Around:
    """Where solutions that are alone are looked for where others are free."""
    n = graph.robot.n
    rows = ([round(POLICY.nudge * (1.6 - (7 * k + 3) % 11 * 0.3), 6) for k in range(n)], *starts(n).tolist())
    free = [tuple(0.0 if k in graph.given else entry for k, entry in enumerate(row)) for row in rows]
    return program.Around(motions=MOTIONS, starts=tuple(free[1:]), nudge=free[0], is_short=graph.is_short)


def count_text(graph: SolutionGraph) -> str:
    """How many solutions a pose has."""
    most = graph.count or graph.leaves
    solutions = "one solution" if most == 1 else f"up to {most} solutions"
    if graph.complete and not graph.everywhere:
        return f"Almost every reachable pose has {solutions}; special ones may have more."
    proof = ", all of them listed" if graph.complete else " in closed form"
    return f"A reachable pose has {solutions}{proof}, except where joints are free."


def _existing(run: GraphWalk[Value, Mask], leaves: Sequence[Leaf[Value, Mask]]) -> list[tuple[Mask, Mask]]:
    """Which branches exist, and which are to be checked: those that reach the pose, where roots may be extraneous.

    Where one of them has the pose to more digits, so have the others: a wrong choice of signs is almost right next to
    poses at which two choices are one. Those that have lost digits on the way are checked instead, and all where none
    has the pose to all digits and there are more choices than solutions: perhaps none of them is one.
    """
    graph = run.graph
    # As many branches as solutions in space: none of them is extraneous.
    if graph.complete and graph.leaves == graph.count and graph.robot.n - len(graph.given) >= 6:
        return [(leaf.exists, leaf.ill) for leaf in leaves]
    most, small = CLOSED * run.reach, Fraction(str(POLICY.reproduced)) * run.reach
    errors = [_error(run, leaf) for leaf in leaves]
    found = [leaf.exists & Mask(error.less(most)) for leaf, error in zip(leaves, errors, strict=True)]
    best = reduce(Value.minimum, [mask.value.select(e, most) for mask, e in zip(found, errors, strict=True)])
    limit = (best * WORSE).maximum(small)
    rough = Mask(small.less(limit)) if graph.leaves != graph.count else run.field.truth(False)
    if len(leaves) == 1:
        return [(found[0], leaves[0].ill | rough)]
    right = [leaf.ill | Mask(error.less(limit)) for leaf, error in zip(leaves, errors, strict=True)]
    return [(mask & each, leaf.ill | rough) for mask, each, leaf in zip(found, right, leaves, strict=True)]


def _error(run: GraphWalk[Value, Mask], leaf: Leaf[Value, Mask]) -> Value:
    """The largest error of the pose of cosines and sines that are nearly those of angles, as a length."""
    pose, entries = pose_of(run, leaf.joints), run.graph.places
    turns = [abs(pose.rotation[i][j] - run.pose[i][j]) for i, j in entries if j < 3]
    turns += [abs(pair[0] * pair[0] + pair[1] * pair[1] - 1) for pair in leaf.joints if len(pair) == 2]
    moves = [abs(pose.position[i] - run.pose[i][j]) for i, j in entries if j == 3]
    return reduce(Value.maximum, [*([reduce(Value.maximum, turns) * run.reach] if turns else []), *moves])


class _AtZero(TapeDomain):
    """The scalars of a robot whose joint variables are zero."""

    def argument(self, kind: str, index: int) -> Value:
        """One entry of an argument; zero if it is a joint variable."""
        return self.number(0) if kind == Q else super().argument(kind, index)


def frames(trace: Trace) -> list[Value]:
    """The constant frames of T = C_1 M_1 C_2 M_2 ... C_n M_n C_(n+1), M_i the motion of joint i about or along z."""
    chain = build_chain(replace(trace.robot, links=(), gravity=None), _AtZero(trace.robot, trace.graph))
    between = [joint.fixed @ joint.motion(chain.zero, chain.one) for joint in chain.joints]
    ordered: list[Frame[Value]] = [chain.base @ between[0], *between[1:], chain.tool]
    return [entry for frame in ordered for row in frame.rows(chain.zero, chain.one)[:3] for entry in row]


def search_function(trace: Trace, graph: SolutionGraph) -> tuple[program.InverseSearch | None, str]:
    """What generated code needs to find all solutions without formulas; None and why where it cannot."""
    free = graph.robot.n - len(graph.given)
    wanted = sum(FREEDOMS.get(row, 1) for row in graph.task)
    if free > wanted:
        return None, f"{graph.why_not}; the task fixes {wanted} of {free} joints, so the others are to be `given`"
    payload = next((node.formulas[0].payload for node in graph.nodes if node.kind is NodeKind.GENERAL), None)
    solution: GeneralSolution | None = payload.solution if payload else None
    places = tuple(sorted(graph.places))
    formulation, tape = trace.choice.cheapest([Formulation("the frames between the joints", lambda: frames(trace))])
    widths = {POSE: POSE_ENTRIES, **({GIVEN: len(graph.given)} if graph.given else {}), NEAR: trace.n}
    return program.InverseSearch(
        function=Function(SEARCH_INTERFACE, ((trace.n + 1) * FRAME_ENTRIES,), tape, formulation.words, widths=widths),
        branches=solution.branches if solution else MOST_SOLUTIONS,
        joints=trace.n,
        given=graph.given,
        entries=next((known for known in (WHOLE, POSITION) if tuple(sorted(known)) == places), places),
        eliminations=solution.eliminations if solution else (),
        count=solution.count if solution else 0,
        summary=_summary(graph, solution),
        reason=f"its joints follow from {_eigenvalues(solution)}" if solution else graph.why_not,
        motions=MOTIONS,
    ), ""


def _summary(graph: SolutionGraph, solution: GeneralSolution | None) -> str:
    if solution is None:
        return (
            "Damped Newton from many starts: there are no formulas, and solutions may be missing. "
            f"At most {MOST_SOLUTIONS} are listed."
        )
    method = f"computed from {_eigenvalues(solution)}, each refined by Newton's method"
    more = " (more only where joints are free)," if graph.everywhere else ","
    pose = "A" if graph.everywhere or not graph.complete else "Almost every"
    return f"{pose} reachable pose has up to {solution.count or solution.branches} solutions{more} {method}."


def _eigenvalues(solution: GeneralSolution) -> str:
    size = solution.eliminations[0].eigenvalues
    return f"the eigenvalues of a {size}x{size} matrix"


Row = tuple[Sequence[Value], Value, Value | int]  # of G, with what is off and a weight
STEP_INTERFACE = Interface(
    "inverse_kinematics_step",
    (Q, POSE, DAMPING),
    ("n",),
    "q",
    "A configuration nearer to a pose, how far the first one is from it, and the unit of length.",
    "joint variables [rad, m], the error of the pose, lengths relative to the reach, and the reach [m]",
)


def newton_step(trace: Trace, graph: SolutionGraph, reach: Value) -> Function:
    """The program of one step towards a pose, for solutions that are in doubt.

    With e what the wanted entries of the pose are off and G their derivatives, lengths relative to the reach of the
    arm,

        q' = q - (G^T G + damping)^-1 G^T e

    (Levenberg, A method for the solution of certain non-linear problems in least squares, 1944), but G^T G is not
    formed, which squares the singular values: the step is that of least squares with rows of the damping below those of
    G. Where R is wanted whole, the axes of the joints are enough: turned by w, the columns r_j of R, which should be
    t_j, move by w x r_j; two such motions have the product 2 w.v, and that with r_j - t_j is w.(sum of t_j x r_j), as
    if w were three rows of weight 2.
    """
    joints = [k for k in range(trace.n) if k not in graph.given]
    unit = trace.domain.number(0).less(reach).select(reach, 1)
    rows, error = _fit(trace, graph, unit)
    columns = [[slopes[k] for slopes, _, _ in rows] for k in joints]
    steps = least_squares(columns, [weight for _, _, weight in rows], [off for _, off, _ in rows])
    results = trace.arguments(Q)
    for joint, step in zip(joints, steps, strict=True):
        results[joint] = results[joint] - (step if trace.chain.joints[joint].revolute else unit * step)
    tape = cut(*bake(trace.graph, [value.ref for value in (*results, error(), unit)], trace.choice.numbers))
    return Function(STEP_INTERFACE, (trace.n + 2,), tape, "damped Newton", widths={POSE: POSE_ENTRIES, DAMPING: 1})


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
