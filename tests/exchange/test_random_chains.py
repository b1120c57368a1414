"""Random chains and almost parallel axes: both tables are the URDF's arm, as Pinocchio reads it."""

import math
from collections.abc import Iterable
from fractions import Fraction
from math import pi

import numpy as np
import pytest

from derive.exchange.arm import arm_of
from derive.exchange.common_normals import AS_WRITTEN, FAR, TURNED
from derive.exchange.from_urdf import MOST_MOVED, Imported, ImportOptions, as_meant, cut_off, import_urdf, meant, named
from derive.exchange.reading.urdf import read_urdf
from derive.exchange.robot_of_arm import TOUCHING
from derive.mechanics.space import exactly
from derive.robot.description import Convention
from derive.robot.evaluate import evaluate
from derive.verification.oracle.functions import Oracle
from tests.exchange.arms import random_chain
from tests.exchange.urdfs import J, Reading, pose, urdf

ROUNDING = 1e-12


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
        far = max(abs(evaluate(cell, {})) for joint in imported.robot.joints for cell in (joint.d, joint.a))
        sines = (abs(math.sin(evaluate(joint.alpha, {}))) for joint in imported.robot.joints)
        slant = min((sine for sine in sines if sine > 0.99 * least), default=1.0)  # of axes that are not parallel
        assert np.linalg.norm(apart[:3, 3]) <= bound.position + ROUNDING * max(1.0, far), said
        assert np.linalg.norm(apart[:3, :3], 2) <= bound.rotation + ROUNDING, said
        assert far <= FAR * arm.reach + ROUNDING or far <= 2 * arm.reach / slant, said
        if imported.robot.links:
            wanted = reading.torque(q, qd, qdd)
            got = oracle.evaluate("inverse_dynamics", q, qd, qdd)
            moved = bound.position + bound.rotation + max(arm.snaps, default=0.0) + float(min(TOUCHING, snap))
            assert np.abs(got - wanted).max() <= 1e-10 + 1000 * moved, said


def test_twelve_random_chains_have_tables() -> None:
    for seed in range(12):
        convention = Convention.STANDARD if seed % 4 < 2 else Convention.MODIFIED
        check(seed, Fraction(1, 10**6) if seed % 2 else Fraction(0), [convention])


@pytest.mark.sweep
@pytest.mark.parametrize("hundred", range(100))
def test_ten_thousand_random_chains_have_both_tables(hundred: int) -> None:
    for seed in range(100 * hundred, 100 * hundred + 100):
        check(seed, Fraction(1, 10**6) if seed % 2 else Fraction(0))


SNAP = Fraction(1, 10**6)


@pytest.mark.parametrize(
    ("written", "fraction"),
    [
        *(("1.57", 1 / 2), ("1.571", 1 / 2), ("-1.5707", -1 / 2), ("1.5708", 1 / 2), ("1.57079", 1 / 2)),
        *(("3.14", 1), ("3.1415", 1), ("-3.1416", -1), ("0.785", 1 / 4), ("4.712", 3 / 2), ("0.3926990", 1 / 8)),
    ],
)
def test_first_decimals_of_a_fraction_of_pi_are_known(written: str, fraction: float) -> None:
    assert float(meant(Fraction(written))) == pytest.approx(fraction * pi, abs=1e-15)


@pytest.mark.parametrize(
    "written", ["0", "1.6", "1.56", "1.5706", "1.5701", "1.572", "3.15", "0.3", "1.2", "0.01", "1.570234879", "0.1308"]
)
def test_other_angles_are_what_they_are(written: str) -> None:
    assert meant(Fraction(written)) == Fraction(written)


def arm(first: str, second: str) -> str:
    """Three axes at distances that are no multiples of each other, all parallel but for some turns, and a wrist."""
    axes = [J("0 0 0.3"), J("0 0.1 0", first), J("0.4 0.1 0", second), J("0.4 0 0.1", "1.57 0 0.4")]
    return urdf([*axes, J("0.1 0 0.2", type="fixed")])


CUT = arm("3.14 0 0", "3.1415 0 0")
MEASURED = arm("0.000523 0.00047 0", "0.00123 -0.0006 0")
FIVE_DIGITS = arm("3.14159 0 0", "-3.1416 0 0")


def imported(text: str, snap: Fraction) -> tuple[Imported, float, float]:
    """The arm of a text, its largest cell that is a length, and how far its poses are from Pinocchio's."""
    found = import_urdf(read_urdf(text.encode(), "arm.urdf"), None, None, ImportOptions(snap=snap))
    reading = Reading(text, found.joints)
    q = np.random.default_rng(3).uniform(-1, 1, found.robot.n)
    apart = float(np.linalg.norm((pose(found.robot, q) - reading.pose(q, "l5"))[:3, 3]))
    return found, max(abs(evaluate(cell, {})) for joint in found.robot.joints for cell in (joint.d, joint.a)), apart


def test_axes_that_five_digits_slant_are_parallel_at_once() -> None:
    found, far, apart = imported(FIVE_DIGITS, SNAP)
    assert far < 1
    assert apart <= found.certificate.position < TURNED
    assert sum("taken as parallel" in note for note in found.notes) == 2


def test_cut_angles_are_taken_for_fractions_of_pi_where_axes_would_meet_far_away() -> None:
    """The report names each with its joint and line; the certificate holds what they cost."""
    found, far, apart = imported(CUT, SNAP)
    assert far < 1
    assert 1e-4 < apart <= found.certificate.position < MOST_MOVED * 1.5
    told = next(note for note in found.notes if "taken for fractions of pi" in note)
    assert all(f"{angle} (joint j{joint}, line" in told for angle, joint in (("3.14", 2), ("3.1415", 3), ("1.57", 4)))
    exact, far, apart = imported(CUT, Fraction(0))
    assert far > 50
    assert apart < 1e-9
    assert any("almost fractions of pi" not in note and ": kept" in note for note in exact.notes)


def test_angles_stay_where_no_common_normal_is_far() -> None:
    found, _, apart = imported(arm("0 0 0", "0 0 0"), SNAP)
    assert apart < 1e-12
    assert "1.57" in found.text
    assert not any("taken for" in note for note in found.notes)


def test_measured_slants_are_kept_and_the_snap_that_removes_them_is_named() -> None:
    found, far, apart = imported(MEASURED, SNAP)
    assert far > FAR * 1.5
    assert apart < 1e-9
    (told,) = (note for note in found.notes if note.startswith("--snap "))
    snap, cost = told.split()[1], float(told.partition(" m and ")[0].split()[-1])
    snapped, far, apart = imported(MEASURED, Fraction(snap))
    assert far < 1
    assert apart <= snapped.certificate.position == pytest.approx(cost, rel=0.06)


def test_what_is_taken_as_parallel_without_any_snap_costs_less() -> None:
    found, far, apart = imported(arm("0.000001 0 0", "0.0000012 0 0"), Fraction(0))
    assert far < 1
    assert apart <= found.certificate.position < 2 * AS_WRITTEN


def test_cut_angles_are_found_between_links() -> None:
    robot = read_urdf(CUT.encode(), "arm.urdf")
    cut = cut_off(robot, "l1", "l3", SNAP)
    assert sorted((joint.name, float(angle)) for joint, angle in cut) == [("j2", 3.14), ("j3", 3.1415)]
    assert named(cut[:1], False).endswith("almost fractions of pi")
    assert cut_off(as_meant(robot), "l0", "l5", SNAP) == []


def test_what_a_snap_would_cost_is_said_as_distance_and_as_angle() -> None:
    """A tip that is turned by 1.57 where it stands moves no place, but its frame."""
    text = urdf([J(), J("0.5 0 0", "0 0 1.57", type="fixed")])
    found = import_urdf(read_urdf(text.encode(), "arm.urdf"), None, None, ImportOptions(snap=SNAP))
    (told,) = (note for note in found.notes if "would take them" in note)
    assert told.endswith("move poses by up to 1e-30 m and 0.0012 rad")
