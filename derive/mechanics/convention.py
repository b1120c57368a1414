"""The same arm by the table of the other convention, with its dynamics; symbolic, and exact.

Both tables are one product of motions Z_i = Rot(z, theta_i) Trans(z, d_i) and factors X_i = Trans(x, a_i) Rot(x,
alpha_i),

    standard:  base (Z_1 X_1) (Z_2 X_2) ... (Z_n X_n) tool,
    modified:  base (X_0 Z_1) (X_1 Z_2) ... (X_{n-1} Z_n) tool,

and differ in the brackets: row i of the one holds the X of row i + 1 of the other. What is left over at one end goes
into the tool (X_n) or into the base (X_0). DH frame i stands before X_i in the modified convention and behind it in the
standard one (Khalil and Dombre, Modeling, Identification and Control of Robots, ch. 3; Craig, Introduction to Robotics,
ch. 3), so centres of mass and tensors are seen through X_i. A rotor stands at o_{i-1} (standard) or, d_i further along
the same axis, at o_i (modified): the link that carries it makes up for the difference.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import reduce
from math import atan2, pi

from derive.algebra.constants import exact_number
from derive.algebra.domain import PolynomialDomain
from derive.algebra.generators import Kind, robot_cells
from derive.algebra.ring import Polynomial
from derive.mechanics import vectors
from derive.mechanics.chain import build_chain, central_inertia, constant_frame, constant_vector, link_factor
from derive.mechanics.forward_kinematics import forward_kinematics
from derive.mechanics.vectors import Frame, Matrix, Vector
from derive.robot import expression as tree
from derive.robot.description import INERTIA, Convention, Description, Inertia, Link, Motor
from derive.robot.evaluate import evaluate
from derive.robot.expression import ZERO, Call, Expression, Pi, Sum, is_constant, number
from derive.robot.names import without_lost_symbols
from derive.robot.robot import Robot
from derive.robot.units import turned_angles
from derive.robot.writer import cell_text

ROUND = 180  # a constant angle of a base or tool is recognised where it is a multiple of pi by this
NEAR = 1e-9  # how near to such a multiple it is looked for; whether it is one is then decided exactly


@dataclass(frozen=True, slots=True)
class Factor:
    """X = Trans(x, a) Rot(x, alpha); the two commute."""

    a: Expression = ZERO  # length [m]
    alpha: Expression = ZERO  # angle [rad]

    @property
    def is_one(self) -> bool:
        """Whether it is the identity as it is written."""
        return self.a == ZERO == self.alpha


@dataclass(frozen=True, slots=True)
class Conversion:
    """An arm in the other convention."""

    source: Robot  # the arm as it was
    result: Description  # the same arm; it has no file yet
    leaving: Factor  # the factor that leaves the table: X_n, now in the tool, or X_0, now in the base
    entering: Factor  # the factor that enters it: X_0, out of the base, or X_n, out of the tool
    notes: tuple[str, ...]  # where the other convention says something else, as sentences

    @property
    def factors(self) -> tuple[Factor, ...]:
        """X_0 ... X_n of the arm."""
        rows = tuple(Factor(joint.a, joint.alpha) for joint in self.source.joints)
        return (self.entering, *rows) if self.source.convention is Convention.STANDARD else (*rows, self.entering)


def convert(robot: Robot, entering: Factor | None = None) -> Conversion:
    """The arm by the table of the other convention: T, J, B, C, g and tau are the same functions.

    Args:
        entering: What is taken out of the base for the first row (of a modified table), or out of the tool for the last
            row (of a standard one): any factor is right. None for the whole base or tool where it is such a factor,
            and for nothing where it is none.
    """
    # What may enter: the translation along x of the base (tool) with each angle that its cells may mean.
    to_modified = robot.convention is Convention.STANDARD
    end = robot.base if to_modified else robot.tool
    candidates = [entering] if entering is not None else [Factor(end[0][3], angle) for angle in _angles(end)]
    carried = [(link, motor) for link, motor, _ in _motors(robot)]
    # All cosines, sines and quotients of the result are generators of one ring, where equality is decidable.
    calls = [Call(name, (factor.alpha,)) for factor in candidates for name in ("cos", "sin")]
    divided = [tree.power(link.mass, -1) for link, _ in carried if not _is_zero(robot, link.mass)]
    cells = Cells(robot, [*(factor.a for factor in candidates), *calls, *divided])
    if entering is None:
        # The candidate that equals the whole base (tool) exactly, if there is one.
        whole = cells.frame(end)
        entering = next((factor for factor in candidates if cells.factor(factor) == whole), Factor())
    first, last = robot.joints[0], robot.joints[-1]
    rows = [Factor(joint.a, joint.alpha) for joint in robot.joints]
    leaving = Factor(last.a, last.alpha) if to_modified else Factor(first.a, first.alpha)
    # The brackets shift by one factor: X_{i-1} for X_i in row i, or the other way round.
    moved = [entering, *rows[:-1]] if to_modified else [*rows[1:], entering]
    base, tool = cells.frame(robot.base), cells.frame(robot.tool)
    # base X_0^-1 (X_0 Z_1) ... (X_{n-1} Z_n) X_n tool is the same product.
    if to_modified:
        base, tool = base @ cells.factor(entering).inverse, cells.factor(leaving) @ tool
    else:
        base, tool = base @ cells.factor(leaving), cells.factor(entering).inverse @ tool
    links, notes = _links(robot, cells, moved)
    result = replace(
        robot,
        convention=Convention.MODIFIED if to_modified else Convention.STANDARD,
        joints=tuple(replace(joint, a=x.a, alpha=x.alpha) for joint, x in zip(robot.joints, moved, strict=True)),
        base=cells.matrix(base, robot.base),
        tool=cells.matrix(tool, robot.tool),
        links=links,
        remarks=(),
    )
    return Conversion(robot, without_lost_symbols(robot, result), leaving, entering, tuple(notes))


def _angles(matrix: Sequence[Sequence[Expression]]) -> Iterator[Expression]:
    """Angles about x that a constant transform may have: those in its cells, and the one that its numbers are."""
    cosine, sine = matrix[1][1], matrix[2][1]
    # A rotation by a number: the multiple of pi/180 that it is but for rounding.
    if is_constant(cosine) and is_constant(sine):
        turns = atan2(evaluate(sine, {}), evaluate(cosine, {})) / pi * ROUND
        if abs(turns - round(turns)) < NEAR:
            yield tree.multiply(number(Fraction(round(turns), ROUND)), Pi())
    for angle in dict.fromkeys([*turned_angles(cosine), *turned_angles(sine)]):
        yield from (angle, tree.negate(angle), tree.add(angle, Pi()), tree.add(Pi(), tree.negate(angle)))


def _is_zero(robot: Description, cell: Expression) -> bool:
    return exact_number(cell, dict(robot.parameters)) == 0


def _motors(robot: Robot) -> Iterator[tuple[Link, Motor, int]]:
    """Rotors with a mass whose place differs by convention, with the link that carries them, and its number."""
    for i, link in enumerate(robot.links):
        motor = link.motor
        if i and motor is not None and not (_is_zero(robot, motor.mass) or _is_zero(robot, robot.joints[i].d)):
            yield robot.links[i - 1], motor, i - 1


class Cells:
    """Cells of a robot as exact polynomials, and polynomials as cells again."""

    def __init__(self, robot: Robot, extra: Iterable[Expression]) -> None:
        domain = self.domain = PolynomialDomain(robot, extra, rates=False)
        places, first = range(len(domain.generators)), (Kind.PARAMETER, Kind.PI)
        # Parameters and pi stand first in a product, then what is made of them.
        self._order = sorted(places, key=lambda place: domain.generators[place].kind not in first)

    def frame(self, matrix: Sequence[Sequence[Expression]]) -> Frame[Polynomial]:
        """A constant transform."""
        return constant_frame(tuple(map(tuple, matrix)), self.domain)

    def factor(self, factor: Factor) -> Frame[Polynomial]:
        """X = Trans(x, a) Rot(x, alpha)."""
        return link_factor(factor.a, factor.alpha, self.domain)

    def matrix(
        self, frame: Frame[Polynomial], before: Sequence[Sequence[Expression]]
    ) -> tuple[tuple[Expression, ...], ...]:
        """The cells of a transform."""
        known = [cell for row in before for cell in row]
        rows = frame.rows(self.domain.number(0), self.domain.number(1))
        return tuple(tuple(self.cell(entry, known) for entry in row) for row in rows)

    def cell(self, value: Polynomial, known: Iterable[Expression] = ()) -> Expression:
        """A polynomial as a cell: one that is known, up to its sign, or a sum in a fixed order."""
        for cell in known:
            negated = tree.add(*map(tree.negate, cell.terms)) if isinstance(cell, Sum) else tree.negate(cell)
            if found := next((each for each in (cell, negated) if self.domain.constant(each) == value), None):
                return found
        terms = [([exponents[place] for place in self._order], factor) for exponents, factor in value.terms()]
        # Positive terms first, higher powers first.
        ordered = sorted(terms, key=lambda term: (term[1] < 0, [-exponent for exponent in term[0]]))
        bases = [self.domain.generators[place].expression for place in self._order]
        return tree.add(*(tree.multiply(number(factor), *map(tree.power, bases, powers)) for powers, factor in ordered))


@dataclass(frozen=True, slots=True)
class _Body:
    """A link without its rotors."""

    mass: Expression  # its cell
    com: Vector[Polynomial]  # centre of mass
    inertia: Matrix[Polynomial]  # about the centre of mass

    def through(self, frame: Frame[Polynomial]) -> _Body:
        """The body, known in some frame, seen from the frame in which that one is given."""
        turn = frame.rotation
        com = vectors.add(frame.position, vectors.multiply(turn, self.com))
        return _Body(self.mass, com, vectors.conjugate(turn, self.inertia))


def _links(robot: Robot, cells: Cells, moved: Sequence[Factor]) -> tuple[tuple[Link, ...], list[str]]:
    """The links in the frames of the other table, and notes on what differs there."""
    to_modified = robot.convention is Convention.STANDARD
    rows = [Factor(joint.a, joint.alpha) for joint in robot.joints] if to_modified else moved
    rotors = {i: motor for _, motor, i in _motors(robot)}
    links, notes = list(robot.links), list[str]()
    motor, d = (robot.links[0].motor if robot.links else None), robot.joints[0].d
    if motor is not None and not (_is_zero(robot, motor.mass) or _is_zero(robot, d)):
        notes.append(
            f"the rotor of joint 1 stands {cell_text(d)} {'further' if to_modified else 'less far'} along its axis in "
            "this convention: the potential energy differs by a constant, and nothing else does"
        )
    for i, (link, row) in enumerate(zip(robot.links, rows, strict=False)):
        # Both DH frames of this link coincide, and so do its parameters.
        if row.is_one and i not in rotors:
            continue
        behind, domain = cells.factor(row), cells.domain
        body = _Body(link.mass, constant_vector(link.com, domain), central_inertia(link, domain).matrix)
        # First into the joint frame, where rotors are; then, if the frame behind is wanted, back through X_i.
        body = body.through(behind) if to_modified else body
        if i in rotors:
            body, note = _made_up(body, robot, rotors[i], i, behind, domain)
            notes.append(note)
            if body.mass != link.mass:
                links[i + 1] = replace(links[i + 1], motor=replace(rotors[i], mass=ZERO))
        body = body if to_modified else body.through(behind.inverse)
        known, entries = [getattr(link.inertia, key) for key in INERTIA], vectors.from_matrix(body.inertia)
        inertia = Inertia(**{key: cells.cell(getattr(entries, key), known) for key in INERTIA})
        x, y, z = (cells.cell(entry, link.com) for entry in body.com)
        links[i] = replace(links[i], mass=body.mass, com=(x, y, z), inertia=inertia)
    return tuple(links), notes


def _made_up(
    body: _Body, robot: Robot, motor: Motor, i: int, behind: Frame[Polynomial], domain: PolynomialDomain
) -> tuple[_Body, str]:
    """A link, in its joint frame, that has the same inertia together with the next rotor at its new place as before.

    Mass, first moment and second moments of both together stay: with the rotor's mass mu moved by delta, the centre of
    mass goes back by mu/m delta.
    """
    to_modified = robot.convention is Convention.STANDARD
    joint, mu = robot.joints[i + 1], domain.constant(motor.mass)
    along = vectors.scale(domain.constant(joint.d), vectors.column(behind.rotation, 2))
    # o_{i-1}, and d_i further on the axis of the rotor's joint.
    places = (behind.position, vectors.add(behind.position, along))
    old, new = places if to_modified else places[::-1]
    way = f"{cell_text(joint.d)} {'further' if to_modified else 'less far'} along its axis in this convention"
    if _is_zero(robot, body.mass):
        note = f"the rotor of joint {i + 2} would stand {way}: link {i + 1}, without mass, has the rotor's mass now"
        return _Body(motor.mass, old, body.inertia), note
    m = domain.constant(body.mass)
    # m c + mu r stays: c' = c - mu/m (r' - r).
    back = vectors.scale(mu * domain.constant(tree.power(body.mass, -1)), vectors.subtract(new, old))
    com = vectors.subtract(body.com, back)
    # I' = I + St(m, c) + St(mu, r) - St(m, c') - St(mu, r')
    before = (vectors.steiner(m, body.com).matrix, vectors.steiner(mu, old).matrix)
    after = (vectors.steiner(-m, com).matrix, vectors.steiner(-mu, new).matrix)
    inertia = reduce(vectors.add_matrices, (*before, *after), body.inertia)
    note = f"the rotor of joint {i + 2} stands {way}: com and inertia of link {i + 1} make up for its mass"
    return _Body(body.mass, com, inertia), note


def has_equal_poses(conversion: Conversion) -> bool:
    """Whether both tables, multiplied out in exact arithmetic, give one T."""
    source, result = conversion.source, Robot.of(conversion.result)
    values, angles = robot_cells(result)
    calls = [Call(name, (angle,)) for angle in angles for name in ("cos", "sin")]
    domain = PolynomialDomain(source, [*values, *calls], rates=False)
    ours, theirs = (forward_kinematics(build_chain(robot, domain)) for robot in (source, result))
    return ours == theirs
