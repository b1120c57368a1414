"""Robots and URDFs for tests of exchange: of the catalogue, of random bodies, of random chains."""

import random
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from derive.exchange.numeric import with_numbers
from derive.robot.description import Inertia, Link, Motor
from derive.robot.expression import Expression, multiply, number
from derive.robot.names import limit_symbols, robot_symbols
from derive.robot.robot import Robot
from tests.exchange.urdfs import HALF, PI, J, body, urdf
from tests.random_robots import chains
from tests.rows import robot_of_rows

FEW = ("scara-matlab", "skeleton-modified", "stanford-deluca", "puma560-corke")
"""Slides, parallel axes, reversed variables, a base, both conventions."""

EVERY = chains()

SWEEP = [pytest.param(name, marks=[] if name in FEW else pytest.mark.sweep) for name in EVERY]
"""The few in every run of the tests, the others in the sweep."""


def decimal(value: float) -> Expression:
    return number(Fraction(round(value * 10000), 10000))


def numeric(name: str) -> Robot:
    """A robot of the catalogue with lengths for the symbols that have none."""
    robot, random = Robot.load(name), np.random.default_rng(len(name))
    known, symbols = dict(robot.parameters), dict.fromkeys((*robot_symbols(robot), *limit_symbols(robot)))
    return with_numbers(robot, {each: decimal(random.uniform(0.3, 0.9)) for each in symbols if each not in known})


def dressed(name: str, *, rotors: bool = False, coulomb: bool = False, calm: bool = False) -> Robot:
    """A robot of the catalogue with random bodies that exist, and without limits.

    Calm, friction grows with what a joint carries: long chains without it are chaotic, and no two methods agree for
    10 s.
    """
    robot, random = numeric(name), np.random.default_rng(len(name))

    def link(carried: int) -> Link:
        spread = random.normal(size=(3, 3)) / 5
        second = spread @ spread.T + 0.01 * np.eye(3)
        moments = np.trace(second) * np.eye(3) - second
        cells = (decimal(moments[at]) for at in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)))
        x, y, z = (decimal(c) for c in random.uniform(-0.2, 0.2, 3))
        motor = Motor(*(decimal(random.uniform(*ends)) for ends in ((0.1, 0.5), (0.001, 0.002), (-60, 60))))
        return Link(
            decimal(random.uniform(1, 3)),
            (x, y, z),
            Inertia(*cells),
            motor=motor if rotors else None,
            armature=decimal(random.uniform(0.2, 0.4)),
            viscous=decimal(random.uniform(1, 3) * (carried if calm else 1)),
            coulomb=decimal(random.uniform(1, 3) * coulomb),
        )

    joints = tuple(replace(joint, limits=None) for joint in robot.joints)
    gravity = (decimal(0.3), decimal(-9.1), decimal(-2.7))
    return replace(robot, joints=joints, gravity=gravity, links=tuple(link(robot.n - i) for i in range(robot.n)))


def uneven(robot: Robot) -> Robot:
    """The robot with more friction where its joints move backwards."""
    links = (replace(link, coulomb=(link.dry[0], multiply(number("1.3"), link.dry[0]))) for link in robot.links)
    return replace(robot, links=tuple(links))


TABLES = {
    "spatial": "R d: 0.3, alpha: 0.7 | P theta: 0.4, a: 0.2, alpha: pi/2 | R a: 0.25, d: 0.1, alpha: -1.1 | R d: 0.1",
    "planar": "R a: 0.5 | R a: 0.4 | R a: 0.3",
    "upright": "R d: 0.3, a: 0.2, alpha: pi/2 | R a: 0.4 | P a: 0.1",
}


def arm(name: str, convention: str = "standard") -> Robot:
    """An arm of random bodies that exist."""
    random, rows = np.random.default_rng(len(name)), TABLES[name]
    lines = ["gravity: [0, 0, -9.81]", "links:"]
    for _ in rows.split("|"):
        points = random.integers(-20, 21, size=(6, 3)) / 100
        away = points - points.mean(axis=0)
        second = away.T @ away
        tensor = np.trace(second) * np.eye(3) - second
        cells = ", ".join(
            f"{x}{y}: {tensor['xyz'.index(x), 'xyz'.index(y)]:.6f}" for x, y in ("xx", "yy", "zz", "xy", "xz", "yz")
        )
        lines.append(
            f"  - {{mass: 6, com: [{', '.join(f'{c:.3f}' for c in points.mean(axis=0))}], "
            f"inertia: {{{cells}}}, armature: 0.1}}"
        )
    return robot_of_rows(rows, "\n".join(lines), name=name, convention=convention)


def with_links(robot: Robot, *links: tuple[str, str, str]) -> Robot:
    """The robot with other links: mass, com, tensor."""
    made = []
    for mass, com, tensor in links:
        x, y, z = (number(Fraction(cell)) for cell in com.split())
        made.append(
            Link(number(Fraction(mass)), (x, y, z), Inertia(*(number(Fraction(cell)) for cell in tensor.split())))
        )
    return replace(robot, links=tuple(made))


def random_arm(seed: int, *, motors: bool = False) -> Robot:
    """An arm of 2 to 7 joints; the bodies are clouds of points, flat ones, rods and points, and published ones."""
    random = np.random.default_rng(seed)
    n = int(random.integers(2, 8))
    rows, links = [], []
    for i in range(1, n + 1):
        slides = random.random() < 0.2
        alpha = random.choice(["0", "pi/2", "-pi/2", "0.7", "-1.1"])
        cells = f"d: {random.integers(0, 4) / 10}" if not slides else f"theta: {random.choice(['0', 'pi/2', '0.4'])}"
        sign = random.choice(["", "-"])
        moving = f"d: {sign}q{i}" if slides else f"theta: {sign}q{i}"
        kind = "prismatic" if slides else "revolute"
        rows.append(f"  - {{type: {kind}, {moving}, {cells}, a: {random.integers(0, 4) / 10}, alpha: {alpha}}}")
        links.append(_link(random, motors))
    convention = random.choice(["standard", "modified"])
    head = [f"name: random-{seed}", f"convention: {convention}", "joints:", *rows, "gravity: [0, 0, -9.81]", "links:"]
    return Robot.from_text("\n".join([*head, *links]) + "\n")


def _link(random: np.random.Generator, motors: bool) -> str:
    """A cloud of four to one points, so a body, a plate, a rod or a point; some tensors are off as published ones."""
    count = int(random.choice([4, 4, 4, 4, 3, 2, 1]))
    mass = round(float(random.uniform(0.2, 4)), 3)
    points = random.normal(size=(count, 3)) * 0.1
    away = points - points.mean(axis=0)
    second = mass * away.T @ away / count
    tensor = np.trace(second) * np.eye(3) - second
    if random.random() < 0.35:  # what a torque does not notice, mostly
        tensor = np.diag(np.diag(tensor)) + np.diag([*random.uniform(-0.4, 0.4, 1), *[0.0] * 2]) * tensor.max()
    entries = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
    digits = int(random.choice([4, 6, 9, 17]))
    cells = ", ".join(f"{'xyz'[i]}{'xyz'[j]}: {tensor[i, j]:.{digits}g}" for i, j in entries)
    com = ", ".join(f"{c:.4f}" for c in points.mean(axis=0))
    rotor = (
        f"{random.uniform(0, 0.3):.3f}, inertia: {random.uniform(1, 20) * 1e-5:.3g}, ratio: {random.integers(-90, 91)}"
    )
    more = f", motor: {{mass: {rotor}}}" if motors else f", armature: {random.uniform(0, 0.2):.3f}"
    return f"  - {{mass: {mass}, com: [{com}], inertia: {{{cells}}}{more}}}"


ANGLES = ("0", "0", HALF, f"-{HALF}", PI, "0.7853981633974483", "1.57", "1.5707", "-2.1", "0.003", "1.570796")
LENGTHS = ("0", "0", "0", "0.3", "-0.25", "0.4318", "1e-10", "0.001")
AXES = ("0 0 1", "0 0 1", "0 0 -1", "0 1 0", "-1 0 0", "1 1 0", "0.1 0.2 -2")
TYPES = ("revolute", "revolute", "revolute", "prismatic", "continuous")


def random_chain(seed: int) -> tuple[str, list[str]]:
    """A URDF of one to seven joints that move, and their names in the order of the chain."""
    source = random.Random(seed)

    def triple(words: tuple[str, ...], most: float) -> str:
        if source.random() < 0.15:
            return " ".join(repr(round(source.uniform(-most, most), 6)) for _ in range(3))
        return " ".join(source.choice(words) for _ in range(3))

    joints = []
    for _ in range(source.randint(1, 7)):
        if source.random() < 0.3:
            joints.append(J(triple(LENGTHS, 0.5), triple(ANGLES, 3.0), type="fixed", inertial=_body(source)))
        kind, axis = source.choice(TYPES), source.choice(AXES)
        limit = 'lower="-0.5" upper="0.8" effort="10" velocity="1"' if kind != "continuous" else ""
        joints.append(J(triple(LENGTHS, 0.5), triple(ANGLES, 3.0), axis, kind, limit, _body(source)))
    joints.append(J(triple(LENGTHS, 0.5), triple(ANGLES, 3.0), type="fixed"))
    return urdf(joints), [f"j{k}" for k, joint in enumerate(joints, 1) if joint.type != "fixed"]


def _body(source: random.Random) -> tuple[str, str, str, str] | None:
    """A body, or none; its principal moments are those of some box."""
    if source.random() < 0.3:
        return None
    a, b, c = (source.uniform(0.01, 0.3) ** 2 for _ in range(3))
    centre = " ".join(f"{source.uniform(-0.2, 0.2):.4f}" for _ in range(3))
    return body(f"{source.uniform(0.1, 5):.3f}", centre, "0.3 0 -1", f"{b + c!r} {a + c!r} {a + b!r} 0 0 0")
