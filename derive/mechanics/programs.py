"""The functions generated for a robot, traced through the recursions.

Every function has a list of candidates that compute the same; the one with the fewest operations is kept, the first of
equals. A further formulation is one more `Candidate` in the function's list.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

from derive.algebra.program import Function, Program
from derive.algebra.tape_domain import QD, QDD, TAU, Q, TapeDomain
from derive.algebra.tape_finish import Finisher
from derive.algebra.tape_graph import Graph
from derive.algebra.tape_value import Value
from derive.errors import QuantityError
from derive.mechanics import forward_kinematics as kinematics
from derive.mechanics.chain import Chain, build_chain
from derive.mechanics.composite_inertia import inertia_matrix
from derive.mechanics.coriolis import coriolis_matrix
from derive.mechanics.forward_dynamics import forward_dynamics
from derive.mechanics.gravity import gravity_vector
from derive.mechanics.jacobian import jacobian
from derive.mechanics.newton_euler import inverse_dynamics
from derive.mechanics.regrouping import regroup
from derive.robot.names import free_symbols
from derive.robot.robot import Robot


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
    """A function before its tape is chosen."""

    name: str
    arguments: tuple[str, ...]
    shape: tuple[int, ...]
    candidates: tuple[Candidate, ...]


def build_program(robot: Robot) -> Program:
    """All functions of ``robot``: kinematics, and dynamics where the file has links.

    Raises:
        QuantityError: A cell divides by zero or has no real root once the parameters have their numbers.
    """
    trace = Trace(robot)
    finisher = Finisher(robot, trace.graph)
    functions = [_function(specification, finisher) for specification in trace.kinematics()]
    if robot.has_dynamics:
        functions += [_function(specification, finisher) for specification in trace.dynamics()]
        functions.append(_accelerations(trace, finisher))
    return Program(tuple(functions), free_symbols(robot))


def _function(specification: Specification, finisher: Finisher) -> Function:
    tapes = [
        (finisher.tape([value.ref for value in candidate.values()]), candidate.formulation)
        for candidate in specification.candidates
    ]
    tape, formulation = min(tapes, key=lambda pair: pair[0].operations.total)
    return Function(specification.name, specification.arguments, specification.shape, tape, formulation)


def _accelerations(trace: Trace, finisher: Finisher) -> Function:
    """Forward dynamics; infinite or not a number where no motion of a joint meets inertia.

    Cells without a value have been refused by the functions before.
    """
    try:
        return _function(trace.accelerations(), finisher)
    except QuantityError:
        return _function(trace.no_accelerations(), finisher)


class Trace:
    """The recursions of one robot, run on one graph."""

    def __init__(self, robot: Robot) -> None:
        self.graph = Graph()
        self.domain = TapeDomain(robot, self.graph)
        self.n = robot.n
        self.chain: Chain[Value] = build_chain(robot, self.domain)

    @cached_property
    def regrouped(self) -> Chain[Value]:
        """The chain in base parameters."""
        return regroup(self.chain)

    def kinematics(self) -> tuple[Specification, ...]:
        """Functions of the table alone."""
        poses, n = "transforms of joint frames from the base outwards", self.n
        return (
            Specification("forward_kinematics", (Q,), (4, 4), (Candidate(poses, self._pose),)),
            Specification("link_transforms", (Q,), (n, 4, 4), (Candidate(poses, self._links),)),
            Specification("jacobian", (Q,), (6, n), (Candidate("geometric, from axes and origins", self._jacobian),)),
        )

    def dynamics(self) -> tuple[Specification, ...]:
        """Functions of the links' inertia."""
        n = self.n
        base = "in base parameters"
        return (
            Specification("inertia_matrix", (Q,), (n, n), (Candidate(f"composite bodies {base}", self._inertia),)),
            Specification(
                "coriolis_matrix", (Q, QD), (n, n), (Candidate(f"moving composite bodies {base}", self._coriolis),)
            ),
            Specification("gravity_vector", (Q,), (n,), (Candidate(f"composite first moments {base}", self._gravity),)),
            Specification("inverse_dynamics", (Q, QD, QDD), (n,), (Candidate(f"Newton-Euler {base}", self._torques),)),
        )

    def accelerations(self) -> Specification:
        """Forward dynamics."""
        words = "inertia matrix and Newton-Euler, factorised without roots"
        return Specification("forward_dynamics", (Q, QD, TAU), (self.n,), (Candidate(words, self._solution),))

    def no_accelerations(self) -> Specification:
        """Forward dynamics of an arm whose inertia matrix is singular everywhere."""
        words = "the inertia matrix is singular everywhere"
        return Specification("forward_dynamics", (Q, QD, TAU), (self.n,), (Candidate(words, self._divided_by_zero),))

    def _arguments(self, kind: str) -> list[Value]:
        return [self.domain.argument(kind, i) for i in range(self.n)]

    def _pose(self) -> list[Value]:
        return self._flat(kinematics.rows(kinematics.forward_kinematics(self.chain), self.chain.zero, self.chain.one))

    def _links(self) -> list[Value]:
        frames = kinematics.link_transforms(self.chain)
        return [v for frame in frames for v in self._flat(kinematics.rows(frame, self.chain.zero, self.chain.one))]

    def _jacobian(self) -> list[Value]:
        return self._flat(jacobian(self.chain))

    def _inertia(self) -> list[Value]:
        return self._flat(inertia_matrix(self.regrouped))

    def _coriolis(self) -> list[Value]:
        half = self.domain.number(Fraction(1, 2))
        return self._flat(coriolis_matrix(self.regrouped, self._arguments(QD), half))

    def _gravity(self) -> list[Value]:
        return gravity_vector(self.regrouped)

    def _torques(self) -> list[Value]:
        return self._with_friction(inverse_dynamics(self.regrouped, self._arguments(QD), self._arguments(QDD)))

    def _solution(self) -> list[Value]:
        rest = [self.chain.zero] * self.n
        bias = self._with_friction(inverse_dynamics(self.regrouped, self._arguments(QD), rest))
        return forward_dynamics(inertia_matrix(self.regrouped), bias, self._arguments(TAU))

    def _divided_by_zero(self) -> list[Value]:
        return [torque / self.chain.zero for torque in self._arguments(TAU)]

    def _with_friction(self, torques: Sequence[Value]) -> list[Value]:
        """Torques and b*qd + f*sign(qd)."""
        friction = [
            joint.viscous * rate + joint.coulomb * rate.sign()
            for joint, rate in zip(self.chain.joints, self._arguments(QD), strict=True)
        ]
        return [torque + loss for torque, loss in zip(torques, friction, strict=True)]

    def _flat(self, rows: Sequence[Sequence[Value]]) -> list[Value]:
        return [value for row in rows for value in row]
