"""Where the Jacobian of an arm loses rank: the zeros of the determinant of a task in factors, or those of all minors.

An arm with a task of as many coordinates as joints is judged by its determinant, as is one of six joints. Any other is
singular where the rank of J is less than usual, `derive.model.singularities.rank`.

Everything is exact: the factors multiply to the determinant as polynomials modulo s^2 + c^2 = 1. Their rational factors
are moved where a reader expects them: 0.43*c2 + 0.41*s23, not 43*c2 + 41*s23.
"""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from fractions import Fraction
from itertools import combinations
from math import gcd, lcm

import sympy

from derive.algebra.domain import PolynomialDomain
from derive.algebra.factors import Factor, Factoring
from derive.algebra.generators import Kind
from derive.algebra.ring import Polynomial, TooManyTerms
from derive.lecture.form import LectureForm
from derive.lecture.sympy_conversion import Expr, expression_to_sympy
from derive.mechanics.exact_kinematics import Kinematics
from derive.model.singularities.blocks import matrices, square_blocks, task_words
from derive.model.singularities.rank import Zero, rank_loss
from derive.model.singularities.real_zeros import RealZeros
from derive.model.singularities.singularities import (
    Condition,
    JacobianBlock,
    Outcome,
    Posture,
    SingularFactor,
    Singularities,
)
from derive.robot.expression import Number
from derive.robot.options.inverse import FREEDOMS, POSE
from derive.robot.options.style import Contraction, Style
from derive.robot.robot import Robot

MAX_DET_TERMS = 20_000  # budget of any polynomial on the way to the determinant
MAX_JOINTS = 10  # of longer arms no closed form is looked for
MAX_MINOR_TERMS = 3_000

Write = Callable[[Polynomial], Expr]
MOST_WHOLE = 10**9  # whole numbers that are larger read no better than decimals


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
    determinants = [block.determinant() for block in blocks]
    if not blocks or not all(determinants):
        return None
    written = []
    for b in blocks:
        matrix = sympy.ImmutableMatrix([[write(entry) for entry in row] for row in b.entries])
        written.append(JacobianBlock(b.name, b.rows, b.columns, b.reference, b.others_are_zero, matrix))
    found = []
    for factor in _factors(zeros, determinants):
        if zeros.vanishes(factor.value):
            return None
        expression = write(factor.value)
        is_position, has_wrist = blocks[0].task == ("position",), len(blocks) == 2
        condition = zero_condition(zeros, factor, expression, write, is_position=is_position, has_wrist=has_wrist)
        found.append(SingularFactor(expression, factor.exponent, condition, bool(zeros.moving(factor.value))))
    determinant = sympy.Mul(*(f.expression**f.exponent for f in found))
    families = tuple((f.condition,) for f in found if f.condition is not None)
    outcome = Outcome.FOUND if families else Outcome.NEVER
    shape, task = (robot.n, robot.n), blocks[0].task
    return Singularities(outcome, tuple(written), determinant, tuple(found), task, shape, robot.n, families)


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
    if loss.rank < min(shape):
        outcome = Outcome.EVERYWHERE
    elif families:
        outcome = Outcome.FOUND
    else:
        outcome = Outcome.NEVER if loss.complete else Outcome.UNSOLVED
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
        posture = Posture.WRIST
    elif articulated and elbow:
        posture = {(2,): Posture.ELBOW, (1, 2): Posture.SHOULDER}.get(joints)
    certain = exists is True or bool(values)
    return Condition(expression, variable, values, posture, tuple(j + 1 for j in joints), certain)


def _in_one_turn(angle: Expr) -> Expr:
    """An angle with its multiple of pi in (-1, 1]."""
    turns = sympy.ceiling((angle.coeff(sympy.pi) - 1) / 2)
    return angle - 2 * turns * sympy.pi


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
