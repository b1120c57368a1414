"""Arms for the inverse kinematics: tables of published arms, and random ones of every class.

A table is written as lines ``joint theta d a alpha`` (standard) or ``joint alpha a d theta`` (modified), degrees and
metres, a joint's own variable left out: ``R 0 0.15 0.4 -90``.
"""

import json
import random
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from derive.robot.names import free_symbols
from derive.robot.robot import Robot
from derive.verification.oracle.frames import NumericArm, jacobian, numeric_arm

Rows = tuple[tuple[str, str, str, str, str], ...]
"""Type, theta, d, a, alpha of each joint: cells as text, angles in degrees."""


@dataclass(frozen=True)
class ArmCase:
    name: str  # as in a robot file
    kind: str  # the class that it belongs to
    rows: Rows  # its table, in the order joint, theta, d, a, alpha in both conventions
    modified: bool = False  # whether a and alpha are those of the row before
    base: tuple[tuple[str, ...], ...] = ()  # rows of a 4x4 matrix of cells, or nothing
    tool: tuple[tuple[str, ...], ...] = ()
    task: str = "pose"  # ``pose`` or ``position``
    given: tuple[int, ...] = ()  # joints that are given, by index from 0
    values: dict[str, float] = field(default_factory=dict, hash=False)  # numbers of symbols that the table leaves open
    source: str = ""

    @property
    def text(self) -> str:
        """The robot file, its own choice of task and given joints included."""
        joints = []
        for i, (joint, theta, d, a, alpha) in enumerate(self.rows, 1):
            cells = {"theta": theta, "d": d, "a": a, "alpha": alpha}
            moving = "theta" if joint == "R" else "d"
            cells[moving] = f"q{i}" if cells[moving] == "0" else f"q{i} + ({cells[moving]})"
            joints.append({"type": "revolute" if joint == "R" else "prismatic", "q": f"q{i}", **cells})
        inverse = {key: value for key, value in (("task", self.task), ("given", self.given_names)) if value != "pose"}
        lines = [
            f"name: {self.name}",
            f"title: {json.dumps(self.source or self.kind)}",
            f"convention: {'modified' if self.modified else 'standard'}",
            "units: {angle: deg, length: m}",
            *(f"{key}: {json.dumps(rows)}" for key, rows in (("base", self.base), ("tool", self.tool)) if rows),
            "joints:",
            *(f"  - {json.dumps(joint)}" for joint in joints),
        ]
        if any(inverse.values()):
            lines.append(f"inverse: {json.dumps({key: value for key, value in inverse.items() if value})}")
        return "\n".join(lines) + "\n"

    @property
    def given_names(self) -> list[str]:
        return [f"q{i + 1}" for i in self.given]

    def robot(self, choice: bool = True) -> Robot:
        """The robot, without its choice of task where that is left to the caller."""
        text = self.text if choice else self.text.split("inverse:")[0]
        return Robot.from_text(text, self.name)

    @property
    def arm(self) -> NumericArm:
        robot = self.robot(choice=False)
        missing = set(free_symbols(robot)) - set(self.values)
        assert not missing, f"{self.name}: no numbers for {missing}"
        return numeric_arm(robot, self.values)


def _of_tables(tables: str) -> tuple[ArmCase, ...]:
    """Arms by two lines each: name, convention, class, options and source; then the rows of the table."""
    cases = []
    lines = [line for line in tables.strip().splitlines() if line]
    for head, table in zip(lines[::2], lines[1::2], strict=True):
        words, source = (part.strip() for part in head.split("|"))
        name, convention, kind, *options = words.split()
        rows = [tuple(row.split()) for row in table.split(";")]
        if convention == "modified":  # joint alpha a d theta
            rows = [(joint, theta, d, a, alpha) for joint, alpha, a, d, theta in rows]
        chosen = dict(option.split("=") for option in options)
        given = tuple(int(i) for i in chosen.get("given", "").split(",") if i)
        task = chosen.get("task", "pose")
        cases.append(ArmCase(name, kind, tuple(rows), convention == "modified", task=task, given=given, source=source))
    return tuple(cases)


def arm_of(head: str, table: str, rest: str = "") -> Robot:
    """The robot of one table, ``standard`` or ``modified`` and options, and of more lines of its file."""
    (case,) = _of_tables(f"arm {' test '.join([*head.split(maxsplit=1), ''][:2])} | a test\n{table}")
    return Robot.from_text(case.text + rest)


FOLDER = Path(__file__).parent
PUBLISHED = _of_tables((FOLDER / "published.txt").read_text(encoding="utf-8"))
"""Arms of books, manuals and papers."""

HARD = _of_tables((FOLDER / "hard.txt").read_text(encoding="utf-8"))
"""Arms on which solvers stumble: equal, vanishing, huge lengths, axes almost parallel, several structures at once."""

LOST = {case.name: case for case in _of_tables((FOLDER / "lost.txt").read_text(encoding="utf-8"))}
"""Arms of which solutions were lost once: by slides whose equations end at infinity, beside singular poses."""

TURNS = ("0", "90", "-90", "180")
ODD_TURNS = ("30", "-45", "60", "20", "-70", "105", "12.5")


class _Draw:
    def __init__(self, seed: str) -> None:
        self.rng = random.Random(seed)
        self.odd = self.rng.random() < 0.4
        self.symbolic = self.rng.random() < 0.25
        self.values: dict[str, float] = {}

    def length(self, zero: float = 0.3) -> str:
        if self.rng.random() < zero:
            return "0"
        value = round(self.rng.uniform(0.08, 0.7) * self.rng.choice([1, 1, 1, -1]), self.rng.choice([1, 2, 3]))
        value = value or 0.2
        if self.symbolic and self.rng.random() < 0.6 and value > 0:
            name = f"l{len(self.values) + 1}"
            self.values[name] = value
            return name
        return str(value)

    def twist(self, zero: bool = True) -> str:
        """An angle between axes; with ``zero`` false neither 0 nor 180."""
        if self.odd and self.rng.random() < 0.6:
            return self.rng.choice(ODD_TURNS)
        return self.rng.choice(TURNS if zero else ("90", "-90"))

    def offset(self) -> str:
        return self.rng.choice(["0", "0", "0", "90", "-90", "180", "35"])

    def frame(self) -> tuple[tuple[str, ...], ...]:
        if self.rng.random() < 0.5:
            return ()
        cells = [self.length() for _ in range(3)]
        kind = self.rng.randrange(4)
        rows = [("1", "0", "0"), ("0", "1", "0"), ("0", "0", "1")]
        if kind == 1:
            rows = [("0", "-1", "0"), ("1", "0", "0"), ("0", "0", "1")]
        elif kind == 2:
            rows = [("2/3", "-1/3", "2/3"), ("2/3", "2/3", "-1/3"), ("-1/3", "2/3", "2/3")]
        elif kind == 3:
            rows = [("cos(25)", "0", "sin(25)"), ("0", "1", "0"), ("-sin(25)", "0", "cos(25)")]
        return (*((*row, cell) for row, cell in zip(rows, cells, strict=True)), ("0", "0", "0", "1"))


@dataclass
class _Shape:
    """Geometry in both conventions: a_i, alpha_i from axis i to i+1; d_i, theta_i on axis i."""

    types: list[str]
    theta: list[str]
    d: list[str]
    a: list[str]
    alpha: list[str]

    def concurrent(self, first: int, draw: _Draw) -> None:
        """Axes first, first+1, first+2 (from 0) meet in one point and are not parallel."""
        for i in (first, first + 1):
            self.a[i], self.alpha[i] = "0", draw.twist(zero=False)
        self.d[first + 1] = "0"

    def parallel(self, first: int, draw: _Draw) -> None:
        """Axes first, first+1, first+2 (from 0) are parallel or opposed, and apart."""
        for i in (first, first + 1):
            self.a[i], self.alpha[i] = draw.length(zero=0), draw.rng.choice(["0", "0", "180"])

    def case(self, name: str, kind: str, draw: _Draw, **options: object) -> ArmCase:
        modified, n = draw.rng.random() < 0.5, len(self.types)
        a, alpha = self.a[:n], self.alpha[:n]
        if modified:  # the geometry between joints moves one row down; the first row has what was after the last
            a, alpha = a[-1:] + a[:-1], alpha[-1:] + alpha[:-1]
        rows = tuple(zip(self.types, self.theta, self.d, a, alpha, strict=True))
        return ArmCase(name, kind, rows, modified, draw.frame(), draw.frame(), values=draw.values, **options)  # type: ignore[arg-type]


def _shape(types: str, draw: _Draw, zero: float = 0.35) -> _Shape:
    return _Shape(
        list(types),
        [draw.offset() for _ in types],
        [draw.length(zero) if t == "R" else draw.rng.choice(["0", "0", "0.1"]) for t in types],
        [draw.length(zero) for _ in types],
        [draw.twist() for _ in types],
    )


def _types(draw: _Draw, n: int, slides: tuple[int, int]) -> str:
    count = draw.rng.randint(*slides)
    chosen = set(draw.rng.sample(range(n), count))
    return "".join("P" if i in chosen else "R" for i in range(n))


def _few(n: int, slides: tuple[int, int], task: str = "pose") -> Callable[[_Draw, str], ArmCase]:
    return lambda draw, name: _shape(_types(draw, n, slides), draw).case(name, "", draw, task=task)


def _planar(draw: _Draw, name: str) -> ArmCase:
    shape = _shape(draw.rng.choice(["RRR", "RRR", "RPR", "PRR", "RRP"]), draw, zero=0.1)
    for i in range(3):
        turning = shape.types[i] == "R" and shape.types[(i + 1) % 3] == "R"
        shape.alpha[i] = draw.rng.choice(["0", "0", "180"]) if turning else draw.rng.choice(["90", "-90"])
    return shape.case(name, "", draw)


def _wrist(first: int, types: str = "RRRRRR") -> Callable[[_Draw, str], ArmCase]:
    def make(draw: _Draw, name: str) -> ArmCase:
        chosen = types
        if "?" in types:
            slides = _types(draw, 3, (1, 3))
            chosen = types.replace("???", slides)
        shape = _shape(chosen, draw)
        shape.concurrent(first if first >= 0 else draw.rng.choice([1, 2]), draw)
        return shape.case(name, "", draw)

    return make


def _parallel(slides: int) -> Callable[[_Draw, str], ArmCase]:
    def make(draw: _Draw, name: str) -> ArmCase:
        first = draw.rng.randrange(4)
        outside = [i for i in range(6) if not first <= i < first + 3]
        chosen = set(draw.rng.sample(outside, slides))
        shape = _shape("".join("P" if i in chosen else "R" for i in range(6)), draw)
        shape.parallel(first, draw)
        return shape.case(name, "", draw)

    return make


def _offset(draw: _Draw, name: str) -> ArmCase:
    shape = _shape("RRRRRR", draw)
    first = draw.rng.choice([0, 1, 2, 3, 3])
    shape.concurrent(first, draw)
    place = draw.rng.choice(["a", "d"])
    cells = shape.a if place == "a" else shape.d
    cells[first + (1 if place == "d" else draw.rng.choice([0, 1]))] = draw.length(zero=0)
    return shape.case(name, "", draw)


def _general(types: Callable[[_Draw], str]) -> Callable[[_Draw, str], ArmCase]:
    def make(draw: _Draw, name: str) -> ArmCase:
        shape = _shape(types(draw), draw, zero=0.0)
        shape.alpha = [draw.rng.choice(ODD_TURNS) for _ in shape.types]
        return shape.case(name, "", draw)

    return make


def _redundant(draw: _Draw, name: str) -> ArmCase:
    kind = draw.rng.randrange(3)
    shape = _shape("RRRRRRR", draw)
    if kind < 2:
        shape.concurrent(0, draw)
        shape.concurrent(4, draw)
        if kind == 1:
            shape.a[2], shape.a[3] = "0.08", "-0.08"
        given = 2
    else:
        shape.concurrent(0 if draw.rng.random() < 0.5 else 4, draw)
        given = draw.rng.choice([0, 6])
    return shape.case(name, "", draw, given=(given,))


CLASSES: dict[str, Callable[[_Draw, str], ArmCase]] = {
    "1dof": _few(1, (0, 1)),
    "2dof": _few(2, (0, 2)),
    "2dof-position": _few(2, (0, 1), "position"),
    "3dof-planar": _planar,
    "3dof-spatial": _few(3, (0, 3)),
    "3dof-spatial-position": _few(3, (0, 3), "position"),
    "3dof-wrist": lambda draw, name: (shape := _shape("RRR", draw), shape.concurrent(0, draw))[0].case(name, "", draw),
    "4dof": _few(4, (0, 2)),
    "5dof": _few(5, (0, 2)),
    "6R-spherical-wrist": _wrist(3),
    "6R-wrist-first": _wrist(0),
    "6R-wrist-middle": _wrist(-1),
    "6R-three-parallel": _parallel(0),
    "6DOF-P-spherical-wrist": _wrist(3, "???RRR"),
    "6DOF-P-wrist-first": _wrist(0, "RRR???"),
    "6DOF-P-three-parallel": _parallel(1),
    "6DOF-P-other": lambda draw, name: _shape(_types(draw, 6, (1, 3)), draw).case(name, "", draw),
    "6R-offset": _offset,
    "6R-general": _general(lambda draw: "RRRRRR"),
    "5R1P-general": _general(lambda draw: _types(draw, 6, (1, 1))),
    "4R2P-general": _general(lambda draw: _types(draw, 6, (2, 2))),
    "redundant-locked": _redundant,
}
"""Makers of random arms by class; the published ones use the same names."""


def random_arm(kind: str, number: int) -> ArmCase:
    """A random arm of a class, always the same for the same number; its Jacobian has full rank somewhere."""
    for attempt in range(1000):
        draw = _Draw(f"{kind} {number} {attempt}")
        case = CLASSES[kind](draw, f"{kind.lower()}-{number}")
        case = replace(case, kind=kind, source=f"random arm {number} of class {kind}")
        if is_regular(case):
            return case
    raise AssertionError(f"no arm of class {kind}")


def is_regular(case: ArmCase) -> bool:
    """Whether the joints that are solved for have a Jacobian of full rank, clearly, at random configurations."""
    arm = case.arm
    q = np.random.default_rng(1).uniform(-2, 2, (5, arm.n))
    unit = float(np.abs([*arm.a, *arm.d]).sum()) or 1.0
    slope = jacobian(arm, q)
    slope[:, :3] /= unit
    slope = slope[:, : 3 if case.task == "position" else 6, [i for i in range(arm.n) if i not in case.given]]
    slope = slope * np.where(arm.revolute, 1.0, unit)[[i for i in range(arm.n) if i not in case.given]]
    if slope.shape[1] < slope.shape[2]:
        return False
    values = np.linalg.svd(slope, compute_uv=False)
    return bool((values[:, -1] > 1e-3).any())
