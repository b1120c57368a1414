"""What is found of an arm's singularities, and its words: as text, or as LaTeX with the words in ``text``."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

import sympy

from derive.lecture.sympy_conversion import Expr, Matrix
from derive.mechanics.exact import Reference

Write = Callable[[Any], str]


class Outcome(StrEnum):
    """What was found."""

    FOUND = "found"  # the rank is less than usual where a condition holds
    NEVER = "never"  # the rank is the same in every configuration
    EVERYWHERE = "everywhere"  # the rank is less than the numbers of rows and columns in every configuration
    UNSOLVED = "no closed form"  # no closed form was found of where the rank is less than usual


class Posture(StrEnum):
    """What a singular posture is called (Siciliano et al., Robotics, sec. 3.3.2 and 3.3.3)."""

    WRIST = "wrist"  # axes 4 and 6 are aligned
    ELBOW = "elbow"  # the arm is stretched out or folded: the wrist centre lies in the plane of axes 2 and 3
    SHOULDER = "shoulder"  # the wrist centre lies on axis 1, or in the plane through it that is parallel to axis 2


@dataclass(frozen=True)
class Condition:
    """Where one factor is zero."""

    expression: Expr  # the factor
    variable: Expr | None  # the joint variable, or the sum of angles, that can be solved for; None if none can
    values: tuple[Expr, ...]  # what it is there, angles in (-pi, pi]; empty if nothing can be solved
    posture: Posture | None  # what the arm looks like, where that is certain
    joints: tuple[int, ...]  # the joints (from 1) whose variables it holds
    is_certain: bool = True  # whether it is known that it can be zero, whatever the parameters are

    @property
    def is_solution(self) -> bool:
        """Whether it is the variable less its one value, printed ``q2 = pi``; not ``q3``, which is zero itself."""
        return len(self.values) == 1 and bool(self.expression == self.variable - self.values[0] != self.variable)


@dataclass(frozen=True)
class JacobianBlock:
    """A square block of J."""

    name: str  # ``J``, or ``J_11`` and ``J_22`` where J is block triangular about the wrist centre
    rows: tuple[int, ...]  # its rows of J, from 1; none where they are combinations of these
    columns: tuple[int, ...]  # its columns of J, from 1
    reference: Reference  # the point and the axes that J is taken about and in
    others_are_zero: bool  # whether the rows of J that are left out are zero everywhere
    matrix: Matrix  # the block; before it is written its polynomials, row by row
    task: tuple[str, ...] = ()  # what its rows are the velocities of; empty for all of J


@dataclass(frozen=True)
class SingularFactor:
    """A factor of the determinant."""

    expression: Expr  # the factor
    exponent: int  # its power
    condition: Condition | None  # where it is zero; None if it does not move with the arm, or is never zero
    moves: bool = True  # whether it changes with the arm


@dataclass(frozen=True)
class Singularities:
    """Where an arm is singular."""

    outcome: Outcome  # what was found
    blocks: tuple[JacobianBlock, ...] = ()  # whose determinants are multiplied; none where no square block decides
    determinant: Expr | None = None  # their product in factors; 0 if singular everywhere, None where there is none
    factors: tuple[SingularFactor, ...] = ()  # without a determinant what alone makes all minors zero
    task: tuple[str, ...] = ()  # whose velocities the rows are: x, y, z, phi, position, ...; empty for all of J
    shape: tuple[int, int] = (6, 6)  # rows and columns of the Jacobian
    rank: int | None = None  # its usual rank; None where it was not computed
    families: tuple[tuple[Condition, ...], ...] = ()  # the rank is less where all conditions of one of these hold
    complete: bool = True  # whether it is less nowhere else
    unless: tuple[Expr, ...] = ()  # what is taken not to be zero where ``complete``

    @property
    def conditions(self) -> tuple[Condition, ...]:
        """Each of these alone makes the rank less than usual."""
        return tuple(family[0] for family in self.families if len(family) == 1)

    @property
    def square(self) -> str:
        """The matrix whose determinant is zero where the rank is less: ``J``, ``J^T*J`` or ``J*J^T``; else empty."""
        rows, columns = self.shape
        if self.rank != min(self.shape):
            return ""
        return "J" if rows == columns else "J^T*J" if rows > columns else "J*J^T"

    @property
    def is_constant(self) -> bool:
        """Whether no factor changes with the arm."""
        return not any(factor.moves for factor in self.factors)

    @property
    def expressions(self) -> tuple[Expr, ...]:
        """Everything in it that is printed."""
        values = (value for family in self.families for c in family for value in (c.expression, *c.values))
        return (*([] if self.determinant is None else [self.determinant]), *values, *self.unless)

    def latex_lines(self, write: Callable[[Expr], str] = sympy.latex) -> list[str]:
        """The determinant, and where the rank is less, aligned for mathematics mode."""
        of = "\\mathbf{J}'" if self.task else "\\mathbf{J}"  # as in the handout
        determinant = [f"\\det {of} = {write(self.determinant)}"] if self.blocks else []
        body = (f"  & {line} \\\\" for line in (*determinant, *statement(self, write, latex=True)))
        return ["\\begin{aligned}", *body, "\\end{aligned}"]

    def _repr_latex_(self) -> str:
        return f"$\\displaystyle {' '.join(self.latex_lines())}$"


def statement(found: Singularities, write: Write, *, latex: bool = False) -> Iterator[str]:
    """What decides, where the rank is less, and whether that is all."""

    def words(text: str) -> str:
        return f"\\text{{{text}}}" if latex else text

    zero = f"det({found.square}) = 0" if found.square else ""
    if latex:
        zero = zero.replace("det", "\\det").replace("*", " ")
    if found.blocks and found.task:
        yield words(f"the determinant of {_matrix(found)}")
    elif not found.blocks:
        least = "usual" if found.rank is None else str(found.rank)
        end = words(", ") + zero if zero else words("" if found.rank is None else ", which it never exceeds")
        where = words(f"where the rank of {_matrix(found)} is less than {least}") + end
        yield where if found.rank != 0 else words(f"{_matrix(found)} is zero in every configuration")
    yield from (_family(family, write, words) for family in found.families)
    unless = words(" or ").join(map(write, found.unless))
    unless = words(" unless ") + unless + words(" is 0") if unless else ""
    if not found.complete:
        none = "others may exist" if found.families else "no closed form was found"
        yield words(f"{none}; what decides is ") + (zero or words("the rank in numbers"))
    elif found.families and not found.blocks:
        yield words("nowhere else") + unless
    elif not found.families and found.blocks and not found.is_constant:
        yield words("no singularity: it is zero in no configuration")
    elif not found.families:
        if found.determinant is not None and found.determinant.free_symbols:
            unless = words(" unless this is 0")
        what = "it" if found.blocks else "the rank"
        yield words("no singularity") + unless + words(f": {what} is the same in every configuration")


def _matrix(found: Singularities) -> str:
    """``J (6x4)``, ``J for the task x, y (rows 1, 2)``."""
    task = f" for the task {', '.join(found.task)}" if found.task else ""
    if not found.blocks:
        return f"J{task} ({found.shape[0]}x{found.shape[1]})"
    block = found.blocks[0]
    axes = "" if block.reference.frame is None else f" in the axes of frame {block.reference.frame}"
    point = "" if block.reference.point is None else f" about the origin of frame {block.reference.point}"
    rows = f" (rows {', '.join(map(str, block.rows))})" if block.rows else ""
    return f"J{task}{rows}{axes}{point}"


def _family(family: tuple[Condition, ...], write: Write, words: Write) -> str:
    """``s2 = 0 and c3 = 0: q2 = 0 or pi, q3 = -pi/2 or pi/2 (elbow)``."""
    zeros, solved = [], []
    for c in family:
        solution = f"{write(c.variable)} = {words(' or ').join(map(write, c.values))}" if c.values else ""
        zeros.append(solution if c.is_solution else f"{write(c.expression)} = 0")
        solved += [solution] if solution and not c.is_solution and c.expression != c.variable else []
    notes = [c.posture.value for c in family if c.posture]
    notes += [] if all(c.is_certain for c in family) else ["where this has real solutions"]
    found = words(" and ").join(zeros) + (words(": ") + ", ".join(solved) if solved else "")
    return found + "".join(words(f" ({note})") for note in notes)
