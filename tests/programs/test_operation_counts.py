"""Operation counts on well known arms: well below the best that any published generator reaches, and never again above.

Multiplications, additions and divisions; signs are free, sines and cosines apart, work on parameters alone apart.
"""

from __future__ import annotations

import pytest

from derive.programs.functions.functions import build_program
from derive.programs.program import Program
from derive.robot.robot import Robot

PUMA = ["alpha: pi/2", "a: a2", "a: a3, d: d3, alpha: -pi/2", "d: d4, alpha: pi/2", "alpha: -pi/2", "alpha: 0"]
LWR = [
    "alpha: pi/2", "alpha: -pi/2", "d: d3, alpha: -pi/2", "alpha: pi/2", "d: d5, alpha: pi/2", "alpha: -pi/2", "d: 0"
]  # fmt: skip

LIMITS = {
    "puma": (PUMA, {"T": 91, "J": 74, "g": 48, "B": 235, "tau": 432, "C": 720}),
    "lwr": (LWR, {"T": 99, "J": 95, "g": 80, "B": 270, "tau": 510, "C": 950}),
}
NAMES = {
    "T": "forward_kinematics",
    "J": "jacobian",
    "g": "gravity_vector",
    "B": "inertia_matrix",
    "tau": "inverse_dynamics",
    "C": "coriolis_matrix",
}


def symbolic_arm(rows: list[str]) -> Robot:
    """Revolute joints; all ten inertial parameters of every link are symbols."""
    joints = "\n".join(f"  - {{type: revolute, {row}}}" for row in rows)
    links = "\n".join(
        f"  - {{mass: m{i}, com: [x{i}, y{i}, z{i}], "
        f"inertia: {{xx: Ixx{i}, yy: Iyy{i}, zz: Izz{i}, xy: Ixy{i}, xz: Ixz{i}, yz: Iyz{i}}}}}"
        for i in range(1, len(rows) + 1)
    )
    text = f"name: arm\nconvention: standard\njoints:\n{joints}\ngravity: [0, 0, -g]\nlinks:\n{links}\n"
    return Robot.from_text(text)


@pytest.fixture(scope="module", params=list(LIMITS))
def arm(request: pytest.FixtureRequest) -> tuple[Program, dict[str, int]]:
    """A program and its limits."""
    rows, limits = LIMITS[request.param]
    return build_program(symbolic_arm(rows)), limits


def test_counts_stay_below_those_of_other_generators(arm: tuple[Program, dict[str, int]]) -> None:
    program, limits = arm
    found = {symbol: program[NAMES[symbol]].operations.arithmetic for symbol in limits}
    assert {symbol: count for symbol, count in found.items() if count > limits[symbol]} == {}


def test_gravity_along_the_first_axis_needs_no_first_angle(arm: tuple[Program, dict[str, int]]) -> None:
    program, _ = arm
    for name in ("gravity_vector", "inertia_matrix", "inverse_dynamics", "coriolis_matrix"):
        sources = [node.source for node in program[name].tape.nodes if node.source is not None]
        assert all((source.kind, source.index) != ("q", 0) for source in sources)
