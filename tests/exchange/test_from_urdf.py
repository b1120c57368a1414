"""A robot from a URDF is the URDF's arm."""

from __future__ import annotations

import numpy as np
import pytest

from derive.exchange.from_urdf import ImportOptions, import_urdf, robot_name
from derive.exchange.read_urdf import read_urdf
from derive.robot.description import Convention
from derive.verification.oracle.functions import Oracle
from tests.exchange.urdfs import HALF, PI, J, Reading, body, pose, urdf

ARM = urdf(
    [
        J("0 0 0.3", "0.1 -0.4 2", inertial=body("3", "0.1 0 0.2", "0.3 0.2 0.1", "0.2 0.3 0.4 0.01 0.02 -0.03")),
        J("0.4 0 0", f"{HALF} 0 0", "0 -2 0", inertial=body("2", "0 0.1 0.2", moments="0.1 0.1 0.05 0 0 0")),
        J("0.3 0 0", f"0 {HALF} 0", type="fixed", inertial=body("1", "0.1 0 0", moments="0.01 0.02 0.02 0 0 0")),
        J("0 0 0.2", f"0 0 {PI}", "1 0 0", type="prismatic", inertial=body("1.5", moments="0.03 0.02 0.02 0 0 0")),
        J("0 0.2 0", "0.4 0 0", type="continuous", limit="", inertial=body("0.5", "0 0 0.1")),
        J("0.1 0 0.1", "0 0.5 0", type="fixed"),
    ]
)


@pytest.mark.parametrize("convention", Convention)
def test_poses_and_dynamics_are_those_of_pinocchio(convention: Convention) -> None:
    imported = import_urdf(read_urdf(ARM.encode(), "arm.urdf"), None, None, ImportOptions(convention=convention))
    reading, oracle = Reading(ARM, ("j1", "j2", "j4", "j5")), Oracle.of(imported.robot)
    random = np.random.default_rng(4)
    for _ in range(5):
        q, qd, qdd = random.uniform(-2, 2, (3, 4))
        assert np.abs(pose(imported.robot, q) - reading.pose(q, "l6")).max() < 1e-12
        wanted = reading.torque(q, qd, qdd)
        assert np.abs(oracle.evaluate("inverse_dynamics", q, qd, qdd) - wanted).max() < 1e-10
        assert np.abs(oracle.evaluate("inertia_matrix", q) - reading.inertia(q)).max() < 1e-10


def test_limits_that_bound_nothing_are_none_and_named() -> None:
    limits = ('lower="-inf" upper="inf"', 'lower="0" upper="0"', 'lower="-1e9" upper="2"', 'lower="-2" upper="1"')
    text = urdf([J("0 0 0.3", limit=limit) for limit in limits])
    imported = import_urdf(read_urdf(text.encode(), "arm.urdf"), None, None)
    assert [joint.limits is None for joint in imported.robot.joints] == [True, True, True, False]
    assert [note for note in imported.notes if "taken as none" in note] == [
        "joint j1: limits -1e+60 to 1e+60 are taken as none",
        "joint j2: limits 0 to 0 are taken as none",
        "joint j3: limits -1e+09 to 2 are taken as none",
    ]


def test_lengths_a_nanometre_from_few_digits_have_these_and_others_all() -> None:
    """0.1 - 1.94e-11 of an exporter's rounding is 0.1, within the bound; with no snap it is what it is."""
    text = urdf(
        [J("0 0 0.10000000000194"), J("0.1 0 0.3", f"{HALF} 0 0"), J("0.2500001234 0 1e-11", type="fixed")]
    ).encode()
    snapped, exact = (import_urdf(read_urdf(text, "a"), None, None, ImportOptions(snap=s)) for s in ("1e-6", "0"))
    assert "d: 0.4," in snapped.text
    assert "a: 0.2500001234," in snapped.text
    assert 1e-11 <= snapped.certificate.position < 1e-9
    assert exact.certificate.position < 1e-15
    assert "d: 0.40000000000194," in exact.text


def test_a_name_of_robot_files_stays_and_any_other_text_becomes_one() -> None:
    named = {"a--b": "a--b", "x" * 40: "x" * 40, "UR5 (cb3)": "ur5-cb3", "import": "import-robot", "ü": "arm"}
    assert {text: robot_name(text) for text in named} == named
