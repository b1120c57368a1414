"""The commented robot file that ``derive new NAME`` writes; it loads as it is."""

from __future__ import annotations

from derive.errors import RobotFileError, quoted
from derive.robot.limits import FILE_LIMITS
from derive.robot.load import is_robot_name

_HEAD = """\
# Robot file. Check it:  derive show {name}.yaml T      Build it:  derive build {name}.yaml
name: {name}                 # a-z, 0-9 and -; also the name of the output folder
title: "{name}"              # any text
convention: standard         # standard: Rot z theta, Trans z d, Trans x a, Rot x alpha (Siciliano, Spong, Corke)
                             # modified: Rot x alpha_(i-1), Trans x a_(i-1), Rot z theta_i, Trans z d_i (Craig, Khalil)
units: {{angle: rad, length: m}}   # deg and mm are allowed: then plain numbers in the table and in limits are in them

# One row per joint. A cell is a number, a name or an expression with + - * / **, pi, sqrt, sin, cos, tan.
# Cells that are 0, the name of the variable (q1, q2, ...) and the variable's own cell may be left out:
# theta is the variable of a revolute joint, d that of a prismatic one; an offset is written theta: q1 + pi/2.
joints:
"""

_TAIL = """
# Optional constant 4x4 transforms before frame 0 and after the last frame.
# tool:
#   - [1, 0, 0, 0]
#   - [0, 1, 0, 0]
#   - [0, 0, 1, 0.1]
#   - [0, 0, 0, 1]

# Optional dynamics: one row per joint, everything in the link's own frame, in kg, m and kg m^2; what is left out is 0.
gravity: [0, -g, 0]          # acceleration of gravity in the base frame; here y points up
links:
"""

_PARAMETERS = """
# Numbers of names, in SI units and radians. Names without a number stay arguments of the generated functions,
# and so do names listed under runtime although they have one.
parameters:
  g: 9.81
# runtime: [m{last}]
"""


def new_robot_text(name: str, joints: int = 2) -> str:
    """A commented robot file: an arm of revolute joints with parallel axes, its lengths and masses left as names.

    Args:
        name: Name of the robot, ``[a-z][a-z0-9-]*``.
        joints: Number of rows.

    Raises:
        RobotFileError: A name or number of joints that no robot may have.
    """
    if not is_robot_name(name):
        raise RobotFileError(
            f"{quoted(name)} is not a robot name",
            allowed=f"allowed: a-z, 0-9 and -, not first, at most {FILE_LIMITS.name_length} characters",
            remedy="no Python keyword and no name of an imported package",
        )
    if not 1 <= joints <= FILE_LIMITS.joints:
        raise RobotFileError(f"{joints} joints", allowed=f"allowed: 1 to {FILE_LIMITS.joints}")
    rows = "".join(_row(i) for i in range(1, joints + 1))
    links = "".join(_link(i) for i in range(1, joints + 1))
    return _HEAD.format(name=name) + rows + _TAIL + links + _PARAMETERS.format(last=joints)


def _row(i: int) -> str:
    note = "   # limits: [-pi/2, pi/2] may be added" if i == 1 else ""
    return f"  - {{type: revolute, q: q{i}, theta: q{i}, d: 0, a: a{i}, alpha: 0}}{note}\n"


def _link(i: int) -> str:
    text = f"""\
  - mass: m{i}
    com: [l{i} - a{i}, 0, 0]
    inertia: {{zz: I{i}}}      # about the centre of mass; keys xx yy zz xy xz yz
"""
    if i == 1:
        text += """\
    # armature: G1**2*Jm1                          # reflected rotor inertia, or the full model of the motor:
    # motor: {mass: mm1, inertia: Im1, ratio: kr1}
    # friction: {viscous: b1, coulomb: f1}
"""
    return text
