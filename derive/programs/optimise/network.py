"""A program as a network of polynomials: every variable a sum of products of others, with coefficients that are free.

This is the form in which sharing is looked for: sums and products are n-ary, a term is a coefficient (a number, or what
depends on run-time parameters alone) times a product of variables, and a variable is worth having only if its
definition costs less than writing it out. What is no sum or product (a sine, a quotient) is a function of variables.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Protocol

from derive.programs.optimise.coefficients import PRIME, Coefficients, residue_of, scatter
from derive.programs.tape.graph import ONE, UNITS, ZERO, Ref, is_negative, signed
from derive.programs.tape.tape import OPERATION_COST, Op

Monomial = tuple[int, ...]  # a product of variables, ascending; the empty one stands for 1
# Coefficients by monomial, none of them zero. Once it defines a variable it is not changed any more.
Polynomial = dict[Monomial, Ref]
ROOT = -1  # the variable whose definition is the outputs


@dataclass(frozen=True, slots=True)
class Operand:
    """An argument of a function or an output: coefficient 1 or -1 times a variable, or a coefficient alone."""

    variable: int | None
    coefficient: Ref


@dataclass(frozen=True, slots=True)
class Opaque:
    """A function of other values; for an input the operation is None and there are no operands."""

    op: Op | None  # the function
    operands: tuple[Operand, ...]  # its arguments
    source: int = 0  # the node of an input in the graph that was read


Definition = Polynomial | Opaque


class Watcher(Protocol):
    """What is told of every change of a network."""

    def learn(self, variable: int, definition: Definition) -> None:
        """A variable has got a definition."""

    def forget(self, variable: int, definition: Definition) -> None:
        """A variable loses its definition."""


class Network:
    """Definitions of variables, who uses them, and what they cost; changes can be taken back."""

    def __init__(self, coefficients: Coefficients) -> None:
        self.coefficients = coefficients
        self.definition: dict[int, Definition] = {}
        self.users: dict[int, dict[int, int]] = {}  # by variable those that use it, with how often
        self.cost = 0  # of all definitions, each operation at its `OPERATION_COST`
        self.residue: list[int] = []  # of each variable, at the random point at which coefficients are compared
        self.work = 0  # divisors looked at so far, by which effort is measured
        self.watcher: Watcher | None = None
        self._costs: dict[int, int] = {}
        self._used: dict[int, list[int]] = {}  # the variables that stand in each definition
        self._by_residue: dict[int, list[int]] = {}
        self._log: list[tuple[int, Definition | None]] = []
        self._changed: list[int] = []

    def polynomials(self) -> Iterator[tuple[int, Polynomial]]:
        """Variables that are sums or products, with their definitions."""
        return ((v, d) for v, d in self.definition.items() if isinstance(d, dict))

    def polynomial(self, variable: int) -> Polynomial | None:
        """The sum or product that defines a variable; None where that is a function, or where it has none."""
        found = self.definition.get(variable)
        return found if isinstance(found, dict) else None

    def create(self, definition: Definition) -> int:
        """Make a variable; one of the same value that has been dropped lends its number."""
        residue = self.evaluate(definition)
        row = self._by_residue.setdefault(min(residue, PRIME - residue), [])
        for variable in row:
            if variable not in self.definition and self.residue[variable] == residue:
                self.define(variable, definition)
                return variable
        variable = len(self.residue)
        self.residue.append(residue)
        row.append(variable)
        self.define(variable, definition)
        return variable

    def evaluate(self, definition: Definition) -> int:
        """The value of a definition at the random point at which coefficients are compared."""
        residue, residue_of_coefficient = self.residue, self.coefficients.residue
        if isinstance(definition, Opaque):
            if definition.op is None:
                return scatter("input", definition.source)
            values = []
            for operand in definition.operands:
                value = residue_of_coefficient(operand.coefficient)
                values.append(value if operand.variable is None else value * residue[operand.variable] % PRIME)
            return residue_of(definition.op, values)
        total = 0
        for monomial, coefficient in definition.items():
            product = residue_of_coefficient(coefficient)
            for variable in monomial:
                product = product * residue[variable] % PRIME
            total += product
        return total % PRIME

    def find(self, residue: int) -> Operand | None:
        """A coefficient or the oldest variable in use with some value or minus it; None where there is none."""
        # A coefficient costs nothing, so it is taken before any variable.
        if (coefficient := self.coefficients.find(residue)) is not None:
            return Operand(None, coefficient)
        for variable in self._by_residue.get(min(residue, PRIME - residue), ()):
            if variable in self.definition:
                return Operand(variable, signed(ONE, self.residue[variable] != residue))
        return None

    def needs(self, variable: int, other: int) -> bool:
        """Whether a variable is another, or is computed from it."""
        if variable == other:
            return True
        seen = {variable}
        stack = [variable]
        # Along definitions to what they use; there is no circle, so this ends.
        while stack:
            for used in self._used[stack.pop()]:
                if used == other:
                    return True
                if used not in seen:
                    seen.add(used)
                    stack.append(used)
        return False

    def define(self, variable: int, definition: Definition | None) -> None:
        """Give a variable its definition, or with None take it away."""
        self._log.append((variable, self._replace(variable, definition)))

    def _replace(self, variable: int, definition: Definition | None) -> Definition | None:
        """Exchange a definition for another, with what is known of users and costs; the old one."""
        users, watcher = self.users, self.watcher
        old = self.definition.pop(variable, None)
        # The old definition's variables lose one user for each time that they stand in it.
        if old is not None:
            self.cost -= self._costs[variable]
            used = self._used[variable]
            for other in used:
                row = users[other]
                if row[variable] > 1:
                    row[variable] -= 1
                else:
                    del row[variable]
            self._changed += used
            if watcher is not None:
                watcher.forget(variable, old)
        # The new one's gain them; both are looked at by `settle`.
        if definition is not None:
            self.definition[variable] = definition
            if isinstance(definition, dict):
                cost, used = polynomial_cost(definition), [other for monomial in definition for other in monomial]
            else:
                cost = 0 if definition.op is None else OPERATION_COST[definition.op]
                used = [operand.variable for operand in definition.operands if operand.variable is not None]
            self._costs[variable], self._used[variable] = cost, used
            self.cost += cost
            for other in used:
                row = users.setdefault(other, {})
                row[variable] = row.get(variable, 0) + 1
            self._changed.append(variable)
            if watcher is not None:
                watcher.learn(variable, definition)
        return old

    def order(self) -> list[int]:
        """Variables after those they need, depth first from the outputs."""
        order: list[int] = []
        done = {ROOT}
        stack = [ROOT]
        while stack:
            variable = stack[-1]
            # Depth first without recursion: a variable stays on the stack until all that it uses is done.
            waiting = [k for k in self._used[variable] if k not in done]
            if waiting:
                stack.extend(reversed(waiting))
                continue
            stack.pop()
            if variable not in done:
                done.add(variable)
                order.append(variable)
        return order

    def mark(self) -> int:
        """Where the network stands, for `undo`."""
        return len(self._log)

    def undo(self, mark: int) -> None:
        """Take back all changes since some point."""
        # The log holds old definitions; undone from the last change to the first.
        while len(self._log) > mark:
            self._replace(*self._log.pop())
        self._changed.clear()

    def settle(self) -> None:
        """Drop what nobody uses, and write out what is not worth a variable."""
        while self._changed:
            variable = self._changed.pop()
            if (definition := self.definition.get(variable)) is None or variable == ROOT:
                continue
            # Unused: dropped. A single signed variable or coefficient: put in the users' place. Used once: written out.
            if not (users := self.users.get(variable)):
                self.define(variable, None)
            elif isinstance(definition, dict) and (len(definition) < 2 or len(users) == 1):
                if (alias := single(definition)) is not None:
                    for user in list(users):
                        self._substitute(user, variable, definition, alias)
                elif len(users) == 1:
                    self._merge(next(iter(users)), variable, definition)

    def _merge(self, user: int, variable: int, polynomial: Polynomial) -> None:
        """Write out a variable in its only user, if it stands there once and that costs nothing."""
        if (outer := self.polynomial(user)) is None or self.users[variable][user] > 1:
            return
        if len(polynomial) > 1:
            # A sum times other factors must stay a sum: x (a + b) costs one operation less than x a + x b.
            monomial, coefficient = next((m, k) for m, k in outer.items() if variable in m)
            if len(monomial) > 1 or (
                coefficient not in UNITS and sum([k in UNITS for m, k in polynomial.items() if m]) > 1
            ):
                return
        merged = self.expanded(outer, variable, polynomial)
        if polynomial_cost(merged) <= self._costs[user] + self._costs[variable]:
            self.define(user, merged)

    def _substitute(self, user: int, variable: int, polynomial: Polynomial, alias: Operand) -> None:
        """Put what a variable stands for in its place in the definition of a user."""
        definition = self.definition[user]
        if isinstance(definition, dict):
            self.define(user, self.expanded(definition, variable, polynomial))
            return
        # A function keeps its arguments; of these only the sign may change.
        operands = tuple(
            operand
            if operand.variable != variable
            else Operand(alias.variable, signed(alias.coefficient, is_negative(operand.coefficient)))
            for operand in definition.operands
        )
        self.define(user, Opaque(definition.op, operands, definition.source))

    def plus(self, into: Polynomial, monomial: Monomial, coefficient: Ref) -> None:
        """Add a term to a polynomial that is being made."""
        old = into.get(monomial)
        total = coefficient if old is None else self.coefficients.add(old, coefficient)
        if total == ZERO:
            into.pop(monomial, None)
        else:
            into[monomial] = total

    def expanded(self, polynomial: Polynomial, variable: int, inner: Polynomial) -> Polynomial:
        """A polynomial with one variable written out."""
        result: Polynomial = {}
        for monomial, coefficient in polynomial.items():
            if variable not in monomial:
                self.plus(result, monomial, coefficient)
                continue
            rest = list(monomial)
            rest.remove(variable)
            # (rest x) with x = sum k m: sum k rest m, coefficients multiplied.
            for m, k in inner.items():
                self.plus(result, tuple(sorted((*rest, *m))), self.coefficients.multiply(coefficient, k))
        # Powers of the variable: one factor was written out at a time.
        return self.expanded(result, variable, inner) if any(variable in m for m in result) else result


def single(polynomial: Polynomial) -> Operand | None:
    """The signed variable or the coefficient that a polynomial is; None where it is more."""
    if not polynomial:
        return Operand(None, ZERO)
    if len(polynomial) > 1:
        return None
    monomial, coefficient = next(iter(polynomial.items()))
    if not monomial:
        return Operand(None, coefficient)
    return Operand(monomial[0], coefficient) if len(monomial) == 1 and coefficient in UNITS else None


def polynomial_cost(polynomial: Polynomial) -> int:
    """Multiplications and additions of a sum of products."""
    cost = len(polynomial) - 1
    for monomial, coefficient in polynomial.items():
        if monomial:
            cost += len(monomial) - (coefficient in UNITS)
    return cost if cost > 0 else 0
