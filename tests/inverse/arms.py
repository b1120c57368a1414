"""Arms for the inverse kinematics: tables of published arms, and random ones of every class.

A table is written as lines ``joint theta d a alpha`` (standard) or ``joint alpha a d theta`` (modified), degrees and
metres, a joint's own variable left out: ``R 0 0.15 0.4 -90``.
"""

from __future__ import annotations

import json
import random
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from derive.robot.names import free_symbols
from derive.robot.robot import Robot
from derive.verification.oracle.frames import NumericArm, jacobian, numeric_arm

Rows = tuple[tuple[str, str, str, str, str], ...]
"""Type, theta, d, a, alpha of each joint: cells as text, angles in degrees."""


@dataclass(frozen=True)
class ArmCase:
    name: str  # as in a robot file
    kind: str  # the class that it belongs to
    rows: Rows  # its table, in the order joint, theta, d, a, alpha in both conventions
    modified: bool = False  # whether a and alpha are those of the row before
    base: tuple[tuple[str, ...], ...] = ()  # rows of a 4x4 matrix of cells, or nothing
    tool: tuple[tuple[str, ...], ...] = ()
    task: str = "pose"  # ``pose`` or ``position``
    given: tuple[int, ...] = ()  # joints that are given, by index from 0
    values: dict[str, float] = field(default_factory=dict, hash=False)  # numbers of symbols that the table leaves open
    source: str = ""

    @property
    def text(self) -> str:
        """The robot file, its own choice of task and given joints included."""
        joints = []
        for i, (joint, theta, d, a, alpha) in enumerate(self.rows, 1):
            cells = {"theta": theta, "d": d, "a": a, "alpha": alpha}
            moving = "theta" if joint == "R" else "d"
            cells[moving] = f"q{i}" if cells[moving] == "0" else f"q{i} + ({cells[moving]})"
            joints.append({"type": "revolute" if joint == "R" else "prismatic", "q": f"q{i}", **cells})
        inverse = {key: value for key, value in (("task", self.task), ("given", self.given_names)) if value != "pose"}
        lines = [
            f"name: {self.name}",
            f"title: {json.dumps(self.source or self.kind)}",
            f"convention: {'modified' if self.modified else 'standard'}",
            "units: {angle: deg, length: m}",
            *(f"{key}: {json.dumps(rows)}" for key, rows in (("base", self.base), ("tool", self.tool)) if rows),
            "joints:",
            *(f"  - {json.dumps(joint)}" for joint in joints),
        ]
        if any(inverse.values()):
            lines.append(f"inverse: {json.dumps({key: value for key, value in inverse.items() if value})}")
        return "\n".join(lines) + "\n"

    @property
    def given_names(self) -> list[str]:
        """Names of the joints that are given."""
        return [f"q{i + 1}" for i in self.given]

    def robot(self, choice: bool = True) -> Robot:
        """The robot, without its choice of task where that is left to the caller."""
        text = self.text if choice else self.text.split("inverse:")[0]
        return Robot.from_text(text, self.name)

    @property
    def arm(self) -> NumericArm:
        robot = self.robot(choice=False)
        missing = set(free_symbols(robot)) - set(self.values)
        assert not missing, f"{self.name}: no numbers for {missing}"
        return numeric_arm(robot, self.values)


PUBLISHED_TABLES = """
puma560 standard 6R-spherical-wrist | Corke, Robotics, Vision and Control, mdl_puma560
R 0 0 0 90; R 0 0 0.4318 0; R 0 0.15005 0.0203 -90; R 0 0.4318 0 90; R 0 0 0 -90; R 0 0 0 0
puma560-craig modified 6R-spherical-wrist | Craig, Introduction to Robotics, section 3.7
R 0 0 0 0; R -90 0 0 0; R 0 0.4318 0.1501 0; R -90 0.0203 0.4331 0; R 90 0 0 0; R -90 0 0 0
stanford standard 6DOF-P-spherical-wrist | Paul 1981; Corke, mdl_stanford
R 0 0.412 0 -90; R 0 0.154 0 90; P -90 0 0 0; R 0 0 0 -90; R 0 0 0 90; R 0 0.263 0 0
ur3 standard 6R-three-parallel | Universal Robots, DH parameters
R 0 0.1519 0 90; R 0 0 -0.24365 0; R 0 0 -0.21325 0; R 0 0.11235 0 90; R 0 0.08535 0 -90; R 0 0.0819 0 0
ur5 standard 6R-three-parallel | Universal Robots, DH parameters
R 0 0.089159 0 90; R 0 0 -0.425 0; R 0 0 -0.39225 0; R 0 0.10915 0 90; R 0 0.09465 0 -90; R 0 0.0823 0 0
ur10 standard 6R-three-parallel | Universal Robots, DH parameters
R 0 0.1273 0 90; R 0 0 -0.612 0; R 0 0 -0.5723 0; R 0 0.163941 0 90; R 0 0.1157 0 -90; R 0 0.0922 0 0
ur5e standard 6R-three-parallel | Universal Robots, DH parameters
R 0 0.1625 0 90; R 0 0 -0.425 0; R 0 0 -0.3922 0; R 0 0.1333 0 90; R 0 0.0997 0 -90; R 0 0.0996 0 0
ur16e standard 6R-three-parallel | Universal Robots, DH parameters
R 0 0.1807 0 90; R 0 0 -0.4784 0; R 0 0 -0.36 0; R 0 0.17415 0 90; R 0 0.11985 0 -90; R 0 0.11655 0 0
paul-elbow standard 6R-three-parallel | Paul 1981, elbow manipulator: joints 2, 3, 4 parallel, wrist of three axes
R 0 0 0 90; R 0 0 0.432 0; R 0 0 0.386 0; R 0 0 0.094 -90; R 0 0 0 90; R 0 0.1 0 0
irb120 standard 6R-spherical-wrist | ABB IRB 120 product specification
R 0 0.29 0 -90; R -90 0 0.27 0; R 0 0 0.07 -90; R 0 0.302 0 90; R 0 0 0 -90; R 180 0.072 0 0
irb140 standard 6R-spherical-wrist | ABB IRB 140 product specification; Corke, mdl_irb140
R 0 0.352 0.07 -90; R -90 0 0.36 0; R 0 0 0 -90; R 0 0.38 0 90; R 0 0 0 -90; R 180 0.065 0 0
kr5-arc standard 6R-spherical-wrist | KUKA KR 5 arc data sheet
R 0 0.4 0.18 -90; R 0 0 0.6 0; R -90 0 0.12 -90; R 0 0.62 0 90; R 0 0 0 -90; R 0 0.115 0 0
lrmate200id standard 6R-spherical-wrist | Fanuc LR Mate 200iD data sheet
R 0 0 0.05 -90; R -90 0 0.33 180; R 0 0 0.035 -90; R 0 -0.335 0 90; R 0 0 0 -90; R 0 -0.08 0 180
staubli-rx90 modified 6R-spherical-wrist | Khalil and Dombre, Modeling, Identification and Control of Robots, ch. 3
R 0 0 0 0; R 90 0 0 0; R 0 0.45 0 0; R -90 0 0.45 0; R 90 0 0 0; R -90 0 0 0
staubli-tx90 standard 6R-spherical-wrist | Staubli TX90 data sheet
R 0 0.478 0.05 -90; R -90 0 0.425 0; R 90 0.05 0 90; R 0 0.425 0 -90; R 0 0 0 90; R 0 0.1 0 0
crs-a465 standard 6R-spherical-wrist | CRS Robotics A465 manual
R 0 0.33 0 90; R 0 0 0.305 0; R 90 0 0 90; R 0 0.33 0 -90; R 0 0 0 90; R 0 0.076 0 0
cobra600 standard 4dof | Corke, mdl_cobra600
R 0 0.387 0.325 0; R 0 0 0.275 180; P 0 0 0 0; R 0 0 0 0
adept-one standard 4dof | Schilling, Fundamentals of Robotics, section 2-7
R 0 0.877 0.425 180; R 0 0 0.375 0; P 0 0 0 0; R 90 0.2 0 0
rhino-xr3 standard 5dof | Schilling, Fundamentals of Robotics, section 2-6
R 0 0.2604 0 -90; R 0 0 0.2286 0; R 0 0 0.2286 0; R -90 0 0.0095 -90; R 0 0.1683 0 0
alpha-ii standard 5dof | Schilling, Fundamentals of Robotics, problem section 2
R 0 0.215 0 -90; R 0 0 0.1778 0; R 0 0 0.1778 0; R -90 0 0 -90; R 0 0.1295 0 0
scorbot-er7 standard 5dof | Eshed Robotec Scorbot-ER VII manual
R 0 0.3585 0.05 -90; R 0 0 0.3 0; R 0 0 0.25 0; R -90 0 0 -90; R 0 0.212 0 0
yasukawa-l3 modified 5dof | Craig, Introduction to Robotics, section 3.7
R 0 0 0 0; R -90 0 0 0; R 0 0.4 0 0; R 0 0.35 0 0; R 90 0 0 0
jaco standard 6R-offset | Kinova Jaco (60 degree wrist), DH parameters; d = D1, -e2, -d4b, -d5b, -d6b
R 0 0.2755 0 90; R 0 0 0.41 180; R 0 -0.0098 0 90; R 0 -0.25008 0 60; R 0 -0.08577 0 60; R 0 -0.21158 0 180
mico standard 6R-offset | Kinova Mico (60 degree wrist), DH parameters
R 0 0.2755 0 90; R 0 0 0.29 180; R 0 -0.007 0 90; R 0 -0.16598 0 60; R 0 -0.08556 0 60; R 0 -0.20278 0 180
crx-10ia modified 6R-offset | Abbes and Poisson, Robotics 13(6), 2024
R 0 0 0 0; R -90 0 0 -90; R 180 0.54 0 0; R -90 0 -0.54 0; R 90 0 0.15 0; R -90 0 -0.16 0
xarm6 standard 6R-offset | UFACTORY xArm 6 user manual
R 0 0.267 0 -90; R -79.34995 0 0.28948866 0; R 79.34995 0 0.0775 -90; R 0 0.3425 0 90; R 0 0 0.076 -90; R 0 0.097 0 0
dvrk-psm modified 6DOF-P-other | da Vinci Research Kit, PSM kinematics
R 90 0 0 90; R -90 0 0 -90; P 90 0 -0.4318 0; R 0 0 0.4162 0; R -90 0 0 -90; R -90 0.0091 0 -90
raghavan-roth standard 6R-general | Raghavan and Roth, J. Mech. Design 115, 1993, 6R example (shape)
R 0 0 0.8 20; R 0 0.9 1.2 31; R 0 3.7 0.33 45; R 0 1 1.8 81; R 0 0.5 0.6 12; R 0 2.1 2.2 100
manseur-doty standard 6R-general | Manseur and Doty, Int. J. Robotics Research 8, 1989: 16 real solutions
R 0 0 0.3 90; R 0 0 1 1; R 0 0.2 0 90; R 0 0 1.5 1; R 0 0 0 90; R 0 0 0 1
panda modified redundant-locked given=6 | Franka Emika, DH parameters
R 0 0 0.333 0; R -90 0 0 0; R 90 0 0.316 0; R 90 0.0825 0 0; R -90 -0.0825 0.384 0; R 90 0 0 0; R 90 0.088 0.107 0
iiwa14 standard redundant-locked given=2 | KUKA LBR iiwa 14 R820 data sheet
R 0 0.36 0 -90; R 0 0 0 90; R 0 0.42 0 90; R 0 0 0 -90; R 0 0.4 0 -90; R 0 0 0 90; R 0 0.126 0 0
wam7 standard redundant-locked given=2 | Barrett WAM 7-DOF user manual
R 0 0 0 -90; R 0 0 0 90; R 0 0.55 0.045 -90; R 0 0 -0.045 90; R 0 0.3 0 -90; R 0 0 0 90; R 0 0.06 0 0
pr2-arm standard redundant-locked given=2 | Willow Garage PR2, arm dimensions
R 0 0 0.1 -90; R 90 0 0 90; R 0 0.4 0 -90; R 0 0 0 90; R 0 0.321 0 -90; R 0 0 0 90; R 0 0.18 0 0
baxter standard redundant-locked given=6 | Rethink Robotics Baxter, DH parameters
R 0 0.2703 0.069 -90; R 90 0 0 90; R 0 0.3644 0.069 -90; R 0 0 0 90; R 0 0.3743 0.01 -90; R 0 0 0 90; R 0 0.2295 0 0
planar-2r standard 2dof | Craig; Spong, Hutchinson, Vidyasagar; Siciliano et al.
R 0 0 0.5 0; R 0 0 0.4 0
planar-2r-position standard 2dof-position task=position | the same, reached by its point
R 0 0 0.5 0; R 0 0 0.4 0
planar-2r-equal standard 2dof-position task=position | equal links: the folded arm has a free joint
R 0 0 0.5 0; R 0 0 0.5 0
planar-3r standard 3dof-planar | Siciliano et al., section 2.12.1
R 0 0 0.5 0; R 0 0 0.4 0; R 0 0 0.2 0
anthropomorphic standard 3dof-spatial | Siciliano et al., section 2.9.4
R 0 0 0 90; R 0 0 0.5 0; R 0 0 0.4 0
anthropomorphic-position standard 3dof-spatial-position task=position | Siciliano et al., section 2.12.4
R 0 0 0 90; R 0 0 0.5 0; R 0 0 0.4 0
elbow-offset-position standard 3dof-spatial-position task=position | Spong, Hutchinson, Vidyasagar, section 5.3
R 0 0.6 0 90; R 0 0.15 0.5 0; R 0 0 0.4 0
spherical standard 3dof-spatial | Siciliano et al., section 2.9.3
R 0 0 0 -90; R 0 0.15 0 90; P 0 0 0 0
spherical-position standard 3dof-spatial-position task=position | Siciliano et al., section 2.12.2
R 0 0 0 -90; R 0 0.15 0 90; P 0 0 0 0
cylindrical standard 3dof-spatial | Spong, Hutchinson, Vidyasagar, section 3.2
R 0 0.4 0 0; P 0 0 0 -90; P 0 0 0 0
cylindrical-position standard 3dof-spatial-position task=position | Spong, Hutchinson, Vidyasagar, section 3.2
R 0 0.4 0 0; P 0 0 0 -90; P 0 0 0 0
cartesian standard 3dof-spatial | Spong, Hutchinson, Vidyasagar, section 1.3
P 0 0 0 -90; P -90 0 0 -90; P 0 0 0 0
wrist-zyz standard 3dof-wrist | Siciliano et al., section 2.9.5
R 0 0 0 -90; R 0 0 0 90; R 0 0.2 0 0
wrist-rpy standard 3dof-wrist | roll, pitch, yaw: three axes at right angles
R 0 0 0 90; R 90 0 0 90; R 0 0 0 0
scara-rrpr standard 4dof | Spong, Hutchinson, Vidyasagar, section 3.2
R 0 0 0.5 0; R 0 0 0.4 180; P 0 0 0 0; R 0 0.2 0 0
scara-rrrp standard 4dof | the slide last
R 0 0.3 0.5 0; R 0 0 0.4 0; R 0 0 0 180; P 0 0 0 0
scara-prrr standard 4dof | the slide first
P 0 0 0.1 0; R 0 0 0.5 0; R 0 0 0.4 180; R 0 0.1 0 0
scara-rprr modified 4dof | the slide second
R 0 0 0.3 0; P 0 0.5 0 0; R 0 0 0 0; R 180 0.4 0.1 0
gantry-wrist standard 6DOF-P-spherical-wrist | three slides and a wrist
P 0 0 0 -90; P -90 0 0 -90; P 0 0 0 0; R 0 0 0 -90; R 0 0 0 90; R 0 0.1 0 0
gantry-offset-wrist standard 6DOF-P-other | three slides and a wrist with an offset
P 0 0 0 -90; P -90 0 0 -90; P 0 0 0 0; R 0 0 0.05 -90; R 0 0.08 0 90; R 0 0.1 0 0
gantry-4 standard 4dof | three slides and a turn
P 0 0 0 -90; P -90 0 0 -90; P 0 0 0 0; R 0 0.1 0 0
cylindrical-wrist standard 6DOF-P-spherical-wrist | Spong, Hutchinson, Vidyasagar, section 3.2: with a wrist
R 0 0.4 0 0; P 0 0 0 -90; P 0 0 0 0; R 0 0 0 -90; R 0 0 0 90; R 0 0.1 0 0
anthropomorphic-wrist standard 6R-spherical-wrist | Siciliano et al., section 2.9.7
R 0 0 0 90; R 0 0 0.5 0; R 0 0 0 90; R 0 0.4 0 -90; R 0 0 0 90; R 0 0.1 0 0
scara-wrist standard 6R-three-parallel | three parallel axes first
R 0 0.3 0.5 0; R 0 0 0.4 0; R 0 0.1 0.1 90; R 0 0 0.2 90; R 0 0.1 0 90; R 0 0.2 0 0
pendulum modified 1dof | one joint
R 90 0 0.2 30
slide standard 1dof | one slide
P 30 0 0.2 45
"""


HARD_TABLES = """
equal-lengths standard hard | PUMA-like, every length the same
R 0 0.3 0.3 90; R 0 0.3 0.3 0; R 0 0.3 0.3 90; R 0 0.3 0 -90; R 0 0 0 90; R 0 0.3 0 0
equal-lengths-general standard hard | general 6R, every length the same, all axes at right angles
R 0 0.3 0.3 90; R 0 0.3 0.3 90; R 0 0.3 0.3 90; R 0 0.3 0.3 90; R 0 0.3 0.3 90; R 0 0.3 0.3 90
equal-lengths-parallel standard hard | three parallel axes, every length the same
R 0 0.2 0 90; R 0 0 0.2 0; R 0 0 0.2 0; R 0 0.2 0 90; R 0 0.2 0 -90; R 0 0.2 0 0
equal-planar-3r standard hard | planar, every link the same
R 0 0 0.4 0; R 0 0 0.4 0; R 0 0 0.4 0
equal-anthropomorphic standard hard task=position | equal links: the folded arm turns freely about its shoulder
R 0 0 0 90; R 0 0 0.4 0; R 0 0 0.4 0
tiny-link standard hard | a link of 1e-6 m
R 0 0 0.000001 90; R 0 0 0.4 0; R 0 0 0 90; R 0 0.4 0 -90; R 0 0 0 90; R 0 0.1 0 0
tiny-wrist-offset standard hard | a wrist that misses its centre by 1e-4 m
R 0 0.35 0.1 90; R 0 0 0.4 0; R 0 0 0.1 90; R 0 0.4 0 -90; R 0 0.0001 0 90; R 0 0.1 0 0
small-wrist-offset standard hard | a wrist that misses its centre by 1 mm
R 0 0.35 0.1 90; R 0 0 0.4 0; R 0 0 0.1 90; R 0 0.4 0.001 -90; R 0 0 0 90; R 0 0.1 0 0
tiny-twist standard hard | axes 2 and 3 almost parallel: 0.06 degrees
R 0 0.3 0 90; R 0 0 0.4 0.06; R 0 0 0.1 90; R 0 0.4 0 -90; R 0 0 0 90; R 0 0.1 0 0
tiny-twist-ur standard hard | a UR whose parallel axes are calibrated: 0.06 degrees apart
R 0 0.0892 0 90; R 0 0 -0.425 0.06; R 0 0 -0.39225 -0.06; R 0 0.10915 0 90; R 0 0.09465 0 -90; R 0 0.0823 0 0
tiny-twist-scara standard hard | a SCARA whose axes are 0.06 degrees apart
R 0 0.3 0.3 0.06; R 0 0 0.25 180; P 0 0 0 0; R 0 0.1 0 0
large-offsets standard hard | offsets of 100 m on links of 0.3 m
R 0 100 0 90; R 0 0 0.3 0; R 0 0 0 90; R 0 0.3 0 -90; R 0 0 0 90; R 0 100 0 0
millimetres standard hard | lengths as numbers of millimetres, taken for metres
R 0 400 25 -90; R 0 0 455 0; R -90 0 35 -90; R 0 420 0 90; R 0 0 0 -90; R 0 80 0 0
micrometres standard hard | an arm of a few micrometres
R 0 0.000004 0 90; R 0 0 0.000003 0; R 0 0 0 90; R 0 0.000003 0 -90; R 0 0 0 90; R 0 0.000001 0 0
no-shoulder standard hard | nothing but forearm and wrist: axes 1, 2 and 3 concurrent
R 0 0 0 90; R 0 0 0 -90; R 0 0.4 0 90; R 0 0 0 -90; R 0 0.4 0 90; R 0 0 0.1 0
no-tool-no-base standard hard | a wrist centre in frame 6
R 0 0 0 90; R 0 0 0.4 0; R 0 0 0 90; R 0 0.4 0 -90; R 0 0 0 90; R 0 0 0 0
five-parallel-p standard hard | planar arm on a slide with a tilted wrist
P 0 0 0 0; R 0 0 0.4 0; R 0 0 0.3 0; R 0 0 0.1 90; R 0 0.1 0 0
four-parallel standard hard | two pairs of parallel axes
R 0 0.2 0.3 0; R 0 0 0.3 90; R 0 0.1 0.2 0; R 0 0 0.2 90; R 0 0.1 0 90; R 0 0.1 0 0
two-triples standard hard | three parallel axes and a wrist on them
R 0 0.1 0 90; R 0 0 0.3 0; R 0 0 0.3 0; R 0 0 0 90; R 0 0 0 90; R 0 0.2 0 0
opposed-parallel standard hard | three axes, every second one opposed
R 0 0.1 0.1 90; R 0 0.1 0.3 180; R 0 0.2 0.3 180; R 0 0.1 0.1 90; R 0 0.1 0 90; R 0 0.2 0 0
slides-parallel-to-axes standard hard | each slide along the axis before it
R 0 0 0 0; P 0 0 0.3 90; R 0 0 0.2 0; P 0 0 0.1 90; R 0 0.1 0.1 90; R 0 0.1 0 0
forty-five standard hard | twists of 45 degrees, a wrist that is not orthogonal
R 0 0.3 0.1 45; R 0 0.1 0.4 45; R 0 0.1 0.1 -45; R 0 0.4 0 45; R 0 0 0 45; R 0 0.1 0 0
cuspidal standard hard task=position | Wenger: an orthogonal cuspidal arm, d2 = 1, d3 = 2, d4 = 1.5
R 0 0 1 -90; R 0 1 2 90; R 0 0 1.5 0
"""


LOST_TABLES = """
parallel-123 standard lost | three parallel axes, then three of an offset wrist
R 0 0.2 0.3 0; R 0 0 0.35 0; R 0 0 0.12 90; R 0 0.1 0.15 90; R 0 0.2 0.1 90; R 0 0.1 0 0
prrprr standard lost | a slide whose equations are singular at infinity
P 0 0 -0.4819 74.48; R 90 0 0 74.48; R -90 0.2838 0.1478 -45; P 90 0 0.172 -63; R 22.9 0.57 0 74.48; R 0 0.17 0.37 -25.8
prrr modified lost | two solutions of a special pose
P 90 0 0.4 0; R 180 0.3 0.4 0; R -90 0 0 0; R 90 -0.3 0.4 0
rrrp modified lost | two solutions of a special pose
R 90 0 0.5566 0; R -90 0 0.4889 0; R -90 0 0 0; P -90 0.3 0.3 0
tiago standard lost given=3 | the arm of a TIAGo by its URDF: wrist of three axes, offsets at shoulder and elbow
R 90 -0.182 -0.125 90; R 90 0.018 0 90; R 0 -0.3115 0.02 90; R 0 0 -0.02 90; R 0 0.312 0 -90; R 0 0 0 90; R 0 0 0 0
"""


def _of_tables(tables: str) -> tuple[ArmCase, ...]:
    cases = []
    lines = [line for line in tables.strip().splitlines() if line]
    for head, table in zip(lines[::2], lines[1::2], strict=True):
        words, source = (part.strip() for part in head.split("|"))
        name, convention, kind, *options = words.split()
        rows = [tuple(row.split()) for row in table.split(";")]
        if convention == "modified":  # joint alpha a d theta
            rows = [(joint, theta, d, a, alpha) for joint, alpha, a, d, theta in rows]
        chosen = dict(option.split("=") for option in options)
        given = tuple(int(i) for i in chosen.get("given", "").split(",") if i)
        task = chosen.get("task", "pose")
        cases.append(ArmCase(name, kind, tuple(rows), convention == "modified", task=task, given=given, source=source))
    return tuple(cases)


def arm_of(head: str, table: str, rest: str = "") -> Robot:
    """The robot of one table, ``standard`` or ``modified`` and options, and of more lines of its file."""
    (case,) = _of_tables(f"arm {' test '.join([*head.split(maxsplit=1), ''][:2])} | a test\n{table}")
    return Robot.from_text(case.text + rest)


PUBLISHED = _of_tables(PUBLISHED_TABLES)
"""Arms of books, manuals and papers."""

HARD = _of_tables(HARD_TABLES)
"""Arms on which solvers stumble: equal, vanishing, huge lengths, axes almost parallel, several structures at once."""

LOST = {case.name: case for case in _of_tables(LOST_TABLES)}
"""Arms of which solutions were lost once: by slides whose equations end at infinity, beside singular poses."""

TURNS = ("0", "90", "-90", "180")
ODD_TURNS = ("30", "-45", "60", "20", "-70", "105", "12.5")


class _Draw:
    def __init__(self, seed: str) -> None:
        self.rng = random.Random(seed)
        self.odd = self.rng.random() < 0.4
        self.symbolic = self.rng.random() < 0.25
        self.values: dict[str, float] = {}

    def length(self, zero: float = 0.3) -> str:
        if self.rng.random() < zero:
            return "0"
        value = round(self.rng.uniform(0.08, 0.7) * self.rng.choice([1, 1, 1, -1]), self.rng.choice([1, 2, 3]))
        value = value or 0.2
        if self.symbolic and self.rng.random() < 0.6 and value > 0:
            name = f"l{len(self.values) + 1}"
            self.values[name] = value
            return name
        return str(value)

    def twist(self, zero: bool = True) -> str:
        """An angle between axes; with ``zero`` false neither 0 nor 180."""
        if self.odd and self.rng.random() < 0.6:
            return self.rng.choice(ODD_TURNS)
        return self.rng.choice(TURNS if zero else ("90", "-90"))

    def offset(self) -> str:
        """A constant part of a joint angle."""
        return self.rng.choice(["0", "0", "0", "90", "-90", "180", "35"])

    def frame(self) -> tuple[tuple[str, ...], ...]:
        if self.rng.random() < 0.5:
            return ()
        cells = [self.length() for _ in range(3)]
        kind = self.rng.randrange(4)
        rows = [("1", "0", "0"), ("0", "1", "0"), ("0", "0", "1")]
        if kind == 1:
            rows = [("0", "-1", "0"), ("1", "0", "0"), ("0", "0", "1")]
        elif kind == 2:
            rows = [("2/3", "-1/3", "2/3"), ("2/3", "2/3", "-1/3"), ("-1/3", "2/3", "2/3")]
        elif kind == 3:
            rows = [("cos(25)", "0", "sin(25)"), ("0", "1", "0"), ("-sin(25)", "0", "cos(25)")]
        return (*((*row, cell) for row, cell in zip(rows, cells, strict=True)), ("0", "0", "0", "1"))


@dataclass
class _Shape:
    """Geometry in both conventions: a_i, alpha_i from axis i to i+1; d_i, theta_i on axis i."""

    types: list[str]
    theta: list[str]
    d: list[str]
    a: list[str]
    alpha: list[str]

    def concurrent(self, first: int, draw: _Draw) -> None:
        """Axes first, first+1, first+2 (from 0) meet in one point and are not parallel."""
        for i in (first, first + 1):
            self.a[i], self.alpha[i] = "0", draw.twist(zero=False)
        self.d[first + 1] = "0"

    def parallel(self, first: int, draw: _Draw) -> None:
        """Axes first, first+1, first+2 (from 0) are parallel or opposed, and apart."""
        for i in (first, first + 1):
            self.a[i], self.alpha[i] = draw.length(zero=0), draw.rng.choice(["0", "0", "180"])

    def case(self, name: str, kind: str, draw: _Draw, **options: object) -> ArmCase:
        """The arm in one of the two conventions."""
        modified, n = draw.rng.random() < 0.5, len(self.types)
        a, alpha = self.a[:n], self.alpha[:n]
        if modified:  # the geometry between joints moves one row down; the first row has what was after the last
            a, alpha = a[-1:] + a[:-1], alpha[-1:] + alpha[:-1]
        rows = tuple(zip(self.types, self.theta, self.d, a, alpha, strict=True))
        return ArmCase(name, kind, rows, modified, draw.frame(), draw.frame(), values=draw.values, **options)  # type: ignore[arg-type]


def _shape(types: str, draw: _Draw, zero: float = 0.35) -> _Shape:
    return _Shape(
        list(types),
        [draw.offset() for _ in types],
        [draw.length(zero) if t == "R" else draw.rng.choice(["0", "0", "0.1"]) for t in types],
        [draw.length(zero) for _ in types],
        [draw.twist() for _ in types],
    )


def _types(draw: _Draw, n: int, slides: tuple[int, int]) -> str:
    count = draw.rng.randint(*slides)
    chosen = set(draw.rng.sample(range(n), count))
    return "".join("P" if i in chosen else "R" for i in range(n))


def _few(n: int, slides: tuple[int, int], task: str = "pose") -> Callable[[_Draw, str], ArmCase]:
    return lambda draw, name: _shape(_types(draw, n, slides), draw).case(name, "", draw, task=task)


def _planar(draw: _Draw, name: str) -> ArmCase:
    shape = _shape(draw.rng.choice(["RRR", "RRR", "RPR", "PRR", "RRP"]), draw, zero=0.1)
    for i in range(3):
        turning = shape.types[i] == "R" and shape.types[(i + 1) % 3] == "R"
        shape.alpha[i] = draw.rng.choice(["0", "0", "180"]) if turning else draw.rng.choice(["90", "-90"])
    return shape.case(name, "", draw)


def _wrist(first: int, types: str = "RRRRRR") -> Callable[[_Draw, str], ArmCase]:
    def make(draw: _Draw, name: str) -> ArmCase:
        chosen = types
        if "?" in types:
            slides = _types(draw, 3, (1, 3))
            chosen = types.replace("???", slides)
        shape = _shape(chosen, draw)
        shape.concurrent(first if first >= 0 else draw.rng.choice([1, 2]), draw)
        return shape.case(name, "", draw)

    return make


def _parallel(slides: int) -> Callable[[_Draw, str], ArmCase]:
    def make(draw: _Draw, name: str) -> ArmCase:
        first = draw.rng.randrange(4)
        outside = [i for i in range(6) if not first <= i < first + 3]
        chosen = set(draw.rng.sample(outside, slides))
        shape = _shape("".join("P" if i in chosen else "R" for i in range(6)), draw)
        shape.parallel(first, draw)
        return shape.case(name, "", draw)

    return make


def _offset(draw: _Draw, name: str) -> ArmCase:
    shape = _shape("RRRRRR", draw)
    first = draw.rng.choice([0, 1, 2, 3, 3])
    shape.concurrent(first, draw)
    place = draw.rng.choice(["a", "d"])
    cells = shape.a if place == "a" else shape.d
    cells[first + (1 if place == "d" else draw.rng.choice([0, 1]))] = draw.length(zero=0)
    return shape.case(name, "", draw)


def _general(types: Callable[[_Draw], str]) -> Callable[[_Draw, str], ArmCase]:
    def make(draw: _Draw, name: str) -> ArmCase:
        shape = _shape(types(draw), draw, zero=0.0)
        shape.alpha = [draw.rng.choice(ODD_TURNS) for _ in shape.types]
        return shape.case(name, "", draw)

    return make


def _redundant(draw: _Draw, name: str) -> ArmCase:
    kind = draw.rng.randrange(3)
    shape = _shape("RRRRRRR", draw)
    if kind < 2:
        shape.concurrent(0, draw)
        shape.concurrent(4, draw)
        if kind == 1:
            shape.a[2], shape.a[3] = "0.08", "-0.08"
        given = 2
    else:
        shape.concurrent(0 if draw.rng.random() < 0.5 else 4, draw)
        given = draw.rng.choice([0, 6])
    return shape.case(name, "", draw, given=(given,))


CLASSES: dict[str, Callable[[_Draw, str], ArmCase]] = {
    "1dof": _few(1, (0, 1)),
    "2dof": _few(2, (0, 2)),
    "2dof-position": _few(2, (0, 1), "position"),
    "3dof-planar": _planar,
    "3dof-spatial": _few(3, (0, 3)),
    "3dof-spatial-position": _few(3, (0, 3), "position"),
    "3dof-wrist": lambda draw, name: (shape := _shape("RRR", draw), shape.concurrent(0, draw))[0].case(name, "", draw),
    "4dof": _few(4, (0, 2)),
    "5dof": _few(5, (0, 2)),
    "6R-spherical-wrist": _wrist(3),
    "6R-wrist-first": _wrist(0),
    "6R-wrist-middle": _wrist(-1),
    "6R-three-parallel": _parallel(0),
    "6DOF-P-spherical-wrist": _wrist(3, "???RRR"),
    "6DOF-P-wrist-first": _wrist(0, "RRR???"),
    "6DOF-P-three-parallel": _parallel(1),
    "6DOF-P-other": lambda draw, name: _shape(_types(draw, 6, (1, 3)), draw).case(name, "", draw),
    "6R-offset": _offset,
    "6R-general": _general(lambda draw: "RRRRRR"),
    "5R1P-general": _general(lambda draw: _types(draw, 6, (1, 1))),
    "4R2P-general": _general(lambda draw: _types(draw, 6, (2, 2))),
    "redundant-locked": _redundant,
}
"""Makers of random arms by class; the published ones use the same names."""


def random_arm(kind: str, number: int) -> ArmCase:
    """A random arm of a class, always the same for the same number; its Jacobian has full rank somewhere."""
    for attempt in range(1000):
        draw = _Draw(f"{kind} {number} {attempt}")
        case = CLASSES[kind](draw, f"{kind.lower()}-{number}")
        case = replace(case, kind=kind, source=f"random arm {number} of class {kind}")
        if is_regular(case):
            return case
    raise AssertionError(f"no arm of class {kind}")


def is_regular(case: ArmCase) -> bool:
    """Whether the joints that are solved for have a Jacobian of full rank, clearly, at random configurations."""
    arm = case.arm
    q = np.random.default_rng(1).uniform(-2, 2, (5, arm.n))
    unit = float(np.abs([*arm.a, *arm.d]).sum()) or 1.0
    slope = jacobian(arm, q)
    slope[:, :3] /= unit
    slope = slope[:, : 3 if case.task == "position" else 6, [i for i in range(arm.n) if i not in case.given]]
    slope = slope * np.where(arm.revolute, 1.0, unit)[[i for i in range(arm.n) if i not in case.given]]
    if slope.shape[1] < slope.shape[2]:
        return False
    values = np.linalg.svd(slope, compute_uv=False)
    return bool((values[:, -1] > 1e-3).any())
