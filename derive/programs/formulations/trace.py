"""One robot's graph, and what all functions that are traced on it start from.

Among it closed forms of the dynamics: exact polynomials, expanded and then factored. For small arms, or where most
inertial parameters vanish, they cost less than a recursion once common parts are found. For others they grow out of
bounds, so only short ones are offered.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import cache, cached_property, partial, reduce
from itertools import product
from math import prod
from typing import TYPE_CHECKING

from derive.algebra.domain import PolynomialDomain
from derive.algebra.generators import Generator, Kind
from derive.algebra.ring import Polynomial, TooManyTerms
from derive.errors import ExpressionError
from derive.inverse.closed.graph import GraphWalk
from derive.inverse.closed.unknowns import turned
from derive.mechanics.chain import Chain, build_chain
from derive.mechanics.energy import gravity_vector, inertia_matrix, kinetic_energy, potential_energy
from derive.mechanics.forward_kinematics import jacobian_from
from derive.mechanics.newton_euler import inverse_dynamics
from derive.mechanics.torque_derivatives import coriolis_matrix
from derive.mechanics.vectors import Frame
from derive.programs.formulations.cheapest_kinematics import Stations, cheapest_jacobian, cheapest_pose
from derive.programs.formulations.choice import Formulation, FormulationChoice
from derive.programs.formulations.frame_choice import (
    CHAIN_CHOICES,
    FrameChoices,
    FrameChoiceSearch,
    ParallelRun,
    arrange,
    parallel_runs,
    starting_choices,
)
from derive.programs.optimise.search_policy import POLICY, Effort
from derive.programs.tape.derivative import derivative
from derive.programs.tape.field import ClosingField, ClosingWalk
from derive.programs.tape.graph import Graph
from derive.programs.tape.value import PASSIVE, QD, QDD, Passive, Q, TapeDomain, Value, least_squares
from derive.robot import tree
from derive.robot.description import coupling
from derive.robot.evaluate import evaluate
from derive.robot.expression import Expression
from derive.robot.names import free_symbols, robot_symbols
from derive.robot.options.style import Contraction
from derive.robot.robot import Robot

if TYPE_CHECKING:
    from derive.inverse.loops.linkage import SolvedLoop

_ARGUMENTS = {Kind.VARIABLE: Q, Kind.RATE: QD, Kind.ACCELERATION: QDD}
_LATE = (Kind.SINE, Kind.COSINE, *_ARGUMENTS)  # what depends on the arguments
Polynomials = Sequence[Polynomial]
# The functions that have one, from the chain, the joints' rates and accelerations, and 1/2.
CLOSED_FORMS: Mapping[str, Callable[[Chain[Polynomial], Polynomials, Polynomials, Polynomial], Polynomials]] = {
    "inertia_matrix": lambda chain, qd, qdd, half: [b for row in inertia_matrix(chain) for b in row],
    "coriolis_matrix": lambda chain, qd, qdd, half: [c for row in coriolis_matrix(chain, qd, half) for c in row],
    "gravity_vector": lambda chain, qd, qdd, half: gravity_vector(chain),
    "kinetic_energy": lambda chain, qd, qdd, half: [kinetic_energy(chain, qd, half)],
    "potential_energy": lambda chain, qd, qdd, half: [potential_energy(chain)],
    "inverse_dynamics": lambda chain, qd, qdd, half: inverse_dynamics(chain, qd, qdd),
}
Monomial = tuple[tuple[int, int], ...]  # generator indices with their exponents, ascending
_TOLERANCE = 1e-14  # of rotations
_TRIALS = (0.37, 0.83)  # values of the first free symbol; the others are spread above


class ClosedForm:
    """The dynamics of one robot as polynomials in one choice of angles, which ``words`` tell."""

    def __init__(self, robot: Robot, tape: TapeDomain, *, sums: bool) -> None:
        self.words = "closed form in sums of angles" if sums else "closed form"
        self._robot = robot
        self._tape = tape
        self._sums = sums

    @cached_property
    def _domain(self) -> PolynomialDomain:
        terms = POLICY.closed_form_terms
        sums = self._sums
        return PolynomialDomain(self._robot, sums=lambda group: sums, contraction=Contraction.OPPOSED, max_terms=terms)

    @cached_property
    def _chain(self) -> Chain[Polynomial]:
        return build_chain(self._robot, self._domain)

    def values(self, function: str) -> list[Value] | None:
        """The outputs of a function, row by row, torques without friction; None where they are long."""
        try:
            domain, joints = self._domain, range(self._robot.n)
            rates, accelerations = [domain.rate(i) for i in joints], [domain.acceleration(i) for i in joints]
            found = CLOSED_FORMS[function](self._chain, rates, accelerations, domain.number(Fraction(1, 2)))
        except (TooManyTerms, ExpressionError):
            return None
        if sum(len(entry) for entry in found) > POLICY.closed_form_terms:
            return None
        return [self._value(entry) for entry in found]

    @cached_property
    def _values(self) -> list[Value]:
        return [self._generator(generator) for generator in self._domain.generators]

    def _value(self, p: Polynomial) -> Value:
        """A polynomial, expanded: what does not depend on the arguments is gathered first, so that it is hoisted."""
        zero, one = self._tape.number(0), self._tape.number(1)
        groups: dict[Monomial, Value] = {}
        for exponents, coefficient in p.terms():
            used = tuple((i, e) for i, e in enumerate(exponents) if e)
            late = tuple((i, e) for i, e in used if self._domain.generators[i].kind in _LATE)
            early = self._product(tuple(pair for pair in used if pair not in late), self._tape.number(coefficient))
            groups[late] = groups.get(late, zero) + early
        return sum((factor * self._product(late, one) for late, factor in groups.items()), zero)

    def _product(self, monomial: Monomial, start: Value) -> Value:
        for i, exponent in monomial:
            start = start * self._values[i] ** exponent
        return start

    def _generator(self, generator: Generator) -> Value:
        tape, kind = self._tape, generator.kind
        match kind:
            case Kind.SINE:
                return self._angle(generator.joint).sin()
            case Kind.COSINE:
                return self._angle(generator.joint).cos()
            case Kind.VARIABLE | Kind.RATE | Kind.ACCELERATION:
                return tape.argument(_ARGUMENTS[kind], generator.joint)
            case Kind.CONSTANT_COSINE:
                return tape.cosine_sine(generator.argument)[0]
            case Kind.CONSTANT_SINE:
                return tape.cosine_sine(generator.argument)[1]
            case Kind.ROOT | Kind.PRIME_ROOT:
                return tape.constant(generator.argument).sqrt()
            case Kind.INVERSE:
                return 1 / tape.constant(generator.argument)
            case Kind.PARAMETER | Kind.PI:
                return tape.constant(generator.argument)

    def _angle(self, joint: int) -> Value:
        """The sum of joint variables of which a generator is the sine or cosine."""
        members, directions = self._domain.angles[joint], self._domain.directions
        turns = (directions[members[0]] * directions[m] * self._tape.argument(Q, m) for m in members)
        return sum(turns, self._tape.number(0))


def has_exact_rotations(robot: Robot, tolerance: float = _TOLERANCE) -> bool:
    """Whether constant transforms, perhaps to six decimals in a file, are rotations to rounding for any symbols."""
    numbers = dict(robot.parameters)
    fixed = {name: evaluate(numbers[name], {}) for name in robot_symbols(robot) if name in numbers}
    mounts = (stand.mount for stand in tree.stands(robot))
    matrices = (robot.base, robot.tool, *mounts, *(end.tool for end in robot.ends))
    for first in _TRIALS:
        values = fixed | {name: first + 0.071 * k for k, name in enumerate(free_symbols(robot))}
        for matrix in matrices:
            try:
                rows = [[evaluate(cell, values) for cell in row[:3]] for row in matrix[:3]]
            except ArithmeticError:
                return False
            for i, j in product(range(3), repeat=2):
                if abs(sum(a * b for a, b in zip(rows[i], rows[j], strict=True)) - (i == j)) > tolerance:
                    return False
    return True


class Trace:
    """The graph of one robot and its chain of tape values, shared by all functions.

    With ``whole`` it is that of the arm which leads to an end of a tree, on the graph of the tree, and ``places`` are
    the arm's joints in the tree.
    """

    def __init__(
        self, robot: Robot, effort: Effort = Effort.FULL, whole: Trace | None = None, places: Sequence[int] = ()
    ) -> None:
        self.robot = robot
        self.n = robot.n
        self.effort = effort
        self._whole, self._places = whole, places
        self.graph: Graph = whole.graph if whole else Graph()
        self.passive: Passive = whole.passive if whole else passive_joints(robot, self.graph)
        self.domain = TapeDomain(whole.robot if whole else robot, self.graph, places if whole else None, self.passive)
        self.chain: Chain[Value] = build_chain(robot, self.domain)
        self.choice: FormulationChoice = whole.choice if whole else FormulationChoice(robot, self.graph, effort)
        self._to_ends: dict[str, tuple[Trace, tuple[int, ...]]] = {}
        self._cheapest: dict[str, tuple[FrameChoices, ...]] = {}
        self._arranged: dict[tuple[FrameChoices, bool], Chain[Value]] = {}
        # J seen from a joint frame, of the end effector or of the frame's origin, which several functions begin with
        self.jacobian_from = cache(partial(jacobian_from, self.chain))

    @cached_property
    def half(self) -> Value:
        """1/2."""
        return self.domain.number(Fraction(1, 2))

    def to_end(self, name: str) -> tuple[Trace, tuple[int, ...]]:
        """The trace of the arm that leads to an end, and the indices of its joints."""
        if name not in self._to_ends:
            arm, places = tree.arm(self.robot, name)
            self._to_ends[name] = Trace(arm, self.effort, self, places), places
        return self._to_ends[name]

    @cached_property
    def runs(self) -> tuple[ParallelRun, ...]:
        """The joints in runs of parallel axes, with the sums of their angles."""
        return parallel_runs(self.chain, self.domain.cosine_sine_of_sum)

    @cached_property
    def stations(self) -> Stations | None:
        """Where vectors come from on their way to the world; None in a tree, or if a rotation is one only nearly."""
        return Stations(self.chain, self.runs) if self.chain.is_serial and has_exact_rotations(self.robot) else None

    @cached_property
    def end_stations(self) -> Stations | None:
        """The same on their way to the end effector."""
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
        """Closed forms in each choice of angles; none of coupled joints."""
        if self.robot.coupled:
            return ()
        has_sums = not self.chain.is_serial or any(len(run.placements) > 1 for run in self.runs)
        choices = (False, True) if has_sums else (False,)
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
        """An argument, joint by joint."""
        return [self.domain.argument(kind, i) for i in range(self.n)]

    def variables(self, kind: str) -> list[Value]:
        """An argument as it is given, of coupled joints by variables."""
        if not self.robot.coupled:
            return self.arguments(kind)
        return [self.domain.variable(kind, k) for k in range(self.robot.dof)]

    @cached_property
    def matrix(self) -> list[list[Value]]:
        """What turns velocities of the variables into those of the joints: S, or the choice of an arm's joints."""
        if self.robot.coupled:
            return coupling(self.robot, self.domain.constant)
        whole = self._whole or self
        return [[self.domain.number(int(place == k)) for k in range(whole.n)] for place in self._places]

    def by_variables(self, values: Sequence[Value], shape: Sequence[int], axis: int) -> list[Value]:
        """An array whose axis has an entry for each joint, with one for each variable: S^T v along the axis."""
        step, matrix, found = prod(shape[axis + 1 :]), self.matrix, list[Value]()
        columns = list(zip(*matrix, strict=True))
        for start, column, place in product(range(prod(shape[:axis])), columns, range(step)):
            entries = values[start * self.n * step + place : (start + 1) * self.n * step : step]
            found.append(sum((s * v for s, v in zip(column, entries, strict=True)), self.chain.zero))
        return found

    def for_variables(
        self, formulation: Formulation, sizes: Sequence[int | str], lengths: Mapping[str, int]
    ) -> Formulation:
        """What is computed joint by joint, for the variables of the whole robot."""
        if formulation.is_of_variables:
            return formulation
        values = list(formulation.trace())
        shape = [self.n if size == "n" else lengths[size] if isinstance(size, str) else size for size in sizes]
        for axis in (axis for axis, size in enumerate(sizes) if size == "n"):
            values = self.by_variables(values, shape, axis)
            shape[axis] = len(self.matrix[0])
        return Formulation(formulation.words, partial(list, values))

    def zeros(self) -> list[Value]:
        """An argument that vanishes."""
        return [self.chain.zero] * self.n

    def still(self) -> list[Value]:
        """The accelerations of the joints while the variables have none."""
        return [self.domain.bias(i) for i in range(self.n)]

    def in_time(self, values: Sequence[Value]) -> list[Value]:
        """How values change in time, those that passive joints move included."""
        whole = self._whole or self
        return derivative(values, rates(whole.robot, self.passive, whole.domain))

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


# -- the passive joints of closed loops: their positions, slopes and accelerations from the variables


def passive_joints(robot: Robot, graph: Graph) -> Passive:
    """The passive joints, loop by loop: cosines and sines, or lengths, of their variables, G, and dG/dt qd."""
    found, bare = Passive(), replace(robot, links=(), gravity=None)
    if not robot.loops:
        return found
    from derive.inverse.loops.closing import twists
    from derive.inverse.loops.linkage import SolvedLoop, linkage  # the inverse kinematics, which few programs need

    variables, loops = [variable.variable for variable in robot.variables], linkage(robot)
    if not all(isinstance(one, SolvedLoop) for one in loops):
        domain, places = TapeDomain(robot, graph), [k for k, joint in enumerate(robot.joints) if joint.follows]
        given = {place: _numbers(robot, place, domain.variable(PASSIVE, k)) for k, place in enumerate(places)}
        found = Passive(given, is_given=True)
    for one in loops:
        domain = TapeDomain(robot, graph, passive=found)
        if isinstance(one, SolvedLoop) and not found.is_given:
            found = replace(found, numbers={**found.numbers, **_solved(one, domain)})
            domain = TapeDomain(robot, graph, passive=found)
        columns, _ = twists(bare, one, domain)
        determinant, numerators = one.determinant(columns), one.first(robot, columns, domain)
        slopes: dict[Expression, Value] = {name: numerator / determinant for name, numerator in numerators}
        found = replace(found, slopes={**found.slopes, **slopes})
        domain, biases = TapeDomain(robot, graph, passive=found), dict[int, Value]()
        known = found
        if found.is_given:  # those of loops behind have no slopes yet
            known = replace(found, numbers={p: found.numbers[p] for p in (*found.biases, *one.passive)})
        for p in one.passive:
            names, own = zip(*robot.joints[p].follows, strict=True)
            moved = derivative([found.slopes[slope] for slope in own], rates(robot, known, domain))
            shares = (domain.variable(QD, variables.index(name)) for name in names)
            biases[p] = sum((a * b for a, b in zip(moved, shares, strict=True)), domain.number(0))
        found = replace(found, biases={**found.biases, **biases})
    return found


def _numbers(robot: Robot, place: int, value: Value) -> tuple[Value, ...]:
    return (value.cos(), value.sin()) if robot.joints[place].is_revolute else (value,)


def _solved(one: SolvedLoop, domain: TapeDomain) -> dict[int, tuple[Value, ...]]:
    """The numbers of the passive joints of a loop in closed form."""
    numbers = dict[int, tuple[Value, ...]]()
    # The three angles of a ball joint have singular poses where the ball itself has none.
    kind = GraphWalk if one.circuit.places.count(-1) > 1 else ClosingWalk
    _, leaf = one.walk(domain, ClosingField(domain), partial(domain.argument, Q), kind)
    for place, shift, own in zip(one.circuit.places, one.graph.shifts, leaf.joints, strict=True):
        if place in one.passive:
            constant = domain.cosine_sine(shift) if len(own) == 2 else domain.constant(shift)
            numbers[place] = turned(own, constant, -1) if isinstance(constant, tuple) else (own[0] - constant,)
    return numbers


def iterated_positions(robot: Robot, graph: Graph) -> list[Value]:
    """Passive joints by damped Newton steps from where they are given, and by how much the loops are open then."""
    from derive.inverse.loops.closing import STEP, STEPS, lengths, openings, twists
    from derive.inverse.loops.linkage import SolvedLoop, linkage

    bare, numbers = replace(robot, links=(), gravity=None), dict[int, tuple[Value, ...]]()
    domain, places = TapeDomain(robot, graph), [k for k, joint in enumerate(robot.joints) if joint.follows]
    open_by, unit = domain.number(0), sum((abs(domain.constant(cell)) for cell in lengths(robot)), domain.number(0))
    at = {place: domain.variable(PASSIVE, k) for k, place in enumerate(places)}
    for one in linkage(robot):
        if isinstance(one, SolvedLoop):
            numbers |= _solved(one, domain)
            domain = TapeDomain(robot, graph, passive=Passive(numbers))
            at |= {place: domain.argument(Q, place) for place in one.passive}
            continue
        for step in range(STEPS + 1):
            numbers |= {place: _numbers(robot, place, at[place]) for place in one.passive}
            domain = TapeDomain(robot, graph, passive=Passive(numbers))
            rows, misses = openings(bare, one, domain)
            if step == STEPS:
                open_by = reduce(Value.maximum, map(abs, misses), open_by)
                break
            columns, _ = twists(bare, one, domain)
            slopes = [[columns[p][row] for row in one.rows] for p in one.passive]
            change = least_squares(slopes, [1] * len(slopes), [rows[row] for row in one.rows])
            turns = [robot.joints[p].is_revolute for p in one.passive]
            sizes = [abs(x) if turn else abs(x) / unit for x, turn in zip(change, turns, strict=True)]
            damping = (reduce(Value.maximum, sizes) / Fraction(STEP)).maximum(1)
            at |= {p: at[p] - x / damping for p, x in zip(one.passive, change, strict=True)}
    return [*(at[place] for place in places), open_by]


def rates(robot: Robot, passive: Passive, domain: TapeDomain) -> dict[Value, Value]:
    """The rates of the variables, and of the numbers of passive joints, with which values change in time."""
    found = {domain.variable(Q, k): domain.variable(QD, k) for k in range(robot.dof)}
    for place, numbers in passive.numbers.items():
        rate = domain.argument(QD, place)
        if len(numbers) == 1:
            found[numbers[0]] = rate
        else:
            cosine, sine = numbers
            found |= {cosine: -sine * rate, sine: cosine * rate}
    return found
