"""One robot's graph, and what all functions that are traced on it start from.

Whether the constant transforms of a robot are rotations exactly.

A file may write them in decimals with six places; then identities of rotations hold to six places only.

A generated function before its tape is chosen: its interface, and the formulations that compute it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

from derive.mechanics.chain import Chain, build_chain
from derive.mechanics.regrouping import regroup
from derive.programs.cheapest_kinematics import Stations
from derive.programs.closed_form import ClosedForm
from derive.programs.effort import Effort
from derive.programs.frame_choice import CHAIN_CHOICES, Forms, FormSearch, arrange, starting_forms
from derive.programs.parallel_axes import Run, parallel_runs
from derive.programs.program import Column
from derive.programs.tape.finish import Finisher, price
from derive.programs.tape.graph import Graph, Ref
from derive.programs.tape.scalars import QD, TapeDomain
from derive.programs.tape.value import Value
from derive.robot.description import Matrix
from derive.robot.evaluate import evaluate
from derive.robot.names import free_symbols, number_of, robot_symbols
from derive.robot.robot import Robot

_TOLERANCE = 1e-14
_TRIALS = (0.37, 0.83)
"""Values of the first free symbol; the others are spread above."""


def has_exact_rotations(robot: Robot) -> bool:
    """Whether base and tool are rotations to rounding, whatever the values of free symbols."""
    numbers = number_of(robot)
    fixed = {name: evaluate(numbers[name], {}) for name in robot_symbols(robot) if name in numbers}
    for first in _TRIALS:
        values = fixed | {name: first + 0.071 * k for k, name in enumerate(free_symbols(robot))}
        if not (_is_rotation(robot.base, values) and _is_rotation(robot.tool, values)):
            return False
    return True


def _is_rotation(matrix: Matrix, values: Mapping[str, float]) -> bool:
    try:
        rows = [[evaluate(cell, values) for cell in row[:3]] for row in matrix[:3]]
    except ArithmeticError:
        return False
    products = ((i, j, sum(a * b for a, b in zip(rows[i], rows[j], strict=True))) for i in range(3) for j in range(3))
    return all(abs(product - (i == j)) <= _TOLERANCE for i, j, product in products)


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


@dataclass(frozen=True, slots=True)
class Candidate:
    """One way to compute a function.

    Attributes:
        formulation: In words, for the generated file.
        values: The outputs, row by row.
    """

    formulation: str
    values: Callable[[], Sequence[Value]]


@dataclass(frozen=True, slots=True)
class Specification:
    """A function before its tape is chosen.

    Attributes:
        name: For instance ``inverse_dynamics``.
        arguments: Kinds of its arguments, in order; may be empty.
        shape: Of the result for one configuration.
        candidates: Formulations of the same values; the one of least `Operations.cost` is emitted, the first of equals.
        columns: What the entries along the last axis of the result belong to, where that has names.
        search: Whether a long search for shared parts pays.
    """

    name: str
    arguments: tuple[str, ...]
    shape: tuple[int, ...]
    candidates: tuple[Candidate, ...]
    columns: tuple[Column, ...] = ()
    search: bool = True


def near(graph: Graph, candidates: Iterable[Candidate], factor: float) -> tuple[Candidate, ...]:
    """Those worth improving: as traced they cost no more than ``factor`` times the cheapest."""
    known = [Candidate(candidate.formulation, _held(candidate.values())) for candidate in candidates]
    prices = [price(graph, [v.ref for v in candidate.values()])[0] for candidate in known]
    return tuple(c for c, found in zip(known, prices, strict=True) if found <= factor * min(prices))


def _held(values: Sequence[Value]) -> Callable[[], Sequence[Value]]:
    return lambda: values
