"""What the generators of a robot's ring stand for, and which of them a set of expressions needs.

The ring must know its generators before any expression can become a polynomial, so the expressions are read twice:
here for what they contain, in `derive.algebra.domain` for what they are.
"""

from collections.abc import Iterable
from dataclasses import dataclass, field
from enum import Enum
from fractions import Fraction
from math import isqrt, lcm

from derive.algebra.angles import ExactAngle, decompose
from derive.robot import tree
from derive.robot.description import INERTIA, derivatives
from derive.robot.expression import Call, Expression, Name, Number, Pi, Power, Product, Sum, children, power, rebuilt
from derive.robot.robot import Robot


class Kind(Enum):
    """What a generator stands for."""

    INVERSE = "inverse"
    ROOT = "root"
    PRIME_ROOT = "prime root"
    SINE = "sine of a joint angle"
    COSINE = "cosine of a joint angle"
    CONSTANT_SINE = "sine of a constant angle"
    CONSTANT_COSINE = "cosine of a constant angle"
    VARIABLE = "prismatic variable"
    ACCELERATION = "acceleration"
    RATE = "rate"
    PARAMETER = "parameter"
    PI = "pi"


MOVING = frozenset({Kind.SINE, Kind.COSINE, Kind.VARIABLE})  # generators that joint variables enter
_FUNCTIONS = {
    Kind.SINE: "sin",
    Kind.COSINE: "cos",
    Kind.CONSTANT_SINE: "sin",
    Kind.CONSTANT_COSINE: "cos",
    Kind.ROOT: "sqrt",
    Kind.PRIME_ROOT: "sqrt",
}


@dataclass(frozen=True, slots=True)
class Generator:
    """One generator of the ring."""

    kind: Kind  # what it stands for
    name: str  # unique name in the ring
    argument: Expression  # the expression that it is a function of (the symbol itself for names)
    joint: int = -1  # index of the joint it belongs to, or -1
    partner: str = ""  # name of the cosine of the angle whose sine it is, and the other way round; else empty

    @property
    def expression(self) -> Expression:
        """What it stands for."""
        if self.kind is Kind.INVERSE:
            return power(self.argument, -1)
        function = _FUNCTIONS.get(self.kind)
        return Call(function, (self.argument,)) if function else self.argument


def sine_and_cosine(angle: Expression, key: str, joint: int = -1) -> tuple[Generator, Generator]:
    """The generators for the sine and the cosine of one angle, partners of each other."""
    kinds = (Kind.SINE, Kind.COSINE) if joint >= 0 else (Kind.CONSTANT_SINE, Kind.CONSTANT_COSINE)
    sine, cosine = f"sin {key}", f"cos {key}"
    return Generator(kinds[0], sine, angle, joint, cosine), Generator(kinds[1], cosine, angle, joint, sine)


# Largest multiple of one angle unit that is expanded by the addition theorem: cos(24 a) has 13 terms in cos(a).
MAX_MULTIPLE = 24
MAX_UNITS = 4
"""Most constant units of one angle that are told apart; the addition theorem for k units has 2^(k-1) terms, so a longer
sum is one unit."""

# Angles (multiples of pi, up to sign and right angles) whose cosine and sine are square roots of these primes.
SPECIAL: dict[Fraction, tuple[int, ...]] = {
    Fraction(0): (),
    Fraction(1, 4): (2,),
    Fraction(1, 6): (3,),
    Fraction(1, 12): (2, 3),
}


def canonical(e: Expression) -> Expression:
    """The tree with the terms of sums and the factors of products in a fixed order."""
    ordered = rebuilt(e, canonical, folds=False)
    match ordered:
        case Sum(terms):
            return Sum(tuple(sorted(terms, key=repr)))
        case Product(factors):
            return Product(tuple(sorted(factors, key=repr)))
        case _:
            return ordered


def scaled(unit: Expression, k: Fraction) -> Expression:
    """A multiple of an angle unit, in the form in which it names a generator."""
    return unit if k == 1 else Product((Number(k), unit))


def split_pi(multiple: Fraction) -> tuple[int, Fraction]:
    """A multiple of pi as right angles and a rest of at most half of one: multiple = quarter/2 + rest."""
    quarter = round(multiple * 2)
    rest = multiple - Fraction(quarter, 2)
    if rest == Fraction(-1, 4):
        quarter, rest = quarter - 1, Fraction(1, 4)
    return quarter % 4, rest


def square_free(value: Fraction) -> tuple[Fraction, tuple[int, ...]]:
    """The square root of a positive rational as factor * product of sqrt(p)."""
    # sqrt(n/d) = sqrt(n d)/d: trial division takes out squares, and single primes under the root
    number = value.numerator * value.denominator
    factor, primes = Fraction(1, value.denominator), []
    p = 2
    while p * p <= number and p < 10_000:
        while number % (p * p) == 0:
            number //= p * p
            factor *= p
        if number % p == 0:
            number //= p
            primes.append(p)
        p += 1
    root = isqrt(number)  # what no small prime divides may still be a square; else it stays under the root whole
    return (factor * root, tuple(primes)) if root * root == number else (factor, (*primes, number))


@dataclass
class Atoms:
    """What a set of expressions needs beyond rational numbers, in order of first appearance."""

    joints: frozenset[str] = frozenset()  # names of joint angles, given
    names: dict[str, None] = field(default_factory=dict)  # plain symbols
    # Angle units, each with the common denominator of its coefficients.
    units: dict[Expression, int] = field(default_factory=dict)
    # The absolute coefficients that occur of each unit.
    multiples: dict[Expression, dict[Fraction, None]] = field(default_factory=dict)
    # Constant angles rest*pi in (0, 1/4) that are not special.
    pi_rests: dict[Fraction, None] = field(default_factory=dict)
    primes: dict[int, None] = field(default_factory=dict)  # primes whose square roots are needed
    roots: dict[Expression, None] = field(default_factory=dict)  # radicands of the other square roots, innermost first
    inverses: dict[Expression, None] = field(default_factory=dict)  # denominators, innermost first
    has_pi: bool = False  # whether pi occurs outside of angles
    angles: set[Expression] = field(default_factory=set)  # those recorded: formulas have the same few again and again

    def is_common(self, unit: Expression) -> bool:
        """Whether all multiples of a unit are expanded by the addition theorem from one common part."""
        return max(self.multiples[unit]) * self.units[unit] <= MAX_MULTIPLE

    def add_angle(self, e: Expression) -> None:
        """Record what the sine and cosine of an angle need."""
        if e in self.angles:
            return
        self.angles.add(e)
        exact = bundled(decompose(canonical(e)), self.joints)
        rest = abs(split_pi(exact.pi_multiple)[1])
        if rest in SPECIAL:
            self.primes.update(dict.fromkeys(SPECIAL[rest]))
        else:
            self.pi_rests[rest] = None
        for unit, k in exact.terms:
            if unit == Number(Fraction(1)):
                unit, k = Number(abs(k)), Fraction(1)
            self.units[unit] = lcm(self.units.get(unit, 1), k.denominator)
            self.multiples.setdefault(unit, {})[abs(k)] = None

    def add_value(self, e: Expression) -> None:
        """Record what an expression needs."""
        match e:
            case Pi():
                self.has_pi = True
            case Name(name):
                self.names[name] = None
            case Power(base, exponent):
                self.add_value(base)
                if exponent < 0 and not isinstance(base, Number):
                    self.inverses[canonical(base)] = None
            case Call("sqrt", (Number(radicand),)):
                if radicand > 0:
                    self.primes.update(dict.fromkeys(square_free(radicand)[1]))
            case Call("sqrt", (argument,)):
                self.add_value(argument)
                self.roots[canonical(argument)] = None
            case Call("cos" | "sin" | "tan" as function, (argument,)):
                self.add_angle(argument)
                if function == "tan":
                    self.inverses[canonical(Call("cos", (argument,)))] = None
            case _:
                for child in children(e):
                    self.add_value(child)


def bundled(exact: ExactAngle, joints: frozenset[str]) -> ExactAngle:
    """The angle with its constant units as one, where there are so many that their addition theorem explodes."""
    constant = [(u, k) for u, k in exact.terms if not (isinstance(u, Name) and u.name in joints)]
    if len(constant) <= MAX_UNITS:
        return exact
    moving = [term for term in exact.terms if term not in constant]
    whole = canonical(Sum(tuple(Product((Number(k), u)) for u, k in constant)))
    return ExactAngle(exact.pi_multiple, (*moving, (whole, Fraction(1))))


def collect(values: Iterable[Expression], angles: Iterable[Expression], joints: frozenset[str] = frozenset()) -> Atoms:
    """What some expressions need of a ring, and the sines and cosines of constant angles [rad]."""
    atoms = Atoms(joints)
    for e in angles:
        atoms.add_angle(e)
    for e in values:
        atoms.add_value(e)
    return atoms


def robot_cells(robot: Robot) -> tuple[list[Expression], list[Expression]]:
    """Every expression of a robot that its ring must hold: cells that are values, and angles of the table [rad]."""
    values = [cell for joint in robot.joints for cell in (joint.a, joint.d)]
    values += [cell for matrix in (robot.base, robot.tool) for row in matrix for cell in row]
    values += robot.gravity or ()
    for link in robot.links:
        values += (link.mass, *link.com, link.armature, link.viscous, *link.dry)
        values += (getattr(link.inertia, key) for key in INERTIA)
        if link.motor is not None:
            values += (link.motor.mass, link.motor.inertia, link.motor.ratio)
    more_values, more_angles = tree.constant_cells(robot)
    values = values + [factor for joint in robot.joints for _, factor in joint.drive] + [*derivatives(robot).values()]
    angles = [angle for joint in robot.joints for angle in (joint.theta, joint.alpha)]
    return values + more_values, angles + more_angles
