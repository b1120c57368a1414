"""Plans that several tests use."""

from __future__ import annotations

PICK_AND_PLACE = """\
robot: scara-matlab
profile: quintic
sample: 0.01
points:
  rest: [0, 0, 1, 0]
  A: [pi/2, pi/2, 1, 0]
  B: [pi/2, pi/2, 3, 0]
  C: [pi/2, 0, 1, 0]
  D: [pi/2, 0, 3, 0]
path: [rest, {to: A, time: 3}, {to: B, time: 3}, {to: A, time: 3}, {to: C, time: 3}, {to: D, time: 3}]
control: {law: computed-torque, kp: 100, kd: 20}
friction: smooth
"""
"""Document 004, simulation: five points, six places, 3 s each."""

PUMA_FALLS = """\
robot: puma560-corke
points: {a: [0, 45, -90, 10, 20, 30]}
path: [a, {to: a, time: TIME}]
friction: none
"""
"""An arm without motors."""
