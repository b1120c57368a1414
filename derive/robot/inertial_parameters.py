"""The parameters in which torques are linear, by name: what identification works with.

Every link has ten whether the file gives them or not, since a measurement must tell them all; motors, armatures and
friction have theirs where the file gives them.
"""

from __future__ import annotations

from dataclasses import dataclass

from derive.robot.expression import ZERO
from derive.robot.robot import Robot

# Mass, first moments, and the entries of the inertia tensor about the frame's origin.
LINK_PARTS = ("m", "mx", "my", "mz", "Ixx", "Iyy", "Izz", "Ixy", "Ixz", "Iyz")
# Rotor mass, rotor inertia about its axis, armature, viscous and Coulomb friction.
JOINT_PARTS = ("mm", "Im", "Ia", "b", "f")
# What each part is, with its unit.
MEANINGS = {
    "m": "mass [kg]",
    "mx": "first moment, x [kg m]",
    "my": "first moment, y [kg m]",
    "mz": "first moment, z [kg m]",
    "Ixx": "inertia tensor about the frame's origin, xx [kg m^2]",
    "Iyy": "inertia tensor about the frame's origin, yy [kg m^2]",
    "Izz": "inertia tensor about the frame's origin, zz [kg m^2]",
    "Ixy": "inertia tensor about the frame's origin, xy [kg m^2]",
    "Ixz": "inertia tensor about the frame's origin, xz [kg m^2]",
    "Iyz": "inertia tensor about the frame's origin, yz [kg m^2]",
    "mm": "mass of the rotor [kg]",
    "Im": "inertia of the rotor about its axis [kg m^2]",
    "Ia": "armature [kg m^2 or kg]",
    "b": "viscous friction [N m s or N s/m]",
    "f": "Coulomb friction [N m or N]",
}
# Regressors are generated up to so many joints: their entries grow with the square, each of them a sum.
REGRESSOR_JOINTS = 16


@dataclass(frozen=True, slots=True, order=True)
class Parameter:
    """One parameter."""

    joint: int  # number of its joint or link, from 1
    part: str  # one of `LINK_PARTS` or `JOINT_PARTS`

    @property
    def name(self) -> str:
        """As it is printed: ``Izz2``; ``Ixy2`` is the entry of the tensor's matrix, no sign taken off."""
        return f"{self.part}{self.joint}"

    @property
    def of_link(self) -> bool:
        """Whether it is one of a link's ten."""
        return self.part in LINK_PARTS


def has_regressor(robot: Robot) -> bool:
    """Whether regressors are generated for a robot."""
    return robot.has_dynamics and robot.n <= REGRESSOR_JOINTS


def standard_parameters(robot: Robot) -> tuple[Parameter, ...]:
    """The columns of the standard regressor (Siciliano et al., Robotics, section 7.2.2)."""
    found = []
    for i, link in enumerate(robot.links, start=1):
        given = {
            "mm": link.motor is not None,
            "Im": link.motor is not None,
            "Ia": link.armature != ZERO,
            "b": link.viscous != ZERO,
            "f": link.coulomb != ZERO,
        }
        found += [Parameter(i, part) for part in LINK_PARTS]
        found += [Parameter(i, part) for part in JOINT_PARTS if given[part]]
    return tuple(found)
