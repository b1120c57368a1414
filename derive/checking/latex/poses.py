"""Names of a document for entries of a pose, ``x``, ``p_x``, ``r_{13}``: which pose they mean is settled for all of it.

A name stays a name while the document is read. Afterwards the pose is chosen with which most equations hold: the end
effector's, or that of the wrist; rotations from the base, or from the third frame.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

from derive.checking.formulas.diagnosis import Question
from derive.checking.formulas.findings import Finding, Role, compared
from derive.checking.inverse.latex import printed_words
from derive.checking.inverse.poses import PoseNames
from derive.errors import Location
from derive.lecture.sympy_conversion import expression_from_sympy
from derive.model.model import Model
from derive.robot.description import Convention
from derive.robot.expression import Call, Expression, Name, names, substitute
from derive.robot.names import own_names
from derive.robot.robot import Robot

CERTAIN = 1  # equations that must be right in one reading of the pose before another one is wrong
MARK = "⌖"  # first letter of what stands for a name of the pose
_POINT = re.compile(r"([xyzXYZ])_?([1-9])")  # a coordinate of the end of a link
WRIST = 3  # joints of a wrist


@dataclass(frozen=True)
class PoseReading:
    """What the names of a pose mean."""

    position: int  # the frame whose origin is meant
    reference: int  # the frame from which a rotation to the end effector is meant
    values: Mapping[str, Expression]  # what each name stands for
    usual: bool  # whether it is the pose of the end effector in the base

    @property
    def shown(self) -> str:
        """The reading in words."""
        return f"positions are read as the origin of frame {self.position}, rotations from frame {self.reference}"


@dataclass(frozen=True, slots=True)
class Claim:
    """An equation with names of a pose, which is compared once it is known which pose is meant."""

    first: Expression
    other: Expression
    left: str  # the first side as printed
    right: str  # the other one
    where: Location
    is_open: bool = False  # whether it may be no claim at all: one name may have two meanings
    is_branch: bool = False  # whether the first side is a joint variable whose label may be that of a branch

    def read(self, robot: Robot, reading: PoseReading | None = None) -> Finding:
        """The comparison in a reading; without one it has no names of a pose."""
        first, other = (substitute(e, reading.values) if reading else e for e in (self.first, self.other))
        question = Question(robot, other, first)
        return compared(question, self.left, (0, 0), Role.IDENTITY, self.right, self.left, self.where)


class Poses:
    """The names of a pose in one text."""

    def __init__(self, model: Model, text: str) -> None:
        words = list(printed_words(text))
        self._model, self._names = model, PoseNames.of(model.robot, words)
        points = {word: match for word in words if (match := _POINT.fullmatch(word))}
        known = {word: ("xyz".index(match[1].lower()), int(match[2])) for word, match in points.items()}
        self._points = {
            word: at for word, at in known.items() if at[1] <= model.n and word not in own_names(model.robot)
        }

    def placeholder(self, name: str) -> Expression | None:
        """What stands for a name until its meaning is settled; None where it is no name of a pose."""
        pose = self._names
        known = name in pose.entries or name in pose.wrist or name in self._points
        return Name(MARK + name) if known else self._angle(name)

    def _angle(self, name: str) -> Expression | None:
        """The orientation of a planar arm, the angle in the first entry of its rotation."""
        meaning = self._names.angles.get(name)
        first = expression_from_sympy(self._model.quantity("T")[0, 0])
        if meaning is None or not (isinstance(first, Call) and first.function == "cos"):
            return None
        return substitute(meaning, {"(phi)": first.arguments[0]})

    def judged(self, claims: Sequence[Claim], told: list[str], known: bool) -> list[Finding | None]:
        """The verdicts on equations about a pose, in the reading that most of them need; None where it is uncertain."""
        if not claims:
            return []
        readings = [
            (reading, [claim.read(self._model.robot, reading) for claim in claims]) for reading in self.readings
        ]
        reading, found = max(readings, key=lambda pair: sum(finding.verdict.equal for finding in pair[1]))
        right = sum(finding.verdict.equal for finding in found)
        if right and not reading.usual:
            told.append(f"{reading.shown} ({right} of {len(found)} equations)")
        # what no pose explains is wrong only where several others say which pose is meant
        is_certain = (right >= CERTAIN and 2 * right >= len(found)) or (known and reading.usual)
        is_firm = [is_certain and not (claim.is_branch or claim.is_open) for claim in claims]
        return [f if f.verdict.equal or firm else None for f, firm in zip(found, is_firm, strict=True)]

    @cached_property
    def readings(self) -> tuple[PoseReading, ...]:
        """The readings that are tried, the usual one first."""
        n = self._model.n
        origins = {k: self._model.quantity(f"T[0,{k}]")[:3, 3] for k in range(n - 1, max(n - 1 - WRIST, 0), -1)}
        whole = self._model.quantity("T")
        distinct = [k for k, p in origins.items() if p != whole[:3, 3] and p != origins.get(k + 1)]
        places = [(n, 0), *((k, 0) for k in distinct)]
        places += [(k, n - WRIST) for k, _ in places] if n > WRIST else []
        return tuple(self._reading(position, reference) for position, reference in places)

    def _reading(self, position: int, reference: int) -> PoseReading:
        n, quantity = self._model.n, self._model.quantity
        place = quantity("T") if position == n else quantity(f"T[0,{position}]")
        turn = quantity(f"T[{reference},{n}]") if reference else quantity("T")
        wrist = quantity(f"T[0,{max(n - 2, 1)}]")  # the origin of the last frame but two is that of a wrist
        entries = {
            name: (place if column == 4 else turn)[row - 1, column - 1]
            for name, (row, column) in self._names.entries.items()
        }
        entries |= {name: wrist[k, 3] for name, k in self._names.wrist.items()}
        shift = self._model.robot.convention is Convention.MODIFIED  # there a link ends at the next frame
        ends = {k: quantity(f"T[0,{k + shift}]") if k + shift <= n else quantity("T") for _, k in self._points.values()}
        entries |= {name: ends[k][axis, 3] for name, (axis, k) in self._points.items()}
        values = {MARK + name: expression_from_sympy(value) for name, value in entries.items()}
        return PoseReading(position, reference, values, position == n and not reference)


def names_of_pose(*formulas: Expression) -> set[str]:
    """The names of a pose in formulas, as they are printed."""
    return {name.removeprefix(MARK) for e in formulas for name in names(e) if name[0] == MARK}
