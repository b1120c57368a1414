"""A motion as plain data."""

from __future__ import annotations

import json

import pytest

from derive.motion.motion import Motion
from derive.motion.output.summary import summary
from tests.motion.plans import PICK_AND_PLACE


def test_exact_peaks_stand_beside_their_decimals() -> None:
    motion = Motion.from_text(PICK_AND_PLACE, "p.yaml")
    found = summary(motion)
    assert json.loads(json.dumps(found, allow_nan=False)) == found
    first = found["segments"][0]
    assert (found["plan"], found["duration"], found["samples"]) == ("p.yaml", 15.0, 1501)
    assert first["joints"]["q1"]["speed"]["exact"] == "5*pi/16"
    assert first["joints"]["q1"]["speed"]["value"] == pytest.approx(0.98174770424681)
    load = motion.peaks[0].loads[0]
    assert first["joints"]["q1"]["torque"] == {"value": load.peak, "time": load.time, "rms": load.rms}
    assert first["work"] == pytest.approx(sum(joint["work"] for joint in first["joints"].values()))


def test_what_was_sampled_has_no_exact_value_and_an_arm_without_links_no_torque() -> None:
    found = summary(Motion.load("skeleton-reach"))
    (segment,) = found["segments"]
    assert "exact" not in segment["joints"]["q4"]["speed"]
    assert "work" not in segment
    assert set(segment["joints"]["q1"]) == {"speed", "acceleration"}


def test_a_simulation_has_its_ledger_and_the_largest_errors() -> None:
    text = "robot: {name: p, convention: standard, gravity: [0, -9.81, 0], joints: [{type: revolute, a: 1, speed: 1}], "
    text += "links: [{mass: 1}]}\npoints: {a: [0], b: [1]}\npath: [a, {to: b, time: 1}]\n"
    motion = Motion.from_text(text + "control: {law: pd-gravity, kp: 400, kd: 40}\n")
    run = motion.simulate()
    found = summary(motion, run)
    assert found["simulation"]["reached"]
    assert found["simulation"]["largest_errors"]["q1"] == abs(run.q - motion(run.t)[0]).max()
    (violation,) = found["violations"]
    assert (violation["joint"], violation["what"], violation["limit"]) == ("q1", "speed", 1.0)
