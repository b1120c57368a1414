"""Linear combinations of joint variables in printed lines, and what follows from those that are known."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction

import numpy as np

from derive.robot.expression import Call, Expression, Name, children, linear_terms, names
from derive.robot.robot import Robot

Vector = tuple[Fraction, ...]  # a linear combination of the joint variables


class JointCombinations:
    """Reads expressions as linear combinations of joint variables."""

    def __init__(self, robot: Robot, sums: Mapping[str, Expression]) -> None:
        self._variables = [joint.variable for joint in robot.joints]
        self._sums = sums

    def combination(self, e: Expression) -> Vector | None:
        """The linear combination of joint variables that an expression is, constants aside; None if it is none."""
        variables = self._variables
        vector = [Fraction(0)] * len(variables)
        for factor, term in linear_terms(e):
            if isinstance(term, Name) and term.name in self._sums:
                whole = self.combination(self._sums[term.name])
                vector = [a + factor * b for a, b in zip(vector, whole or vector, strict=True)]
            elif isinstance(term, Name) and term.name in variables:
                vector[variables.index(term.name)] += factor
            elif any(name in variables or name in self._sums for name in names(term)):
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


class Known:
    """What is known of the joint variables: linear combinations, cosines and sines of some."""

    def __init__(self, joints: Sequence[int], n: int) -> None:
        self._rows: list[Vector] = [unit_vector(j, n) for j in joints]
        self._functions: set[tuple[str, Vector]] = set()

    def has(self, function: str, vector: Vector) -> bool:
        """Whether it follows from what is known."""
        if (function, vector) in self._functions:
            return True
        rows = np.array([*self._rows, vector], dtype=float)
        return bool(np.linalg.matrix_rank(rows) == (np.linalg.matrix_rank(rows[:-1]) if len(rows) > 1 else 0))

    def add(self, function: str, vector: Vector) -> None:
        """One thing more; cosine and sine together are the angle."""
        self._functions.add((function, vector))
        if not function or {("cos", vector), ("sin", vector)} <= self._functions:
            self._rows.append(vector)


def unit_vector(j: int, n: int) -> Vector:
    """One joint variable."""
    return tuple(Fraction(int(k == j)) for k in range(n))
