"""Who chooses recursion or closed form: of the formulations that compute the same values the cheapest becomes the tape.

Numbers of the robot are put into a graph traced with its symbols, each formulation is improved for a short time, those
that come close to the best for a longer one, and the tape is cut from the cheapest. Every threshold of this is in
`derive.programs.optimise.search_policy`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import partial

from derive.algebra.constants import Constant, exact_number
from derive.programs.optimise.improve import Improvement
from derive.programs.optimise.search_policy import POLICY, Effort
from derive.programs.tape.build import Replacements, bake, copy, cut
from derive.programs.tape.cost import Cost, program_cost
from derive.programs.tape.graph import Graph, Ref
from derive.programs.tape.tape import PARAMETER, InputSource, Tape
from derive.programs.tape.value import Value
from derive.robot.names import free_symbols, number_of, robot_symbols
from derive.robot.robot import Robot


@dataclass(frozen=True, slots=True)
class Formulation:
    """One way to compute a function."""

    words: str  # what it is, for the generated file
    trace: Callable[[], Sequence[Value]]  # gives the outputs, row by row


class FormulationChoice:
    """Chooses among the formulations of the functions of one robot."""

    def __init__(self, robot: Robot, graph: Graph, effort: Effort = Effort.FULL) -> None:
        self._graph = graph
        self._effort = effort
        self.numbers = _numbers(robot)
        self._priced, self._known = Graph(), dict[int, Ref]()

    def price(self, outputs: Sequence[Ref]) -> Cost:
        """What some outputs cost with the robot's numbers, before they are improved."""
        return program_cost(self._priced, copy(self._graph, outputs, self._priced, self._known, self.numbers))

    def near(self, formulations: Iterable[Formulation], margin: float | None) -> tuple[Formulation, ...]:
        """The formulations that as traced cost at most ``margin`` times the cheapest; None for any cost."""
        # Without a margin all are made before the first is traced; the order of tracing numbers the nodes.
        untraced = tuple(formulations) if margin is None else formulations
        traced = [Formulation(f.words, partial(list, f.trace())) for f in untraced]
        if margin is None:
            return tuple(traced)
        costs = [program_cost(self._graph, [value.ref for value in f.trace()]).body for f in traced]
        return tuple(f for f, cost in zip(traced, costs, strict=True) if cost <= margin * min(costs))

    def cheapest(self, formulations: Sequence[Formulation], *, search: bool = True) -> tuple[Formulation, Tape]:
        """The cheapest formulation once all are improved, the first of equals.

        All are improved for a short time; a longer search is spent on those close to the best.
        """
        outputs = [[value.ref for value in formulation.trace()] for formulation in formulations]
        programs = [bake(self._graph, refs, self.numbers) for refs in outputs]
        if self._effort is Effort.QUICK:
            winner = min(range(len(programs)), key=lambda i: program_cost(*programs[i]).body)
            return formulations[winner], cut(*programs[winner])
        drafts = [Improvement(*program) for program in programs]
        for draft in drafts:
            draft.draft()
        costs = [draft.cost for draft in drafts]
        least = min(costs)
        is_large = least > POLICY.large_program
        close = [i for i in range(len(drafts)) if costs[i] <= POLICY.draft_margin * least]
        finalists = sorted(close, key=costs.__getitem__)[: 1 if is_large else POLICY.finalists]
        if search and not is_large:
            for i in finalists:
                drafts[i].search()
        winner = min(sorted(finalists), key=lambda i: drafts[i].cost)
        tape = cut(*drafts[winner].result())
        for draft in drafts:
            draft.close()
        return formulations[winner], tape


def _numbers(robot: Robot) -> Replacements:
    """For each symbol its number, or its place in the parameter vector."""
    free = {name: k for k, name in enumerate(free_symbols(robot))}
    numbers = number_of(robot)
    found: dict[int, InputSource | Constant] = {}
    for i, name in enumerate(robot_symbols(robot)):
        found[i] = InputSource(PARAMETER, free[name]) if name in free else exact_number(numbers[name], {})
        assert found[i] is not None, "the loader admits only numbers as parameters"
    return found
