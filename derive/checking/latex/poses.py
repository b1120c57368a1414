"""Names for entries of a pose, ``x``, ``r_{13}``: in a whole document those of the pose that most equations need."""

import re
from collections.abc import Iterable, Mapping, Sequence
from collections.abc import Set as AbstractSet
from contextlib import suppress
from dataclasses import dataclass, replace
from enum import Enum
from functools import cached_property

import sympy

from derive.checking.formulas.diagnosis import Question
from derive.checking.formulas.findings import Finding, Role, compared
from derive.checking.inverse.poses import PoseNames
from derive.checking.inverse.reading import printed_words
from derive.checking.latex.left import AXES
from derive.checking.latex.quantities import own_quantity, slope
from derive.errors import CheckError, Location
from derive.lecture.sympy_conversion import Expr, Matrix, expression_from_sympy
from derive.model.equality import compare
from derive.model.model import Model
from derive.robot.description import Convention
from derive.robot.expression import Call, Expression, Name, multiply, names, number, substitute
from derive.robot.names import own_names
from derive.robot.robot import Robot

CERTAIN = 1  # equations that must be right in one reading of the pose before another one is wrong
MARK = "⌖"  # first letter of what stands for a name of the pose
# A coordinate of a point of a link, or its speed; with a letter before the number it is the centre of mass.
_POINT = re.compile(r"([xyzXYZv])_?([cCgG]?)_?([1-9])|([pPv])_?([cCgG]?)_?([1-9])_?([xyz])")
_OF_COLUMN = re.compile("[nsoap]_?[xyz]")  # an entry of [n o a p], which is the pose of the end effector
WRIST = 3  # joints of a wrist


class Points(Enum):
    """What a point with the number of a link is."""

    END = "the ends of links"
    CENTRE = "centres of mass"
    JOINT = "the joints where links begin"
    NEXT = "centres of mass of the links on a cart"
    CART = "ends of links, seen from the cart"
    AXIS = "coordinates of the end effector, x_1, x_2 and x_3"


class Settled(Enum):
    """What is settled for itself, one after the other."""

    PLACE = "positions"
    TURN = "rotations"
    POINT = "points of links"
    WRIST = "the wrist"
    ANGLE = "the orientation of a planar arm"
    LABEL = "entries with the number of a frame"


@dataclass(frozen=True)
class PoseReading:
    """What the names of a pose mean."""

    position: int  # the frame whose origin is meant
    reference: int  # the frame from which a rotation to the end effector is meant
    values: Mapping[str, Expression]  # what each name stands for
    usual: bool  # whether it is the pose of the end effector in the base
    points: Points = Points.END  # what points with the number of a link are
    wrist: int = 0  # the frame whose origin is the wrist

    def shown(self, group: Settled) -> str:
        """The reading of one kind of names in words."""
        readings = {
            Settled.POINT: f"points are read as {self.points.value}",
            Settled.WRIST: f"the wrist is read as the origin of frame {self.wrist}",
            Settled.LABEL: "entries with the number of a frame are read as those of its own pose in the base",
        }
        usual = f"positions are read as the origin of frame {self.position}, rotations from frame {self.reference}"
        return readings.get(group, usual)


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

    @property
    def pose_names(self) -> set[str]:
        """The names of a pose in it."""
        return names_of_pose(self.first, self.other)

    def is_condition(self, robot: Robot) -> bool:
        """Whether a side has parameters alone: it says where the hand is, such as x^2 + y^2 = (l_1 + l_2)^2."""
        is_still = {joint.variable for joint in robot.movers}.isdisjoint((*names(self.first), *names(self.other)))
        return is_still and not (names_of_pose(self.first) and names_of_pose(self.other))

    def read(self, robot: Robot, values: Mapping[str, Expression] | None = None) -> Finding:
        """The comparison with values for the names of a pose; without them it has none."""
        first, other = (substitute(e, values) if values else e for e in (self.first, self.other))
        question = Question(robot, other, first)
        return compared(question, self.left, (0, 0), Role.IDENTITY, self.right, self.left, self.where)


class Poses:
    """The names of a pose in one text."""

    def __init__(
        self,
        model: Model,
        text: str,
        columns: Mapping[str, int],
        letters: AbstractSet[str] = frozenset(),
        matrices: AbstractSet[str] = frozenset(),  # names of matrices, which are no entries: T_{21} = [...]
    ) -> None:
        self._letters = "|".join(letters)  # of entries, the author's own
        words = [word for word in printed_words(text) if word not in matrices]
        found = PoseNames.of(model.robot, words, any_wrist=model.n > WRIST)
        named = {word: re.fullmatch("([a-z])_?([xyz])", word) for word in words}
        own = {w: ("xyz".index(m[2]) + 1, columns[m[1]]) for w, m in named.items() if m and m[1] in columns}
        self._model, self._names = model, replace(found, entries={**found.entries, **own})
        self._has_accelerations = bool(re.search(r"\\ddot\s*\{?\s*[xyzXYZ]", text))
        points = {word: match for word in words if (match := _POINT.fullmatch(word))}
        self._centres = {word for word, match in points.items() if (match[2] or match[5]) and model.robot.links}
        known = [(w, m) for w, m in points.items() if w in self._centres or not (m[2] or m[5])]
        # the axis of each, 3 for a speed, from 4 on for a coordinate of the velocity, and the link
        places = ("xyzv".index((m[1] or m[7]).lower()) + 4 * (m[4] == "v") for _, m in known)
        axes = {w: (axis, int(m[3] or m[6])) for (w, m), axis in zip(known, places, strict=True)}
        # row and column of each that the text has, and the poses that may be meant: seen from a frame, or its own
        self._labelled: dict[str, tuple[int, int, tuple[str, str]]] = {}
        self.named: Matrix | None = None  # whose entries the names of this part of the text are; None for the whole arm
        self.settled: PoseReading | None = None  # what the text as a whole means, once its equations are judged
        last = model.n + (f"x{model.n + 1}" in axes)  # P_3 of two links, the end effector or the last centre of mass
        self._points = {w: at for w, at in axes.items() if at[1] <= last and w not in own_names(model.robot)}

    @property
    def has_o_columns(self) -> bool:
        """Whether o_x belongs to the second column of a rotation, not to the position."""
        return any(name[0] == "o" and column == 2 for name, (_, column) in self._names.entries.items())

    def placeholder(self, name: str) -> Expression | None:
        """What stands for a name until its meaning is settled; None where it is no name of a pose."""
        pose, (base, _, frame), n = self._names, name.partition("^"), self._model.n
        if self.named is not None and name in pose.entries:
            return expression_from_sympy(self.named[tuple(index - 1 for index in pose.entries[name])])
        if self._letters and (own := re.fullmatch(f"({self._letters})([1-3])([1-3])", name)):
            self._labelled[name] = (int(own[2]), int(own[3]), (f"T[{max(n - WRIST, 0)},{n}]", "T"))
        elif base in pose.entries and frame and int(frame) < n:
            self._labelled[name] = (*pose.entries[base], (f"T[{frame},{n}]", f"T[{frame}]"))
        known = any(name in each for each in (self._labelled, pose.entries, pose.wrist)) or self.is_point(name)
        return Name(MARK + name) if known or MARK + name in self._angles else None

    def is_other(self, name: str, words: AbstractSet[str]) -> bool:
        """Whether a name is given by another name of the same coordinate, and so is one of the author's own."""
        entries, wrist = self._names.entries, self._names.wrist
        if name in AXES and any((wrist[w] + 1, 4) == entries.get(name) for w in words if w in wrist):
            return not any(entries.get(word, (0, 4))[1] < 4 for word in words)  # z = d_1 - z_w
        places = {**entries, **wrist}
        return any(word != name and places.get(word, name) == places.get(name) for word in words)

    @cached_property
    def _angles(self) -> dict[str, Expression]:
        """What names of the orientation of a planar arm stand for: the angle in the first entry of its rotation."""
        if not self._names.angles:
            return {}
        turns = zip(self._model.q, self._model.quantity("J")[5, :], strict=True)  # about one direction
        angle = expression_from_sympy(sympy.Add(*(q * turn for q, turn in turns)))
        first = expression_from_sympy(self._model.quantity("T")[0, 0])
        if not compare(self._model.robot, first, Call("cos", (angle,))).equal:
            return {}
        return {MARK + name: substitute(meaning, {"(phi)": angle}) for name, meaning in self._names.angles.items()}

    def judged(self, claims: Sequence[Claim], told: list[str], known: bool, is_named: bool) -> list[Finding | None]:
        """The verdicts in the reading that most equations need, or as known or named; None where it is uncertain."""
        findings: dict[int, Finding | None] = {}
        chosen = self.readings[0]
        for group in Settled:
            own = {i: claim for i, claim in enumerate(claims) if self._group(claim) is group}
            if not own:
                continue
            # positions say which origin is meant, then rotations which frame they are seen from
            readings = self._readings_of(group, chosen)
            found = [(readings[0], [self._read(claim, readings[0]) for claim in own.values()])]
            if not all(map(_is_right, found[0][1])):
                found += [(r, [self._read(claim, r) for claim in own.values()]) for r in readings[1:]]
            chosen, verdicts = max(found, key=lambda pair: sum(map(_is_right, pair[1])))
            right = sum(map(_is_right, verdicts))
            # most need another origin; beside names of the wrist p_x is hardly that of the wrist
            if group is Settled.PLACE and (2 * right < len(verdicts) or (self._names.wrist and right <= CERTAIN)):
                chosen, verdicts = found[0]
            if chosen.reference and group in (Settled.TURN, Settled.WRIST):  # before R_36 is spoken of, as usual
                usual = [self._read(claim, self.readings[0]) for claim in own.values()]
                verdicts = [u if _is_right(u) else f for u, f in zip(usual, verdicts, strict=True)]
            if (right := sum(map(_is_right, verdicts))) and chosen is not readings[0]:
                told.append(f"{chosen.shown(group)} ({right} of {len(verdicts)} equations)")
            # what no reading explains is wrong only where others of its kind say which one is meant
            of_columns = all(map(_OF_COLUMN.fullmatch, (n for claim in own.values() for n in claim.pose_names)))
            is_place = group is Settled.PLACE and known  # of the usual pose it is enough that something else says so
            is_turn = group is Settled.TURN and of_columns and (known or right)
            is_most = right >= CERTAIN and 2 * right >= len(verdicts)
            may_say = is_named and group is not Settled.LABEL
            is_certain = is_most or (chosen.usual and (is_place or is_turn))
            for (i, claim), finding in zip(own.items(), verdicts, strict=True):
                # labels of branches, and names with two meanings, may explain what is wrong
                may_differ = claim.is_branch or (claim.is_open and group is not Settled.POINT)
                is_said = may_say and isinstance(claim.first, Name) and not names_of_pose(claim.other)
                is_some = claim.is_branch and finding is not None and finding.some
                is_told = is_some or ((is_certain or is_said) and not may_differ)
                findings[i] = finding if _is_right(finding) or is_told else None
        self.settled = chosen
        return [findings[i] for i in range(len(claims))]

    def _readings_of(self, group: Settled, chosen: PoseReading) -> list[PoseReading]:
        """What names of one kind may mean, the others being settled already."""
        match group:
            case Settled.ANGLE:
                return [chosen]
            case Settled.LABEL:
                return [replace(chosen, values={**chosen.values, **self.labels(k)}) for k in (False, True)]
            case Settled.POINT:
                return [replace(chosen, values={**chosen.values, **self._values(k)}, points=k) for k in self._kinds]
            case Settled.WRIST:
                return [replace(chosen, values={**chosen.values, **self._wrist(k)}, wrist=k) for k in self._wrists()]
        return [reading for reading in self.readings if group is Settled.TURN or not reading.reference]

    def _read(self, claim: Claim, reading: PoseReading) -> Finding | None:
        """The comparison in a reading, of numbers in the units of the file; None where a side has no value in it."""
        found = self._read_with(claim, reading, reading.values)
        if self._model.robot.units.millimetres and not (_is_right(found) or (found and found.some)):
            lengths = (name for name in claim.pose_names if self._names.entries.get(name, (0, 4))[1] == 4)
            own = {MARK + n: multiply(number(1000), e) for n in lengths if (e := reading.values.get(MARK + n))}
            again = self._read_with(claim, reading, {**reading.values, **own})
            found = again if _is_right(again) or (again and again.some) else found
        return found

    def _read_with(self, claim: Claim, reading: PoseReading, values: Mapping[str, Expression]) -> Finding | None:
        with suppress(CheckError, ArithmeticError):
            sides = (substitute(e, values) for e in (claim.first, claim.other))
            joints = {joint.variable for joint in self._model.robot.movers}
            if not reading.usual and joints.isdisjoint(name for side in sides for name in names(side)):
                return None  # a reading in which nothing moves explains everything
            return claim.read(self._model.robot, values)
        return None

    def _group(self, claim: Claim) -> Settled:
        """What the names in a claim say: a point of a link, a rotation, or a position."""
        known, pose = claim.pose_names, self._names
        kinds: dict[Settled, Iterable[str]] = {Settled.LABEL: self._labelled, Settled.ANGLE: pose.angles}
        kinds |= {Settled.POINT: filter(self.is_point, known), Settled.WRIST: pose.wrist}
        kinds |= {Settled.TURN: (name for name, (_, column) in pose.entries.items() if column < 4)}
        return next((group for group, own in kinds.items() if not known.isdisjoint(own)), Settled.PLACE)

    @cached_property
    def readings(self) -> tuple[PoseReading, ...]:
        """The readings that are tried, the usual one first."""
        n = self._model.n
        origins = {k: self._model.quantity(f"T[{k}]")[:3, 3] for k in range(n - 1, max(n - 1 - WRIST, 0), -1)}
        whole = self._model.quantity("T")
        distinct = [k for k, p in origins.items() if p != whole[:3, 3] and p != origins.get(k + 1)]
        places = [(n, 0), *((k, 0) for k in distinct)]
        # rotations of a wrist of three joints, or of what follows the three joints of the arm
        places = places[:1] if self._model.robot.is_tree else places
        places += [(k, frame) for frame in dict.fromkeys((n - WRIST, WRIST)) if 0 < frame < n for k, _ in places]
        readings, others = [], self._wrist(self._wrists()[0]) | self._values(Points.END) | self._angles
        for position, reference in places:
            place = whole if position == n else self._model.quantity(f"T[{position}]")
            turn = self._model.quantity(f"T[{reference},{n}]") if reference else whole
            at = self._names.entries.items()
            entries = {name: (place if j == 4 else turn)[i - 1, j - 1] for name, (i, j) in at}
            is_usual = (position, reference) == (n, 0)
            readings.append(PoseReading(position, reference, _placed(entries) | others, is_usual))
        return tuple(readings)

    def labels(self, is_of_frame: bool = False) -> dict[str, Expression]:
        """What entries with the number of a frame stand for: those of its pose, or of the end effector seen from it."""
        found = self._labelled.items()
        return _placed({name: self._model.quantity(seen[is_of_frame])[i - 1, j - 1] for name, (i, j, seen) in found})

    def _wrists(self) -> list[int]:
        """The frames whose origins may be the wrist: that of the three last joints, or of the last one."""
        n = self._model.n
        return [k for k in ((n - 2, n - 1, n) if n > WRIST + 1 else (n - 1, n, n - 2)) if k > 0]

    def _wrist(self, frame: int) -> dict[str, Expression]:
        place = self._model.quantity(f"T[{frame}]")
        return _placed({name: place[k, 3] for name, k in self._names.wrist.items()})

    def is_point(self, name: str) -> bool:
        """Whether a name is that of a coordinate of a point of a link, its derivative or its speed."""
        return name.rstrip("'") in self._points

    def point_readings(self, known: set[str]) -> list[Mapping[str, Expression]]:
        """What names stand for with each meaning of the points among them."""
        found = ({**self.readings[0].values, **self._values(kind)} for kind in self._kinds)
        return [*{tuple(reading.get(MARK + name) for name in sorted(known)): reading for reading in found}.values()]

    @property
    def _kinds(self) -> list[Points]:
        """What points may be; with x_1 and x_2 alone, also the coordinates of one of them."""
        are_axes = all(axis == 0 and k <= len(AXES) and w not in self._centres for w, (axis, k) in self._points.items())
        has_cart = self._model.n > 1 and not self._model.robot.movers[0].is_revolute and bool(self._model.robot.links)
        may_be = {Points.AXIS: are_axes, **dict.fromkeys((Points.NEXT, Points.CART), has_cart)}
        return [kind for kind in Points if may_be.get(kind, True)]

    def _values(self, kind: Points) -> dict[str, Expression]:
        """What the names of points stand for, and those of their velocities."""
        places = self._points
        if kind is Points.AXIS:
            kind, places = Points.END, {name: (k - 1, self._model.n) for name, (_, k) in places.items()}
        kinds = {name: Points.CENTRE if name in self._centres else kind for name in places}
        found = {name: self._point(k, kinds[name]) for name, (_, k) in places.items()}
        moving = {name: slope(self._model.robot, point, "t") for name, point in found.items()}
        values: dict[str, Expr] = {}
        for name, (axis, _) in places.items():
            if axis == 3:  # the speed
                values[name] = sympy.sqrt(sympy.Add(*(rate**2 for rate in moving[name])))
            else:
                values[name] = moving[name][axis - 4] if axis > 3 else found[name][axis]
                values[f"{name}'"] = slope(self._model.robot, values[name], "t")
                if self._has_accelerations:
                    values[f"{name}''"] = slope(self._model.robot, values[f"{name}'"], "t")
        return _placed(values)

    def _point(self, link: int, kind: Points) -> Matrix:
        robot, n = self._model.robot, self._model.n
        if kind is Points.CENTRE and robot.links:
            return own_quantity(self._model, f"centre[{min(link, n)}]")
        if kind is Points.NEXT:
            return own_quantity(self._model, f"centre[{min(link + 1, n)}]")
        # in the modified convention a link begins at its frame, and ends at the next one
        end = link + (robot.convention is Convention.MODIFIED) - (kind is Points.JOINT)
        place = (self._model.quantity(f"T[{end}]") if end <= n else self._model.quantity("T"))[:3, 3]
        return place - self._model.quantity("T[1]")[:3, 3] * int(kind is Points.CART)


def _is_right(finding: Finding | None) -> bool:
    return finding is not None and finding.verdict.equal


def _placed(values: Mapping[str, Expr]) -> dict[str, Expression]:
    return {MARK + name: expression_from_sympy(value) for name, value in values.items()}


def names_of_pose(*formulas: Expression) -> set[str]:
    """The names of a pose in formulas, as they are printed."""
    return {name.removeprefix(MARK) for e in formulas for name in names(e) if name[0] == MARK}
