"""Rods between ball joints: each assembly is found, and a rod moves a linkage as a coupler without mass does."""

import re
from dataclasses import replace
from math import pi

import numpy as np
import pytest

from derive.inverse.loops.linkage import linkage, positions
from derive.inverse.loops.parallelogram import reduced
from derive.inverse.loops.rod import rod_graph
from derive.robot.description import IDENTITY
from derive.robot.expression import ZERO
from derive.robot.load import robot_file_bytes
from derive.robot.robot import Robot
from derive.robot.writer import robot_text
from derive.verification.oracle.frames import chain_frames, numeric_arm
from derive.verification.samples import oracle_of
from tests.random_robots import seeds
from tests.verification.oracle.test_loops import mechanism


def with_rod(name: str) -> str:
    """A built-in linkage with a rod from the crank in place of the coupler, which is a part of the crank."""
    text = robot_file_bytes(name).decode()
    text = re.sub(r"{type: revolute, +(name: \w+), +q: q2, (.*), passive: true}", r"{type: fixed, \1, \2}", text)
    return re.sub(r"\[\w+, (\w+)\], by: revolute", r"[crank, \1], by: distance, length: l2", text)


@pytest.mark.parametrize("name", ["four-bar", "slider-crank"])
def test_a_rod_moves_a_linkage_as_a_coupler_without_mass_does(name: str) -> None:
    oracles = []
    for robot in (Robot.from_text(with_rod(name)), Robot.load(name)):
        cells = tuple((k, ZERO if k in ("m2", "I2") else cell) for k, cell in robot.parameters)
        loops = [tuple(replace(loop, branch=sign) for loop in robot.loops) for sign in "+-"]
        oracles.append([oracle_of(replace(robot, parameters=cells, loops=each)) for each in loops])
    q, qd, qdd = np.random.default_rng(4).uniform(-3, 3, (3, 20, 1))
    matched = []
    for rod in oracles[0]:
        found = [np.abs(np.sin(rod.following(q).x - each.following(q).x[:, ::2])).max() for each in oracles[1]]
        matched.append(other := oracles[1][int(np.argmin(found))])
        assert min(found) < 1e-12
        one, two = rod.following(q), other.following(q)
        assert np.abs(one.slope[:, -1] - two.slope[:, -1]).max() < 1e-11
        assert np.abs(one.slope_dot(qd)[:, -1] - two.slope_dot(qd)[:, -1]).max() < 1e-11
        torques, expected = (each.evaluate("inverse_dynamics", q, qd, qdd) for each in (rod, other))
        assert np.abs(torques - expected).max() < 1e-12 * np.abs(expected).max()
    assert matched[0] is not matched[1]


@pytest.mark.parametrize("name", ["rssr", "rssp"])
@pytest.mark.parametrize("seed", seeds(40, 4, 40))
def test_all_assemblies_in_space_are_found_and_none_is_spurious(name: str, seed: int) -> None:
    robot, q = mechanism(name, seed), np.random.default_rng(seed).uniform(-pi, pi, 4)
    turns, arm, (loop,) = name == "rssr", numeric_arm(robot), robot.loops
    robots = [replace(robot, loops=(replace(loop, branch=sign),)) for sign in "+-"]
    found = [positions(one, linkage(one), [q]) for one in robots]
    grid = np.linspace(-1, 1, 20_001)[:-1] * (pi if turns else 9)
    for k, angle in enumerate(q):
        frames = chain_frames(arm, np.stack(np.broadcast_arrays(angle, grid), axis=-1))
        a, b = (frames[..., joint + 1, :3, :] @ own[:, 3] for joint, own in (arm.ends["a0"], arm.ends["b0"]))
        gap = np.linalg.norm(a - b, axis=-1) - arm.loops[0][1]
        expected = grid[np.flatnonzero(np.sign(gap) != np.sign(np.roll(gap, -1)))]
        own = np.array([full[1][k] for full, exists in found if exists[k]])
        if np.abs(gap).min() > 1e-5:  # a grid sees no double root
            apart = np.abs(own[:, None] - expected)
            assert len(own) == len(expected)
            assert (np.minimum(apart, np.abs(apart - 2 * pi * turns)).min(axis=1, initial=9) < 2e-3).all()


def test_opposite_sides_of_equal_length_turn_alike() -> None:
    rod = with_rod("four-bar")
    same = rod.replace("a: l3", "a: l1").replace("length: l2", "length: l0").replace("l3: 0.25", "l3: 1")
    assert [joint.row["theta"] for joint in reduced(Robot.from_text(same)).joints] == ["q1", "q1"]
    assert reduced(Robot.from_text(rod)).loops


def test_a_rod_is_written_as_it_was_read_in_the_units_of_the_file() -> None:
    text = (
        with_rod("four-bar")
        .replace("length: l2", "length: 350")
        .replace("convention", "units: {length: mm}\nconvention")
    )
    written = robot_text(robot := Robot.from_text(text))
    assert "by: distance, length: 350" in written
    assert Robot.from_text(written).loops == robot.loops
    assert str(robot.loops[0].length.value) == "7/20"


def test_a_joint_whose_axis_ends_the_rod_does_not_move_it() -> None:
    arm = linkage(Robot.from_text(with_rod("four-bar")))[0].circuit.arm
    graph = rod_graph(arm, (False, False, True))
    assert graph is not None
    assert graph.count == 2
    assert rod_graph(replace(arm, tool=IDENTITY), (False, False, True)) is None
