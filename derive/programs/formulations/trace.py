"""One robot's graph, and what all functions that are traced on it start from."""

from collections.abc import Callable, Sequence
from fractions import Fraction
from functools import cached_property
from itertools import product

from derive.mechanics.chain import Chain, build_chain
from derive.mechanics.vectors import Frame
from derive.programs.formulations.cheapest_kinematics import Stations, cheapest_jacobian, cheapest_pose
from derive.programs.formulations.choice import FormulationChoice
from derive.programs.formulations.closed_form import ClosedForm
from derive.programs.formulations.frame_choice import (
    CHAIN_CHOICES,
    FrameChoices,
    FrameChoiceSearch,
    arrange,
    starting_choices,
)
from derive.programs.formulations.parallel_axes import ParallelRun, parallel_runs
from derive.programs.optimise.search_policy import POLICY, Effort
from derive.programs.tape.graph import Graph
from derive.programs.tape.scalars import QD, TapeDomain
from derive.programs.tape.value import Value
from derive.robot.evaluate import evaluate
from derive.robot.names import free_symbols, robot_symbols
from derive.robot.robot import Robot

_TOLERANCE = 1e-14
_TRIALS = (0.37, 0.83)  # values of the first free symbol; the others are spread above


def has_exact_rotations(robot: Robot, tolerance: float = _TOLERANCE) -> bool:
    """Whether base and tool are rotations to rounding, whatever the values of free symbols.

    A file may write them in decimals with six places; then identities of rotations hold to six places only.
    """
    numbers = dict(robot.parameters)
    fixed = {name: evaluate(numbers[name], {}) for name in robot_symbols(robot) if name in numbers}
    for first in _TRIALS:
        values = fixed | {name: first + 0.071 * k for k, name in enumerate(free_symbols(robot))}
        for matrix in (robot.base, robot.tool):
            try:
                rows = [[evaluate(cell, values) for cell in row[:3]] for row in matrix[:3]]
            except ArithmeticError:
                return False
            for i, j in product(range(3), repeat=2):
                if abs(sum(a * b for a, b in zip(rows[i], rows[j], strict=True)) - (i == j)) > tolerance:
                    return False
    return True


class Trace:
    """The graph of one robot and its chain of tape values, shared by all functions."""

    def __init__(self, robot: Robot, effort: Effort = Effort.FULL) -> None:
        self.robot = robot
        self.n = robot.n
        self.effort = effort
        self.graph = Graph()
        self.domain = TapeDomain(robot, self.graph)
        self.chain: Chain[Value] = build_chain(robot, self.domain)
        self.choice = FormulationChoice(robot, self.graph, effort)
        self._cheapest: dict[str, tuple[FrameChoices, ...]] = {}
        self._arranged: dict[tuple[FrameChoices, bool], Chain[Value]] = {}

    @cached_property
    def half(self) -> Value:
        """1/2."""
        return self.domain.number(Fraction(1, 2))

    @cached_property
    def runs(self) -> tuple[ParallelRun, ...]:
        """The joints in runs of parallel axes, with the sums of their angles."""
        return parallel_runs(self.chain, self.domain.cosine_sine_of_sum)

    @cached_property
    def stations(self) -> Stations | None:
        """Where vectors come from on their way to the world; None where base or tool is a rotation only nearly."""
        return Stations(self.chain, self.runs) if has_exact_rotations(self.robot) else None

    @cached_property
    def end_stations(self) -> Stations | None:
        """The same on their way to the end effector; None where base or tool is a rotation only nearly."""
        if self.stations is None:
            return None
        inverted, total = self.chain.inverted, self.domain.cosine_sine_of_sum
        runs = parallel_runs(inverted, lambda turns: total([(self.n - 1 - k, -direction) for k, direction in turns]))
        return Stations(inverted, runs)

    @cached_property
    def shortest_pose(self) -> Frame[Value] | None:
        """T by the shortest ways to the world frame, where there are stations; several functions start from it."""
        return None if self.stations is None else cheapest_pose(self.stations)

    @cached_property
    def shortest_jacobian(self) -> list[list[Value]] | None:
        """J by the shortest ways to the world frame, rows first."""
        return None if self.stations is None else cheapest_jacobian(self.stations)

    @cached_property
    def closed_forms(self) -> tuple[ClosedForm, ...]:
        """Closed forms in each choice of angles."""
        choices = (False, True) if any(len(run.placements) > 1 for run in self.runs) else (False,)
        return tuple(ClosedForm(self.robot, self.domain, sums=sums) for sums in choices)

    def arranged(self, choices: FrameChoices, *, axial: bool = False) -> Chain[Value]:
        """The chain in base parameters, with frames as they are chosen."""
        if (key := (choices, axial)) not in self._arranged:  # searches for several functions try the same choices
            self._arranged[key] = arrange(self.chain, choices, self.domain.cosine_sine_of_sum, self.half, axial=axial)
        return self._arranged[key]

    def cheapest_choices(
        self,
        name: str,
        values: Callable[[FrameChoices], Sequence[Value]],
        choices: Sequence[str] = CHAIN_CHOICES,
        starts: Sequence[FrameChoices] = (),
    ) -> tuple[FrameChoices, ...]:
        """The frame choices with which a recursion takes the fewest operations, as far as a short search finds them."""
        if self.effort is Effort.QUICK:
            return starting_choices(self.chain)[:1]
        if name not in self._cheapest:
            search = FrameChoiceSearch(
                self.chain, choices, lambda chosen: tuple([value.ref for value in values(chosen)]), self.choice.price
            )
            self._cheapest[name] = search.best(starts or starting_choices(self.chain), POLICY.frame_choice_finalists)
        return self._cheapest[name]

    def arguments(self, kind: str) -> list[Value]:
        """An argument."""
        return [self.domain.argument(kind, i) for i in range(self.n)]

    def zeros(self) -> list[Value]:
        """An argument that vanishes."""
        return [self.chain.zero] * self.n

    def with_friction(self, torques: Sequence[Value]) -> list[Value]:
        """Torques of the joints [N m, N] and b*qd + f*sign(qd), or (f + d*sign(qd))*sign(qd) by direction."""
        friction = [
            joint.viscous * rate + (joint.coulomb + joint.coulomb_even * rate.sign()) * rate.sign()
            for joint, rate in zip(self.chain.joints, self.arguments(QD), strict=True)
        ]
        return [torque + loss for torque, loss in zip(torques, friction, strict=True)]


def flat(rows: Sequence[Sequence[Value]]) -> list[Value]:
    """The entries of a matrix."""
    return [value for row in rows for value in row]
