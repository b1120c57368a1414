"""What a file of links and joints says, in plain floats, and how far a robot file of all of it is from that.

Poses and torques come from the joints as they stand in the file, by Rodrigues' rotation about their own axes and by
Newton and Euler in the axes of the world. Nothing is shared with the making of the rows.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
import numpy.typing as npt

from derive.exchange.reading.elements import MOVING, Origin, Urdf, UrdfJoint
from derive.inverse.numeric.chain import cross_matrix
from derive.robot.description import RootType
from derive.robot.robot import Robot
from derive.verification.oracle.functions import Oracle

Array = npt.NDArray[Any]
STATES = 10  # at which both are compared
GRAVITY = (0.0, 0.0, -9.81)  # where a file says nothing [m/s^2]
# Of a root that moves: whether each of its joints turns, and about or along which axis.
ROOTS: Mapping[RootType | None, tuple[tuple[bool, int], ...]] = {
    None: (),
    RootType.PLANAR: ((False, 0), (False, 1), (True, 2)),
    RootType.FLOATING: ((False, 0), (False, 1), (False, 2), (True, 2), (True, 1), (True, 0)),
}


@dataclass(frozen=True, slots=True)
class Step:
    """A joint with its link."""

    parent: int  # place of the step before, -1 for what stands
    origin: Array  # (4, 4) of the link in the one before, at zero
    axis: Array  # (3,) unit vector
    turns: bool | None  # whether it turns, or slides; None of one that is fixed
    mass: float  # of the link [kg]
    com: Array  # (3,) in its frame [m]
    inertia: Array  # (3, 3) about the centre of mass, along the axes of its frame
    drag: tuple[float, float, float]  # armature, viscous and dry friction


@dataclass(frozen=True, slots=True)
class FileTree:
    """All steps, each behind the one that it follows."""

    steps: tuple[Step, ...]
    links: Mapping[str, int]  # place of the step that moves each link
    gravity: Array  # (3,) [m/s^2]
    coupling: Array  # (joints, variables) positions of joints per unit of those that follow no other
    offset: Array  # (joints,) and what is added

    @classmethod
    def of(cls, urdf: Urdf, joints: Sequence[UrdfJoint], root: RootType | None) -> Self:
        """The joints of a file, from the root outwards, in the order of the rows."""
        kinds = ROOTS[root]
        base = next((joint.parent for joint in joints), next(iter(urdf.bodies)))
        nothing = (0.0, np.zeros(3), np.zeros((3, 3)))
        steps = [Step(i - 1, np.eye(4), np.eye(3)[k], turns, *nothing, (0, 0, 0)) for i, (turns, k) in enumerate(kinds)]
        steps.append(Step(len(steps) - 1, np.eye(4), np.eye(3)[2], None, *_body(urdf, base), (0, 0, 0)))
        links = {base: len(steps) - 1}
        for joint in joints:
            axis = np.array([float(c) for c in joint.axis])
            turns = MOVING.get(joint.type)
            drag = (float(joint.armature), float(joint.damping), float(joint.friction))
            unit = axis / np.linalg.norm(axis) if turns is not None else axis
            steps.append(Step(links[joint.parent], _placed(joint.origin), unit, turns, *_body(urdf, joint.child), drag))
            links[joint.child] = len(steps) - 1
        coupling, offset = _coupling(len(kinds), [joint for joint in joints if joint.type in MOVING])
        return cls(tuple(steps), links, np.array([float(c) for c in urdf.gravity or GRAVITY]), coupling, offset)

    @property
    def moving(self) -> list[int]:
        """Places of the joints that move."""
        return [k for k, step in enumerate(self.steps) if step.turns is not None]

    def frames(self, q: Array) -> Array:
        """Poses of all links, (..., steps, 4, 4)."""
        values, found = dict(zip(self.moving, np.moveaxis(q, -1, 0), strict=True)), list[Array]()
        for k, step in enumerate(self.steps):
            before = found[step.parent] if step.parent >= 0 else np.broadcast_to(np.eye(4), (*q.shape[:-1], 4, 4))
            pose, motion = before @ step.origin, np.broadcast_to(np.eye(4), (*q.shape[:-1], 4, 4)).copy()
            if step.turns:
                motion[..., :3, :3] = _turned(step.axis, values[k])
            elif step.turns is not None:
                motion[..., :3, 3] = step.axis * values[k][..., None]
            found.append(pose if step.turns is None else pose @ motion)
        return np.stack(found, axis=-3)

    def torques(self, q: Array, qd: Array, qdd: Array) -> Array:
        """Joint torques, (..., n)."""
        frames, steps = self.frames(q), self.steps
        turn, place = frames[..., :3, :3], frames[..., :3, 3]
        index, still = {k: i for i, k in enumerate(self.moving)}, np.zeros((*q.shape[:-1], 3))
        motions: list[tuple[Array, Array, Array]] = []  # angular velocity and acceleration, acceleration of the origin
        axes = {}
        for k, step in enumerate(steps):
            w, alpha, a = motions[step.parent] if step.parent >= 0 else (still, still, still - self.gravity)
            r = place[..., k, :] - (place[..., step.parent, :] if step.parent >= 0 else 0)
            a = a + np.cross(alpha, r) + np.cross(w, np.cross(w, r))
            if step.turns is not None:
                axes[k] = turn[..., k, :, :] @ step.axis  # which a turn about itself leaves where it is
                rate, gain = (axes[k] * values[..., index[k], None] for values in (qd, qdd))
                if step.turns:
                    alpha, w = alpha + gain + np.cross(w, rate), w + rate
                else:
                    a = a + 2 * np.cross(w, rate) + gain
            motions.append((w, alpha, a))
        forces: list[Array] = [still] * len(steps)
        moments: list[Array] = [still] * len(steps)
        tau = np.zeros(q.shape)
        for k in reversed(range(len(steps))):
            step, (w, alpha, a) = steps[k], motions[k]
            com = turn[..., k, :, :] @ step.com
            inertia = turn[..., k, :, :] @ step.inertia @ np.swapaxes(turn[..., k, :, :], -1, -2)
            push = step.mass * (a + np.cross(alpha, com) + np.cross(w, np.cross(w, com)))
            spin = (inertia @ w[..., None])[..., 0]
            forces[k] = forces[k] + push
            moments[k] = moments[k] + (inertia @ alpha[..., None])[..., 0] + np.cross(w, spin) + np.cross(com, push)
            if step.turns is not None:
                i, (armature, viscous, dry) = index[k], step.drag
                load = (axes[k] * (moments[k] if step.turns else forces[k])).sum(-1)
                tau[..., i] = load + armature * qdd[..., i] + viscous * qd[..., i] + dry * np.sign(qd[..., i])
            if step.parent >= 0:
                r = place[..., k, :] - place[..., step.parent, :]
                forces[step.parent] = forces[step.parent] + forces[k]
                moments[step.parent] = moments[step.parent] + moments[k] + np.cross(r, forces[k])
        return tau


def _coupling(roots: int, joints: Sequence[UrdfJoint]) -> tuple[Array, Array]:
    """Positions of the joints of a root and of those of the file from those that follow no other."""
    places = {joint.name: k for k, joint in enumerate(joints)}
    follows, offset = np.zeros((len(joints), len(joints))), np.zeros(len(joints))
    for k, joint in enumerate(joints):
        if joint.mimics is not None:
            follows[k, places[joint.mimics]], offset[k] = float(joint.multiplier), float(joint.offset)
    # p = F p + o + (own variables): all at once (1 - F)^-1, whatever follows whatever
    whole = np.linalg.inv(np.eye(len(joints)) - follows)
    own = [k for k, joint in enumerate(joints) if joint.mimics is None]
    matrix = np.zeros((roots + len(joints), roots + len(own)))
    matrix[:roots, :roots], matrix[roots:, roots:] = np.eye(roots), whole[:, own]
    return matrix, np.concatenate([np.zeros(roots), whole @ offset])


def _placed(origin: Origin) -> Array:
    """Translation, then Rz(yaw) Ry(pitch) Rx(roll)."""
    frame = np.eye(4)
    for axis, angle in zip(np.eye(3)[::-1], reversed(origin.rpy), strict=True):
        frame[:3, :3] = frame[:3, :3] @ _turned(axis, np.array(float(angle)))
    frame[:3, 3] = [float(c) for c in origin.xyz]
    return frame


def _turned(axis: Array, angle: Array) -> Array:
    """Rodrigues: 1 + sin K + (1 - cos) K^2."""
    k = cross_matrix(axis)
    s, c = np.sin(angle)[..., None, None], np.cos(angle)[..., None, None]
    return np.asarray(np.eye(3) + s * k + (1 - c) * (k @ k))


def _body(urdf: Urdf, link: str) -> tuple[float, Array, Array]:
    if (body := urdf.bodies[link]) is None:
        return 0.0, np.zeros(3), np.zeros((3, 3))
    frame, (xx, yy, zz, xy, xz, yz) = _placed(body.origin), map(float, body.inertia)
    tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    return float(body.mass), frame[:3, 3], frame[:3, :3] @ tensor @ frame[:3, :3].T


@dataclass(frozen=True, slots=True)
class Agreement:
    """How far a robot file is from the file that it was made of, at random states: measured, not proven."""

    position: float  # largest distance of two ends [m]
    rotation: float  # largest angle between two ends [rad]
    inertia: float  # largest difference of entries of B, of the largest entry
    torques: float  # largest difference of torques, of the largest torque
    reach: float  # distance of the farthest end from the root [m]
    is_dynamic: bool

    def __str__(self) -> str:
        said = f"ends within {self.position:.1g} m and {self.rotation:.1g} rad of the file's"
        if self.is_dynamic:
            said += f", inertia matrix within {self.inertia:.1g} and torques within {self.torques:.1g} of the largest"
        return f"{said}, at {STATES} random states"


def agreement(tree: FileTree, robot: Robot, ends: Sequence[str]) -> Agreement:
    """Compare a robot with its file; the links at its ends in their order."""
    random, n, oracle, s = np.random.default_rng(0), robot.dof, Oracle.of(robot), tree.coupling
    q, qd, qdd = random.uniform(-1, 1, (3, STATES, n))
    q = q * np.where([joint.is_revolute for joint in robot.variables], np.pi, 1)
    names = [f"forward_kinematics_{name}".rstrip("_") for name in oracle.arm.ends]
    ours = np.stack([oracle.evaluate(name, q) for name in names], axis=1)
    joints = q @ s.T + tree.offset
    theirs = tree.frames(joints)[..., [tree.links[link] for link in ends], :, :]
    away = np.linalg.norm((ours - theirs)[..., :3, 3], axis=-1).max()
    # Frobenius norm of the difference of two rotations: sqrt(8) sin(angle / 2).
    apart = np.linalg.norm((ours - theirs)[..., :3, :3], axis=(-2, -1)).max() / np.sqrt(8)
    reach, angle = np.linalg.norm(theirs[..., :3, 3], axis=-1).max(), 2 * np.arcsin(min(apart, 1))
    if not robot.links:
        return Agreement(float(away), float(angle), 0.0, 0.0, float(reach), False)
    units, one = np.broadcast_to(s.T, (STATES, *s.T.shape)), joints[:, None, :]
    still = np.zeros(units.shape)
    columns = tree.torques(np.broadcast_to(one, still.shape), still, units)
    columns = columns - tree.torques(joints, joints * 0, joints * 0)[:, None, :]
    pairs = (
        (oracle.evaluate("inertia_matrix", q), np.swapaxes(columns @ s, -1, -2)),
        (oracle.evaluate("inverse_dynamics", q, qd, qdd), tree.torques(joints, qd @ s.T, qdd @ s.T) @ s),
    )
    inertia, torques = (float(np.abs(own - other).max() / max(np.abs(other).max(), 1e-300)) for own, other in pairs)
    return Agreement(float(away), float(angle), inertia, torques, float(reach), True)
