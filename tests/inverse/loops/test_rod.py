"""Rods between ball joints: each assembly is found, and a rod moves a linkage as a coupler without mass does."""

import re
from dataclasses import replace
from functools import partial
from math import pi

import numpy as np
import pytest
from scipy.optimize import fsolve
from sympy import Symbol

from derive.errors import QuantityError
from derive.handouts.notation.notation import Notation
from derive.handouts.parts.closure import closure_lines
from derive.inverse.loops.circuit import rod_graph
from derive.inverse.loops.closing import IteratedLoops
from derive.inverse.loops.linkage import linkage, positions, rates
from derive.inverse.loops.parallelogram import reduced
from derive.model.model import Model
from derive.robot.description import IDENTITY
from derive.robot.expression import ZERO
from derive.robot.load import robot_file_bytes
from derive.robot.robot import Robot
from derive.robot.writer import robot_text
from derive.verification.oracle.frames import NumericArm, chain_frames, numeric_arm
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
    assert rod_graph(arm, (False, False, True)).count == 2
    with pytest.raises(QuantityError, match="does not change"):
        rod_graph(replace(arm, tool=IDENTITY), (False, False, True))


DELTA = """
name: delta-from-motors
convention: standard
joints:
  - {type: fixed, name: hip1, after: base, a: 0.2, alpha: pi/2}
  - {type: revolute, name: motor1, q: q1, after: hip1, a: 0.25}
  - {type: fixed, name: hip2, after: base, theta: 2*pi/3, a: 0.2, alpha: pi/2}
  - {type: revolute, name: motor2, q: q2, after: hip2, a: 0.25}
  - {type: fixed, name: hip3, after: base, theta: -2*pi/3, a: 0.2, alpha: pi/2}
  - {type: revolute, name: motor3, q: q3, after: hip3, a: 0.25}
  - {type: prismatic, name: slide_x, after: base, q: x, passive: true, SLIDE}
  - {type: prismatic, name: slide_y, q: y, passive: true, SLIDE}
  - {type: prismatic, name: platform, q: z, passive: true, SLIDE}
  - {type: fixed, name: anchor1, after: platform, a: 0.05}
  - {type: fixed, name: anchor2, after: platform, theta: 2*pi/3, a: 0.05}
  - {type: fixed, name: anchor3, after: platform, theta: -2*pi/3, a: 0.05}
loops:
  - {join: [motor1, anchor1], by: distance, length: 0.5, branch: "-"}
  - {join: [motor2, anchor2], by: distance, length: 0.5}
  - {join: [motor3, anchor3], by: distance, length: 0.5}
ends: {platform: platform}
""".replace("SLIDE", SLIDE := "mount: [[0, 0, 1, 0], [1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 0, 1]]")


def with_three_rods(seed: int, branch: str, slide: str = SLIDE) -> Robot:
    """A platform on a turned pedestal that three rods hold, of two cranks and a slide, of unequal lengths."""
    a, b, c, d, e, f = np.random.default_rng(seed).uniform(0.1, 0.4, 6).round(3)
    joins = ["[arm, knob]", "[anchor, wheel]", "[knob, carriage]"]
    rows = [
        f"{{type: revolute, name: arm, q: q1, a: {a}, alpha: 0.3, d: {b}}}",
        f"{{type: revolute, name: wheel, after: base, theta: q2 + 1, a: {c}, alpha: pi/2, mount: [[0, 0, 1, -1], "
        f"[1, 0, 0, {d}], [0, 1, 0, 0], [0, 0, 0, 1]]}}",
        "{type: prismatic, name: carriage, after: base, q: q3, limits: [-0.5, 0.5], alpha: 0.4, a: -0.8}",
        "{type: revolute, name: pedestal, after: base, q: q4, alpha: 0.7, a: 0.1}",
        f"{{type: prismatic, name: one, after: pedestal, q: x, d: 0.05 - x, passive: true, {SLIDE}}}",
        f"{{type: prismatic, name: two, q: y, passive: true, {slide}}}",
        f"{{type: prismatic, name: three, q: z, passive: true, {SLIDE}}}",
        f"{{type: fixed, name: knob, after: three, a: {e}}}",
        f"{{type: fixed, name: anchor, after: three, a: {f}, theta: 2}}",
    ]
    loops = [f"{{join: {join}, by: distance, length: {1.0 + 0.1 * k}}}" for k, join in enumerate(joins)]
    loops[1] = loops[1].replace("}", f", branch: '{branch}'}}") if branch else loops[1]
    joints, closed = ("".join(f"\n  - {row}" for row in part) for part in (rows, loops))
    ends = ", ".join(f"{name}: {name}" for name in ("arm", "wheel", "carriage", "knob", "anchor"))
    return Robot.from_text(f"name: held\nconvention: standard\njoints:{joints}\nloops:{closed}\nends: {{{ends}}}\n")


def held_gap(arm: NumericArm, at: list[float], x: np.ndarray) -> np.ndarray:
    """Squared lengths of the rods of `with_three_rods` less what they are."""
    frames = chain_frames(arm, np.array([*at, *x]))
    ends = {name: frames[joint + 1, :3, :] @ own[:, 3] for name, (joint, own) in arm.ends.items()}
    pairs = (("arm", "knob"), ("anchor", "wheel"), ("knob", "carriage"))
    return np.array([((ends[a] - ends[b]) ** 2).sum() for a, b in pairs]) - np.array([1.0, 1.1, 1.2]) ** 2


@pytest.mark.parametrize("seed", seeds(20, 2, 20))
def test_both_points_that_three_rods_hold_are_found_and_no_other(seed: int) -> None:
    robots, source = [with_three_rods(seed, sign) for sign in "+-"], np.random.default_rng(seed)
    arm, loops, places = numeric_arm(robots[0]), linkage(robots[1]), list(linkage(robots[0])[0].passive)
    q = source.uniform(-1, 1, (6, 4)) * [3, 3, 0.5, 3]
    results = [positions(robot, linkage(robot), list(q.T)) for robot in robots]
    for k, at in enumerate(q):
        gap, found = partial(held_gap, arm, at.tolist()), list[np.ndarray]()
        for start in source.uniform(-2, 2, (16, 3)):
            x, _, done, _ = fsolve(gap, start, full_output=True, xtol=1e-13)
            if done == 1 and np.abs(gap(x)).max() < 1e-10 and all(np.abs(x - other).max() > 1e-5 for other in found):
                found.append(x)
        own = [np.array(full)[places, k] for full, exists in results if exists[k]]
        assert len(found) == len(own)
        assert all(np.abs(gap(x)).max() < 1e-12 for x in own)
        assert all(min(np.abs(x - other).max() for other in found) < 1e-7 for x in own)
    full, exists = results[1]
    assert exists.any()
    slope, _ = rates(robots[1], loops, full, {})
    for j, step in enumerate(1e-6 * np.eye(4)):
        ahead, back = (np.array(positions(robots[1], loops, list((q + way).T))[0]) for way in (step, -step))
        off = np.abs((ahead - back) / 2e-6 - slope[:, j]) / np.maximum(1, np.abs(slope[:, j]))
        assert off[:, exists].max() < 1e-6


def test_a_delta_from_its_motors_is_printed_and_oblique_slides_are_solved_numerically() -> None:
    robot = Robot.from_text(DELTA)
    model = Model(robot)
    (one,) = model.closure.loops
    q = [0.3, -0.4, 0.1]
    full, (exists,) = positions(robot, linkage(robot), [np.array([x]) for x in q])
    assert exists
    values = dict(zip([joint.variable for joint in robot.joints], np.array(full)[:, 0], strict=True))
    known = {line.symbol: line.value.subs(values) for line in one.known}
    assert all(abs(float(e.subs(known).subs(values))) < 1e-12 for e in one.surfaces)
    assert "2 solutions (complete)" in closure_lines(model.closure, "text", Notation.of(robot))
    found = dict(zip(map(Symbol, ("q1", "q2", "q3")), q, strict=True))
    for line in one.solution.lines:
        found[line.symbol] = line.value.subs(found)
    assert all(abs(float(found[Symbol(name)]) - values[name]) < 1e-12 for name in "xyz")
    assert values["z"] < 0
    tilted = "mount: [[1, 0, 0, 0], [0, 0.6, -0.8, 0], [0, 0.8, 0.6, 0], [0, 0, 0, 1]]"
    (oblique,) = linkage(with_three_rods(0, "", tilted))
    assert isinstance(oblique, IteratedLoops)
    signs = zip(robot.loops, "+-+", strict=True)
    with pytest.raises(QuantityError, match="allowed: one of them"):
        linkage(replace(robot, loops=tuple(replace(loop, branch=sign) for loop, sign in signs)))
