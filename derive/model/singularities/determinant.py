"""Where the Jacobian of an arm loses rank: the zeros of the determinant of a task in factors, or those of all minors.

An arm with a task of as many coordinates as joints is judged by its determinant, as is one of six joints. Any other is
singular where the rank of J is less than usual, `derive.model.singularities.rank`. A task is that of the robot file;
else the one that is natural for the arm: the coordinates in which it moves if these are as many as its joints (the
plane of a planar arm and the turn about its normal, x, y, z and the turn of a SCARA, the orientation of a wrist), the
position for three other joints, the position in its plane for two. Rows are those of the world, or of frame 0 where the
base is slanted, since the rank is the same and the entries are not.

Six joints: all of J, about the wrist centre if axes 4, 5 and 6 meet there, for then J_12 = 0 and det J = det J_11 det
J_22 (Siciliano et al., Robotics, sec. 3.3.1).

Everything is exact: the factors multiply to the determinant as polynomials modulo s^2 + c^2 = 1. Their rational factors
are moved where a reader expects them: 0.43*c2 + 0.41*s23, not 43*c2 + 41*s23.
"""

from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from fractions import Fraction
from itertools import combinations
from math import gcd, lcm

import sympy

from derive.algebra.domain import PolynomialDomain
from derive.algebra.factors import Factor, Factoring
from derive.algebra.generators import Kind
from derive.algebra.ring import Polynomial, TooManyTerms, determinant
from derive.lecture.form import LectureForm
from derive.lecture.sympy_conversion import Expr, expression_to_sympy
from derive.mechanics.exact import JacobianColumn, Kinematics, Reference, jacobian_columns
from derive.mechanics.vectors import column, dot
from derive.model.singularities import singularities
from derive.model.singularities.rank import RealZeros, Zero, rank_loss
from derive.model.singularities.singularities import Condition, JacobianBlock, Outcome, SingularFactor, Singularities
from derive.robot.expression import ONE, ZERO, Number, number
from derive.robot.options.inverse import FREEDOMS, POSE, TASKS
from derive.robot.options.style import Contraction, Style
from derive.robot.robot import Robot

ALL = (1, 2, 3, 4, 5, 6)
MAX_DET_TERMS = 20_000  # budget of any polynomial on the way to the determinant
MAX_JOINTS = 10  # of longer arms no closed form is looked for
MAX_MINOR_TERMS = 3_000
Write = Callable[[Polynomial], Expr]
MOST_WHOLE = 10**9  # whole numbers that are larger read no better than decimals


def square_blocks(kinematics: Kinematics) -> tuple[JacobianBlock, ...]:
    """The diagonal blocks whose determinants multiply to the wanted one; none where no square one decides."""
    robot = kinematics.robot
    if robot.inverse.task != POSE:
        is_square = sum(FREEDOMS.get(word, 1) for word in robot.inverse.task) == robot.n
        return (min(_task_rows(kinematics), key=_length),) if is_square else ()
    if robot.n < 5:
        return next(((block,) for block in _candidates(kinematics) if determinant(block.matrix)), ())
    if robot.n != 6:
        return ()
    for point in (4, 5, 3, 6) if all(joint.is_revolute for joint in robot.joints[3:]) else ():
        # Joints 4, 5, 6 do not move a point on all their axes: the linear parts of their columns are zero. About this
        # wrist centre J_12 = 0, and the determinant is det J_11 det J_22.
        columns = jacobian_columns(kinematics, Reference(point, point))
        if not any(entry for column in columns[3:] for entry in column[:3]):
            references, halves = [Reference(k, point) for k in range(7)], (("J_11", ALL[:3]), ("J_22", ALL[3:]))
            return tuple(_shortest(kinematics, name, places, references) for name, places in halves)
    return (_shortest(kinematics, "J", ALL, [Reference(k, k) for k in range(7)]),)


def _shortest(
    kinematics: Kinematics, name: str, places: tuple[int, ...], references: Sequence[Reference]
) -> JacobianBlock:
    """The diagonal block about the reference where its entries have the fewest terms; the first of equals."""
    return min((_block(name, places, places, r, jacobian_columns(kinematics, r)) for r in references), key=_length)


def _length(block: JacobianBlock) -> int:
    return sum(len(entry) for row in block.matrix for entry in row)


def matrices(kinematics: Kinematics) -> Iterator[Sequence[Sequence[Polynomial]]]:
    """Rows of J that decide for an arm without a square block, in several axes and about several points."""
    robot = kinematics.robot
    if robot.inverse.task != POSE:
        yield from (block.matrix for block in _task_rows(kinematics))
        return
    for k in range(robot.n + 1) if robot.n <= 7 else (robot.n // 2,):
        with suppress(TooManyTerms):
            yield tuple(zip(*jacobian_columns(kinematics, Reference(k, k)), strict=True))


def task_words(task: Sequence[str]) -> tuple[str, ...]:
    """A task of the robot file with its name, where it has one: ``position``."""
    return next(((name,) for name, rows in TASKS.items() if rows == tuple(task)), tuple(task))


def _task_rows(kinematics: Kinematics) -> Iterator[JacobianBlock]:
    """The Jacobian of the file's task, in all axes that it allows; the two of the approach are the end effector's."""
    robot, turn, derivative = kinematics.robot, kinematics.end.rotation, kinematics.domain.derivative
    task, joints, angular = robot.inverse.task, range(robot.n), kinematics.angular_columns(robot.n)
    is_turned = len({"x", "y", "z"} & set(task)) in (0, 3)
    for frame in (None, *range((robot.n + 1) * is_turned)):
        of_arm = tuple(zip(*jacobian_columns(kinematics, Reference(frame)), strict=True))
        numbers, rows = list[int](), list[tuple[Polynomial, ...]]()
        for word in task:
            if word == "phi":  # the numerator of the derivative of atan2(r21, r11)
                across, along = turn[1][0], turn[0][0]
                rows.append(tuple(along * derivative(across, k) - across * derivative(along, k) for k in joints))
            elif word == "approach":
                rows += [tuple(dot(column(turn, i), w) for w in angular) for i in (0, 1)]
            else:
                numbers += [4, 5, 6] if word == "orientation" else ["xyz".index(word) + 1]
                rows += [of_arm[number - 1] for number in numbers[len(rows) :]]
        known = tuple(numbers) if len(numbers) == len(rows) else ()
        columns = tuple(joint + 1 for joint in joints)
        yield JacobianBlock("J", known, columns, Reference(frame), False, tuple(rows), task_words(task))


def _candidates(kinematics: Kinematics) -> Iterator[JacobianBlock]:
    """Blocks of all columns of an arm with a natural task, in the order in which they are preferred."""
    n, base = kinematics.robot.n, kinematics.robot.base
    # A slanted base turns frame 0 so that its axes are none of the world.
    is_straight = all(cell in (ZERO, ONE, number(-1)) for row in base[:3] for cell in row[:3])
    end = Reference(frame=None if is_straight else 0)
    columns = tuple(range(1, n + 1))
    yield from _nonzero_rows(kinematics, [Reference(), Reference(frame=0)])
    if n == 3:
        yield _block("J", (1, 2, 3), columns, end, jacobian_columns(kinematics, end))
    frames = (None, *range(n + 1))
    yield from _nonzero_rows(kinematics, [Reference(k, m) for m in (None, *range(n + 1)) for k in frames])


def _nonzero_rows(kinematics: Kinematics, references: Sequence[Reference]) -> Iterator[JacobianBlock]:
    """The coordinates in which an arm moves, where they are as many as the joints; of two joints in a plane its own."""
    n = kinematics.robot.n
    for reference in references:
        columns = jacobian_columns(kinematics, reference)
        rows = tuple(r for r in ALL if any(column[r - 1] for column in columns))
        linear, angular = (tuple(r for r in rows if (r > 3) == is_turn) for is_turn in (False, True))
        if n == 2 and reference.point is None and (len(linear), len(angular)) == (2, 1):
            rows = linear
        if len(rows) == n and (len(angular) <= 1 or rows == (4, 5, 6)):
            yield _block("J", rows, tuple(range(1, n + 1)), reference, columns)


def _block(
    name: str, rows: tuple[int, ...], columns: tuple[int, ...], reference: Reference, entries: Sequence[JacobianColumn]
) -> JacobianBlock:
    chosen = tuple(tuple(entries[c - 1][r - 1] for c in columns) for r in rows)
    others = (entries[c - 1][r - 1] for c in columns for r in ALL if r not in rows)
    # What the rows are the velocities of.
    turns = rows[sum(r <= 3 for r in rows) :]
    names = ("x", "y", "z", "rotation about x", "rotation about y", "phi" if len(turns) == 1 else "rotation about z")
    words = ("orientation",) if turns == (4, 5, 6) else task_words([names[r - 1] for r in rows])
    return JacobianBlock(name, rows, columns, reference, not any(others), chosen, (words if len(entries) < 6 else ()))


def find_singularities(robot: Robot, style: Style | None = None) -> Singularities:
    """Where the Jacobian of a robot loses rank."""
    if robot.n == 1 and robot.inverse.task == POSE:
        return Singularities(Outcome.NEVER, shape=(6, 1), rank=1)
    chosen, stated = style or robot.style, robot.inverse.task
    rows = sum(FREEDOMS.get(word, 1) for word in stated)
    for derived in (_of_determinant, _of_minors) if robot.n <= MAX_JOINTS else ():
        with suppress(TooManyTerms):
            if found := derived(robot, chosen):
                return found
    task = () if stated == POSE else task_words(stated)
    return Singularities(Outcome.UNSOLVED, task=task, shape=(rows, robot.n), complete=False)


def _of_determinant(robot: Robot, style: Style) -> Singularities | None:
    """By the determinant of a task; None where there is no such task, or it is zero everywhere."""
    domain = PolynomialDomain(robot, contraction=style.contraction, rates=False, offsets=True, max_terms=MAX_DET_TERMS)
    write, zeros = LectureForm(domain, style=style).kinematic, RealZeros(domain)
    blocks = square_blocks(Kinematics(robot, domain))
    determinants = [determinant(block.matrix) for block in blocks]
    if not blocks or not all(determinants):
        return None
    shown = (sympy.ImmutableMatrix([list(map(write, row)) for row in block.matrix]) for block in blocks)
    written = tuple(replace(block, matrix=matrix) for block, matrix in zip(blocks, shown, strict=True))
    found = []
    for factor in _factors(zeros, determinants):
        if zeros.vanishes(factor.value):
            return None
        expression = write(factor.value)
        is_position, has_wrist = blocks[0].task == ("position",), len(blocks) == 2
        condition = zero_condition(zeros, factor, expression, write, is_position=is_position, has_wrist=has_wrist)
        found.append(SingularFactor(expression, factor.exponent, condition, zeros.moves(factor.value)))
    product = sympy.Mul(*(f.expression**f.exponent for f in found))
    families = tuple((f.condition,) for f in found if f.condition is not None)
    outcome = Outcome.FOUND if families else Outcome.NEVER
    shape, task = (robot.n, robot.n), blocks[0].task
    return Singularities(outcome, written, product, tuple(found), task, shape, robot.n, families)


def _of_minors(robot: Robot, style: Style) -> Singularities:
    """By the common zeros of the largest minors of the file's task, else of J."""
    contraction, most = Contraction.OPPOSED, MAX_MINOR_TERMS
    domain = PolynomialDomain(robot, contraction=contraction, rates=False, offsets=True, max_terms=most)
    write, zeros = LectureForm(domain, style=style).kinematic, RealZeros(domain)
    loss = rank_loss(domain, matrices(Kinematics(robot, domain)))

    def _condition(zero: Zero) -> Condition:
        _, factor = _scaled(domain, zero.factor, [])
        found = zero_condition(zeros, factor, write(factor.value), write, is_position=False, has_wrist=False)
        if found is None or zero.value is None or found.variable is None:
            return found or Condition(write(factor.value), None, (), None, ())
        value = found.values[zero.value]
        return replace(found, expression=found.variable - value, values=(value,))

    families = tuple(_together([_condition(zero) for zero in family]) for family in loss.families)
    alone = tuple(SingularFactor(family[0].expression, 1, family[0]) for family in families if len(family) == 1)
    task = () if robot.inverse.task == POSE else task_words(robot.inverse.task)
    shape = (sum(FREEDOMS.get(word, 1) for word in robot.inverse.task), robot.n)
    alike = Outcome.NEVER if loss.complete else Outcome.UNSOLVED
    outcome = Outcome.EVERYWHERE if loss.rank < min(shape) else Outcome.FOUND if families else alike
    zero = sympy.S.Zero if outcome is Outcome.EVERYWHERE else None
    unless = tuple(map(write, loss.unless))
    return Singularities(outcome, (), zero, alone, task, shape, loss.rank, families, loss.complete, unless)


def _together(family: list[Condition]) -> tuple[Condition, ...]:
    """Conditions that hold together: one without solutions may have none where another one moves its joints."""
    shared = {joint for a, b in combinations(family, 2) for joint in {*a.joints} & {*b.joints}}
    return tuple(c if c.values or shared.isdisjoint(c.joints) else replace(c, is_certain=False) for c in family)


def _factors(zeros: RealZeros, determinants: list[Polynomial]) -> list[Factor]:
    """The factors of all blocks: one number, what does not move, then what does, from the base outwards."""
    domain, robot, factoring = zeros.domain, zeros.domain.robot, Factoring(zeros.domain)
    cells = [cell for joint in robot.joints for cell in (joint.a, joint.d)] + [row[3] for row in robot.tool[:3]]
    lengths = sorted({abs(cell.value) for cell in cells if isinstance(cell, Number) and cell.value})
    number, powers = domain.ring.one, dict[Polynomial, Factor]()
    for p in determinants:
        for factor in factoring.factors(p):
            scale, scaled = _scaled(domain, factor, lengths)
            number = number * scale
            known = powers.get(scaled.value)
            exponent = scaled.exponent + (known.exponent if known else 0)
            powers[scaled.value] = Factor(scaled.value, exponent, scaled.kind, scaled.joints)
    rest = [f for f in powers.values() if f.value != 1]
    rest.sort(key=lambda factor: zeros.moving(factor.value))
    return [Factor(number, 1)] * (number != 1) + rest


def _scaled(domain: PolynomialDomain, factor: Factor, lengths: list[Fraction]) -> tuple[Polynomial, Factor]:
    """A rational power and a factor whose product is the one given.

    The coefficients of a sum become numeric lengths of the robot if one number makes all of them so, else whole numbers
    without a common divisor, or decimals up to 1 where these would be beyond `MOST_WHOLE`; most of them positive.
    """
    ring, p = domain.ring, factor.value
    if factor.kind is not None:
        return ring.one, factor
    if p.is_constant:
        return p**factor.exponent, Factor(ring.one, 1)
    coefficients = [c for _, c in p.terms()]
    positive = sum(1 if c > 0 else -1 for c in coefficients) or coefficients[0]
    sizes = [abs(c) for c in coefficients]
    # Whole coefficients without a common divisor, unless one number makes all of them lengths of the robot.
    common = Fraction(lcm(*(c.denominator for c in sizes)), gcd(*(c.numerator for c in sizes)))
    if max(sizes) * common > MOST_WHOLE:
        common = 1 / max(sizes)
    scales = [length / sizes[0] for length in lengths] if len(sizes) > 1 else []
    scale = next((scale for scale in scales if all(scale * c in lengths for c in sizes)), common)
    scale = scale if positive > 0 else -scale
    return ring.number(Fraction(1) / scale) ** factor.exponent, Factor(p * scale, factor.exponent)


# -- where a factor is zero: an equation, its solutions where they can be read off, and the name of the posture


def zero_condition(
    zeros: RealZeros, factor: Factor, expression: Expr, write: Write, *, is_position: bool, has_wrist: bool
) -> Condition | None:
    """Where a factor of the determinant is zero; None if it does not move, or is never zero."""
    joints, domain = zeros.moving(factor.value), zeros.domain
    exists = bool(joints) and zeros.exist([factor.value])
    if exists is False:
        return None
    variable: Expr | None = None
    values: tuple[Expr, ...] = ()
    if factor.kind is not None:  # a sine or cosine alone
        variable = expression_to_sympy(domain.angle_sum(factor.joints))
        angles = (sympy.S.Zero, sympy.pi) if factor.kind is Kind.SINE else (-sympy.pi / 2, sympy.pi / 2)
        offset = expression_to_sympy(domain.offset_sum(factor.joints))
        values = tuple(_in_one_turn(angle - offset) for angle in angles)
    elif len(joints) == 1:
        values = _solved(domain, factor.value, joints[0], write)
        variable = sympy.Symbol(domain.robot.joints[joints[0]].variable) if values else None
    robot, posture = domain.robot, None
    articulated = all(joint.is_revolute for joint in robot.joints[:3]) and (has_wrist or is_position)
    elbow = any({1, 2} <= set(group) and 0 not in group for group in domain.groups)
    if has_wrist and joints == (4,):
        posture = singularities.Posture.WRIST
    elif articulated and elbow:
        posture = {(2,): singularities.Posture.ELBOW, (1, 2): singularities.Posture.SHOULDER}.get(joints)
    certain = exists is True or bool(values)
    return Condition(expression, variable, values, posture, tuple(j + 1 for j in joints), certain)


def _in_one_turn(angle: Expr) -> Expr:
    """An angle with its multiple of pi in (-1, 1]."""
    return angle - 2 * sympy.ceiling((angle.coeff(sympy.pi) - 1) / 2) * sympy.pi


def _solved(domain: PolynomialDomain, p: Polynomial, joint: int, write: Write) -> tuple[Expr, ...]:
    """q of k*q + rest = 0 where k is a number; both angles of a*c + b*s = 0, the arc tangents of -a/b."""
    slope = domain.derivative(p, joint)
    if not domain.robot.joints[joint].is_revolute:
        if not slope.is_constant:
            return ()
        rest = p - slope * domain.ring.generator(domain.robot.joints[joint].variable)
        return (write(rest * (-1 / slope.constant_term)),)
    # p = a c + b s + rest and dp/dq = b c - a s give a and b; both must be free of joint variables.
    c, s = domain.cosine_sine_of(joint, offset=True)
    offset = expression_to_sympy(domain.offsets[joint])
    a, b = p * c - slope * s, p * s + slope * c
    if any(domain.derivative(p, j) for p in (a, b) for j in range(domain.robot.n)):
        return ()
    ways = (sympy.atan2(write(-a), write(b)), sympy.atan2(write(a), write(-b)))
    return tuple(_in_one_turn(way - offset) for way in ways)
