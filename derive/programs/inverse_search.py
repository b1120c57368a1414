"""Inverse kinematics of arms without formulas: what generated code needs to find the joints by itself.

The code for this is the same for every arm: an elimination and an eigenvalue problem (`derive.inverse.general.search`),
or damped Newton from many starts (`derive.inverse.numeric.newton`). Of the arm it needs the frames between its joints,
which are a tape, exact until numbers are printed and with parameters as arguments, and which joints are eliminated.
"""

from __future__ import annotations

from dataclasses import replace

from derive.inverse.closed.graph import SolutionGraph
from derive.inverse.closed.nodes import NodeKind
from derive.inverse.general.closure import Closure
from derive.inverse.general.elimination import Elimination as ModelElimination
from derive.inverse.general.rigid_motion import BESIDE
from derive.inverse.general.search import GeneralSolution
from derive.inverse.numeric.chain import POSE, POSITION
from derive.mechanics.chain import build_chain
from derive.mechanics.vectors import Frame
from derive.programs.formulations.choice import Formulation
from derive.programs.formulations.trace import Trace
from derive.programs.program import GIVEN, NEAR, POSE_ENTRIES, Elimination, Function, Interface, InverseSearch, Way
from derive.programs.program import POSE as POSE_ARGUMENT
from derive.programs.tape.scalars import Q, TapeDomain
from derive.programs.tape.value import Value
from derive.robot.options.inverse import FREEDOMS

FRAME_ENTRIES = 12  # of the first three rows of a frame
# Configurations that an arm of six joints can have; so many rows has the result where their number is not known.
MOST_SOLUTIONS = 16
# By which singular poses are brought beside, row by row; lengths in the unit.
MOTIONS = tuple(tuple(entry for row in motion for entry in row) for motion in BESIDE)
INTERFACE = Interface(
    "inverse_kinematics",
    (),
    ("branches", "n"),
    "q",
    "Joint variables of a pose of the end effector, every solution.",
    "a row for each solution [rad, m], sorted by the first joint, then the second and so on; NaN in unused rows",
)


class _AtZero(TapeDomain):
    """The scalars of a robot whose joint variables are zero."""

    def argument(self, kind: str, index: int) -> Value:
        """One entry of an argument; zero if it is a joint variable."""
        return self.number(0) if kind == Q else super().argument(kind, index)


def frames(trace: Trace) -> list[Value]:
    """The constant frames of T = C_1 M_1 C_2 M_2 ... C_n M_n C_(n+1), M_i the motion of joint i about or along z."""
    domain = _AtZero(trace.robot, trace.graph)
    chain = build_chain(replace(trace.robot, links=(), gravity=None), domain)
    between = [joint.fixed @ joint.motion(chain.zero, chain.one) for joint in chain.joints]
    ordered: list[Frame[Value]] = [chain.base @ between[0], *between[1:], chain.tool]
    return [entry for frame in ordered for row in frame.rows(chain.zero, chain.one)[:3] for entry in row]


def search_function(trace: Trace, graph: SolutionGraph) -> tuple[InverseSearch | None, str]:
    """What generated code needs to find all solutions without formulas; None and why where it cannot."""
    free = graph.robot.n - len(graph.given)
    wanted = sum(FREEDOMS.get(row, 1) for row in graph.task)
    if free > wanted:
        return None, f"{graph.why_not}; the task fixes {wanted} of {free} joints, so the others are to be `given`"
    payload = next((node.formulas[0].payload for node in graph.nodes if node.kind is NodeKind.GENERAL), None)
    solution: GeneralSolution | None = payload.solution if payload else None
    places = tuple(sorted(graph.places))
    entries = next((known for known in (POSE, POSITION) if tuple(sorted(known)) == places), places)
    words = "the frames between the joints"
    formulation, tape = trace.choice.cheapest([Formulation(words, lambda: frames(trace))])
    given = {GIVEN: len(graph.given)} if graph.given else {}
    widths = {POSE_ARGUMENT: POSE_ENTRIES, **given, NEAR: trace.n}
    function = Function(INTERFACE, ((trace.n + 1) * FRAME_ENTRIES,), tape, formulation.words, widths=widths)
    return InverseSearch(
        function=function,
        branches=solution.branches if solution else MOST_SOLUTIONS,
        joints=trace.n,
        given=graph.given,
        entries=entries,
        eliminations=tuple(map(_plain, solution.eliminations)) if solution else (),
        count=solution.count if solution else 0,
        summary=_summary(graph, solution),
        reason=f"its joints follow from {_eigenvalues(solution)}" if solution else graph.why_not,
        motions=MOTIONS,
    ), ""


def _plain(elimination: ModelElimination) -> Elimination:
    """An elimination as numbers alone, which targets may see."""
    ways = (
        replace(_way(each.closure), equations=each.equations, constant=each.constant, linear=each.linear)
        for each in elimination.reductions
    )
    return Elimination(
        ways=tuple(ways),
        hidden=elimination.hidden,
        multiplied=elimination.multiplied,
        rows=elimination.rows,
        finish=_way(elimination.finish),
        start=elimination.start,
        straight=elimination.straight,
    )


def _way(closure: Closure) -> Way:
    return Way(closure.joints, closure.dropped, closure.direction, closure.eliminated)


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
