"""Random robots: YAML text of the robot file beside the plain numbers it stands for.

The numbers are drawn first and then dressed up as cells in every way the format allows (decimals, fractions, degrees,
millimetres, named parameters with and without numbers, formulas), so a test that rebuilds the robot from the numbers
with another engine checks the whole path from the text on.
"""

import json
import math
import os
import random
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import strategies as st

from derive.robot.load import catalogue_names
from derive.robot.robot import Robot

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class JointNumbers:
    """One row of the DH table in radians and metres; theta and d without the variable."""

    revolute: bool
    sign: int
    theta: float
    d: float
    a: float
    alpha: float


@dataclass(frozen=True)
class LinkNumbers:
    """Inertial parameters of one link in SI units; the tensor is about the centre of mass."""

    mass: float
    com: tuple[float, float, float]
    inertia: tuple[float, float, float, float, float, float]
    rotor_mass: float = 0.0
    rotor_inertia: float = 0.0
    ratio: float = 0.0
    armature: float = 0.0
    viscous: float = 0.0
    coulomb: float = 0.0

    @property
    def tensor(self) -> Array:
        xx, yy, zz, xy, xz, yz = self.inertia
        return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


@dataclass(frozen=True)
class RandomRobot:
    """A robot file and what it means.

    Attributes:
        text: The YAML text.
        standard: Whether the convention is standard.
        joints: The DH table.
        base: World to frame 0.
        tool: Frame n to the end effector.
        gravity: Acceleration of gravity in the world.
        links: Empty without dynamics.
        values: Numbers of the symbols that stay free in generated code.
    """

    text: str
    standard: bool
    joints: tuple[JointNumbers, ...]
    base: Array = field(default_factory=lambda: np.eye(4))
    tool: Array = field(default_factory=lambda: np.eye(4))
    gravity: tuple[float, float, float] = (0.0, 0.0, -9.81)
    links: tuple[LinkNumbers, ...] = ()
    values: dict[str, float] = field(default_factory=dict)

    @property
    def n(self) -> int:
        return len(self.joints)

    def __repr__(self) -> str:
        return f"RandomRobot(\n{self.text})"


def robot_text(rng: random.Random, n: int | None = None) -> str:
    """Text of a random valid robot file with n joints (1 to 7 unless given)."""
    return random_robot(rng, n).text


def random_robot(
    rng: random.Random,
    n: int | None = None,
    *,
    standard: bool | None = None,
    dynamics: bool = True,
    symbols: bool = True,
) -> RandomRobot:
    return _Writer(rng, n or rng.randint(1, 7), standard, dynamics, symbols).robot()


def robots(max_joints: int = 7, **options: bool) -> st.SearchStrategy[RandomRobot]:
    seeds, sizes = st.integers(0, 2**32 - 1), st.integers(1, max_joints)
    return st.builds(lambda n, seed: random_robot(random.Random(seed), n, **options), sizes, seeds)


def configurations(rng: random.Random, n: int, count: int = 1) -> Array:
    """Random joint vectors, (count, n)."""
    return np.array([[rng.uniform(-1.5, 1.5) for _ in range(n)] for _ in range(count)])


Cell = tuple[str, float]
"""Text as it stands in the file, and the number it stands for."""


class _Writer:
    """Draws the numbers of one robot and writes them down."""

    def __init__(self, rng: random.Random, n: int, standard: bool | None, dynamics: bool, symbols: bool) -> None:
        self.rng, self.n, self.dynamics, self.symbols = rng, n, dynamics, symbols
        self.standard = rng.random() < 0.5 if standard is None else standard
        self.degrees, self.millimetres = rng.random() < 0.4, rng.random() < 0.3
        self.plain_names = rng.random() < 0.7
        self.parameters: dict[str, str] = {}
        self.runtime: list[str] = []
        self.values: dict[str, float] = {}

    def robot(self) -> RandomRobot:
        rows, joints = zip(*(self.joint(i) for i in range(1, self.n + 1)), strict=True)
        base_rows, base = self.transform()
        tool_rows, tool = self.transform()
        gravity_cells, gravity = self.gravity()
        links = [self.link(i) for i in range(1, self.n + 1)] if self.dynamics else []
        block: dict[str, object] = {
            "name": f"random-{self.n}{'s' if self.standard else 'm'}",
            "title": self.rng.choice(["Random arm", 'An "odd" arm: 100 % & {{ x }} # \\input', "Braccio nº 1"]),
            "convention": "standard" if self.standard else "modified",
            "joints": list(rows),
            "units": {"angle": "deg" if self.degrees else "rad", "length": "mm" if self.millimetres else "m"},
            "base": base_rows,
            "tool": tool_rows,
            "gravity": gravity_cells,
            "links": [row for row, _ in links],
            "parameters": self.parameters,
            "runtime": self.runtime,
        }
        dropped = {key for key in ("base", "tool", "links", "parameters", "runtime") if not block[key]}
        if not (self.degrees or self.millimetres):
            dropped.add("units")
        return RandomRobot(
            text=_yaml({key: value for key, value in block.items() if key not in dropped}),
            standard=self.standard,
            joints=tuple(joints),
            base=base,
            tool=tool,
            gravity=gravity,
            links=tuple(numbers for _, numbers in links),
            values=self.values,
        )

    def joint(self, i: int) -> tuple[dict[str, object], JointNumbers]:
        rng = self.rng
        revolute, sign = rng.random() < 0.7, rng.choice([1, 1, 1, -1])
        variable = f"q{i}" if self.plain_names else f"{'theta' if revolute else 'x'}{i}"
        theta = (("0", 0.0) if rng.random() < 0.5 else self.angle("th", i)) if revolute else self.angle("th", i)
        d, a, alpha = self.length("d", i), self.length("a", i), self.angle("al", i)
        constant = theta if revolute else d
        own = _with_variable(rng, variable, sign, constant[0])
        row: dict[str, object] = {"type": "revolute" if revolute else "prismatic", "q": variable}
        row |= {"theta": own if revolute else theta[0], "d": d[0] if revolute else own, "a": a[0], "alpha": alpha[0]}
        if own == variable and rng.random() < 0.5:
            del row["theta" if revolute else "d"]
        for key in [key for key, cell in row.items() if cell == "0" and rng.random() < 0.5]:
            del row[key]
        if self.plain_names and rng.random() < 0.3:
            del row["q"]
        if rng.random() < 0.5:
            row["limits"] = self.limits(revolute)
        return row, JointNumbers(revolute, sign, theta[1], d[1], a[1], alpha[1])

    def limits(self, revolute: bool) -> list[object]:
        if revolute:
            return [-170, 170.5] if self.degrees else ["-pi", "pi/2"]
        return [-1500, 1500] if self.millimetres else [-1.5, 1.5]

    def angle(self, prefix: str, i: int) -> Cell:
        rng = self.rng
        quarter = rng.choice([0, 0, 1, -1, 2])
        kind = rng.randrange(6)
        if kind <= 2:
            return self.turn(quarter * 90)
        if kind == 3:
            return self.turn(rng.choice([30, -45, 60, 135, 17.25, -80.5]))
        if kind == 4 or not self.symbols:
            return self.odd_turn()
        name, value = self.symbol(f"{prefix}{i}", 0.2, 1.4)
        text, extra = self.turn(rng.choice([30, 90]))
        return rng.choice([(name, value), (f"-{name}", -value), (f"{name} + {text}", value + extra)])

    def odd_turn(self) -> Cell:
        value = self.rng.uniform(-3, 3)
        return self.turn(round(math.degrees(value), 2)) if self.degrees else _decimal(round(value, 3))

    def turn(self, degrees: float) -> Cell:
        if self.degrees:
            return _decimal(degrees)[0], math.radians(degrees)
        over = {0: "0", 90: "pi/2", -90: "-pi/2", 180: "pi", 30: "pi/6", -45: "-pi/4", 60: "pi/3", 135: "3*pi/4"}
        value = math.radians(degrees)
        return (over[int(degrees)], value) if degrees in over else (f"{degrees}*pi/180", value)

    def length(self, prefix: str, i: int) -> Cell:
        rng = self.rng
        value = round(rng.uniform(-0.8, 0.8), 3)
        kind = rng.randrange(6)
        if kind <= 1:
            return "0", 0.0
        if kind <= 3 or not self.symbols:
            return self.metres(value)
        name, size = self.symbol(f"{prefix}{i}", 0.1, 0.9)
        text, extra = self.metres(abs(value))
        return rng.choice(
            [
                (name, size),
                (f"-{name}", -size),
                (f"{name} + {text}", size + extra),
                (f"2*{name}/3", 2 * size / 3),
                (f"{name}**2 - {text}", size**2 - extra),
                (f"sqrt({name})", math.sqrt(size)),
                (f"{name}*sin({name})", size * math.sin(size)),
            ]
        )

    def metres(self, value: float) -> Cell:
        return (_decimal(round(value * 1000, 6))[0], value) if self.millimetres else _decimal(value)

    def quantity(self, name: str, low: float, high: float) -> Cell:
        """A number without unit conversion: a decimal, a fraction or a symbol."""
        rng = self.rng
        if self.symbols and rng.random() < 0.4:
            return self.symbol(name, low, high)
        return _decimal(round(rng.uniform(low, high), 4))

    def symbol(self, name: str, low: float, high: float) -> Cell:
        """A named parameter: with a number, with one but run-time, or free."""
        if name in self.parameters or name in self.values:
            name = f"{name}x"
        value = round(self.rng.uniform(low, high), 3)
        kind = self.rng.randrange(4)
        if kind <= 2:
            texts = [(str(value), value), (f"{value}/2 + {value}/2", value), ("pi/8", math.pi / 8)]
            text, value = self.rng.choice(texts)
            self.parameters[name] = text
        if kind >= 2:
            self.values[name] = value
        if kind == 2:
            self.runtime.append(name)
        return name, value

    def transform(self) -> tuple[list[list[str]], Array]:
        """A constant transform, or none; its rotation is exact, whatever the way it is written."""
        rng = self.rng
        if rng.random() < 0.4:
            return [], np.eye(4)
        texts, rotation = self.turned() if rng.random() < 0.5 else _quaternion_rotation(rng)
        cells = [self.metres(round(rng.uniform(-0.5, 0.5), 3)) for _ in range(3)]
        matrix = np.eye(4)
        matrix[:3, :3], matrix[:3, 3] = rotation, [value for _, value in cells]
        rows = [[*row, cell[0]] for row, cell in zip(texts, cells, strict=True)]
        return [*rows, ["0", "0", "0", "1"]], matrix

    def turned(self) -> tuple[list[list[str]], Array]:
        angle = self.rng.choice([30.0, 12.5, -75.0]) if self.degrees else self.rng.choice([0.3, -1.1, 2.0])
        value = math.radians(angle) if self.degrees else angle
        c, s = math.cos(value), math.sin(value)
        text = [[f"cos({angle})", f"-sin({angle})", "0"], [f"sin({angle})", f"cos({angle})", "0"], ["0", "0", "1"]]
        return text, np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])

    def gravity(self) -> tuple[list[str], tuple[float, float, float]]:
        rng = self.rng
        name, g = self.symbol("g", 9.7, 9.9) if self.symbols and self.dynamics else _decimal(9.81)
        if rng.random() < 0.5:
            return rng.choice([(["0", "0", f"-{name}"], (0.0, 0.0, -g)), ([f"{name}", "0", "0"], (g, 0.0, 0.0))])
        return [f"{name}*2/3", f"-{name}/3", f"2*{name}/3"], (g * 2 / 3, -g / 3, g * 2 / 3)

    def link(self, i: int) -> tuple[dict[str, object], LinkNumbers]:
        rng = self.rng
        mass = self.quantity(f"m{i}", 0.5, 5.0)
        com = [self.length(f"com{'xyz'[k]}", i) for k in range(3)]
        row: dict[str, object] = {"mass": mass[0], "com": [text for text, _ in com]}
        inertia_row, inertia = self.inertia(i)
        row["inertia"] = inertia_row
        motor = self.motor(i) if rng.random() < 0.5 else {}
        if motor:
            row["motor"] = {key: cell[0] for key, cell in motor.items()}
        friction = self.friction(i) if rng.random() < 0.5 else {}
        if friction:
            row["friction"] = {key: cell[0] for key, cell in friction.items()}
        armature = self.quantity(f"arm{i}", 0.05, 0.8) if rng.random() < 0.3 else ("0", 0.0)
        if armature[1]:
            row["armature"] = armature[0]
        none: Cell = ("0", 0.0)
        return row, LinkNumbers(
            mass=mass[1],
            com=(com[0][1], com[1][1], com[2][1]),
            inertia=inertia,
            rotor_mass=motor.get("mass", none)[1],
            rotor_inertia=motor.get("inertia", none)[1],
            ratio=motor.get("ratio", none)[1],
            armature=armature[1],
            viscous=friction.get("viscous", none)[1],
            coulomb=friction.get("coulomb", none)[1],
        )

    def inertia(self, i: int) -> tuple[dict[str, str], tuple[float, float, float, float, float, float]]:
        cells = {key: self.quantity(f"I{key}{i}", 0.05, 0.4) for key in ("xx", "yy", "zz")}
        for key in ("xy", "xz", "yz"):
            if self.rng.random() < 0.5:
                cells[key] = _decimal(round(self.rng.uniform(-0.02, 0.02), 4))
        xx, yy, zz, xy, xz, yz = (cells.get(key, ("0", 0.0))[1] for key in ("xx", "yy", "zz", "xy", "xz", "yz"))
        return {key: cell[0] for key, cell in cells.items()}, (xx, yy, zz, xy, xz, yz)

    def motor(self, i: int) -> dict[str, Cell]:
        rng = self.rng
        ratio = rng.choice([_decimal(1), _decimal(-3.5), None]) or self.quantity(f"kr{i}", 5.0, 60.0)
        cells = {"inertia": self.quantity(f"Im{i}", 0.001, 0.02), "ratio": ratio}
        return cells if rng.random() < 0.3 else {"mass": self.quantity(f"mm{i}", 0.1, 1.0), **cells}

    def friction(self, i: int) -> dict[str, Cell]:
        cells = {"viscous": self.quantity(f"b{i}", 0.1, 2.0)}
        return cells if self.rng.random() < 0.3 else {**cells, "coulomb": self.quantity(f"f{i}", 0.1, 2.0)}


def _decimal(value: float) -> Cell:
    return format(value, "g") if float(format(value, "g")) == value else repr(value), float(value)


def _with_variable(rng: random.Random, variable: str, sign: int, constant: str) -> str:
    """The moving cell: ``sign*variable + constant`` in one of its ways of writing."""
    signed = variable if sign > 0 else f"-{variable}"
    if constant == "0":
        return signed
    if rng.random() < 0.5:
        return f"{constant} + {variable}" if sign > 0 else f"{constant} - {variable}"
    return f"{signed} + ({constant})" if constant.startswith("-") else f"{signed} + {constant}"


def _quaternion_rotation(rng: random.Random) -> tuple[list[list[str]], Array]:
    """A rotation with rational entries, from a quaternion of small integers."""
    w, x, y, z = 1 + rng.randrange(3), rng.randint(-3, 3), rng.randint(-3, 3), rng.randint(-3, 3)
    total = w * w + x * x + y * y + z * z
    entries = [
        [total - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), total - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), total - 2 * (x * x + y * y)],
    ]
    return [[f"{entry}/{total}" for entry in row] for row in entries], np.array(entries) / total


def _yaml(block: dict[str, object]) -> str:
    """The block as YAML: one key a line, values in flow style (JSON is YAML)."""
    lines = []
    for key, value in block.items():
        if isinstance(value, list) and value and isinstance(value[0], (dict, list)):
            lines += [f"{key}:", *(f"  - {_flow(row)}" for row in value)]
        else:
            lines.append(f"{key}: {_flow(value)}")
    return "\n".join(lines) + "\n"


def _flow(value: object) -> str:
    return json.dumps(value, ensure_ascii=False)


def seeds(count: int, usual: int, swept: int | None = None) -> list[Any]:
    """Seeds: the first ones for every run of the tests, then those of the sweep, the others before a release.

    Sweep and release begin after the number in ``DERIVE_NEW_EXAMPLES``.
    """
    marks = [[]] * usual + [[pytest.mark.sweep]] * ((swept or count) - usual) + [[pytest.mark.release]] * count
    after = int(os.environ.get("DERIVE_NEW_EXAMPLES", "0"))
    return [pytest.param(seed + after * (seed >= usual), marks=marks[seed]) for seed in range(count)]


def swept(*rows: Any) -> list[Any]:
    """Cases of the sweep alone: one value each, or a tuple of several."""
    return [pytest.param(*(row if isinstance(row, tuple) else (row,)), marks=pytest.mark.sweep) for row in rows]


def sampled(cases: Sequence[Any], usual: Collection[Any]) -> list[Any]:
    """Cases: some of them for every run of the tests, the others for the sweep."""
    return [pytest.param(case, marks=[] if case in usual else [pytest.mark.sweep]) for case in cases]


SWEPT = ("kuka-kr5", "puma560-corke", "scara-matlab", "stanford-deluca", "thumb")
"""Built-in robots of every kind, for sweeps that take long for each."""


@cache
def catalogue() -> Mapping[str, Robot]:
    """The built-in robots by name, read once for all tests."""
    return {name: Robot.load(name) for name in catalogue_names()}


@cache
def chains() -> tuple[str, ...]:
    """Names of the built-in robots of one chain, for what takes no trees."""
    return tuple(name for name, robot in catalogue().items() if not robot.is_tree)


def swept_catalogue(most_joints: int = 64, usual: tuple[str, ...] = ()) -> list[Any]:
    """`chains`: those for every run of the tests, those of the sweep, the others before a release."""
    names = (name for name in chains() if catalogue()[name].n <= most_joints)
    rest = {name: [pytest.mark.sweep if name in SWEPT else pytest.mark.release] for name in names}
    return [pytest.param(name, marks=[] if name in usual else marks) for name, marks in rest.items()]
