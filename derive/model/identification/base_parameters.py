"""Base parameters: the fewest combinations of inertial parameters that determine the torques, with proof.

What is linear in the parameters is told apart by B and g: a combination of parameters has no effect on any torque
exactly where it has none on B(q) and g(q). The set is found in three steps.

1. Whatever part of link i looks the same however joint i moves goes to link i-1 (`derive.mechanics.regrouping`;
   Gautier and Khalil, IEEE Trans. Robotics and Automation 6(3), 1990; Khalil and Dombre, Modeling, Identification and
   Control of Robots, ch. 9). That leaves seven parameters of a revolute link, four of a prismatic one, exactly. Masses
   of rotors belong to the links that carry them.
2. Of their columns the first independent ones are kept, from the base outwards, rotors and armatures last. They are
   found at random configurations and, where geometry has symbols, random values modulo a prime; a determinant that is
   not zero there is not zero identically. This is the lower bound of the rank.
3. Every other column is solved for in the kept ones, and the solution is proven as an identity of polynomials. This is
   the upper bound: the joints before the first change of direction, gravity along an axis, sliding joints.

Symbols with a number count as that number, all others and angles that are no multiples of pi/4 or pi/6 as generic.

The values of parameters come as scalars of any kind, and as text in the robot's own symbols for generated files.
"""

from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import lru_cache, partial

import numpy as np

from derive.algebra.constants import exact_number
from derive.algebra.domain import PolynomialDomain, polynomial_expression
from derive.algebra.generators import MOVING
from derive.algebra.quotients import Quotient
from derive.algebra.residues import NoPointError, Residue, ResidueDomain, echelon
from derive.algebra.ring import Polynomial, TooManyTerms, determinant, in_lowest_terms
from derive.errors import DeriveError, ExpressionError, QuantityError
from derive.mechanics.chain import Body, Domain, body_in, build_chain, central_inertia, constant_vector, fixed_bodies
from derive.mechanics.joint_motion import axis
from derive.mechanics.regressor import with_unit_rotors
from derive.mechanics.regrouping import regroup
from derive.mechanics.vectors import S, axial_tensor, scale, steiner
from derive.model.identification.unit_dynamics import UnitDynamics
from derive.robot import inertial_parameters, tree
from derive.robot.description import IDENTITY, Link, Motor
from derive.robot.expression import ZERO, Expression, add, multiply, power, substitute, to_text
from derive.robot.inertial_parameters import FRICTION_PARTS, JOINT_PARTS, LINK_PARTS, Parameter
from derive.robot.robot import Robot

REVOLUTE_PARTS = ("mx", "my", "Ixx", "Izz", "Ixy", "Ixz", "Iyz")
PRISMATIC_PARTS = ("m", "mx", "my", "mz")
# Budget of a product of polynomials in a proof; beyond it a column is kept though it may be dependent.
MAX_PROOF_TERMS = 20_000
MAX_TEXT = 1000  # longest formula, in characters, that is written
_FEWEST_SAMPLES = 6  # configurations at first; more where something seems dependent that is not


class Unproven(DeriveError):
    """A relation that holds at the sampled points is no identity."""


def _solved(
    units: UnitDynamics[Polynomial], residues: ResidueDomain, wanted: Parameter, basis: Sequence[Parameter]
) -> list[Quotient]:
    """The coefficients of independent columns of B and g in a column that depends on them, by Cramer's rule."""
    domain = residues.domain
    right, *columns = [_column(units, domain, parameter) for parameter in (wanted, *basis)]
    keys = sorted({*right, *(key for column in columns for key in column)}, key=repr)
    rows = [[column.get(key, domain.ring.zero) for column in (*columns, right)] for key in keys]
    rows.sort(key=lambda row: sum(map(len, row)))
    # As many rows as columns, the first whose left parts are independent; then Cramer's rule over polynomials.
    chosen = []
    if basis:
        values = [[int(residues.value(entry).values.flat[0]) for entry in row[:-1]] for row in rows]
        pivots, _ = echelon(np.array(values, dtype=np.int64).T, residues.prime)
        if len(pivots) < len(basis):
            raise Unproven("columns that are independent at the points are not")
        chosen = [rows[k] for k in pivots]
    scale = determinant([row[:-1] for row in chosen]) if basis else domain.ring.one
    tops = [determinant([[*row[:k], row[-1], *row[k + 1 : -1]] for row in chosen]) for k in range(len(basis))]
    # Proof: the solution holds in all other rows, as an identity of polynomials in the geometry.
    for row in rows:
        products = (top * entry for top, entry in zip(tops, row[:-1], strict=True))
        if scale * row[-1] != sum(products, domain.ring.zero):
            raise Unproven(f"{wanted.name} depends on other parameters only at some points")
    return [_reduced(top, scale) for top in tops]


def _column(
    units: UnitDynamics[Polynomial], domain: PolynomialDomain, parameter: Parameter
) -> Mapping[Hashable, Polynomial]:
    """By entry of B or g and monomial in the joint variables the coefficient: a polynomial in the geometry."""
    moving = [i for i, g in enumerate(domain.generators) if g.kind in MOVING]
    return {
        (place, monomial): coefficient
        for place, value in (*units.inertia(parameter).items(), *units.gravity(parameter).items())
        for monomial, coefficient in domain.ring.coefficients(value, moving).items()
    }


def _reduced(top: Polynomial, bottom: Polynomial) -> Quotient:
    """top / bottom without common factors, a constant denominator being 1."""
    numerator, denominator = in_lowest_terms(top, bottom)
    if denominator.is_constant:
        return Quotient(numerator * (1 / denominator.constant_term), top.ring.one)
    return Quotient(numerator, denominator)


@dataclass(frozen=True, slots=True)
class Relation:
    """A column that others replace: column(parameter) = sum of coefficient * column(base parameter)."""

    parameter: Parameter  # what is grouped with others, or has no effect
    terms: tuple[tuple[Parameter, Quotient], ...]  # base parameters that take it over; empty without effect


@dataclass(frozen=True, slots=True, eq=False)
class BaseSet:
    """Which parameters are kept, and what becomes of the others after the general rule.

    The links' parameters are those in joint frames, see `derive.mechanics.chain`: on the axis of joint i, which in the
    modified convention is DH frame i.
    """

    parameters: tuple[Parameter, ...]  # the kept ones, joint by joint
    relations: tuple[Relation, ...]  # candidates that the kept ones replace
    domain: PolynomialDomain | None  # the ring of the coefficients in ``relations``
    proven: bool  # whether there are certainly no fewer; else some are kept that others replace, in a formula too long

    def fraction(self, coefficient: Quotient) -> tuple[Expression, Expression]:
        """Numerator and denominator of a coefficient in ``relations``."""
        assert self.domain is not None, "relations come with their ring"
        numerator, denominator = coefficient.numerator, coefficient.denominator
        return polynomial_expression(numerator, self.domain), polynomial_expression(denominator, self.domain)


@lru_cache(maxsize=64)
def base_set(robot: Robot) -> BaseSet:
    """The base parameters of a robot with links."""
    if robot.loops:
        allowed = "allowed: robots without closed loops; here the regressor and the standard parameters"
        raise QuantityError(f"base parameters of {robot.name}, which has closed loops", allowed=allowed)
    numbers = {name: value for name, value in dict(robot.parameters).items() if name not in robot.runtime}
    found = _base_set(robot, numbers)
    if not numbers or not any(relation.terms for relation in found.relations):
        return found
    symbolic = _base_set(robot, {})
    # A relation in symbols is preferred where it says the same and no denominator vanishes for the numbers.
    if symbolic.parameters != found.parameters or not symbolic.proven or symbolic.domain is None:
        return found
    denominators = {c.denominator for relation in symbolic.relations for _, c in relation.terms}
    values = (exact_number(polynomial_expression(d, symbolic.domain), numbers) for d in denominators)
    return symbolic if all(value != 0 for value in values) else found


def _base_set(robot: Robot, numbers: Mapping[str, Expression]) -> BaseSet:
    # What the general rule leaves, in the order in which columns are preferred.
    parts = [REVOLUTE_PARTS if joint.is_revolute else PRISMATIC_PARTS for joint in robot.joints]
    candidates = [Parameter(i, part) for i, row in enumerate(parts, start=1) for part in row]
    own, absorbed = inertial_parameters.standard_parameters(robot), absorbed_rotors(robot)
    candidates += [p for p in own if p.part == "Ia"]
    candidates += [p for p in own if p.part == "Im" and p.joint not in absorbed]
    # b*qd and f*sign(qd) are independent of all others: no column of B or g is odd in one velocity, or jumps. Among
    # each other they are, too, unless joints are coupled.
    friction, geometry = [p for p in own if p.part in FRICTION_PARTS], _geometry(robot, numbers)
    samples = _FEWEST_SAMPLES
    while samples <= 4 * len(candidates):
        try:
            return _proven(geometry, candidates, friction, samples)
        except Unproven:
            samples *= 2
        except (ExpressionError, TooManyTerms, NoPointError, ZeroDivisionError):
            break
    return BaseSet(_ordered([*candidates, *friction]), (), None, proven=False)


def _proven(geometry: Robot, candidates: Sequence[Parameter], friction: Sequence[Parameter], samples: int) -> BaseSet:
    domain = PolynomialDomain(with_unit_rotors(geometry), rates=False, max_terms=MAX_PROOF_TERMS)
    kept, relations, too_long = _related(domain, candidates, samples)
    if geometry.coupled:
        # b S^T S qd, row by row of S, is what an armature does to qdd.
        viscous = [replace(p, part="Ia") for p in friction if p.part == "b"]
        alike = list(_dry_relations(domain, friction))
        for relation in _related(domain, viscous, samples)[1]:
            terms = tuple((replace(p, part="b"), factor) for p, factor in relation.terms)
            alike.append(Relation(replace(relation.parameter, part="b"), terms))
        replaced = {relation.parameter for relation in alike}
        relations, friction = [*relations, *alike], [p for p in friction if p not in replaced]
    return BaseSet(_ordered([*kept, *too_long, *friction]), tuple(relations), domain, proven=not too_long)


def _dry_relations(domain: PolynomialDomain, friction: Sequence[Parameter]) -> Iterator[Relation]:
    """What replaces the dry friction of coupled joints that move together: of s and k s, |k| times that of s."""
    parts: dict[int, list[str]] = {}
    for p in friction:
        if p.part != "b":
            parts.setdefault(p.joint, []).append(p.part)
    # Rows with friction by direction come first: they can take over that without.
    kept: list[int] = []
    for j in sorted(parts, key=lambda joint: (parts[joint] == ["f"], joint)):
        if not any(domain.coupling[j - 1]):  # a factor with the number zero
            yield from (Relation(Parameter(j, part), ()) for part in parts[j])
            continue
        found = ((i, _multiple(domain, j, i)) for i in kept)
        i, k = next(((i, k) for i, k in found if k), (0, Fraction(0)))
        if not k:
            kept.append(j)
            continue
        size = Quotient(domain.number(abs(k)), domain.ring.one)
        for part in parts[j]:
            turned = {"fp": "fm", "fm": "fp"}.get(part, part) if k < 0 else part
            taken = parts[i] if part == "f" else [turned]
            yield Relation(Parameter(j, part), tuple((Parameter(i, other), size) for other in taken))


def _multiple(domain: PolynomialDomain, j: int, i: int) -> Fraction | None:
    """The number k with which row j of S is k times row i, both from 1; None where there is none."""
    row, other = domain.coupling[j - 1], domain.coupling[i - 1]
    at = next(k for k, entry in enumerate(other) if entry)
    ratio = _reduced(row[at], other[at])
    if not ratio.numerator.is_constant or not ratio.denominator.is_constant:
        return None
    is_multiple = all(a * other[at] == b * row[at] for a, b in zip(row, other, strict=True))
    return ratio.numerator.constant_term if is_multiple else None


def _related(
    domain: PolynomialDomain, candidates: Sequence[Parameter], samples: int
) -> tuple[list[Parameter], list[Relation], list[Parameter]]:
    """The candidates that are kept, what replaces the others, and those for which that is too long to find."""
    if not candidates:
        return [], [], []
    n, residues = domain.robot.dof, ResidueDomain(domain, samples)
    coupling = [[residues.value(entry) for entry in row] for row in domain.coupling] if domain.robot.coupled else ()
    units: UnitDynamics[Residue] = UnitDynamics(build_chain(domain.robot, residues), False, coupling)
    place = {pair: k for k, pair in enumerate([(a, b) for a in range(n) for b in range(a, n)])}
    # Entries of B (upper triangle) and g at every sample, one column for each parameter, modulo a prime.
    matrix = np.zeros((samples, len(place) + n, len(candidates)), dtype=np.int64)
    for j, parameter in enumerate(candidates):
        for pair, value in units.inertia(parameter).items():
            matrix[:, place[pair], j] = value.values[:, 0]
        for i, value in units.gravity(parameter).items():
            matrix[:, len(place) + i, j] = value.values[:, 0]
    # The first independent columns from the left, and all columns in them.
    pivots, reduced = echelon(matrix.reshape(-1, len(candidates)), residues.prime)
    exact: UnitDynamics[Polynomial]
    exact = UnitDynamics(build_chain(domain.robot, domain), False, domain.coupling if domain.robot.coupled else ())
    relations: list[Relation] = []
    too_long: list[Parameter] = []
    for j in sorted(set(range(len(candidates))) - set(pivots)):
        support = [candidates[pivot] for k, pivot in enumerate(pivots) if reduced[k, j]]
        try:
            coefficients = _solved(exact, residues, candidates[j], support)
        except TooManyTerms:
            too_long.append(candidates[j])
            continue
        relations.append(Relation(candidates[j], tuple(zip(support, coefficients, strict=True))))
    return [candidates[pivot] for pivot in pivots], relations, too_long


def absorbed_rotors(robot: Robot) -> tuple[int, ...]:
    """Revolute joints (from 1) with a rotor and an armature, whose rotor's inertia is no parameter of its own.

    The square of its speed, (w.u + k qd)^2, is (1 - k) (w.u)^2 + k (w.u + qd)^2 + (k^2 - k) qd^2: links i-1 and i and
    the armature take it over.
    """
    pairs = enumerate(zip(robot.joints, robot.links, strict=True), start=1)
    return tuple(i for i, (j, link) in pairs if j.is_revolute and link.motor is not None and link.armature != ZERO)


def _ordered(parameters: Sequence[Parameter]) -> tuple[Parameter, ...]:
    order = {part: k for k, part in enumerate((*LINK_PARTS, *JOINT_PARTS))}
    return tuple(sorted(parameters, key=lambda p: (p.joint, order[p.part])))


def _geometry(robot: Robot, numbers: Mapping[str, Expression]) -> Robot:
    """What decides on dependence: numbers put in, no tool, joint variables counted from where they are simplest."""
    _put = partial(substitute, values=dict(numbers))
    joints = []
    for joint in robot.joints:
        theta, d = _put(joint.theta), _put(joint.d)
        if not robot.coupled:
            # B's rank does not depend on where variables are counted from, only on how coupled joints stand together.
            theta, d = (ZERO, d) if joint.is_revolute else (theta, ZERO)
        drive = tuple((name, _put(factor)) for name, factor in joint.drive)
        moved = replace(joint, theta=theta, d=d, a=_put(joint.a), alpha=_put(joint.alpha), limits=None, drive=drive)
        joints.append(moved)
    motors = (link.motor and Motor(ratio=_put(link.motor.ratio)) for link in robot.links)
    return replace(
        tree.mapped(replace(robot, joints=tuple(joints)), _put),
        base=tuple(tuple(_put(cell) for cell in cells) for cells in robot.base),
        tool=IDENTITY,
        gravity=robot.gravity and (_put(robot.gravity[0]), _put(robot.gravity[1]), _put(robot.gravity[2])),
        links=tuple(Link(motor=motor) if motor else link for motor, link in zip(motors, robot.links, strict=True)),
        fixed=tree.massless(tree.mapped(robot, _put).fixed),
    )


def parameters_of(body: Body[S]) -> list[S]:
    """A body's ten parameters in the order of `LINK_PARTS`."""
    i = body.inertia
    return [body.mass, *body.first_moment, i.xx, i.yy, i.zz, i.xy, i.xz, i.yz]


def standard_values(robot: Robot, parameters: Sequence[Parameter], domain: Domain[S]) -> list[S]:
    """The parameters as the file gives them, each link's in its DH frame, about the frame's origin."""
    bodies = []
    for link in robot.links:
        mass, r = domain.constant(link.mass), constant_vector(link.com, domain)
        bodies.append(Body(mass, scale(mass, r), central_inertia(link, domain) + steiner(mass, r)))
    for i, frame, link in fixed_bodies(robot, domain):
        if i >= 0:
            bodies[i] = bodies[i] + body_in(frame, link, domain)
    return [_value(p, robot, bodies, domain) for p in parameters]


def base_values(robot: Robot, base: BaseSet, domain: Domain[S], coefficient: Callable[[Quotient], S]) -> list[S]:
    """The base parameters: what the general rule groups, and what the relations of the set add."""
    values = grouped_values(robot, base, domain)
    for relation in base.relations:
        for parameter, factor in relation.terms:
            values[parameter] = values[parameter] + coefficient(factor) * values[relation.parameter]
    return [values[parameter] for parameter in base.parameters]


def grouped_values(robot: Robot, base: BaseSet, domain: Domain[S]) -> dict[Parameter, S]:
    """The parameters in joint frames after the general rule."""
    # links and the masses of rotors, without their spin; what absorbed rotors add to links and armatures
    still = [one if one.motor is None else replace(one, motor=replace(one.motor, inertia=ZERO)) for one in robot.links]
    chain = build_chain(replace(robot, links=tuple(still)), domain)
    bodies, z, armatures = list(chain.bodies), chain.zero, dict[Parameter, S]()
    for i in absorbed_rotors(robot):
        motor = robot.links[i - 1].motor or Motor()
        ratio, inertia = domain.constant(motor.ratio), domain.constant(motor.inertia)
        ratio = ratio if robot.joints[i - 1].sign > 0 else -ratio
        # (w.u + k qd)^2 split as `absorbed_rotors` says: armature, link i, link i-1.
        armatures[Parameter(i, "Ia")] = (ratio * ratio - ratio) * inertia
        turning = axial_tensor(ratio * inertia, (z, z, chain.one))
        bodies[i - 1] = bodies[i - 1] + Body(z, chain.null, turning)
        if (before := chain.joints[i - 1].parent) >= 0:
            turning = axial_tensor(inertia - ratio * inertia, axis(chain.joints[i - 1]))
            bodies[before] = bodies[before] + Body(z, chain.null, turning)
    grouped = regroup(replace(chain, bodies=tuple(bodies))).bodies
    everything = (*base.parameters, *(relation.parameter for relation in base.relations))
    values = {p: _value(p, robot, grouped, domain) for p in everything}
    for p, added in armatures.items():
        values[p] = values[p] + added
    return values


def _value(p: Parameter, robot: Robot, bodies: Sequence[Body[S]], domain: Domain[S]) -> S:
    """One of a body's ten parameters, or that of a rotor, armature or friction."""
    if p.of_link:
        return parameters_of(bodies[p.joint - 1])[LINK_PARTS.index(p.part)]
    link = robot.links[p.joint - 1]
    motor = link.motor or Motor()
    cells = {"mm": motor.mass, "Im": motor.inertia, "Ia": link.armature, "b": link.viscous}
    cells |= inertial_parameters.coulomb_parts(link)
    return domain.constant(cells[p.part])


def standard_formulas(robot: Robot, parameters: Sequence[Parameter]) -> list[str]:
    """What the file gives, ``m1*com1``; empty where a cell is outside of what polynomials can hold."""
    try:
        domain = PolynomialDomain(robot, rates=False)
    except (ExpressionError, ZeroDivisionError):
        return [""] * len(parameters)
    return [_text(polynomial_expression(value, domain)) for value in standard_values(robot, parameters, domain)]


def base_formulas(robot: Robot, base: BaseSet) -> list[str]:
    """What is grouped, ``Izz1 + a1**2*m2``, one formula for each base parameter; empty as those of the file."""
    try:
        domain = PolynomialDomain(robot, rates=False)
    except (ExpressionError, ZeroDivisionError):
        return [""] * len(base.parameters)
    values = grouped_values(robot, base, domain)
    sums = {p: [polynomial_expression(values[p], domain)] for p in base.parameters}
    for relation in base.relations:
        moved = polynomial_expression(values[relation.parameter], domain)
        for parameter, factor in relation.terms:
            numerator, denominator = base.fraction(factor)
            sums[parameter].append(multiply(multiply(numerator, power(denominator, -1)), moved))
    return [_text(add(*terms)) for terms in sums.values()]


def _text(formula: Expression) -> str:
    text = to_text(formula)
    return text if len(text) <= MAX_TEXT else ""
