"""A printed solution of the inverse kinematics: what its lines say, in which order they can be used, their values.

A line gives a joint variable, a sum of them, or a function of one; other lines name quantities, such as D. A plus-minus
is a name of its own, 1 or -1: `Choice`. A line is right if for every configuration some choice gives what it is about.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from itertools import combinations, product

import numpy as np
from sympy.utilities.iterables import connected_components

from derive.checking.formulas.branches import SIGN, count_calls
from derive.checking.formulas.edits import NO_VALUE, float_value, nodes
from derive.checking.formulas.findings import ROUNDED, significant
from derive.errors import CheckError, Location, listed
from derive.robot.expression import ZERO, Call, Expression, Name, Number, children, linear_terms, names, substitute
from derive.robot.robot import Robot

MAX_SIGNS = 10  # plus-minus signs that one line may depend on
CLOSE = 1e-7  # difference of angles [rad] and of lengths relative to their size below which they are the same
Vector = tuple[Fraction, ...]  # a linear combination of the joint variables, constants aside
Choice = Mapping[str, float]  # a value of every plus-minus, and for lines with alternatives which one


@dataclass(frozen=True, eq=False)
class PrintedFormula:
    """A printed right-hand side."""

    expression: Expression  # what it says, in the names of the robot, of the pose and of named quantities
    text: str  # as it is printed
    location: Location  # where it stands
    first: str = ""  # the name that means the first alternative in it, as in ``or q4 + pi``

    @cached_property
    def names(self) -> frozenset[str]:
        """The names in it, which the search for a repair asks for again and again."""
        return frozenset(names(self.expression))


@dataclass(frozen=True, slots=True, eq=False)
class PrintedLine:
    """What is printed about one quantity."""

    quantity: str  # what it is called in messages: ``q2``, ``cos(q2)``, ``D``
    formulas: tuple[PrintedFormula, ...]  # what is printed for it; several where alternatives are given
    target: Expression | None = None  # what it is in the joint variables; None of a quantity that is only named
    name: str = ""  # its name in other lines, if it has one
    primed: bool = False  # whether it gives a joint of a second solution by the first one: ``theta5' = -theta5``

    @property
    def switch(self) -> str:
        """The name of the choice between its alternatives."""
        return f"{SIGN}{self.quantity}"


@dataclass(frozen=True)
class Place:
    """One configuration of the arm and everything that a printed formula may know about it."""

    values: Mapping[str, float]  # numbers by name: parameters, joint variables, sums of them, entries of the pose
    pose: Sequence[Sequence[float]]  # three rows of four entries
    required: bool = True  # whether a complete solution must give it; negative slides need not be given
    twin: Place | None = None  # the configuration whose second solution it is, where primed lines are printed


class PrintedInverse:
    """The lines of one printed solution."""

    def __init__(
        self, robot: Robot, lines: Sequence[PrintedLine], sums: Mapping[str, Expression], close: float = CLOSE
    ) -> None:
        # robot: whose solution it is; lines: its lines; sums: what names such as q23 stand for
        self.robot, self.lines, self.sums = robot, tuple(lines), sums
        # the lines that only name quantities, those about joints, and those that give a second solution by the first
        self.named = {line.name: line for line in self.lines if line.target is None}
        self.given = tuple(line for line in self.lines if line.target is not None and not line.primed)
        self.primed = tuple(line for line in self.lines if line.primed)
        self.close = close  # difference below which values are the same; decimals of many digits count as rounded
        self._before: dict[PrintedLine, tuple[PrintedLine, ...]] = {}
        self._choices: dict[PrintedLine, dict[str, tuple[float, ...]]] = {}

    def check_size(self) -> None:
        """Refuse a line with more choices than can be tried."""
        for line in self.lines:
            if len(self._signs(line)) > MAX_SIGNS:
                found = f"{line.quantity} depends on {len(self._signs(line))} plus-minus signs"
                raise CheckError(found, allowed=f"allowed: at most {MAX_SIGNS}", location=line.formulas[0].location)

    def changed(self, line: PrintedLine, formula: PrintedFormula, expression: Expression) -> PrintedInverse:
        """The solution with another expression in the place of one."""
        formulas = tuple(replace(f, expression=expression) if f is formula else f for f in line.formulas)
        lines = [replace(line, formulas=formulas) if x is line else x for x in self.lines]
        return PrintedInverse(self.robot, lines, self.sums, self.close)

    def mapped(self, change: Callable[[Expression], Expression]) -> PrintedInverse:
        """The solution with every expression changed."""
        changed = [[replace(f, expression=change(f.expression)) for f in line.formulas] for line in self.lines]
        lines = [replace(x, formulas=tuple(f)) for x, f in zip(self.lines, changed, strict=True)]
        return PrintedInverse(self.robot, lines, self.sums, self.close)

    def combination(self, e: Expression) -> Vector | None:
        """The linear combination of joint variables that an expression is, constants aside; None if it is none."""
        variables = [joint.variable for joint in self.robot.joints]
        vector = [Fraction(0)] * len(variables)
        for factor, term in linear_terms(e):
            if isinstance(term, Name) and term.name in self.sums:
                whole = self.combination(self.sums[term.name])
                vector = [a + factor * b for a, b in zip(vector, whole or vector, strict=True)]
            elif isinstance(term, Name) and term.name in variables:
                vector[variables.index(term.name)] += factor
            elif any(name in variables or name in self.sums for name in names(term)):
                return None
        return tuple(vector) if any(vector) else None

    def meaning(self, e: Expression) -> tuple[str, Vector] | None:
        """What is known where an expression is: an angle or length itself, or its cosine, sine or tangent."""
        if isinstance(e, Call) and e.function in ("cos", "sin", "tan"):
            vector = self.combination(e.arguments[0])
            return (e.function, vector) if vector else None
        vector = self.combination(e)
        return ("", vector) if vector else None

    def needed(self, e: Expression) -> Iterator[tuple[str, Vector]]:
        """What must be known for an expression to have a value."""
        if isinstance(e, Name | Call) and (found := self.meaning(e)):
            yield found
        elif not isinstance(e, Name):
            for part in children(e):
                yield from self.needed(part)

    def named_before(self, line: PrintedLine) -> tuple[PrintedLine, ...]:
        """The named quantities that a line needs, each behind those that it needs itself."""
        if line not in self._before:
            found: dict[str, PrintedLine] = {}
            self._collect(line, found, ())
            self._before[line] = tuple(found.values())
        return self._before[line]

    def _collect(self, line: PrintedLine, found: dict[str, PrintedLine], above: tuple[str, ...]) -> None:
        for formula in line.formulas:
            for name in sorted(formula.names & {*self.named, *above}):
                if name in above:
                    what = f"{listed(dict.fromkeys((*above, name)))} are given by each other"
                    raise CheckError(what, remedy="give one of them by what is known", location=formula.location)
                if name in self.named and name not in found:
                    self._collect(self.named[name], found, (*above, name))
                    found[name] = self.named[name]

    def choices(self, line: PrintedLine) -> dict[str, tuple[float, ...]]:
        """The plus-minus signs and alternatives that the value of a line depends on, with their values."""
        if line not in self._choices:
            several = [part for part in (*self.named_before(line), line) if len(part.formulas) > 1]
            switches = {part.switch: tuple(map(float, range(len(part.formulas)))) for part in several}
            self._choices[line] = {**dict.fromkeys(self._signs(line), (1.0, -1.0)), **switches}
        return self._choices[line]

    def _signs(self, line: PrintedLine) -> tuple[str, ...]:
        formulas = [f for part in (*self.named_before(line), line) for f in part.formulas]
        return tuple(sorted({name for f in formulas for name in f.names if name[0] == SIGN}))

    def value(self, line: PrintedLine, place: Place, choice: Choice) -> float:
        """What a line gives at a configuration."""
        # named quantities have their printed values, so that a slip in one shows in all lines that need it
        known = {**place.values, **choice}
        for part in (*self.named_before(line), line):
            formula = part.formulas[int(choice.get(part.switch, 0))]
            own = {formula.first: float_value(part.formulas[0].expression, known)} if formula.first else {}
            known[part.name or part.quantity] = value = float_value(formula.expression, {**known, **own})
        return value

    def values(self, line: PrintedLine, place: Place, fixed: Choice | None = None) -> Iterator[float]:
        """What a line gives at a configuration, for all choices."""
        free = {name: values for name, values in self.choices(line).items() if name not in (fixed or {})}
        for chosen in product(*free.values()):
            with suppress(*NO_VALUE):
                yield self.value(line, place, {**(fixed or {}), **dict(zip(free, chosen, strict=True))})

    def wanted(self, line: PrintedLine, place: Place) -> float:
        """What a line should give at a configuration; not a number where its left side has no value."""
        assert line.target is not None
        with suppress(*NO_VALUE):
            return float_value(line.target, place.values)
        return math.nan

    def hits(self, line: PrintedLine, place: Place, fixed: Choice | None = None) -> bool:
        """Whether some choice gives what the line is about."""
        if place.twin is not None and self.hits(line, place.twin, fixed):
            return True
        wanted, is_angle = self.wanted(line, place), self.is_angle(line)
        if math.isnan(wanted):  # a left side without a value says nothing here
            return True
        return any(is_same(value, wanted, is_angle, self.close) for value in self.values(line, place, fixed))

    def hit_together(self, lines: Sequence[PrintedLine], place: Place, fixed: Choice | None = None) -> bool:
        """Whether some choice gives what all of some lines are about."""
        shared = {name: values for name, values in self.shared(lines).items() if name not in (fixed or {})}
        return any(
            all(self.hits(line, at, {**(fixed or {}), **dict(zip(shared, chosen, strict=True))}) for line in lines)
            for at in (replace(place, twin=None), *filter(None, (place.twin,)))
            for chosen in product(*shared.values())
        )

    def shared(self, lines: Sequence[PrintedLine]) -> dict[str, tuple[float, ...]]:
        """The choices that more than one of some lines depend on."""
        own = [self.choices(line) for line in lines]
        return {n: values for choices in own for n, values in choices.items() if sum(n in o for o in own) > 1}

    def coupled(self) -> Iterator[tuple[PrintedLine, ...]]:
        """The lines with targets in groups whose choices do not depend on each other."""
        pairs = combinations(self.given, 2)  # tied by a sign or an alternative that both depend on
        tied = [(a, b) for a, b in pairs if not self.choices(a).keys().isdisjoint(self.choices(b))]
        groups = connected_components((self.given, tied))
        yield from (tuple(line for line in self.given if line in group) for group in groups)

    def met(self, place: Place) -> bool:
        """Whether a configuration is given: some choice gives it in all lines at once."""
        return all(self.hit_together(group, place) for group in self.coupled())

    def second(self, place: Place) -> Place | None:
        """The second solution of the pose of a configuration, by the primed lines; None where they have no value."""
        values = dict(place.values)
        for line in self.primed:
            found = next(self.values(line, place), None)
            if found is None or not isinstance(line.target, Name):
                return None
            values[line.target.name] = found
        return self.moved(place, values)

    def moved(self, place: Place, q: Mapping[str, float]) -> Place:
        """A configuration with other joint variables, and what follows for their sums."""
        values = {**place.values, **q}
        sums = {name: float_value(meaning, values) for name, meaning in self.sums.items()}
        return replace(place, values={**values, **sums}, twin=None)

    def has_arc(self, line: PrintedLine) -> bool:
        """Whether an arc function of one argument stands in a line or in what it needs."""
        formulas = [f.expression for part in (*self.named_before(line), line) for f in part.formulas]
        return any(count_calls(e, arc) for e in formulas for arc in ("acos", "asin", "atan"))

    def is_angle(self, line: PrintedLine) -> bool:
        """Whether a line is right up to full turns."""
        assert line.target is not None
        vector = self.combination(line.target)
        revolute = [joint.is_revolute for joint in self.robot.joints]
        return vector is not None and any(c and r for c, r in zip(vector, revolute, strict=True))


def closeness(lines: Iterable[PrintedLine]) -> float:
    """Difference below which values are the same: `CLOSE`, or more where decimals of many digits count as rounded."""
    numbers = (e for line in lines for f in line.formulas for e in nodes(f.expression) if isinstance(e, Number))
    decimals = [digits for e in numbers if (digits := significant(e.value)) in ROUNDED]
    return max(CLOSE, 10.0 ** (3 - max(decimals))) if decimals else CLOSE


def is_same(value: float, wanted: float, is_angle: bool, close: float = CLOSE) -> bool:
    """Whether two values are the same, angles up to full turns."""
    if is_angle:
        return abs(math.remainder(value - wanted, math.tau)) < close
    return abs(value - wanted) < close * (1 + abs(wanted))


class Known:
    """What is known of the joint variables: linear combinations, cosines and sines of some."""

    def __init__(self, rows: Iterable[Vector]) -> None:
        self._rows = list(rows)
        self._functions: set[tuple[str, Vector]] = set()

    def has(self, function: str, vector: Vector) -> bool:
        """Whether it follows from what is known."""
        if (function, vector) in self._functions:
            return True
        # a linear combination of known ones: the rank of the rows does not grow with it
        rows = np.array([*self._rows, vector], dtype=float)
        return bool(np.linalg.matrix_rank(rows) == (np.linalg.matrix_rank(rows[:-1]) if len(rows) > 1 else 0))

    def add(self, function: str, vector: Vector) -> None:
        """One thing more; cosine and sine together are the angle."""
        self._functions.add((function, vector))
        if not function or {("cos", vector), ("sin", vector)} <= self._functions:
            self._rows.append(vector)


def free_joints(printed: PrintedInverse) -> tuple[str, ...]:
    """The joint variables that are taken as known: no line gives them, or only as a part of a sum."""
    own = [vector for _, (_, vector) in _meanings(printed)]
    units = _units(printed)
    untouched = [name for j, name in enumerate(units) if not any(vector[j] for vector in own)]
    alone = [name for name, unit in units.items() if unit not in own]
    return tuple(untouched if not _ordered(printed, untouched)[1] else alone)


def determined_joints(printed: PrintedInverse) -> tuple[str, ...]:
    """The joint variables that the lines give."""
    free = free_joints(printed)
    known, left = _ordered(printed, free)
    if left:
        whole = listed(dict.fromkeys(line.quantity for line in left))
        found = f"{whole} are given by each other" if len(left) > 1 else f"{whole} is given by itself"
        raise CheckError(found, remedy="give one of them by the pose alone", location=left[0].formulas[0].location)
    return tuple(name for name, unit in _units(printed).items() if name not in free and known.has("", unit))


def _units(printed: PrintedInverse) -> dict[str, Vector]:
    names = [joint.variable for joint in printed.robot.joints]
    return {name: tuple(Fraction(int(other == name)) for other in names) for name in names}


def _meanings(printed: PrintedInverse) -> list[tuple[PrintedLine, tuple[str, Vector]]]:
    """Lines with what is known from them: an angle, a length or a sum, or a cosine, sine or tangent."""
    return [(line, m) for line in printed.given if line.target and (m := printed.meaning(line.target))]


def _ordered(printed: PrintedInverse, free: Sequence[str]) -> tuple[Known, list[PrintedLine]]:
    """What is known at the end where some joint variables are, and the lines that need each other."""
    units = _units(printed)
    known, waiting = Known(units[name] for name in free), _meanings(printed)
    while ready := [step for step in waiting if all(known.has(*need) for need in _needs(printed, step[0]))]:
        for _, found in ready:
            known.add(*found)
        waiting = [step for step in waiting if step not in ready]
    return known, [line for line, _ in waiting]


def _needs(printed: PrintedInverse, line: PrintedLine) -> Iterator[tuple[str, Vector]]:
    for formula in (f for part in (*printed.named_before(line), line) for f in part.formulas):
        own = {formula.first: ZERO} if formula.first else {}
        yield from printed.needed(substitute(formula.expression, own))
