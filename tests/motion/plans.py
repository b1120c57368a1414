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

FASTEST = """\
robot: puma560-corke
profile: fastest
torque: [56.6, 100, 56.6, 10, 10, 10]
points: {a: [0, 45, -90, 0, 30, 0], b: [90, 90, -180, 40, -30, 90], c: [20, 120, -120, 10, 30, 20]}
path: [a, {to: b, via: pass}, {to: c, payload: 1.5}]
"""

LINE_AND_ARC = """\
robot: {name: arm, convention: standard, inverse: {task: [x, y]}, gravity: [0, -9.81, 0],
  joints: [{type: revolute, a: 1}, {type: revolute, a: 0.8}], links: [{mass: 1, com: [-0.5, 0, 0]}, {mass: 1}]}
points: {a: [0.3, 0.5], b: [0.7, 0.9], c: [0.4, 1.4]}
path: [a, {to: b, time: 1.5, line: yes}, {to: a, time: 2, through: c}]
"""


def swing(time: str, gains: str, joint: str = "") -> str:
    """A pendulum of 1 kg at 1 m that PD control takes from level to one radian; more cells of its joint."""
    arm = f"gravity: [0, -9.81, 0], joints: [{{type: revolute, a: 1{joint}}}], links: [{{mass: 1}}]"
    points = f"points: {{a: [0], b: [1]}}\npath: [a, {{to: b, time: {time}}}]\n"
    return f"robot: {{name: p, convention: standard, {arm}}}\n{points}control: {{law: pd, {gains}}}\n"
