"""Pinocchio models of the same arms and trees, built from their plain numbers and not from the robot file.

A Pinocchio joint stands where joint i's motion ends (after Rot(z, theta) Trans(z, d)); DH frame i of the standard
convention lies Trans(x, a) Rot(x, alpha) further out on the same body. A rotor is an extra revolute joint on the body
before, with the coordinate ratio*q_i; the arm's own quantities then follow from the constant map G of velocities:
B = G' B_ext G, tau = G' tau_ext. Armature is Pinocchio's own. The root of a tree moves along x,
y and z and turns about z, y and x by Pinocchio's own joints.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from derive.robot.description import RootType
from derive.robot.robot import Robot
from derive.robot.task_rows import PARTS, task_rows
from tests.random_robots import JointNumbers, LinkNumbers, RandomRobot
from tests.random_trees import RandomTree, TreeRow

Array = npt.NDArray[np.float64]


def about(axis: str, angle: float) -> Any:
    return pin.SE3(pin.utils.rotate(axis, angle), np.zeros(3))


def along(x: float, y: float, z: float) -> Any:
    return pin.SE3(np.eye(3), np.array([x, y, z]))


@dataclass(frozen=True)
class Reference:
    """A robot in Pinocchio, whose universe is the world; its functions are those of the generated interface."""

    model: Any
    ends: tuple[Any, ...]  # from Pinocchio's joint i to DH frame i
    tool: Any  # from DH frame n to the end effector
    joints: tuple[int, ...]  # Pinocchio's indices of the n joints
    map: Array  # (nv, n) the constant map G of velocities
    viscous: Array  # (n,) joint-side friction
    coulomb: Array
    task_rows: Mapping[str, tuple[int, ...]]  # rows of J, by part
    level: Array  # axes of the base before joint 1
    held: float = 0.0  # potential energy of bodies on the ground
    way: int = 64  # joints that move the end effector

    @property
    def data(self) -> Any:
        """New; results may lie in it as long as it lives."""
        return self.model.createData()

    def link_transforms(self, q: Array) -> Array:
        data = self.data
        pin.forwardKinematics(self.model, data, self.map @ q)
        return np.array([(data.oMi[j] * end).homogeneous for j, end in zip(self.joints, self.ends, strict=True)])

    def forward_kinematics(self, q: Array) -> Array:
        return np.array(self.link_transforms(q)[-1] @ self.tool.homogeneous)

    def jacobian(self, q: Array) -> Array:
        data = self.data
        pin.computeJointJacobians(self.model, data, self.map @ q)
        turn = data.oMi[self.joints[-1]].rotation @ (self.ends[-1] * self.tool).rotation
        return np.array(np.kron(np.eye(2), turn) @ self.jacobian_end(q))

    def jacobian_end(self, q: Array) -> Array:
        data = self.data
        pin.computeJointJacobians(self.model, data, self.map @ q)
        local = np.reshape(pin.getJointJacobian(self.model, data, self.joints[-1], pin.LOCAL), (6, -1))
        return np.array((self.ends[-1] * self.tool).toActionMatrixInverse() @ local @ self.map)

    def kinetic_energy(self, q: Array, qd: Array) -> Array:
        rates, bare = self.map @ qd, self.model.copy()
        bare.armature = np.zeros_like(rates)  # not every version of Pinocchio counts it
        links = pin.computeKineticEnergy(bare, bare.createData(), self.map @ q, rates)
        return np.array(links + rates @ (self.model.armature * rates) / 2)

    def potential_energy(self, q: Array) -> Array:
        return np.array(pin.computePotentialEnergy(self.model, self.data, self.map @ q) + self.held)

    def inertia_matrix(self, q: Array) -> Array:
        data = self.data
        upper = np.triu(pin.crba(self.model, data, self.map @ q))
        return np.array(self.map.T @ (upper + np.triu(upper, 1).T) @ self.map)

    def bias(self, q: Array, qd: Array) -> Array:
        return self.rigid_torque(q, qd, np.zeros_like(q))

    def rigid_torque(self, q: Array, qd: Array, qdd: Array) -> Array:
        data = self.data
        return np.array(self.map.T @ pin.rnea(self.model, data, self.map @ q, self.map @ qd, self.map @ qdd))

    def inverse_dynamics(self, q: Array, qd: Array, qdd: Array) -> Array:
        return self.rigid_torque(q, qd, qdd) + self.viscous * qd + self.coulomb * np.sign(qd)

    def gravity_vector(self, q: Array) -> Array:
        data = self.data
        return np.array(self.map.T @ pin.computeGeneralizedGravity(self.model, data, self.map @ q))

    def coriolis_matrix(self, q: Array, qd: Array) -> Array:
        """The Christoffel C: column j is Gamma(qd, e_j), by polarisation of the quadratic velocity torque."""
        g, identity = self.bias(q, np.zeros_like(q)), np.eye(len(q))
        columns = [(self.bias(q, qd + e) - g) - (self.bias(q, qd - e) - g) for e in identity]
        return np.array(columns).T / 4

    def jacobian_dot(self, q: Array, qd: Array) -> Array:
        """Rate of the geometric Jacobian, (6, n), from that of Pinocchio's Jacobian at the world's origin."""
        data = self.data
        pin.computeJointJacobiansTimeVariation(self.model, data, self.map @ q, self.map @ qd)
        full = pin.getJointJacobianTimeVariation(self.model, data, self.joints[-1], pin.WORLD)
        rate = np.reshape(full, (6, -1)) @ self.map
        jacobian, place = self.jacobian(q), self.forward_kinematics(q)[:3, 3]
        linear = rate[:3] - pin.skew(jacobian[:3] @ qd) @ jacobian[3:] - pin.skew(place) @ rate[3:]
        return np.vstack([linear, rate[3:]])

    def jacobian_hessian(self, q: Array) -> Array:
        return np.stack([self.jacobian_dot(q, e) for e in np.eye(len(q))], axis=-1)

    def rows(self, part: str, matrix: Array) -> Array:
        """Those of a part, of whole vectors in the world, else in the axes before joint 1."""
        rows = self.task_rows[part]
        turn = np.eye(3) if rows in (tuple(range(6)), *PARTS.values()) else self.level
        turned = np.einsum("ji,kj...->ki...", turn, matrix.reshape(2, 3, *matrix.shape[1:]))
        return turned.reshape(matrix.shape)[list(rows)]

    def task_inertia(self, q: Array) -> Array:
        rows = self.rows("all", self.jacobian(q))
        return np.array(np.linalg.pinv(rows @ np.linalg.solve(self.inertia_matrix(q), rows.T)))

    def manipulability(self, q: Array, part: str = "all") -> Array:
        """The product of the singular values, 0 where no row moves."""
        lengths = np.linalg.svd(self.rows(part, self.jacobian(q)), compute_uv=False)[: self.way]
        return np.array(np.prod(lengths) if len(lengths) else 0.0)

    def manipulability_position(self, q: Array) -> Array:
        return self.manipulability(q, "position")

    def manipulability_orientation(self, q: Array) -> Array:
        return self.manipulability(q, "orientation")

    def manipulability_dq(self, q: Array) -> Array:
        """w tr(J^+ dJ / dq_j)."""
        slopes = self.rows("all", self.jacobian_hessian(q))
        inverse = np.linalg.pinv(self.rows("all", self.jacobian(q)))
        return np.array(self.manipulability(q) * np.einsum("ir,rij->j", inverse, slopes))

    def determines(self, name: str, q: Array) -> bool:
        """Whether the task's rows are far enough from dependent ones for a value."""
        if name == "task_inertia":
            return bool(np.linalg.cond(self.task_inertia(q)) < 1e4)
        return not name.startswith("manip") or bool(getattr(self, name.removesuffix("_dq"))(q) > 1e-3)

    def analytic_jacobian_rpy(self, q: Array) -> Array:
        _, pitch, yaw = pin.rpy.matrixToRpy(self.forward_kinematics(q)[:3, :3])
        turned = pin.utils.rotate("z", yaw)
        tilted = turned @ pin.utils.rotate("y", pitch)
        return self.with_angles(q, np.column_stack([tilted[:, 0], turned[:, 1], np.eye(3)[2]]))

    def analytic_jacobian_zyz(self, q: Array) -> Array:
        rotation = self.forward_kinematics(q)[:3, :3]
        turned = pin.utils.rotate("z", np.arctan2(rotation[1, 2], rotation[0, 2]))
        return self.with_angles(q, np.column_stack([np.eye(3)[2], turned[:, 1], rotation[:, 2]]))

    def with_angles(self, q: Array, axes: Array) -> Array:
        """The geometric Jacobian with the rates of three angles about ``axes`` for the angular velocity."""
        jacobian = self.jacobian(q)
        return np.vstack([jacobian[:3], np.linalg.solve(axes, jacobian[3:])])

    def coriolis_vector(self, q: Array, qd: Array) -> Array:
        return self.bias(q, qd) - self.gravity_vector(q)

    def inverse_dynamics_dq(self, q: Array, qd: Array, qdd: Array) -> Array:
        return self.torque_derivatives(q, qd, qdd)[0]

    def inverse_dynamics_dqd(self, q: Array, qd: Array) -> Array:
        return self.torque_derivatives(q, qd, np.zeros_like(q))[1] + np.diag(self.viscous)

    def torque_derivatives(self, q: Array, qd: Array, qdd: Array) -> tuple[Array, Array]:
        """Of the torques without friction, by Pinocchio's analytic recursion."""
        data = self.data
        pin.computeRNEADerivatives(self.model, data, self.map @ q, self.map @ qd, self.map @ qdd)
        return self.map.T @ data.dtau_dq @ self.map, self.map.T @ data.dtau_dv @ self.map

    def wrench_torques_end(self, q: Array, h: Array) -> Array:
        """What an external force on the last joint's body, given at the end effector, takes off the torques."""
        still = np.zeros(self.model.nv)
        with_it = pin.rnea(self.model, self.data, self.map @ q, still, still, self.forces(h))
        return np.array(self.map.T @ (pin.rnea(self.model, self.data, self.map @ q, still, still) - with_it))

    def wrench_torques_end_dq(self, q: Array, h: Array) -> Array:
        """Pinocchio differentiates at forces that are constant in the axes of their bodies."""
        still, slopes = np.zeros(self.model.nv), []
        for forces in (self.forces(0 * h), self.forces(h)):
            data = self.data
            pin.computeRNEADerivatives(self.model, data, self.map @ q, still, still, forces)
            slopes.append(self.map.T @ data.dtau_dq @ self.map)
        return np.array(slopes[0] - slopes[1])

    def wrench_torques(self, q: Array, h: Array) -> Array:
        return self.wrench_torques_end(q, self.at_end(q, h))

    def wrench_torques_dq(self, q: Array, h: Array) -> Array:
        return np.array(np.einsum("rij,r->ij", self.jacobian_hessian(q), h))

    def forces(self, h: Array) -> Any:
        """A wrench in the axes of the end effector as forces on all bodies."""
        forces = pin.StdVec_Force([pin.Force.Zero() for _ in range(self.model.njoints)])
        forces[self.joints[-1]] = (self.ends[-1] * self.tool).act(pin.Force(h[:3], h[3:]))
        return forces

    def forward_dynamics(self, q: Array, qd: Array, tau: Array) -> Array:
        bias = self.inverse_dynamics(q, qd, np.zeros_like(q))
        return np.array(np.linalg.solve(self.inertia_matrix(q), tau - bias))

    def inverse_dynamics_wrench_end(self, q: Array, qd: Array, qdd: Array, h: Array) -> Array:
        rates = (self.map @ each for each in (q, qd, qdd))
        rigid = np.array(self.map.T @ pin.rnea(self.model, self.data, *rates, self.forces(h)))
        return rigid + self.viscous * qd + self.coulomb * np.sign(qd)

    def inverse_dynamics_wrench(self, q: Array, qd: Array, qdd: Array, h: Array) -> Array:
        return self.inverse_dynamics_wrench_end(q, qd, qdd, self.at_end(q, h))

    def forward_dynamics_wrench_end(self, q: Array, qd: Array, tau: Array, h: Array) -> Array:
        bias = self.inverse_dynamics_wrench_end(q, qd, np.zeros_like(q), h)
        return np.array(np.linalg.solve(self.inertia_matrix(q), tau - bias))

    def forward_dynamics_wrench(self, q: Array, qd: Array, tau: Array, h: Array) -> Array:
        return self.forward_dynamics_wrench_end(q, qd, tau, self.at_end(q, h))

    def inverse_dynamics_wrench_end_dq(self, q: Array, qd: Array, qdd: Array, h: Array) -> Array:
        data, rates = self.data, (self.map @ each for each in (q, qd, qdd))
        pin.computeRNEADerivatives(self.model, data, *rates, self.forces(h))
        return np.array(self.map.T @ data.dtau_dq @ self.map)

    def inverse_dynamics_wrench_dq(self, q: Array, qd: Array, qdd: Array, h: Array) -> Array:
        return self.inverse_dynamics_dq(q, qd, qdd) - self.wrench_torques_dq(q, h)

    def at_end(self, q: Array, h: Array) -> Array:
        """A wrench in the axes of the world, in those of the end effector."""
        turn = self.forward_kinematics(q)[:3, :3]
        return np.concatenate([h[:3] @ turn, h[3:] @ turn])


def reference(robot: RandomRobot) -> Reference:
    return _Builder(robot).build()


class _Builder:
    def __init__(self, robot: RandomRobot) -> None:
        self.robot = robot
        self.model = pin.Model()
        self.model.gravity.linear = np.array(robot.gravity)
        self.rotors: list[tuple[int, int]] = []

    def build(self) -> Reference:
        joints: list[int] = []
        for i in range(self.robot.n):
            joints.append(self.add_joint(i, joints[-1] if joints else 0))
        found = {part: task_rows(Robot.from_text(self.robot.text), part) for part in ("all", *PARTS)}
        return self.reference(joints, 0, task_rows=found, level=self.axis(0).rotation)

    def reference(self, joints: list[int], before: int, **others: Any) -> Reference:
        """With so many coordinates before those of the joints."""
        robot = self.robot
        mapping, armature = np.eye(self.model.nv, before + robot.n), np.zeros(self.model.nv)
        mapping[:, before:] = 0.0
        for i, joint in enumerate(joints, before):
            mapping[self.model.joints[joint].idx_v, i] = 1.0
        for i, joint in self.rotors:
            mapping[self.model.joints[joint].idx_v, before + i] = robot.links[i].ratio
        for link, joint in zip(robot.links, joints, strict=False):
            armature[self.model.joints[joint].idx_v] = link.armature
        self.model.armature = armature
        friction = [(0.0, 0.0)] * before + [(link.viscous, link.coulomb) for link in robot.links]
        viscous, coulomb = np.array(friction).reshape(-1, 2).T
        ends = tuple(self.end(row) for row in robot.joints)
        places = (ends, pin.SE3(robot.tool), tuple(joints), mapping)
        return Reference(self.model, *places, viscous, coulomb, **others)

    def end(self, row: JointNumbers) -> Any:
        """From the joint to DH frame i."""
        return along(row.a, 0, 0) * about("x", row.alpha) if self.robot.standard else pin.SE3.Identity()

    def axis(self, i: int) -> Any:
        """From the Pinocchio joint before to a frame whose z axis is the axis of joint i."""
        row, before = self.robot.joints[i], pin.SE3(self.robot.base) if i == 0 else pin.SE3.Identity()
        if not self.robot.standard:
            return before * about("x", row.alpha) * along(row.a, 0, 0)
        return before * self.end(self.robot.joints[i - 1]) if i else before

    def add_joint(self, i: int, parent: int) -> int:
        row = self.robot.joints[i]
        placement = self.axis(i) * about("z", row.theta) * along(0, 0, row.d)
        direction = np.array([0.0, 0.0, row.sign])
        kind = pin.JointModelRevoluteUnaligned if row.revolute else pin.JointModelPrismaticUnaligned
        if self.robot.links and self.robot.links[i].rotor_inertia + self.robot.links[i].rotor_mass:
            self.add_rotor(i, parent)
        joint = int(self.model.addJoint(parent, kind(direction), placement, f"joint{i}"))
        if self.robot.links:
            link = self.robot.links[i]
            body = pin.Inertia(link.mass, np.array(link.com), link.tensor)
            self.model.appendBodyToJoint(joint, body, self.end(row))
        return joint

    def add_rotor(self, i: int, parent: int) -> None:
        """A body on the link before, spinning about z of the joint's axis."""
        link: LinkNumbers = self.robot.links[i]
        lift = 0.0 if self.robot.standard else self.robot.joints[i].d
        spinning = pin.JointModelRevoluteUnaligned(np.array([0.0, 0.0, 1.0]))
        joint = int(self.model.addJoint(parent, spinning, self.axis(i) * along(0, 0, lift), f"rotor{i}"))
        body = pin.Inertia(link.rotor_mass, np.zeros(3), np.diag([0.0, 0.0, link.rotor_inertia]))
        self.model.appendBodyToJoint(joint, body, pin.SE3.Identity())
        self.rotors.append((i, joint))


class TreeBuilder(_Builder):
    """Of a tree; its ends come after it has been built."""

    def __init__(self, tree: RandomTree) -> None:
        super().__init__(tree.table)
        self.tree, self.held = tree, 0.0
        self.moving = [k for k, row in enumerate(tree.rows) if not row.fixed]
        joint, at = 0, pin.SE3(tree.table.base)
        for kind in {None: (), RootType.PLANAR: ("PX", "PY", "RZ")}.get(
            tree.root, ("PX", "PY", "PZ", "RZ", "RY", "RX")
        ):
            joint = int(self.model.addJoint(joint, getattr(pin, f"JointModel{kind}")(), at, f"root{joint}"))
            at = pin.SE3.Identity()
        self.before = joint
        # Of each row and the base the joint that carries it, its frame in that, and the number of joints on the way.
        self.places: dict[int, tuple[int, Any, int]] = {-1: (joint, at, joint)}
        if tree.root:
            self.add_body(-1, tree.body)

    def build(self) -> Reference:
        rows, found = self.tree.rows, dict[int, int]()
        paths: dict[int, tuple[int, ...]] = {-1: ()}
        for k, row in enumerate(rows):
            paths[k] = (*paths[row.after], k)
        for k in sorted(range(len(rows)), key=paths.__getitem__):  # Pinocchio wants branch after branch
            row, (carrier, _, way) = rows[k], self.places[rows[k].after]
            if row.fixed:
                frame = self.start(row) * about("z", row.theta) * along(0, 0, row.d) * self.end(row)
                self.places[k] = carrier, frame, way
                self.add_body(k, row.link)
            else:
                found[k] = self.add_joint(self.moving.index(k), carrier)
                self.places[k] = found[k], self.end(row), way + 1
        return self.reference(
            [found[k] for k in self.moving], self.before, held=self.held, task_rows={}, level=np.eye(3)
        )

    def start(self, row: TreeRow) -> Any:
        """From the joint that carries a row to its own axis, or that of what would move it."""
        frame = self.places[row.after][1] * pin.SE3(row.mount) * about("z", row.gamma) * along(0, 0, row.b)
        return frame if self.robot.standard else frame * about("x", row.alpha) * along(row.a, 0, 0)

    def axis(self, i: int) -> Any:
        return self.start(self.tree.rows[self.moving[i]])

    def add_body(self, k: int, link: LinkNumbers) -> None:
        joint, frame, _ = self.places[k]
        self.model.appendBodyToJoint(joint, pin.Inertia(link.mass, np.array(link.com), link.tensor), frame)
        self.held -= link.mass * (frame.act(np.array(link.com)) @ self.robot.gravity) * (joint == 0)

    def at(self, built: Reference, end: str, rows: Mapping[str, tuple[int, ...]]) -> Reference:
        """What was built, seen from an end, whose task has these rows of J by part."""
        k, tool = self.tree.ends[end]
        joint, frame, way = self.places[k]
        ended = replace(built, joints=(joint,), ends=(frame,), tool=pin.SE3(tool), way=way, task_rows=rows)
        while k >= 0:
            row = self.tree.rows[k]
            ended = ended if row.fixed else replace(ended, level=self.start(row).rotation)
            k = row.after
        return ended
