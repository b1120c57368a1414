"""The parameters in which torques are linear, by name: what identification works with.

Every link has ten whether the file gives them or not, since a measurement must tell them all; motors, armatures and
friction have theirs where the file gives them.
"""

from dataclasses import dataclass

from derive.robot.description import Link
from derive.robot.expression import ZERO, Expression
from derive.robot.robot import Robot

# Mass [kg], first moments [kg m], entries of the inertia tensor about the frame's origin [kg m^2].
LINK_PARTS = ("m", "mx", "my", "mz", "Ixx", "Iyy", "Izz", "Ixy", "Ixz", "Iyz")
# Rotor mass [kg], rotor inertia about its axis [kg m^2], armature [kg m^2 or kg], viscous friction [N m s or N s/m] and
# Coulomb friction, or that for qd > 0 and that against qd < 0 [N m or N].
FRICTION_PARTS = ("b", "f", "fp", "fm")
JOINT_PARTS = ("mm", "Im", "Ia", *FRICTION_PARTS)
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


def coulomb_parts(link: Link) -> dict[str, Expression]:
    """The parameters of a link's Coulomb friction: ``f``, or ``fp`` and ``fm`` by direction."""
    return dict(zip(("fp", "fm"), link.dry, strict=True)) if isinstance(link.coulomb, tuple) else {"f": link.coulomb}


def has_regressor(robot: Robot) -> bool:
    """Whether regressors are generated for a robot."""
    return robot.has_dynamics and robot.n <= REGRESSOR_JOINTS and not robot.coupled


def standard_parameters(robot: Robot) -> tuple[Parameter, ...]:
    """The columns of the standard regressor (Siciliano et al., Robotics, section 7.2.2)."""
    found = []
    for i, link in enumerate(robot.links, start=1):
        given = {"Ia": link.armature != ZERO, "b": link.viscous != ZERO}
        given |= dict.fromkeys(("mm", "Im"), link.motor is not None)
        given |= dict.fromkeys(coulomb_parts(link), link.coulomb != ZERO)
        found += [Parameter(i, part) for part in LINK_PARTS]
        found += [Parameter(i, part) for part in JOINT_PARTS if given.get(part)]
    return tuple(found)
