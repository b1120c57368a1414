"""Products of elementary transforms become tables with the same pose, in both conventions."""

import contextlib
import math
import random
import re

import numpy as np
import pytest

from derive.algebra.angles import decompose
from derive.errors import DeriveError, RobotFileError
from derive.exchange.transforms import robot_of_transforms
from derive.robot.description import Convention
from derive.robot.robot import Robot
from derive.verification.oracle.frames import forward_kinematics, numeric_arm
from tests.exchange.urdfs import turned
from tests.random_robots import swept

# As roboticstoolbox and textbooks write them; the PUMA's first published with the method (Corke 2007).
PUMA = "Tz(L1) Rz(q1) Ry(q2) Ty(L2) Tz(L3) Ry(q3) Tx(L4) Ty(L5) Tz(L6) Rz(q4) Ry(q5) Rz(q6)"
PRODUCTS = [
    "Rz(q1) Tx(a1) Rz(q2) Tx(a2)",
    PUMA,
    "tz(0.333) * Rz(q1) * Rx(-90\u00b0) * Rz(q2) * Rx(90 deg) * tz(0.316) * Rz(q3) * tx(0.0825) * Rz(q4)",
    "Tx(q1) Ty(-q2 + 2) Tz(q3)",
    "Rz(q1) Rx(alpha) Tx(a) Ty(b) Tz(c) Rz(q2) Tz(d)",
    "Rz(q1) Ty(e) Ry(-alpha) Rx(pi/2) Tx(a) Ty(b) Tz(c) Rz(q2) Rx(pi/2) Tx(1) Ty(0.3)",
    "Rz(q1) Ry(b1) Tx(h) Ry(pi/6) Tx(a) Ty(-b) Rz(q2)",
    "Rz(q1) Rz(30 deg) Tx(1) Rz(0.4) Rz(0.2) Rz(q2 + 0.1) Rx(0.3) Rx(0.2) Rz(q3)",
    "Rx(0.3) Rx(q1 + 0.1) Rx(0.4) Tx(1) Ry(0.1) Ry(q2) Ry(0.3) Ry(q3 + 0.2) Ty(1) Ry(0.5)",
    "Ty(0.3) Rx(0.2) Rz(-q1 + pi/2) Tz(q2) Ty(0.1) Rx(pi/4) Tx(q3) Rx(0.3) Ty(1)",
]


def product_of(text: str, values: dict[str, float]) -> np.ndarray:
    """The product in numbers, by Python's own arithmetic."""
    pose = np.eye(4)
    for kind, axis, cell in re.findall(r"([RT])([xyz])\(([^()]*)\)", text.replace("t", "T")):
        plain = cell.replace("\u00b0", "*pi/180").replace(" deg", "*pi/180")
        x, i = eval(plain, {"pi": math.pi, **values}), "xyz".index(axis)  # of the texts above alone
        step = np.eye(4)
        if kind == "T":
            step[i, 3] = x
        else:
            step[:3, :3] = turned(i, x)
        pose = pose @ step
    return pose


def check(text: str, convention: Convention, rng: random.Random) -> Robot:
    """The robot of a product, whose pose is compared at a random point."""
    robot = Robot.from_text(robot_of_transforms(text, "arm", convention))
    names = set(re.findall(r"[A-Za-z]\w*", re.sub(r"[RTt][xyz]|pi|deg", " ", text)))
    values = {name: rng.uniform(0.3, 1.2) for name in names}
    variables = [joint.variable for joint in robot.joints]
    arm = numeric_arm(robot, {name: x for name, x in values.items() if name not in variables})
    pose = forward_kinematics(arm, np.array([values[name] for name in variables]))
    assert np.allclose(pose, product_of(text, values), atol=1e-12), text
    assert robot.convention is convention
    return robot


@pytest.mark.parametrize("convention", Convention)
@pytest.mark.parametrize("text", PRODUCTS)
def test_the_table_has_the_pose_of_the_product(text: str, convention: Convention) -> None:
    check(text, convention, random.Random(text))


def test_the_puma_gets_the_table_of_the_paper() -> None:
    rows = [joint.row for joint in Robot.from_text(robot_of_transforms(PUMA, "puma")).joints]
    assert [row["theta"] for row in rows] == ["q1", "q2 - pi/2", "q3 + pi/2", "q4", "q5", "q6"]
    assert [(row["d"], row["a"], row["alpha"]) for row in rows[:4]] == [
        ("L1", "0", "-pi/2"),
        ("0", "L3", "0"),
        ("L2 + L5", "L4", "pi/2"),
        ("L6", "0", "-pi/2"),
    ]


def random_product(rng: random.Random) -> str:
    """Joints about any axis between constants whose turns are right angles, or one symbol about one axis."""
    parts = []
    for i in range(1, rng.randint(2, 7)):
        right = [f"R{rng.choice('xyz')}({rng.choice([-1, 1])}*pi/2)" for _ in range(rng.randint(0, 2))]
        lengths = [f"T{rng.choice('xyz')}(a{i})"] * rng.randint(0, 1)
        odd = [f"R{rng.choice('xyz')}(u{i})"] * (rng.random() < 0.3)
        constants = [*right, *lengths, *odd]
        rng.shuffle(constants)
        sign, offset = rng.choice(["", "-"]), rng.choice(["", " + pi/2", " - 0.3"])
        parts += [*constants, f"{rng.choice('RRRT')}{rng.choice('xyz')}({sign}q{i}{offset})"]
    return " ".join([*parts, "Tx(0.1) Ry(pi/2)"])


@pytest.mark.parametrize("count", [18, *swept(60)])
def test_most_random_products_have_their_table(count: int) -> None:
    made = 0
    for seed in range(count):
        rng = random.Random(seed)
        with contextlib.suppress(RobotFileError):  # constants whose common normal has no axis
            check(random_product(rng), rng.choice(list(Convention)), rng)
            made += 1
    assert made > count * 5 // 6, made


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("Rz(q1) Ux(3)", "--from-transforms:1:8: unknown transform 'Ux'"),
        ("Rz(q1", "1:1: 'Rz(' is never closed"),
        ("Tx(3)", "no joint"),
        ("", "no joint"),
        ("Rz(q1) Tx(1) Rz(q1)", "1:14: the variable q1 twice"),
        ("Rz(2*q1)", "1:4: the cell '2*q1' of a joint"),
        ("Rz(q1 + q2)", "the cell 'q1 + q2' of a joint"),
        ("Rz(q1 + __import__)", "1:9: unexpected character '_'"),
        ("Rz(q1) Tx(1) Ty(2) Rz(q2)", "the constants Tx(1) Ty(2) between two joints"),
    ],
)
def test_what_is_no_product_is_refused_with_its_place(text: str, message: str) -> None:
    with pytest.raises(DeriveError) as raised:
        robot_of_transforms(text, "arm")
    assert message in str(raised.value)


def test_right_angles_are_found_however_they_are_written() -> None:
    assert decompose(
        Robot.from_text(robot_of_transforms("Rz(q1) Rx(90\u00b0) Rz(q2)", "arm")).joints[0].alpha
    ).pi_multiple
