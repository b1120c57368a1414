"""Whatever the axes are to each other, both tables are the URDF's arm, as Pinocchio reads it."""

from __future__ import annotations

import math
from collections.abc import Iterable
from fractions import Fraction

import numpy as np
import pytest

from derive.exchange.arm import arm_of
from derive.exchange.common_normals import AS_WRITTEN, FAR, TURNED
from derive.exchange.from_urdf import ImportOptions, import_urdf
from derive.exchange.read_urdf import read_urdf
from derive.exchange.robot_of_arm import TOUCHING
from derive.mechanics.space import exactly
from derive.robot.description import Convention
from derive.robot.evaluate import evaluate
from derive.robot.robot import Robot
from derive.verification.oracle.functions import Oracle
from tests.exchange.chains import random_chain
from tests.exchange.urdfs import Reading, pose

ROUNDING = 1e-12


def furthest(robot: Robot) -> float:
    """The largest cell that is a length."""
    return max(abs(evaluate(cell, {})) for joint in robot.joints for cell in (joint.d, joint.a))


def least_slant(robot: Robot, least: float) -> float:
    """The smallest sine of an angle between axes that nobody may take as parallel; 1 where there is none."""
    sines = (abs(math.sin(evaluate(joint.alpha, {}))) for joint in robot.joints)
    return min((sine for sine in sines if sine > 0.99 * least), default=1.0)


def check(seed: int, snap: Fraction, conventions: Iterable[Convention] = Convention) -> None:
    """Tables of a chain: poses within the certificate, torques, no cell far beyond the arm's reach."""
    text, names = random_chain(seed)
    urdf, reading = read_urdf(text.encode(), f"chain-{seed}.urdf"), Reading(text, names)
    tip = list(urdf.bodies)[-1]
    with exactly():
        arm = arm_of(urdf, None, None, snap)
    source = np.random.default_rng(seed)
    for convention in conventions:
        imported = import_urdf(urdf, None, None, ImportOptions(convention=convention, snap=snap))
        oracle, bound = Oracle.of(imported.robot), imported.certificate
        q, qd, qdd = source.uniform(-0.5, 0.8, (3, len(names)))
        apart = pose(imported.robot, q) - reading.pose(q, tip)
        said = f"{seed} {convention.value}"
        least = (TURNED if snap else AS_WRITTEN) * min(1.0, 1 / max(arm.reach, ROUNDING)) / 2
        far, slant = furthest(imported.robot), least_slant(imported.robot, least)
        assert np.linalg.norm(apart[:3, 3]) <= bound.position + ROUNDING * max(1.0, far), said
        assert np.linalg.norm(apart[:3, :3], 2) <= bound.rotation + ROUNDING, said
        assert far <= FAR * arm.reach + ROUNDING or far <= 2 * arm.reach / slant, said
        if imported.robot.links:
            wanted = reading.torque(q, qd, qdd)
            got = oracle.evaluate("inverse_dynamics", q, qd, qdd)
            assert np.abs(got - wanted).max() <= 1e-10 + 1000 * (
                bound.position + bound.rotation + max(arm.snaps, default=0.0) + float(min(TOUCHING, snap))
            ), said


def test_two_hundred_random_chains_have_tables() -> None:
    for seed in range(200):
        convention = Convention.STANDARD if seed % 4 < 2 else Convention.MODIFIED
        check(seed, Fraction(1, 10**6) if seed % 2 else Fraction(0), [convention])


@pytest.mark.sweep
@pytest.mark.parametrize("hundred", range(100))
def test_ten_thousand_random_chains_have_both_tables(hundred: int) -> None:
    for seed in range(100 * hundred, 100 * hundred + 100):
        check(seed, Fraction(1, 10**6) if seed % 2 else Fraction(0))
