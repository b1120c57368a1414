"""How an expression is written: a tree of sums, products and single terms, with its number of operations."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from math import ceil

from flint import Ordering, fmpq, fmpq_mpoly_ctx

from derive.algebra.ring import fraction
from derive.lecture.terms import Monomial, Terms, common_factor, divide, multiply, partition, project

# Sums with more terms are not tried as products: the coefficient of a mass that is one has far fewer.
MAX_TRIED_AS_PRODUCT = 120
# A number from which a factor of a product of decimals is written with smaller ones, see `with_plain_numbers`.
LARGE_FACTOR = 1000


@dataclass(frozen=True)
class Term:
    """coefficient * product of powers."""

    coefficient: Fraction
    monomial: Monomial

    @cached_property
    def operations(self) -> int:
        """Multiplications; signs are free."""
        factors = sum(e for _, e in self.monomial) + (abs(self.coefficient) != 1)
        return max(factors - 1, 0)


@dataclass(frozen=True)
class Times:
    """coefficient * monomial * product of (inner ** exponent)."""

    coefficient: Fraction
    monomial: Monomial
    inner: tuple[tuple[Plan, int], ...]

    @cached_property
    def operations(self) -> int:
        """Multiplications between the factors and everything inside them."""
        outside = sum(e for _, e in self.monomial) + (abs(self.coefficient) != 1)
        return outside - 1 + sum(exponent + plan.operations for plan, exponent in self.inner)


@dataclass(frozen=True)
class Plus:
    """A sum of two or more parts."""

    parts: tuple[Plan, ...]

    @cached_property
    def operations(self) -> int:
        """Additions and everything inside."""
        return len(self.parts) - 1 + sum(part.operations for part in self.parts)


Plan = Term | Times | Plus
Level = frozenset[int]  # numbers of factors that are collected together
Writer = Callable[[Terms], Plan]


def cheapest(plans: Iterable[Plan]) -> Plan:
    """The plan with the fewest operations, of equally cheap ones the first."""
    return min(plans, key=lambda plan: plan.operations)


def flat(terms: Terms) -> Plan:
    """The sum of the terms as they are."""
    parts = tuple(Term(c, m) for m, c in terms.items())
    if not parts:
        return Term(Fraction(0), ())
    return parts[0] if len(parts) == 1 else Plus(parts)


def factored(terms: Terms, inside: Writer, among: Level | None = None) -> Plan:
    """The common factor of all terms taken out."""
    # among: only these factors may come out, such as gravity alone
    common = common_factor(terms) if len(terms) > 1 else ()
    if among is not None:
        common = project(common, among)
    return inside(terms) if not common else _times(common, inside({divide(m, common): c for m, c in terms.items()}))


def grouped(terms: Terms, level: Level, inside: Writer) -> Plan:
    """Collected by the monomials in some factors: ``m1*(...) + m2*(...)``."""
    return joined(_times(outer, inside(rest)) for outer, rest in partition(terms, level).items())


def joined(plans: Iterable[Plan]) -> Plan:
    """The sum of some plans, without a bracket of its own."""
    flattened = [part for plan in plans for part in (plan.parts if isinstance(plan, Plus) else (plan,))]
    return flattened[0] if len(flattened) == 1 else Plus(tuple(flattened))


def nested(terms: Terms, levels: Sequence[Level]) -> Plan:
    """Grouped level by level, joints from the base outwards ``c1*(a2*c2 + a3*c23)``; common factors outside."""
    if len(terms) <= 1:
        return flat(terms)
    if not levels:
        return factored(terms, flat)
    first, rest = levels[0], levels[1:]
    if not any(f in first for m in terms for f, _ in m):  # nothing of this level occurs
        return nested(terms, rest)
    return factored(terms, lambda inner: grouped(inner, first, lambda part: nested(part, rest)))


def product_form(terms: Terms, write: Writer = flat, *, monomials: bool = False) -> Plan | None:
    """The terms as a product with at least two sums in it, (a2*c2 + a3*c23)**2; None where there are fewer.

    Sines and cosines are independent symbols here: only what is a product by its form is found.
    """
    if not 2 <= len(terms) <= MAX_TRIED_AS_PRODUCT:
        return None
    names = sorted({f for m in terms for f, _ in m})
    # a polynomial of FLINT's in the factors with these numbers
    context = fmpq_mpoly_ctx.get([f"x{i}" for i in names], Ordering.lex)
    powers = ((dict(monomial), fmpq(c.numerator, c.denominator)) for monomial, c in terms.items())
    content, factors = context.from_dict({tuple(e.get(f, 0) for f in names): c for e, c in powers}).factor()
    coefficient, sums, outer = fraction(content), [], Monomial()
    # irreducible factors over the rationals: single terms go in front, sums are what makes it a product
    for factor, exponent in factors:
        inner = {tuple((names[i], int(e)) for i, e in enumerate(key) if e): fraction(c) for key, c in factor.terms()}
        if len(inner) > 1:
            sums.append((inner, int(exponent)))
            continue
        ((single, k),) = inner.items()
        coefficient *= k ** int(exponent)
        outer = multiply(outer, tuple((f, e * int(exponent)) for f, e in single))
    if sum(e for _, e in sums) < 2 and not (monomials and outer):
        return None
    parts = []
    for inner, exponent in sums:
        sign = -1 if next(iter(inner.values())) < 0 else 1  # the first term of every sum is positive
        coefficient *= Fraction(sign) ** exponent
        parts.append((write({m: sign * c for m, c in inner.items()}), exponent))
    return Times(coefficient, outer, tuple(parts)) if parts else Term(coefficient, outer)


def with_plain_numbers(plan: Plan) -> Plan:
    """A product of decimals whose sums have numbers of the size that people write.

    Factors come out with whole numbers, ``-4.8e-8*(141 + 10000*d3)*(...)``. Powers of ten, which leave every digit what
    it is, are moved between the number in front and the sums, ``-4.8e-4*(0.0141 + d3)*(...)``; what stands in front of
    a single sum alone is multiplied out, ``-6.768e-6 - 4.8e-4*d3``.
    """
    if not isinstance(plan, Times):
        return plan
    coefficient, sums = plan.coefficient, []
    for inner, exponent in plan.inner:
        # the numbers in front of the terms of a sum; of a sum with another one among its terms none
        parts = inner.parts if isinstance(inner, Plus) else ()
        numbers = [part.coefficient for part in parts if not isinstance(part, Plus)]
        numbers = numbers if len(numbers) == len(parts) else []
        largest = max(map(abs, numbers), default=Fraction(1))
        if largest >= LARGE_FACTOR or (largest < 1 and abs(coefficient) != 1):
            # the power of ten of the largest number, from its digits: no logarithm, which may round
            size = Fraction(10) ** (len(str(int(largest))) - 1 if largest >= 1 else -len(str(ceil(1 / largest) - 1)))
            coefficient *= size**exponent
            inner, numbers = _scaled(inner, 1 / size), [number / size for number in numbers]
        sums.append((inner, exponent))
    # behind a monomial a sum with a bare term, 3*a1*(q1 + 2), stays; any other one takes the number into its terms
    bare = not plan.monomial or not any(abs(number) == 1 for number in numbers)
    if len(sums) == 1 and sums[0][1] == 1 and numbers and bare and coefficient.denominator != 1:
        whole = _scaled(sums[0][0], coefficient)
        return Times(Fraction(1), plan.monomial, ((whole, 1),)) if plan.monomial else whole
    return Times(coefficient, plan.monomial, tuple(sums))


def _scaled(plan: Plan, factor: Fraction) -> Plan:
    """A plan times a number, which every term of a sum takes."""
    if isinstance(plan, Plus):
        return Plus(tuple(_scaled(part, factor) for part in plan.parts))
    return replace(plan, coefficient=factor * plan.coefficient)


def _times(monomial: Monomial, inner: Plan) -> Plan:
    """monomial * inner, merged where inner is a single term or a product; a sum of negatives gets its sign outside."""
    if isinstance(inner, Plus):
        if not monomial:
            return inner
        all_negative = all(not isinstance(part, Plus) and part.coefficient < 0 for part in inner.parts)
        sign = Fraction(-1 if all_negative else 1)
        return Times(sign, monomial, ((_scaled(inner, sign), 1),))
    return replace(inner, monomial=multiply(inner.monomial, monomial))
