"""Where the inertia matrix is diagonal: conditions on lengths, masses and moments of inertia.

An entry of B beside the diagonal is a sum of parameter expressions times products of sines, cosines and slides, which
are linearly independent functions of q: it vanishes for all q exactly where all these coefficients do (Spong,
Hutchinson and Vidyasagar, Robot Modeling and Control, 2006, chapter on dynamics: m3*l2*lc3 = m4*l1*lc4 of the five-bar
linkage).
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import partial
from itertools import combinations
from typing import Any

import sympy

from derive.algebra.angles import decompose
from derive.algebra.domain import PolynomialDomain
from derive.algebra.generators import MOVING, Kind, canonical
from derive.algebra.ring import Polynomial
from derive.errors import QuantityError, listed
from derive.lecture.sympy_conversion import Expr
from derive.model.dynamic_model import DynamicModel
from derive.robot import tree
from derive.robot.description import Motor, derivatives
from derive.robot.expression import Name, names
from derive.robot.options.style import Grouping

Condition = tuple[tuple[Expr, Expr], ...]  # equations, of which at least one holds
# The conditions of an entry, none where it is always zero, or a coefficient that no parameters but zeros make zero.
Entry = tuple[Condition, ...] | Expr
Zeros = frozenset[Polynomial]  # the factors of a coefficient that may be zero
Write = Callable[[Any], str]


@dataclass(frozen=True)
class Decoupling:
    """When the inertia matrix is diagonal: all conditions hold that it lists."""

    entries: dict[tuple[int, int], Entry]  # by row and column from 1
    conditions: tuple[Condition, ...]  # of all entries that have some
    is_exact: bool  # whether they are necessary, too: not where functions of q depend on each other

    def _text(self, entry: Entry, write: Write, without: str) -> str:
        if not isinstance(entry, tuple):
            return f"{'never without a zero parameter' if self.is_exact else 'unknown'}: {write(entry)}"
        return ", ".join(" or ".join(f"{write(a)} = {write(b)}" for a, b in each) for each in entry) or without

    def lines(self, write: Write) -> list[str]:
        """The entries and the whole matrix in words."""
        rows = [(f"B[{i},{j}]", entry) for (i, j), entry in self.entries.items()]
        width, against = max(len(name) for name, _ in rows), [name for name, e in rows if not isinstance(e, tuple)]
        found = ["entries that are zero for all q, no length, mass or moment of inertia being zero:"]
        found += [f"  {name:{width}}  {self._text(entry, write, 'always')}" for name, entry in rows]
        if not against:
            when = f" {'exactly' if self.is_exact else 'at least'} where " if self.conditions else ""
            return [*found, f"B is diagonal{when}{self._text(self.conditions, write, '')}"]
        stand = listed([*against[:3], *([f"{len(against) - 3} others"] if len(against) > 3 else [])])
        why = f"none, for {stand} cannot vanish" if self.is_exact else f"none found for {stand}"
        return [*found, f"conditions for a diagonal B: {why}"]

    def parts(self, write: Write) -> dict[str, Any]:
        """The same as plain data."""
        entries = {f"{i},{j}": self._text(e, write, "always") for (i, j), e in self.entries.items()}
        return {"entries": entries, "text": self.lines(write)[-1], "exact": self.is_exact}


def find_decoupling(model: DynamicModel) -> Decoupling:
    """When the inertia matrix of a model is diagonal."""
    robot, dynamics, domain = model.robot, model.dynamics, model.domain
    if robot.dof < 2:
        raise QuantityError(f"decoupling of {robot.name}, which has one variable", allowed="allowed: two or more")
    write: Callable[[Polynomial], Expr] = partial(model.form.dynamic, grouping=Grouping.EXPANDED)
    can_vanish, every, entries = _can_vanish(domain), set[Zeros](), dict[tuple[int, int], Entry]()
    slopes = {name.name for name in derivatives(robot).values()}
    functions = [i for i, g in enumerate(domain.generators) if g.kind in MOVING or g.name in slopes]
    for i, j in combinations(range(robot.dof), 2):
        whole, own = dynamics.expand(dynamics.inertia_matrix[i][j]), set[Zeros]()
        for p in sorted(domain.ring.coefficients(whole, functions).values(), key=len):
            parts = (domain.ring.wrap(part) for part, _ in p.raw.factor()[1])
            own.add(zeros := frozenset(part * (1 / part.normalised()[0]) for part in parts if can_vanish(part)))
            if not zeros:
                entries[i + 1, j + 1] = write(p if p.normalised()[0] > 0 else -p)
                break
        else:
            entries[i + 1, j + 1] = _conditions(own, write)
            every |= own
    return Decoupling(entries, _conditions(every, write), not robot.loops and _are_independent(domain))


def _conditions(found: Iterable[Zeros], write: Callable[[Polynomial], Expr]) -> tuple[Condition, ...]:
    """Those that do not follow from another one, short ones first; what is added stands left, what is taken right."""

    def _equation(p: Polynomial) -> tuple[Expr, Expr]:
        sides = ({e: c for e, c in p.raw.terms() if (c > 0) == is_left} for is_left in (True, False))
        left, right = (p.ring.wrap(p.ring.context.from_dict(side)) for side in sides)
        return write(left), write(-right) if right else sympy.Integer(0)

    needed = [zeros for zeros in found if not any(other < zeros for other in found)]
    ordered = sorted(sorted((len(p), p.key(), p) for p in zeros) for zeros in needed)
    return tuple(tuple(_equation(p) for _, _, p in each) for each in ordered)


def _are_independent(domain: PolynomialDomain) -> bool:
    """Whether the angles of the generators are linearly independent in the variables, constants left out."""
    variables = {each.variable for each in domain.robot.variables}
    angles = [dict(decompose(canonical(g.argument)).terms) for g in domain.generators if g.kind is Kind.SINE]
    units = dict.fromkeys(unit for terms in angles for unit in terms if not variables.isdisjoint(names(unit)))
    return not angles or sympy.Matrix([[terms.get(u, 0) for u in units] for terms in angles]).rank() == len(angles)


def _can_vanish(domain: PolynomialDomain) -> Callable[[Polynomial], bool]:
    """Whether a factor can vanish with no parameter zero: certainly not a product, nor a sum of what is positive."""
    cells, every = [], list(enumerate(domain.generators))
    for link in tree.bodies(domain.robot):
        motor, t = link.motor or Motor(), link.inertia
        cells += [link.mass, t.xx, t.yy, t.zz, link.armature, motor.mass, motor.inertia]
    plain, roots = {cell.name for cell in cells if isinstance(cell, Name)}, (Kind.PI, Kind.PRIME_ROOT, Kind.ROOT)
    positive = {i for i, g in every if g.name in plain or g.kind in roots}
    turns = (Kind.CONSTANT_SINE, Kind.CONSTANT_COSINE)  # which may vanish though their angle does not
    free = {i for i, g in every if g.kind in turns and any(names(g.argument))}

    def _verdict(p: Polynomial) -> bool:
        used = [(i, e) for exponents, _ in p.terms() for i, e in enumerate(exponents) if e]
        is_positive = all(e % 2 == 0 or i in positive for i, e in used) and len({c > 0 for _, c in p.terms()}) == 1
        return any(i in free for i, _ in used) or (len(p) > 1 and not is_positive)

    return _verdict
