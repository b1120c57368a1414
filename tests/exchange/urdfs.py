"""URDFs that tests write themselves, and what Pinocchio, which reads them on its own, says of them."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from derive.exchange.from_urdf import Imported, ImportOptions, import_urdf
from derive.exchange.reading.urdf import read_urdf
from derive.robot.robot import Robot
from derive.verification.oracle.functions import Oracle

Array = npt.NDArray[np.float64]

PI = "3.141592653589793"
HALF = "1.5707963267948966"


@dataclass(frozen=True)
class J:
    """A joint of a serial chain with the link that it moves; texts stand in the file as they are."""

    xyz: str = "0 0 0"  # of its origin
    rpy: str = "0 0 0"  # of its origin
    axis: str = "0 0 1"
    type: str = "revolute"
    limit: str = 'lower="-3" upper="3" effort="80" velocity="2"'  # attributes of its limits
    inertial: tuple[str, str, str, str] | None = None
    more: str = ""  # further elements of it
    name: str = ""  # of the joint; empty for ``jK``
    link: str = ""  # name of the link; empty for ``lK``
    parent: str = ""  # name of the link that carries it; empty for the one before


def body(mass: str, xyz: str = "0 0 0", rpy: str = "0 0 0", moments: str = "1 1 1 0 0 0") -> tuple[str, str, str, str]:
    """An inertial element: xx, yy, zz, xy, xz, yz."""
    return mass, xyz, rpy, moments


def urdf(joints: Sequence[J], name: str = "arm", base: str = "l0", top: str = "") -> str:
    lines, before = [f'<robot name="{name}">', f'  <link name="{base}"/>', f"  {top}"], base
    for k, joint in enumerate(joints, 1):
        link = joint.link or f"l{k}"
        lines += [f'  <link name="{link}">{_inertial(joint)}</link>']
        lines += [f'  <joint name="{joint.name or f"j{k}"}" type="{joint.type}">']
        lines += [f'    <parent link="{joint.parent or before}"/><child link="{link}"/>']
        lines += [f'    <origin xyz="{joint.xyz}" rpy="{joint.rpy}"/><axis xyz="{joint.axis}"/>']
        limit = f"<limit {joint.limit}/>" if joint.limit and joint.type != "fixed" else ""
        lines += [f"    {limit}{joint.more}", "  </joint>"]
        before = link
    return "\n".join([*lines, "</robot>"]) + "\n"


def _inertial(joint: J) -> str:
    if joint.inertial is None:
        return ""
    mass, xyz, rpy, moments = joint.inertial
    keys = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
    tensor = " ".join(f'{key}="{value}"' for key, value in zip(keys, moments.split(), strict=True))
    return f'<inertial><origin xyz="{xyz}" rpy="{rpy}"/><mass value="{mass}"/><inertia {tensor}/></inertial>'


def turned(axis: int, angle: complex) -> Array:
    """Rotation about x, y or z."""
    c, s, i, j = np.cos(angle), np.sin(angle), (axis + 1) % 3, (axis + 2) % 3
    found = np.eye(3, dtype=np.result_type(c))
    found[i, i], found[j, j], found[i, j], found[j, i] = c, c, -s, s
    return found


def imported(text: str, **options: Any) -> Imported:
    return import_urdf(read_urdf(text.encode(), "arm.urdf"), None, None, ImportOptions(**options))


class Reading:
    """What Pinocchio makes of a URDF, all joints but some held at zero."""

    def __init__(self, text: str, names: Sequence[str]) -> None:
        self.model = pin.buildModelFromXML(text)
        self.data = self.model.createData()
        self.names = tuple(names)

    def _state(self, values: Array) -> Array:
        full = pin.neutral(self.model)
        for name, value in zip(self.names, values, strict=True):
            joint = self.model.joints[self.model.getJointId(name)]
            full[joint.idx_q : joint.idx_q + joint.nq] = [value] if joint.nq == 1 else [np.cos(value), np.sin(value)]
        return full

    def _spread(self, values: Array) -> Array:
        full = np.zeros(self.model.nv)
        full[self._columns] = values
        return full

    @property
    def _columns(self) -> list[int]:
        return [self.model.joints[self.model.getJointId(name)].idx_v for name in self.names]

    def pose(self, q: Array, tip: str, base: str | None = None) -> Array:
        """Of a link in another one, or in the root."""
        pin.framesForwardKinematics(self.model, self.data, self._state(q))
        end = self.data.oMf[self.model.getFrameId(tip, pin.FrameType.BODY)]
        link = base and self.model.getFrameId(base, pin.FrameType.BODY)
        start = pin.SE3.Identity() if base is None else self.data.oMf[link]
        return np.asarray((start.inverse() * end).homogeneous)

    def torque(self, q: Array, qd: Array, qdd: Array, gravity: float = 9.81) -> Array:
        self.model.gravity.linear = np.array([0.0, 0.0, -gravity])
        found = pin.rnea(self.model, self.data, self._state(q), self._spread(qd), self._spread(qdd))
        return np.asarray(found)[self._columns]

    def inertia(self, q: Array) -> Array:
        full = np.asarray(pin.crba(self.model, self.data, self._state(q)))
        full = np.triu(full) + np.triu(full, 1).T
        return full[np.ix_(self._columns, self._columns)]

    def coriolis(self, q: Array, qd: Array) -> Array:
        matrix = np.asarray(pin.computeCoriolisMatrix(self.model, self.data, self._state(q), self._spread(qd)))
        return (matrix @ self._spread(qd))[self._columns]


def pose(robot: Robot, q: Array) -> Array:
    """Of a table, by the independent recursion."""
    return Oracle.of(robot).evaluate("forward_kinematics", q)
