"""The order of the unknowns: the shortest way from nothing known to everything known.

What is known is a set of angles and slides. The angles of a group of parallel joints that are known split its links
into sets that stand still against each other; a step joins two of these sets (it finds the angle between them), or
finds a slide. A step needs an equation in which nothing else is unknown. The best way has the fewest branches in all,
then the simplest steps; of equal ones the one that goes from the base to the tip, then the one of shorter equations.
"""

import heapq
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations

import numpy as np

from derive.algebra.residues import Array
from derive.inverse.closed.evidence import Change, Evidence
from derive.inverse.closed.nodes import BRANCHES, NodeKind
from derive.inverse.closed.unknowns import State

CONSIDERED = 16  # equations of a step that are looked at, the shortest ones
UNLIKE = 6  # what it costs a pair of equations that they stand in different matrices or are of different kinds
RANK = {NodeKind.QUADRATIC: 3, NodeKind.CONIC: 30}  # how unwelcome a type is at equal numbers of branches
POWERS = {1: 0, 2: 1, 4: 2}  # logarithms of branch numbers, which add up


@dataclass(frozen=True)
class Choice:
    """A formula in the rough: the equations by their numbers."""

    kind: NodeKind  # the elementary type
    equations: tuple[int, ...]  # numbers of one or two equations
    cost: tuple[int, int]  # what the search adds up besides branches: kind, then length


@dataclass(frozen=True)
class SearchStep:
    """One unknown, and what determines it."""

    group: int  # the group, -1 for a slide
    parts: tuple[int, int]  # the two parts whose angle is found; for a slide the joint twice
    choices: tuple[Choice, ...]  # ways to do it, the best one first
    equations: tuple[int, ...]  # all equations in which nothing else is unknown, short ones first

    @property
    def best(self) -> Choice:
        """The best way."""
        return self.choices[0]


class Search:
    """Finds the order in which an arm is solved."""

    def __init__(self, evidence: Evidence, given: Sequence[int] = ()) -> None:
        self.evidence = evidence
        robot, groups = evidence.robot, evidence.domain.groups
        self._slides = frozenset(i for i, joint in enumerate(robot.joints) if not joint.is_revolute)
        # Every link of a group by itself; a given joint joins the links before and behind it.
        start = State(tuple(tuple(1 << k for k in range(len(g) + 1)) for g in groups), self._slides & set(given))
        for joint in (joint for joint in given if joint not in self._slides):
            g, *ends = evidence.domain.ends(evidence.domain.unknown(joint))
            start = start.joined(g, *(next(part for part in start.groups[g] if part >> k & 1) for k in ends))
        self.start = start

    def way(self, start: State | None = None) -> list[SearchStep] | None:
        """The steps of the best way from what is known (by default the given joints); None where there is none."""
        # Dijkstra's shortest path over states: costs are (quartics, logarithm of branches, kinds), then base to tip.
        heap: list[tuple[tuple[int, ...], tuple[tuple[int, ...], ...], int, int, State, list[SearchStep]]] = []
        serial = 0
        heapq.heappush(heap, ((0, 0, 0), (), 0, serial, start or self.start, []))
        done: set[State] = set()
        while heap:
            cost, order, length, _, state, steps = heapq.heappop(heap)
            if state in done:
                continue
            done.add(state)
            if state.slides == self._slides and all(len(parts) == 1 for parts in state.groups):
                return steps
            for step, after in self.steps(state):
                if after not in done:
                    best, serial = step.best, serial + 1
                    # Numbers of branches multiply along a way, so their logarithms are added.
                    own = (int(best.kind is NodeKind.CONIC), POWERS[BRANCHES[best.kind]], best.cost[0])
                    total = tuple(a + b for a, b in zip(cost, own, strict=True))
                    way = (*order, self._place(step))
                    heapq.heappush(heap, (total, way, length + best.cost[1], serial, after, [*steps, step]))
        return None

    def advance(self) -> tuple[list[SearchStep], State]:
        """Steps as far as one-joint steps lead, and what is known then."""
        state, steps = self.start, list[SearchStep]()
        while found := min(self.steps(state), key=lambda pair: (pair[0].best.cost, self._place(pair[0])), default=None):
            steps.append(found[0])
            state = found[1]
        return steps, state

    def pairs(self, state: State) -> Iterator[tuple[tuple[int, tuple[int, int]], list[int]]]:
        """Each unknown with the equations in which it and one other unknown occur, short ones first."""
        yield from (((g, parts), self._shortest_first(found)) for g, parts, found in self._targets(state, 2))

    def steps(self, state: State) -> Iterator[tuple[SearchStep, State]]:
        """What can be found next."""
        prime = self.evidence.prime
        for group, parts, found in self._targets(state, 1):
            effect, order = self.evidence.effects[self.change(group, parts[1])], self._shortest_first(found)
            if group < 0:
                degrees, slopes = effect.degrees, effect.coefficients[:, :, 1]
                constant = [k for k in order if degrees[k] == 1 and self._constant(slopes[k])][:CONSIDERED]
                choices = [Choice(NodeKind.TYPE_1, (k,), (0, int(self.lengths[k]))) for k in constant]
                for k in order[:CONSIDERED]:
                    if degrees[k] == 1 and k not in constant:
                        choices.append(Choice(NodeKind.TYPE_1, (k,), (1, int(self.lengths[k]))))
                    elif degrees[k] == 2:
                        cost = RANK[NodeKind.QUADRATIC], int(self.lengths[k])
                        choices.append(Choice(NodeKind.QUADRATIC, (k,), cost))
            else:
                linear = [k for k in order if effect.degrees[k] == 1]
                choices = self._pairs(effect.coefficients, linear)
                # By themselves: best A c + B s = 0, an atan2 alone; then those that never degenerate, because A^2 + B^2
                # is the same at all poses.
                for k in linear[:CONSIDERED]:
                    right, a, b = effect.coefficients[k, :, :3].T
                    never = self._constant((a**2 % prime + b**2 % prime) % prime)
                    rank = 2 if not np.any(right) else 3 if never else 5
                    choices.append(Choice(NodeKind.TYPE_2, (k,), (rank, int(self.lengths[k]))))
                if not choices:
                    conics, rank = [k for k in order if effect.degrees[k] == 2][:4], RANK[NodeKind.CONIC]
                    choices = [Choice(NodeKind.CONIC, (k,), (rank, int(self.lengths[k]))) for k in conics]
            if choices:
                choices.sort(key=lambda choice: (BRANCHES[choice.kind], *choice.cost))
                yield SearchStep(group, parts, tuple(choices), tuple(order)), state.joined(group, *parts)

    def _targets(self, state: State, unknowns: int) -> Iterator[tuple[int, tuple[int, int], Array]]:
        """Angles between parts of groups, then slides, with the equations that leave just so many unknowns."""
        unknown = np.zeros(len(self.evidence.equations), dtype=np.int64)
        turning: list[tuple[int, int, Array]] = []
        for g, parts in enumerate(state.groups):
            if len(parts) > 1:
                own = [self.depends(g, part) for part in parts]
                # An equation that changes with k parts of a group holds k - 1 angles between them.
                unknown += np.maximum(sum(vector.astype(np.int64) for vector in own) - 1, 0)
                turning += [(g, part, vector) for part, vector in zip(parts, own, strict=True)]
        slides = [(joint, self.depends(-1, joint)) for joint in sorted(self._slides - state.slides)]
        for _, vector in slides:
            unknown += vector
        usable = (unknown == unknowns) & self.evidence.allowed
        for (g, a, one), (h, b, other) in combinations(turning, 2):
            if g == h:
                yield g, (a, b), np.flatnonzero(usable & one & other)
        yield from ((-1, (joint, joint), np.flatnonzero(usable & vector)) for joint, vector in slides)

    def _shortest_first(self, equations: Array) -> list[int]:
        return [int(k) for k in equations[np.argsort(self.lengths[equations], kind="stable")]]

    def _place(self, step: SearchStep) -> tuple[int, ...]:
        """Where a step stands from base to tip: its first joint, then how many it spans."""
        if step.group < 0:
            return (step.parts[0], 0)
        group = self.evidence.domain.groups[step.group]
        a, b = ((part & -part).bit_length() - 1 for part in step.parts)
        return (group[min(a, b)], max(a, b) - min(a, b))

    def depends(self, group: int, part: int) -> Array:
        """Which equations change when some links of a group turn, or with a slide where there is no group."""
        return self.evidence.effects[self.change(group, part)].depends

    def change(self, group: int, part: int) -> Change:
        """The change in which some links of a group turn, or the others against them."""
        if group < 0:
            return Change(-1, part)
        # Only differences of angles matter: turning a set of links is turning all others back.
        everything = (2 << len(self.evidence.domain.groups[group])) - 1
        return Change(group, everything ^ part if part & 1 else part)

    @cached_property
    def lengths(self) -> Array:
        """For each equation how much it is made of: what it depends on, its entry, and how many joints M has."""
        evidence, groups = self.evidence, self.evidence.domain.groups
        touched = np.zeros(len(evidence.equations), dtype=np.int64)
        for g, group in enumerate(groups):
            touched += np.maximum(sum(self.depends(g, 1 << k).astype(np.int64) for k in range(len(group) + 1)) - 1, 0)
        for joint in self._slides:
            touched += self.depends(-1, joint)
        kinds = {"R": 0, "p": 1, "u": 3, "m": 8, "k": 12}
        own = [cut.last - cut.first + kinds[entry[0]] + 3 * ("." in entry) for cut, entry in evidence.equations]
        return 8 * touched + np.array(own, dtype=np.int64)

    def others(self, step: SearchStep, first: Choice, special: Evidence) -> Iterator[Choice]:
        """Choices for poses at which the first one fails, the most helpful first; one equation may do there."""
        change, p = self.change(step.group, step.parts[1]), self.evidence.prime
        table = special.effects[change].coefficients
        linear = np.array([k for k in step.equations if self.evidence.effects[change].degrees[k] == 1], dtype=np.int64)
        # Greedy covering: of the poses that are left the choice that helps at most of them, the shortest of equals.
        open_ = np.flatnonzero(self._fails(table, first))
        single = first.kind is NodeKind.TYPE_2
        while open_.size and linear.size:
            own = table[linear][:, open_]
            if step.group < 0:
                helps, kind = own[:, :, 1] != 0, NodeKind.TYPE_1
            elif single:
                helps, kind = np.any(own[:, :, 1:3] != 0, axis=2), NodeKind.TYPE_2
            else:
                # Pairs with a determinant A E - B D that is not zero.
                products = own[:, None, :, 1] * own[None, :, :, 2] % p
                helps, kind = products != products.transpose(1, 0, 2), NodeKind.TYPE_3
            count = helps.sum(axis=-1)
            if not count.max():
                if single or step.group < 0:
                    return
                single = True
                continue
            lengths = self.lengths[linear]
            if kind is NodeKind.TYPE_3:
                lengths = lengths[:, None] + lengths[None]
            best = np.unravel_index(np.lexsort((lengths.ravel(), -count.ravel()))[0], count.shape)
            yield Choice(kind, tuple(int(linear[k]) for k in sorted(best)), (1, int(lengths[best])))
            open_ = open_[~helps[best]]

    def _fails(self, table: Array, choice: Choice) -> Array:
        """At which poses a choice does not determine its unknown."""
        own = [table[k] for k in choice.equations]
        if choice.kind is NodeKind.TYPE_3:
            (a, b), p = own, self.evidence.prime
            return np.asarray(a[:, 1] * b[:, 2] % p == a[:, 2] * b[:, 1] % p)
        leading = {NodeKind.TYPE_1: [1], NodeKind.QUADRATIC: [2], NodeKind.TYPE_2: [1, 2]}
        return np.asarray(np.all(own[0][:, leading.get(choice.kind, [1, 2, 3, 4])] == 0, axis=1))

    def _pairs(self, coefficients: Array, linear: Sequence[int]) -> list[Choice]:
        """Pairs of equations A c + B s = C that determine cosine and sine."""
        # First those that do so at every pose, then A c + B s, -B c + A s, whose determinant is a sum of squares: it is
        # zero where the angle is free, and nowhere else.
        if len(linear) < 2:
            return []
        p, numbers = self.evidence.prime, np.array(linear)
        known: dict[object, int] = {}  # numbers of the cuts and kinds of entry
        own = (self.evidence.equations[k] for k in linear)
        cuts = np.array([known.setdefault((cut, entry[0], "." in entry), len(known)) for cut, entry in own])
        rows, columns = np.triu_indices(len(linear), 1)
        length = self.lengths[numbers[rows]] + self.lengths[numbers[columns]] + UNLIKE * (cuts[rows] != cuts[columns])
        # A E - B D of every pair, for each pose; two products of residues fit into 64 bits together.
        a, b = coefficients[numbers, :, 1], coefficients[numbers, :, 2]
        determinants = (a[rows] * b[columns] - b[rows] * a[columns]) % p
        nonzero = np.all(determinants != 0, axis=1)
        constant = nonzero & np.all(determinants == determinants[:, :1], axis=1)
        # A D + B E = 0 with A^2 + B^2 = D^2 + E^2: the second is the first turned by a right angle.
        turned, squares = nonzero & ~constant, (a * a + b * b) % p
        turned &= np.all(squares[rows] == squares[columns], axis=1)
        i, j = rows[turned], columns[turned]
        turned[turned] = np.all((a[i] * a[j] + b[i] * b[j]) % p == 0, axis=1)
        choices = []
        for rank, mask in ((0, constant), (1, turned), (4, nonzero & ~constant & ~turned)):
            found = np.flatnonzero(mask)
            for k in found[np.argsort(length[found], kind="stable")[:CONSIDERED]]:
                pair = linear[rows[k]], linear[columns[k]]
                choices.append(Choice(NodeKind.TYPE_3, pair, (rank, int(length[k]))))
        return choices

    @staticmethod
    def _constant(values: Array) -> bool:
        """Whether a coefficient is the same number, not zero, at all poses."""
        return bool(values[0] and np.all(values == values[0]))
