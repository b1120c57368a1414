"""A program as a network of polynomials: every variable a sum of products of others, with coefficients that are free.

This is the form in which sharing is looked for: sums and products are n-ary, a term is a coefficient (a number, or what
depends on run-time parameters alone) times a product of variables, and a variable is worth having only if its
definition costs less than writing it out. What is no sum or product (a sine, a quotient) is a function of variables.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Protocol

from derive.programs.optimise.coefficients import PRIME, Coefficients, combine, scatter
from derive.programs.tape.graph import ONE, ZERO, Ref
from derive.programs.tape.tape import Op

Monomial = tuple[int, ...]
"""A product of variables, ascending; the empty one stands for 1."""

Polynomial = dict[Monomial, Ref]
"""Coefficients by monomial, none of them zero."""

ROOT = -1
"""The variable whose definition is the outputs."""


@dataclass(frozen=True, slots=True)
class Operand:
    """An argument of a function or an output: coefficient 1 or -1 times a variable, or a coefficient alone."""

    variable: int | None
    coefficient: Ref


@dataclass(frozen=True, slots=True)
class Opaque:
    """A function of other values; for an input the operation is None and there are no operands."""

    op: Op | None
    operands: tuple[Operand, ...]
    source: int = 0


Definition = Polynomial | Opaque


class Watcher(Protocol):
    """What is told of every change."""

    def learn(self, variable: int, definition: Definition) -> None:
        """A variable has got a definition."""

    def forget(self, variable: int, definition: Definition) -> None:
        """A variable loses its definition."""


class Network:
    """Definitions of variables, who uses them, and what they cost; changes can be taken back.

    Args:
        coefficients: Arithmetic of the coefficients.
    """

    def __init__(self, coefficients: Coefficients) -> None:
        self.coefficients = coefficients
        self.definition: dict[int, Definition] = {}
        self.users: dict[int, dict[int, int]] = {}
        self.cost = 0
        self._costs: dict[int, int] = {}
        self.residue: list[int] = []
        self._by_residue: dict[int, list[int]] = {}
        self.log: list[tuple[int, Definition | None]] = []
        self.work = 0
        self.watcher: Watcher | None = None
        self.changed: list[int] = []

    def polynomials(self) -> Iterator[tuple[int, Polynomial]]:
        """Variables that are sums or products."""
        return ((v, d) for v, d in self.definition.items() if isinstance(d, dict))

    def polynomial(self, variable: int) -> Polynomial | None:
        """Its definition, if that is a sum or product."""
        found = self.definition.get(variable)
        return found if isinstance(found, dict) else None

    def create(self, definition: Definition) -> int:
        """A new variable; one of the same value that has been dropped lends its number."""
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
        if isinstance(definition, Opaque):
            if definition.op is None:
                return scatter("input", definition.source)
            return combine(definition.op, [self._operand(operand) for operand in definition.operands])
        total = 0
        for monomial, coefficient in definition.items():
            product = self.coefficients.residue(coefficient)
            for variable in monomial:
                product = product * self.residue[variable] % PRIME
            total += product
        return total % PRIME

    def _operand(self, operand: Operand) -> int:
        value = self.coefficients.residue(operand.coefficient)
        return value if operand.variable is None else value * self.residue[operand.variable] % PRIME

    def find(self, residue: int) -> Operand | None:
        """A coefficient or the oldest variable that is known to have this value, or minus it."""
        coefficient = self.coefficients.find(residue)
        if coefficient is not None:
            return Operand(None, coefficient)
        for variable in self._by_residue.get(min(residue, PRIME - residue), ()):
            if variable in self.definition:
                return Operand(variable, ONE ^ (self.residue[variable] != residue))
        return None

    def needs(self, variable: int, other: int) -> bool:
        """Whether a variable is another, or its definition or that of any in it uses that."""
        if variable == other:
            return True
        seen = {variable}
        stack = [variable]
        while stack:
            for used in occurrences(self.definition[stack.pop()]):
                if used == other:
                    return True
                if used not in seen:
                    seen.add(used)
                    stack.append(used)
        return False

    def define(self, variable: int, definition: Definition | None) -> None:
        """Give a variable its definition, or take it away."""
        self.log.append((variable, self._replace(variable, definition)))

    def _replace(self, variable: int, definition: Definition | None) -> Definition | None:
        old = self.definition.pop(variable, None)
        if old is not None:
            self._forget(variable, old)
        if definition is not None:
            self.definition[variable] = definition
            self._learn(variable, definition)
        return old

    def _learn(self, variable: int, definition: Definition) -> None:
        cost = self._costs[variable] = self.cost_of(definition)
        self.cost += cost
        users = self.users
        for used in occurrences(definition):
            row = users.get(used)
            if row is None:
                users[used] = {variable: 1}
            else:
                row[variable] = row.get(variable, 0) + 1
        self.changed.append(variable)
        if self.watcher is not None:
            self.watcher.learn(variable, definition)

    def _forget(self, variable: int, definition: Definition) -> None:
        self.cost -= self._costs[variable]
        used = occurrences(definition)
        for other in used:
            row = self.users[other]
            if row[variable] > 1:
                row[variable] -= 1
            else:
                del row[variable]
        self.changed += used
        if self.watcher is not None:
            self.watcher.forget(variable, definition)

    def order(self) -> list[int]:
        """Variables after those they need, depth first from the outputs."""
        order: list[int] = []
        done = {ROOT}
        stack = [ROOT]
        while stack:
            variable = stack[-1]
            waiting = [k for k in occurrences(self.definition[variable]) if k not in done]
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
        return len(self.log)

    def undo(self, mark: int) -> None:
        """Take back all changes since ``mark``."""
        while len(self.log) > mark:
            variable, old = self.log.pop()
            self._replace(variable, old)
        self.changed.clear()

    def settle(self) -> None:
        """Drop what nobody uses, and write out what is not worth a variable."""
        while self.changed:
            variable = self.changed.pop()
            definition = self.definition.get(variable)
            if definition is None or variable == ROOT:
                continue
            users = self.users.get(variable)
            if not users:
                self.define(variable, None)
            elif isinstance(definition, dict) and (len(definition) < 2 or len(users) == 1):
                self._settle_polynomial(variable, definition, users)

    def _settle_polynomial(self, variable: int, polynomial: Polynomial, users: dict[int, int]) -> None:
        alias = single(polynomial)
        if alias is not None:
            for user in list(users):
                self.substitute(user, variable, polynomial, alias)
        elif len(users) == 1:
            ((user, times),) = users.items()
            outer = self.polynomial(user)
            if times == 1 and outer is not None:
                self._merge(user, outer, variable, polynomial)

    def _merge(self, user: int, outer: Polynomial, variable: int, polynomial: Polynomial) -> None:
        """Write out a variable that is used once, if that costs nothing."""
        if len(polynomial) > 1:
            monomial, coefficient = next((m, k) for m, k in outer.items() if variable in m)
            if len(monomial) > 1 or (
                coefficient >> 1 != 1 and sum(k >> 1 == 1 for m, k in polynomial.items() if m) > 1
            ):
                return
        merged = self.expanded(outer, variable, polynomial)
        if self.cost_of(merged) <= self.cost_of(outer) + self.cost_of(polynomial):
            self.define(user, merged)

    def substitute(self, user: int, variable: int, polynomial: Polynomial, alias: Operand) -> None:
        """Put what a variable stands for in its place in the definition of a user."""
        definition = self.definition[user]
        if isinstance(definition, dict):
            self.define(user, self.expanded(definition, variable, polynomial))
            return
        operands = tuple(_renamed(operand, variable, alias) for operand in definition.operands)
        self.define(user, Opaque(definition.op, operands, definition.source))

    def cost_of(self, definition: Definition) -> int:
        """Multiplications and additions of one definition."""
        if isinstance(definition, Opaque):
            return 0
        cost = len(definition) - 1
        for monomial, coefficient in definition.items():
            if monomial:
                cost += len(monomial) if coefficient >> 1 != 1 else len(monomial) - 1
        return cost if cost > 0 else 0

    def plus(self, into: Polynomial, monomial: Monomial, coefficient: Ref) -> None:
        """Add a term to a polynomial that is being made."""
        old = into.get(monomial)
        total = coefficient if old is None else self.coefficients.add(old, coefficient)
        if total == ZERO:
            into.pop(monomial, None)
        else:
            into[monomial] = total

    def expanded(self, polynomial: Polynomial, variable: int, inner: Polynomial) -> Polynomial:
        """The polynomial with one variable written out."""
        result: Polynomial = {}
        for monomial, coefficient in polynomial.items():
            if variable not in monomial:
                self.plus(result, monomial, coefficient)
                continue
            rest = list(monomial)
            rest.remove(variable)
            for m, k in inner.items():
                self.plus(result, tuple(sorted((*rest, *m))), self.coefficients.multiply(coefficient, k))
        if any(variable in m for m in result):
            return self.expanded(result, variable, inner)
        return result


def occurrences(definition: Definition) -> list[int]:
    """The variables of a definition, each as often as it stands there."""
    if isinstance(definition, Opaque):
        return [operand.variable for operand in definition.operands if operand.variable is not None]
    return [variable for monomial in definition for variable in monomial]


def single(polynomial: Polynomial) -> Operand | None:
    """The polynomial as a signed variable or a coefficient, if it is one."""
    if not polynomial:
        return Operand(None, ZERO)
    if len(polynomial) > 1:
        return None
    (monomial, coefficient) = next(iter(polynomial.items()))
    if not monomial:
        return Operand(None, coefficient)
    if len(monomial) == 1 and coefficient >> 1 == ONE >> 1:
        return Operand(monomial[0], coefficient)
    return None


def _renamed(operand: Operand, variable: int, alias: Operand) -> Operand:
    if operand.variable != variable:
        return operand
    return Operand(alias.variable, alias.coefficient ^ (operand.coefficient & 1) if alias.coefficient else ZERO)
