"""The model of a robot: every quantity in closed form, computed once when asked for, as plain SymPy."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from functools import cached_property
from math import gcd, lcm
from typing import TYPE_CHECKING, Any

import sympy

from derive.algebra.generators import MOVING
from derive.algebra.ring import Polynomial
from derive.errors import QuantityError, listed
from derive.lecture.plan import Terms, partition
from derive.lecture.point import at_point
from derive.lecture.sympy_conversion import Expr, Matrix
from derive.model.decoupling import Decoupling, find_decoupling
from derive.model.dynamic_model import DynamicModel
from derive.model.ends import OfEnds
from derive.model.equality import verdict
from derive.model.quantities import DESCRIBED
from derive.model.quantity_names import evaluate, parse
from derive.robot.cells import typed_point
from derive.robot.names import robot_symbols
from derive.robot.rounding import DIGITS

if TYPE_CHECKING:  # the inverse kinematics takes long to import
    from derive.model.closure import Closure


class Model(DynamicModel):
    """Closed forms of one robot.

    Every quantity is an immutable SymPy matrix or an expression in the robot's own symbols, which are plain
    ``sympy.Symbol``s; ``qd1`` and ``qdd1`` are velocity and acceleration of ``q1``. Matrices of the end effector are in
    the world frame unless they say otherwise, lengths in metres, angles in radians.

    Args:
        robot: The robot.
        style: How expressions are grouped: a `Style`, the name of a set of options (``compact``, ``by-geometry``,
            ``expanded``) or options by name, see `Style.of`; default as the file says.
        contraction: Which sums of angles are contracted: ``aligned`` or ``opposed``; default as the file says.

    Attributes:
        robot: The robot.
        style: How expressions are grouped.
        q: Joint variables [rad or m].
        qd: Their velocities.
        qdd: Their accelerations.
    """

    @cached_property
    def decoupling(self) -> Decoupling:
        """Which entries of B beside the diagonal are zero, and with which lengths, masses and inertias all are.

        Spong, Hutchinson and Vidyasagar, Robot Modeling and Control, 2006, chapter on dynamics.
        """
        return find_decoupling(self)

    def abbreviated(self, quantity: str, by: str | None = None) -> tuple[Expr, Mapping[Expr, Expr]]:
        """A dynamic quantity with short names, and what the names mean.

        Args:
            quantity: ``B``, ``C``, ``N``, ``Bdot``, ``g`` or ``tau``.
            by: ``christoffel`` (default for C, N, Bdot and tau) names the Christoffel symbols, ``h*(qd1 + qd2)``;
                ``coefficients`` (default for B and g) names the linear combinations of constants, ``a1 + 2*a2*c2``.

        Returns:
            The matrix, and symbol to expression for every name in it.

        Raises:
            QuantityError: No such quantity or way.
        """
        row, indices, entry = parse(self, quantity)
        return abbreviate(self, row.name if not indices and entry is None else quantity, by)

    @cached_property
    def closure(self) -> Closure:
        """How the passive joints of closed loops follow the variables: positions, and the derivatives G and H.

        Raises:
            QuantityError: The robot has no loops, or one that cannot be solved in closed form.
        """
        if not self.robot.passive:
            remedy = "write loops: in the robot file; those of parallelograms are coupled joints, without G and H"
            raise QuantityError(f"closed loops of {self.robot.name}, which has none", remedy=remedy)
        from derive.model.closure import find_closure

        return find_closure(self)

    def quantity(self, name: str) -> Expr:
        """A quantity by its name.

        Args:
            name: As `derive show` takes it, for instance ``T[1,4]`` or ``christoffel[1,1,2]``.

        Returns:
            The matrix or expression; of ``workspace`` and ``aspects`` what describes them.

        Raises:
            QuantityError: No such quantity or entry.
        """
        return getattr(self, name) if name in DESCRIBED else evaluate(self, name)

    def at(
        self,
        quantity: str,
        q: Sequence[float | str] = (),
        *,
        qd: Sequence[float | str] = (),
        qdd: Sequence[float | str] = (),
        values: Mapping[str, float | str] | None = None,
        exact: bool = False,
        digits: int | None = DIGITS,
    ) -> Expr:
        """A quantity in numbers, as ``derive show --at`` prints it; for many points generated functions are faster.

        Args:
            quantity: Its name, as `quantity` takes it.
            q: Joint values, numbers or cells such as ``"pi/4"``, in the units of the robot file.
            qd: Velocities, in these units per second.
            qdd: Accelerations, likewise.
            values: Numbers by name: symbols as under ``parameters:``, single joints, rates. Symbols that the file gives
                a number have it.
            exact: Whether roots and pi stay what they are.
            digits: Significant digits of the numbers where symbols stay; None for thirty.

        Returns:
            The matrix or expression, its numbers rationals of thirty digits. Symbols without a number stay, and
            the numbers are then decimals of ``digits``, as ``derive show --at`` prints them.

        Raises:
            DeriveError: Not one value per joint, a name that the robot has not, or a value that is no number.
            QuantityError: No such quantity, or it has no finite real value there.
        """
        orders = [",".join(map(str, order)) for order in (q, qd, qdd)]
        named = [f"{name}={value}" for name, value in (values or {}).items()]
        point = typed_point(self.robot, [*filter(None, orders[:1]), *named], *orders[1:])
        point = self.closure.completed(point) if self.robot.passive else point
        found = evaluate(self, quantity)

        def _there(value: Any) -> Expr:
            if hasattr(value, "at"):  # inverse kinematics
                return value.at(point)
            return at_point(value, values=point, name=quantity, exact=exact, digits=digits)

        return found.each(_there) if isinstance(found, OfEnds) else _there(found)

    def equal(self, quantity: str, expression: object) -> bool:
        """Whether an expression equals a scalar quantity identically, wherever both are defined.

        Args:
            quantity: A scalar quantity such as ``T[1,4]``.
            expression: Text in the notation of lecture notes (c12, qd1, ...) or a SymPy expression.

        Raises:
            QuantityError: No such quantity.
            CheckError: The expression cannot be read.
        """
        return verdict(self, quantity, expression).equal


# -- dynamics with short names for what repeats: h for the Christoffel symbols, a_1, a_2, ... for the constants
#
# Two ways in which notes print long dynamics. Christoffel names: ``C = [h*qd2, h*(qd1 + qd2); -h*qd1, 0]`` with
# ``h = -m2*a1*l2*s2``. Dynamic coefficients: ``B_11 = a_1 + 2*a_2*c_2``, one name for each linear combination of
# constants. Two values that differ by a rational factor share one name.

BY_RATES = ("C", "N", "Bdot", "tau")
BY_CONSTANTS = ("B", "g")

# Exact coefficients, and the rates or products of rates that they are multiplied by.
Pairs = list[tuple[Polynomial, Expr]]


def abbreviate(model: DynamicModel, quantity: str, by: str | None) -> tuple[Matrix, Mapping[Expr, Expr]]:
    """A dynamic quantity with short names, and what the names mean."""
    way = by or ("christoffel" if quantity in BY_RATES else "coefficients")
    allowed = {"christoffel": BY_RATES, "coefficients": (*BY_CONSTANTS, *BY_RATES)}
    if way not in allowed:
        raise QuantityError(f"unknown kind of abbreviations {way!r}", allowed="allowed: christoffel or coefficients")
    if quantity not in allowed[way]:
        found = f"abbreviations by {way} do not apply to {quantity!r}"
        raise QuantityError(found, allowed=f"they apply to {listed(allowed[way])}")
    writer = _ByChristoffel(model) if way == "christoffel" else _ByCoefficients(model)
    n, rows = range(model.n), []
    coefficient = model.rate_coefficient(quantity)  # of B, g and tau there is none
    for i in n:
        row = []
        if coefficient is not None:
            row = [writer.rate_sum([(coefficient(i, j, k), model.qd[k]) for k in n]) for j in n]
        elif quantity != "g":
            row = [writer.constant_part(model.dynamics.inertia_matrix[i][j], model.B[i, j]) for j in n]
        if quantity == "tau":
            accelerated = [entry * qdd for entry, qdd in zip(row, model.qdd, strict=True)]
            row = [*accelerated, writer.rate_sum(model.velocity_pairs(i)), model.friction[i]]
        if quantity in ("g", "tau"):
            row = [sympy.Add(*row, writer.constant_part(model.kinematics.gravity_vector[i], model.g[i]))]
        rows.append(row)
    matrix, definitions, letter = sympy.ImmutableMatrix(rows), writer.names.definitions, writer.names.letter
    if len(definitions) != 1:
        return matrix, definitions
    ((symbol, value),) = definitions.items()
    return matrix.xreplace({symbol: sympy.Symbol(letter)}), {sympy.Symbol(letter): value}


class _Names:
    """Gives names to values, the same one to values that differ by a rational factor."""

    def __init__(self, letters: Sequence[str], model: DynamicModel) -> None:
        # h is taken by a symbol h, and by h1
        stems = {name.rstrip("0123456789") for name in robot_symbols(model.robot)}
        self.letter = next((letter for letter in letters if letter not in stems), "abbreviation_")
        self.definitions: dict[Expr, Expr] = {}  # what the names mean
        self._known: dict[object, Expr] = {}

    def name(self, key: object, value: Callable[[], Expr]) -> Expr:
        if key not in self._known:
            self._known[key] = sympy.Symbol(f"{self.letter}{len(self._known) + 1}")
            self.definitions[self._known[key]] = value()
        return self._known[key]


class _ByChristoffel:
    """Writes sums over rates with names for coefficients, or the Christoffel symbols where these occur."""

    def __init__(self, model: DynamicModel) -> None:
        self.names = _Names(("h", "k", "b", "w", "u"), model)
        self._form, self._limit = model.dynamic_form, model.christoffel_limit
        self._grouping = model.style.christoffel
        self._bases: dict[str, Polynomial] = {}
        n = range(model.n)
        for i, j, k in ((i, j, k) for i in n for j in n for k in n if j <= k):
            p = model.dynamics.christoffel(i, j, k)
            if p:
                self._bases.setdefault(p.normalised()[1], p)

    def constant_part(self, p: Polynomial, written: Expr) -> Expr:
        """An entry of B or g as the model writes it."""
        return written

    def rate_sum(self, pairs: Pairs) -> Expr:
        """Sum of p * rate, each p a multiple of a name, equal names collected: ``h*(qd1 + qd2)``."""
        collected: dict[Expr, list[Expr]] = {}
        for p, rate in pairs:
            if p:
                factor, name = self._named(p)
                collected.setdefault(name, []).append(factor * rate)
        terms = []
        for name, rates in collected.items():
            alike = len({abs(rate.as_coeff_Mul()[0]) for rate in rates}) == 1
            terms.append(sympy.Mul(name, sympy.Add(*rates)) if alike else sympy.Add(*(name * rate for rate in rates)))
        return sympy.Add(*terms)

    def _named(self, p: Polynomial) -> tuple[Expr, Expr]:
        """A rational factor and the name that it multiplies."""
        scale, key = p.normalised()
        base = self._bases.setdefault(key, p)
        name = self.names.name(key, lambda: self._form.entry(base, self._limit, self._grouping))
        return sympy.Rational(scale / base.normalised()[0]), name


class _ByCoefficients:
    """Writes polynomials as sums of named constants times what moves."""

    def __init__(self, model: DynamicModel) -> None:
        self.names = _Names(("a", "p", "k", "w", "u"), model)
        self._model, self._form = model, model.form
        self._bases: dict[object, Fraction] = {}
        self._moving = frozenset(i for i, f in enumerate(model.form.table.factors) if f.kind in MOVING)

    def constant_part(self, p: Polynomial, written: Expr) -> Expr:
        """An entry of B or g with a name for the coefficient of every monomial in sines, cosines and variables."""
        dynamics = self._model.dynamics
        expanded = dynamics.expand(p) if p.ring is dynamics.lumped.ring else p
        parts = partition(self._form.table.terms(expanded), self._moving)
        return sympy.Add(*(self._named(rest) * self._form.monomial(outer) for outer, rest in parts.items()))

    def rate_sum(self, pairs: Pairs) -> Expr:
        """sum p * rate, every p with names for its constants."""
        return sympy.Add(*(self.constant_part(p, None) * rate for p, rate in pairs if p))

    def _named(self, terms: Terms) -> Expr:
        lead = terms[min(terms)]
        if list(terms) == [()]:
            return sympy.Rational(lead)
        # the greatest rational of which all are whole multiples
        numerators, denominators = zip(*((c.numerator, c.denominator) for c in terms.values()), strict=True)
        scale = abs(lead) if len(terms) == 1 else Fraction(gcd(*numerators), lcm(*denominators))
        scale = -scale if lead < 0 else scale
        key = tuple(sorted((m, c / scale) for m, c in terms.items()))
        # decimals stay in the value: a name is the value itself, not what a tiny number multiplies
        base = self._bases.setdefault(key, scale if scale.denominator > 1 else Fraction(1))
        name = self.names.name(key, lambda: self._form.write_dynamic({m: c * base for m, c in key}))
        return sympy.Rational(scale / base) * name
