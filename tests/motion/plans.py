"""Plans of the skeleton and of other arms."""

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

REACH = """\
robot: skeleton
curves: {q1: pi/3 + sin(t)/2, q2: pi/4*sin(2*t)}
base: {x: 3*t/10, y: t**2/10, rpy: [0, 0, t/7]}
time: 5
sample: 1/50
values: {l0: 0.4, l1: 0.3, Tx: 0.1, Ty: 0.2}
"""
"""beta = q1, alpha = q2, and a root that moves; document 001 asks for any curves."""

ROOT = """\
robot: skeleton-root
curves: {q1: 3*t/10, q2: t**2/10, q3: pi/3 + sin(t)/2, q4: pi/4*sin(2*t)}
time: 5
values: {l0: 0.4, l1: 0.3}
"""
"""The same with the root's translation as joints (slides 28 and 29)."""
