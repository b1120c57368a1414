"""One robot's graph, and what all functions that are traced on it start from."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from functools import cached_property

from derive.algebra.effort import Effort
from derive.algebra.tape_domain import QD, TapeDomain
from derive.algebra.tape_finish import Finisher
from derive.algebra.tape_graph import Graph, Ref
from derive.algebra.tape_value import Value
from derive.mechanics.arrangement import arrange
from derive.mechanics.chain import Chain, build_chain
from derive.mechanics.closed_form import ClosedForm
from derive.mechanics.exact_rotations import has_exact_rotations
from derive.mechanics.form_search import CHAIN_CHOICES, Forms, FormSearch, starting_forms
from derive.mechanics.parallel_axes import Run, parallel_runs
from derive.mechanics.regrouping import regroup
from derive.mechanics.stations import Stations
from derive.robot.robot import Robot

_CLOSE_FORMS = 2
"""Formulations that are improved before the cheapest is taken."""


class Trace:
    """The graph of one robot and its chain of tape values, shared by all functions.

    Args:
        robot: The robot.
        effort: How long the cheapest forms are looked for.
    """

    def __init__(self, robot: Robot, effort: Effort = Effort.FULL) -> None:
        self.robot = robot
        self.effort = effort
        self.graph = Graph()
        self.domain = TapeDomain(robot, self.graph)
        self.n = robot.n
        self.chain: Chain[Value] = build_chain(robot, self.domain)
        self._forms: dict[str, tuple[Forms, ...]] = {}

    @cached_property
    def runs(self) -> tuple[Run, ...]:
        """The joints in runs of parallel axes, with the sums of their angles."""
        return parallel_runs(self.chain, self.domain.cosine_sine_of_sum)

    @cached_property
    def stations(self) -> Stations | None:
        """Where vectors come from on their way to the world; None where base or tool is a rotation only nearly."""
        return Stations(self.chain, self.runs) if has_exact_rotations(self.robot) else None

    @cached_property
    def closed_forms(self) -> tuple[ClosedForm, ...]:
        """Closed forms in each choice of angles."""
        choices = (False, True) if any(len(run.placements) > 1 for run in self.runs) else (False,)
        return tuple(ClosedForm(self.robot, self.domain, sums=sums) for sums in choices)

    @cached_property
    def regrouped(self) -> Chain[Value]:
        """The chain in base parameters."""
        return regroup(self.chain)

    def arranged(self, forms: Forms, *, axial: bool = False) -> Chain[Value]:
        """The chain in base parameters, with frames as the forms ask; ``axial`` as in `arrange`."""
        return arrange(self.chain, forms, self.domain.cosine_sine_of_sum, self.half, axial=axial)

    def cheapest_forms(
        self,
        name: str,
        values: Callable[[Forms], Sequence[Value]],
        choices: Sequence[str] = CHAIN_CHOICES,
        starts: Sequence[Forms] = (),
    ) -> tuple[Forms, ...]:
        """The forms with which a function takes the fewest operations, as far as a short search finds them.

        Args:
            name: Of the function; what is found for it once is remembered.
            values: Its outputs with some forms.
            choices: The choices that are tried: those that make a difference to it.
            starts: Where the search starts, if not where any does.

        Returns:
            The cheapest before improvement, and others that come close.
        """
        if self.effort is Effort.QUICK:
            return starting_forms(self.chain)[:1]

        def trial(forms: Forms) -> tuple[Ref, ...]:
            return tuple(value.ref for value in values(forms))

        if name not in self._forms:
            search = FormSearch(self.chain, choices, trial, self._finisher.price)
            self._forms[name] = search.best(starts or starting_forms(self.chain), _CLOSE_FORMS)
        return self._forms[name]

    @cached_property
    def half(self) -> Value:
        """1/2."""
        return self.domain.number(Fraction(1, 2))

    @cached_property
    def _finisher(self) -> Finisher:
        return Finisher(self.robot, self.graph)

    def arguments(self, kind: str) -> list[Value]:
        """The n entries of an argument: ``q``, ``qd``, ``qdd`` or ``tau``."""
        return [self.domain.argument(kind, i) for i in range(self.n)]

    def zeros(self) -> list[Value]:
        """An argument that vanishes."""
        return [self.chain.zero] * self.n

    def with_friction(self, torques: Sequence[Value]) -> list[Value]:
        """Torques and b*qd + f*sign(qd)."""
        friction = [
            joint.viscous * rate + joint.coulomb * rate.sign()
            for joint, rate in zip(self.chain.joints, self.arguments(QD), strict=True)
        ]
        return [torque + loss for torque, loss in zip(torques, friction, strict=True)]


def flat(rows: Sequence[Sequence[Value]]) -> list[Value]:
    """The entries of a matrix, row by row."""
    return [value for row in rows for value in row]
