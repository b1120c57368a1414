"""Tables come out as makers and books print them, from URDFs whose frames stand elsewhere."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest

from derive.exchange.from_urdf import ImportOptions, import_urdf
from derive.exchange.read_urdf import read_urdf
from derive.robot.description import Convention
from derive.robot.evaluate import evaluate
from derive.robot.load import catalogue_names
from derive.robot.robot import Robot
from tests.exchange.tables import cells, numbers, table_urdf
from tests.exchange.urdfs import J, pose, urdf

Rows = list[tuple[float, float, float, float]]
"""theta, d, a, alpha."""


def ur(d1: str, far: str, back: str, a2: str, a3: str, wrist: tuple[str, str, str]) -> str:
    """An arm of Universal Robots with the frames of its description for ROS; pi/2 has few digits there."""
    half = "1.570796325"
    return urdf(
        [
            J(f"0 0 {d1}"),
            J(f"0 {far} 0", f"0 {half} 0", "0 1 0"),
            J(f"0 -{back} {a2}", axis="0 1 0"),
            J(f"0 0 {a3}", f"0 {half} 0", "0 1 0"),
            J(f"0 {wrist[0]} 0"),
            J(f"0 0 {wrist[1]}", axis="0 1 0"),
            J(f"0 {wrist[2]} 0", f"-{half} 0 0", type="fixed", link="tool0"),
            J(rpy="0 0 -3.14159265359", type="fixed", link="base", parent="base_link"),
        ],
        base="base_link",
    )


def ur_rows(d1: float, a2: float, a3: float, d4: float, d5: float, d6: float) -> Rows:
    """As the maker prints it."""
    turned = [(0.0, d1, 0.0, pi / 2), (0.0, 0.0, -a2, 0.0), (0.0, 0.0, -a3, 0.0)]
    return [*turned, (0.0, d4, 0.0, pi / 2), (0.0, d5, 0.0, -pi / 2), (0.0, d6, 0.0, 0.0)]


IIWA = urdf(
    [
        J("0 0 0.1575"),
        J("0 0 0.2025", f"{pi / 2} 0 {pi}"),
        J("0 0.2045 0", f"{pi / 2} 0 {pi}"),
        J("0 0 0.2155", f"{pi / 2} 0 0"),
        J("0 0.1845 0", f"{-pi / 2} {pi} 0"),
        J("0 0 0.2155", f"{pi / 2} 0 0"),
        J("0 0.081 0", f"{-pi / 2} {pi} 0"),
        J("0 0 0.045", type="fixed"),
    ]
)

PANDA = urdf(
    [
        J("0 0 0.333"),
        J("0 0 0", f"{-pi / 2} 0 0"),
        J("0 -0.316 0", f"{pi / 2} 0 0"),
        J("0.0825 0 0", f"{pi / 2} 0 0"),
        J("-0.0825 0.384 0", f"{-pi / 2} 0 0"),
        J("0 0 0", f"{pi / 2} 0 0"),
        J("0.088 0 0", f"{pi / 2} 0 0"),
        J("0 0 0.107", type="fixed"),
    ]
)

MAKERS = {
    "UR3": (
        ur("0.1519", "0.1198", "0.0925", "0.24365", "0.21325", ("0.08505", "0.08535", "0.0819")),
        "base",
        "tool0",
        ur_rows(0.1519, 0.24365, 0.21325, 0.11235, 0.08535, 0.0819),
    ),
    "UR5": (
        ur("0.089159", "0.13585", "0.1197", "0.425", "0.39225", ("0.093", "0.09465", "0.0823")),
        "base",
        "tool0",
        ur_rows(0.089159, 0.425, 0.39225, 0.10915, 0.09465, 0.0823),
    ),
    "UR10": (
        ur("0.1273", "0.220941", "0.1719", "0.612", "0.5723", ("0.1149", "0.1157", "0.0922")),
        "base",
        "tool0",
        ur_rows(0.1273, 0.612, 0.5723, 0.163941, 0.1157, 0.0922),
    ),
    "iiwa 14": (
        IIWA,
        None,
        None,
        [
            (0.0, d, 0.0, alpha * pi / 2)
            for d, alpha in zip((0.36, 0.0, 0.42, 0.0, 0.4, 0.0, 0.126), (-1, 1, 1, -1, -1, 1, 0), strict=True)
        ],
    ),
}


@pytest.mark.parametrize("name", MAKERS)
def test_the_standard_table_is_the_makers(name: str) -> None:
    text, base, tip, rows = MAKERS[name]
    robot = import_urdf(read_urdf(text.encode(), name), base, tip).robot
    got = cells(robot, {})
    assert got[: robot.n] == [pytest.approx(row, abs=1e-12) for row in rows]
    assert got[robot.n :] == [pytest.approx(row) for row in (*np.eye(4).tolist(), *np.eye(4).tolist())]


def test_the_modified_table_of_the_panda_is_the_makers() -> None:
    """Its flange stands 0.107 m along the last axis: in the last row."""
    robot = import_urdf(
        read_urdf(PANDA.encode(), "panda"), None, None, ImportOptions(convention=Convention.MODIFIED)
    ).robot
    got = [tuple(evaluate(cell, {}) for cell in (row.alpha, row.a, row.theta, row.d)) for row in robot.joints]
    turns = (0, -1, 1, 1, -1, 1, 1)
    lengths = ((0, 0.333), (0, 0), (0, 0.316), (0.0825, 0), (-0.0825, 0.384), (0, 0), (0.088, 0.107))
    wanted = [(turn * pi / 2, a, 0, d) for turn, (a, d) in zip(turns, lengths, strict=True)]
    assert got == [pytest.approx(row) for row in wanted]


@pytest.mark.parametrize("name", ["puma560-corke", "stanford-deluca", "kuka-kr5", "kuka-lwr4"])
def test_tables_of_books_come_back(name: str) -> None:
    robot = Robot.load(name)
    values = numbers(robot)
    text = table_urdf(robot, values)
    imported = import_urdf(read_urdf(text.encode(), name), None, None, ImportOptions(convention=robot.convention))
    assert cells(imported.robot, {}) == [pytest.approx(row, abs=1e-12) for row in cells(robot, values)]


@pytest.mark.sweep
@pytest.mark.parametrize("name", catalogue_names())
def test_every_built_in_arm_comes_back(name: str) -> None:
    """With the same poses, in both conventions."""
    robot = Robot.load(name)
    values = numbers(robot)
    for convention in Convention:
        text = table_urdf(robot, values)
        imported = import_urdf(read_urdf(text.encode(), name), None, None, ImportOptions(convention=convention))
        q = np.random.default_rng(1).uniform(-1, 1, robot.n)
        apart = pose(imported.robot, q) - pose_of(robot, values, q)
        assert np.abs(apart).max() < 1e-12
        assert imported.certificate.position < 1e-12


def pose_of(robot: Robot, values: dict[str, float], q: np.ndarray) -> np.ndarray:
    """Of a table with names."""
    from derive.verification.oracle.functions import Oracle

    return Oracle.of(robot, values).evaluate("forward_kinematics", q)
