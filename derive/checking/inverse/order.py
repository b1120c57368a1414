"""In which order the lines of a printed solution can be used, and which joint variables they give."""

from collections.abc import Iterable, Iterator, Sequence
from fractions import Fraction

import numpy as np

from derive.checking.inverse.printed import PrintedInverse, PrintedLine, Vector
from derive.errors import CheckError, listed
from derive.robot.expression import ZERO, substitute


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
        where = left[0].formulas[0].location
        raise CheckError(found, remedy="give one of them by the pose alone", location=where)
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
    for part in (*printed.named_before(line), line):
        for formula in part.formulas:
            own = {formula.first: ZERO} if formula.first else {}
            yield from printed.needed(substitute(formula.expression, own))
