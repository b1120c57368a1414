"""A solution of the inverse kinematics as a graph of nodes.

Every node solves for one unknown (or a few) from equations whose coefficients are polynomials of what is known: the
pose, the geometry, and the cosines, sines and lengths of the nodes before it (run by `derive.inverse.closed.walk`).
"""

from dataclasses import dataclass
from functools import cached_property
from math import prod

from derive.algebra.ring import Polynomial
from derive.inverse.closed.nodes import NodeEquation, NodeFormula, NodeKind, Unknown
from derive.inverse.closed.unknowns import InverseDomain
from derive.robot.expression import Expression
from derive.robot.options.inverse import FREEDOMS, ROWS, Task
from derive.robot.robot import Robot

SPECIAL = 4  # isolated solutions at special poses of arms with few joints, where a generic pose has one or two


@dataclass(frozen=True)
class Node:
    """One step of a solution."""

    index: int  # its place in the graph
    unknowns: tuple[Unknown, ...]  # what it solves for; more than one for general nodes alone
    formulas: tuple[NodeFormula, ...]  # the chosen one, then others for poses where its leading coefficients vanish
    needs: tuple[int, ...] = ()  # indices of the nodes whose unknowns occur in its formulas
    branches: int = 1  # how many values it has at most for one combination of values of what it needs

    @property
    def unknown(self) -> Unknown:
        """Its only, or first, unknown."""
        return self.unknowns[0]

    @property
    def kind(self) -> NodeKind:
        """The elementary type of the chosen formula."""
        return self.formulas[0].kind


@dataclass(frozen=True, eq=False)
class SolutionGraph:
    """How the joints of one arm follow from the pose."""

    robot: Robot  # the arm
    domain: InverseDomain  # the ring of all polynomials: pose, parameters, cosines, sines and lengths of unknowns
    task: Task  # which numbers of the pose are wanted, rows of `ROWS`
    given: tuple[int, ...]  # indices of the joints that are arguments
    # Generators of the pose that are computed before any node, in order: name -> polynomial of the entries of T and
    # of those before it. An entry of T itself is named ``T[row,column]``.
    definitions: tuple[tuple[str, Polynomial], ...]
    square_reach: Polynomial  # the sum of the squares of all lengths of table and pose: the scale of what is zero
    nodes: tuple[Node, ...]  # in an order in which each needs only nodes before it
    shifts: tuple[Expression, ...]  # the constant angle or length by which each joint's unknown exceeds its variable
    conditions: tuple[NodeEquation, ...] = ()  # what holds at every reachable pose of fewer than six joints
    count: int = 0  # number of complex solutions of a generic reachable pose; 0 where it is not known
    complete: bool = False  # whether that number is certain
    everywhere: bool = False  # whether no pose has more isolated ones, for certain (`solve.Freedom.fills`)
    why_not: str = ""  # why there is no closed form; empty where there is one
    to_end: bool = False  # whether the last matrix ends at the end effector, whose orientation is not told
    from_base: bool = False  # whether the first one begins in the world, for some rows of a turned base

    @property
    def is_closed(self) -> bool:
        """Whether there is a graph at all."""
        return not self.why_not

    @cached_property
    def axes(self) -> tuple[tuple[int, ...], ...]:
        """For each node the nodes with several branches before it that its values depend on, in order."""
        found: list[tuple[int, ...]] = []
        for node in self.nodes:
            choices = {need for need in node.needs if self.nodes[need].branches > 1}
            found.append(tuple(sorted(choices.union(*(found[need] for need in node.needs)))))
        return tuple(found)

    @property
    def choices(self) -> tuple[int, ...]:
        """The nodes with several branches."""
        return tuple(node.index for node in self.nodes if node.branches > 1)

    @property
    def leaves(self) -> int:
        """The product of the numbers of branches at poses where the chosen formulas serve."""
        return prod(node.formulas[0].branches for node in self.nodes)

    @property
    def slots(self) -> int:
        """The product of the numbers of branches, those included that only formulas for special poses have."""
        return prod(node.branches for node in self.nodes)

    @property
    def spare(self) -> int:
        """For how many solutions of special poses there is room beside the branches."""
        return 0 if self.everywhere or not self.is_short else max(0, SPECIAL - self.slots)

    @property
    def is_short(self) -> bool:
        """Whether there are fewer joints than the task has dimensions."""
        return self.robot.n - len(self.given) < sum(FREEDOMS.get(row, 1) for row in self.task)

    @property
    def places(self) -> tuple[tuple[int, int], ...]:
        """The entries of T that the task gives, row and column from 0."""
        return tuple((i - 1, j - 1) for row in self.task for i, j in ROWS[row])
