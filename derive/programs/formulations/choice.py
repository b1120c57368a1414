"""Who chooses recursion or closed form: of the formulations that compute the same values the cheapest becomes the tape.

Numbers of the robot are put into a graph traced with its symbols, each formulation is improved for a short time, those
that come close to the best for a longer one, and the tape is cut from the cheapest. Every threshold of this is in
`derive.programs.optimise.search_policy`.

Within a formulation, `choose` takes the cheapest combination of ways to compute values that share work: each group of
outputs has options, and what two choices have in common is computed once, so a combination costs what the union of the
nodes costs that its options need.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial, reduce
from operator import or_

from derive.algebra.constants import Constant, exact_number
from derive.programs.optimise.improve import Improvement
from derive.programs.optimise.search_policy import POLICY, Effort
from derive.programs.tape.build import Cost, Replacements, bake, copy, cut, program_cost, reachable
from derive.programs.tape.graph import Graph, Ref, node_of
from derive.programs.tape.tape import OPERATION_COST, PARAMETER, InputSource, Layer, Tape
from derive.programs.tape.value import Value
from derive.robot.names import free_symbols, robot_symbols
from derive.robot.robot import Robot

# The ways to compute one group of outputs; each gives the same outputs in the same order.
Options = Sequence[Sequence[Ref]]


@dataclass(frozen=True, slots=True)
class Formulation:
    """One way to compute a function."""

    words: str  # what it is, for the generated file
    trace: Callable[[], Sequence[Value]]  # gives the outputs, row by row
    is_of_variables: bool = False  # whether it is computed for the variables of coupled joints, not for the joints


class FormulationChoice:
    """Chooses among the formulations of the functions of one robot."""

    def __init__(self, robot: Robot, graph: Graph, effort: Effort = Effort.FULL) -> None:
        self._graph = graph
        self._effort = effort
        # For each symbol its number, or its place in the parameter vector.
        numbers: dict[int, InputSource | Constant] = {}
        free, known = {name: k for k, name in enumerate(free_symbols(robot))}, dict(robot.parameters)
        for i, name in enumerate(robot_symbols(robot)):
            numbers[i] = InputSource(PARAMETER, free[name]) if name in free else exact_number(known[name], {})
            assert numbers[i] is not None, "the loader admits only numbers as parameters"
        self.numbers: Replacements = numbers
        self._priced, self._known = Graph(), dict[int, Ref]()

    def price(self, outputs: Sequence[Ref]) -> Cost:
        """What some outputs cost with the robot's numbers, before they are improved."""
        return program_cost(self._priced, copy(self._graph, outputs, self._priced, self._known, self.numbers))

    def near(self, formulations: Iterable[Formulation], margin: float | None) -> tuple[Formulation, ...]:
        """The formulations that as traced cost at most ``margin`` times the cheapest; None for any cost."""
        # Without a margin all are made before the first is traced; the order of tracing numbers the nodes.
        untraced = tuple(formulations) if margin is None else formulations
        traced = [replace(f, trace=partial(list, f.trace())) for f in untraced]
        if margin is None:
            return tuple(traced)
        costs = [program_cost(self._graph, [value.ref for value in f.trace()]).body for f in traced]
        return tuple(f for f, cost in zip(traced, costs, strict=True) if cost <= margin * min(costs))

    def cheapest(self, formulations: Sequence[Formulation], *, search: bool = True) -> tuple[Formulation, Tape]:
        """The cheapest formulation once all are improved, the first of equals."""
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


def choose(graph: Graph, groups: Sequence[Options]) -> tuple[int, ...]:
    """For every group the option to take; it may not be the best, but no combination with one change is better."""
    # A local search: from several starts, one group after another changes to what is cheapest beside the others.
    needs = _Needs(graph, groups)
    _, best = min((needs.settled(start) for start in needs.starts()), key=lambda found: found[0])
    return tuple(places[k] for places, k in zip(needs.places, best, strict=True))


class _Needs:
    """The body's operations that each option needs, as bits of an integer."""

    def __init__(self, graph: Graph, groups: Sequence[Options]) -> None:
        bits: dict[int, int] = {}
        self._of_cost: dict[int, int] = {}  # the operations of each cost
        free = 1
        for i in reachable(graph, (ref for options in groups for option in options for ref in option)):
            mask = _union(bits[k] for k in graph.operands[i])
            cost = OPERATION_COST[graph.op[i]]
            if graph.layer[i] is Layer.BODY and cost:
                mask |= free
                self._of_cost[cost] = self._of_cost.get(cost, 0) | free
                free <<= 1
            bits[i] = mask
        self.places: list[list[int]] = []
        self.groups: list[list[int]] = []
        for options in groups:
            masks = [_union(bits[node_of(ref)] for ref in option) for option in options]
            kept: list[int] = []
            for place, mask in enumerate(masks):
                if any(masks[k] & ~mask == 0 for k in kept):
                    continue
                kept = [k for k in kept if mask & ~masks[k]] + [place]
            self.places.append(kept)
            self.groups.append([masks[place] for place in kept])

    def _cost(self, needed: int) -> int:
        return sum([cost * (needed & mask).bit_count() for cost, mask in self._of_cost.items()])

    def _cheapest(self, group: int, beside: int) -> int:
        """The option of a group that adds least to what is needed anyway, the first of equals."""
        costs = [self._cost(beside | option) for option in self.groups[group]]
        return costs.index(min(costs))

    def starts(self) -> Iterator[list[int]]:
        """The same place in every group; what is cheapest beside the groups before, and beside those after."""
        for place in range(max(map(len, self.groups), default=0)):
            yield [min(place, len(options) - 1) for options in self.groups]
        count = len(self.groups)
        for order in (range(count), range(count - 1, -1, -1)):
            found, needed = [0] * count, 0
            for group in order:
                found[group] = self._cheapest(group, needed)
                needed |= self.groups[group][found[group]]
            yield found

    def settled(self, found: list[int]) -> tuple[int, list[int]]:
        """A combination that no change of one group improves, with its cost before it."""
        chosen = [options[k] for options, k in zip(self.groups, found, strict=True)]
        spent = self._cost(_union(chosen))
        changed = True
        while changed:
            changed = False
            for group in (g for g, options in enumerate(self.groups) if len(options) > 1):
                beside = _union(chosen[:group] + chosen[group + 1 :])
                place = self._cheapest(group, beside)
                now = self._cost(beside | self.groups[group][place])
                if now < spent:
                    found[group], chosen[group] = place, self.groups[group][place]
                    spent, changed = now, True
        return spent, found


def _union(masks: Iterable[int]) -> int:
    return reduce(or_, masks, 0)
