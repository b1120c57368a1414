"""MJCF files, as MuJoCo compiles them: defaults, included files, and the masses of what has only a shape."""

import re
from collections.abc import Collection, Iterator, Mapping
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np

from derive.errors import Location, RobotFileError, TargetError, quoted
from derive.exchange.arm import frame_at, some
from derive.exchange.reading.elements import ZEROS, Held, Origin, Triple, Urdf, UrdfBody, UrdfJoint
from derive.exchange.reading.urdf import DIGITS, angles_of
from derive.mechanics.space import decimal, exactly, vector
from derive.mechanics.vectors import scale, subtract

# What may stand before the outermost element is passed once, without a second try: files have many comments.
IS_MJCF = re.compile(rb"\A(?:\xef\xbb\xbf)?(?:\s|<\?(?>.*?\?>)|<!--(?>.*?-->))*+<mujoco\b", re.DOTALL)
EARTH: Triple = (*ZEROS[:2], Fraction("-9.81"))  # what gravity is where a file says nothing [m/s^2]
ACTS = ("armature", "damping", "stiffness", "frictionloss")  # by which a tendon acts on joints
UPRIGHT = (1.0, 0.0, 0.0, 0.0)  # the quaternion of no rotation


def read_mjcf(data: bytes, source: str, path: Path | None = None, ends: Collection[str] = ()) -> Urdf:
    """Read an MJCF, of several robots that of the ends or of most motors; a body's joints have links between them."""
    try:
        import mujoco
    except ImportError:
        raise TargetError("reading MJCF needs mujoco, which is not installed", remedy="pip install mujoco") from None
    try:
        kind = mujoco.MjModel
        model = kind.from_xml_path(str(path)) if path else kind.from_xml_string(data.decode("utf-8", "replace"))
    except ValueError as error:
        said = quoted(" ".join(str(error).split()), 200)[1:-1]
        raise RobotFileError(f"MuJoCo: {said}", remedy="correct the file", location=Location(source)) from None
    reader = _Reader(mujoco, model, Location(source), ends)
    reader.refuse_others()
    joints, top = list[UrdfJoint](), reader.top
    bodies = {reader.name("body", top): reader.body(top, ZEROS) if top else None}
    with exactly(model.nbody):
        offsets = {0: ZEROS, top: ZEROS}  # of the origin of a link in its body's frame
        for k in sorted(reader.own - {top}):
            steps = list(reader.joints(k, offsets[int(model.body_parentid[k])]))
            joints += [joint for joint, _ in steps]
            bodies |= {joint.child: None for joint in joints[-len(steps) :]}
            last, offset = steps[max(int(model.body_jntnum[k]), 1) - 1]
            bodies[last.child], offsets[k] = reader.body(k, offset), steps[-1][1]
    name, moves = model.names.split(b"\0", 1)[0].decode(), "floating" if top else ""
    gravity = None if (down := _triple(model.opt.gravity)) == EARTH else down
    held, postures = tuple(reader.closures(offsets)), tuple(reader.postures())
    notes, driven = tuple(reader.notes()), frozenset(reader.name("joint", joint) for _, joint in reader.motors)
    return Urdf(name, bodies, tuple(joints), notes, (), source, "", gravity, held, driven, postures, root=moves)


class _Reader:
    def __init__(self, mujoco: Any, model: Any, place: Location, ends: Collection[str]) -> None:
        self._mujoco, self._model, self._place = mujoco, model, place
        kinds = mujoco.mjtJoint
        self._closing = (int(mujoco.mjtEq.mjEQ_CONNECT), int(mujoco.mjtEq.mjEQ_WELD))
        self._free, self._turns, self._slides = map(int, (kinds.mjJNT_FREE, kinds.mjJNT_HINGE, kinds.mjJNT_SLIDE))
        on_joint, places = model.actuator_trntype == int(mujoco.mjtTrn.mjTRN_JOINT), model.actuator_trnid
        self.motors = [(k, int(places[k][0])) for k in range(model.nu) if on_joint[k]]  # with their joints
        self._ends, (self.top, self.own) = ends, self._robot(ends)
        self._joints = [j for j in range(model.njnt) if model.jnt_bodyid[j] in self.own]
        self.active = [k for k in range(model.neq) if not self._passed(k)]

    def _robot(self, ends: Collection[str]) -> tuple[int, frozenset[int]]:
        """The body that is free, 0 where none is, and all of the robot: that of the ends, most motors, most joints."""
        model = self._model
        free = model.jnt_bodyid[model.jnt_type == self._free]
        tops = np.where(np.isin(model.body_rootid, free), model.body_rootid, 0)
        at, motors = tops[model.jnt_bodyid], np.unique([joint for _, joint in self.motors]).astype(int)
        named = tops[[k for k in range(model.nbody) if self.name("body", k) in ends]]
        top = max(np.unique(tops), key=lambda top: [np.sum(each == top) for each in (named, at[motors], at)])
        return int(top), frozenset(np.flatnonzero(tops == top).tolist())

    def _passed(self, k: int) -> str:
        """Which kind of equality is not read; empty of one between joints or bodies of the robot."""
        model, kinds = self._model, self._mujoco.mjtObj
        if not model.eq_active0[k]:
            return "equalities that are not active"
        if model.eq_type[k] not in (*self._closing, int(self._mujoco.mjtEq.mjEQ_JOINT)):
            return "equalities of tendons or flexes"
        of = {int(kinds.mjOBJ_JOINT): model.jnt_bodyid, int(kinds.mjOBJ_SITE): model.site_bodyid}
        bodies = of.get(int(model.eq_objtype[k]), range(model.nbody))
        held = [int(bodies[i]) for i in (model.eq_obj1id[k], model.eq_obj2id[k]) if i >= 0]
        beside = any(body not in self.own or model.body_mocapid[body] >= 0 for body in held)
        return "equalities to what is left out, or moved from outside" if beside else ""

    def notes(self) -> Iterator[str]:
        """What of the file is not read, by name."""
        model, found = self._model, dict[str, list[str]]()
        beside = [k for k in range(1, model.nbody) if model.body_weldid[k] == k and k not in self.own]
        acting = [k for k in range(model.ntendon) if any(getattr(model, f"tendon_{key}")[k] for key in ACTS)]
        for words, kind, ids in (
            ("bodies that move beside the robot", "body", sorted({int(model.body_rootid[k]) for k in beside})),
            ("springs of joints", "joint", [j for j in self._joints if model.jnt_stiffness[j]]),
            ("tendons that act on joints", "tendon", acting),
            *((self._passed(k), "equality", [k]) for k in range(model.neq) if k not in self.active),
        ):
            found.setdefault(words, []).extend(self.name(kind, k) for k in ids)
        return (f"not read: {words}: {some(names)}" for words, names in found.items() if names)

    def refused(self, found: str, remedy: str) -> RobotFileError:
        return RobotFileError(found, remedy=remedy, location=self._place)

    def name(self, kind: str, k: int) -> str:
        kinds = self._mujoco.mjtObj
        return str(self._mujoco.mj_id2name(self._model, getattr(kinds, f"mjOBJ_{kind.upper()}"), k) or f"{kind}{k}")

    def refuse_others(self) -> None:
        """Refuse joints that follow others otherwise than linearly, and those with several variables."""
        model, seen = self._model, set()
        for k in (k for k in self.active if model.eq_type[k] not in self._closing):
            found = f"equality {quoted(self.name('equality', k))}"
            if model.eq_obj2id[k] < 0 or not model.eq_data[k][1] or any(model.eq_data[k][2:5]):
                allowed = "write polycoef with two coefficients, the second not 0, and joint2"
                raise self.refused(f"{found}: a joint that is no linear function of another one", allowed)
            if int(model.eq_obj1id[k]) in seen:
                raise self.refused(f"{found}: {self.name('joint', model.eq_obj1id[k])} has one already", "remove one")
            seen.add(int(model.eq_obj1id[k]))
        known = (self._turns, self._slides, self._free)  # MuJoCo has free ones at the root alone
        for j in self._joints:
            if model.jnt_type[j] not in known:
                raise self.refused(f"joint {quoted(self.name('joint', j))} is a ball", "write hinges or slides")

    def closures(self, offsets: Mapping[int, Triple]) -> Iterator[Held]:
        """What closes loops: points on two bodies, or frames."""
        model, (_, weld) = self._model, self._closing
        for k in (k for k in self.active if model.eq_type[k] in self._closing):
            data, is_weld, ids = model.eq_data[k], model.eq_type[k] == weld, (model.eq_obj1id[k], model.eq_obj2id[k])
            if model.eq_objtype[k] == int(self._mujoco.mjtObj.mjOBJ_SITE):
                places = [(int(model.site_bodyid[s]), model.site_pos[s], model.site_quat[s]) for s in ids]
            else:  # of welds the frame on the second body comes first
                spots = (data[3:6], data[:3]) if is_weld else (data[:3], data[3:6])
                turns = (data[6:10] if is_weld else UPRIGHT, UPRIGHT)
                places = [(int(body), *place) for body, *place in zip(ids, spots, turns, strict=True)]
            one, other = (self.name("body", b) for b, _, _ in places)
            frames = (Origin(subtract(_triple(at), offsets[b]), _angles(turn)) for b, at, turn in places)
            yield Held((one, other), (next(frames), next(frames)), is_weld)

    def postures(self) -> Iterator[Mapping[str, float]]:
        """Positions of joints where the file begins, and in its keyframes."""
        model = self._model
        moving = [j for j in self._joints if model.jnt_type[j] != self._free]
        for values in (model.qpos0, *model.key_qpos):
            yield {self.name("joint", j): float(values[model.jnt_qposadr[j]]) for j in moving}

    def body(self, k: int, offset: Triple) -> UrdfBody | None:
        """What a body weighs, in the frame of its link."""
        model = self._model
        mass, moments = _number(model.body_mass[k]), _exact(model.body_inertia[k])
        if not (mass or any(moments)):
            return None
        origin = Origin(subtract(_triple(model.body_ipos[k]), offset), _angles(model.body_iquat[k]))
        return UrdfBody(mass, origin, (*moments, *ZEROS), self._place)

    def joints(self, k: int, before: Triple) -> Iterator[tuple[UrdfJoint, Triple]]:
        """The joints of a body, or one that is fixed, each with the place of its link in the frame of the body."""
        model, parent, own = self._model, self.name("body", int(self._model.body_parentid[k])), self.name("body", k)
        quaternion = model.body_quat[k]
        turn = Origin(subtract(_triple(model.body_pos[k]), before), _angles(quaternion))
        first, count = int(model.body_jntadr[k]), int(model.body_jntnum[k])
        if not count:
            yield UrdfJoint(own, "fixed", parent, own, turn, ZEROS, self._place), ZEROS
        here, frame, last = ZEROS, turn, first + count - 1
        is_apart = count and any(model.jnt_pos[last]) and (k not in model.body_parentid or own in self._ends)
        for j in range(first, first + count):
            child = own if j == last and not is_apart else f"{self.name('joint', j)}_link"
            # The file has the link where its joint is at ``ref``.
            there, back = _triple(model.jnt_pos[j]), self._at_rest(j)
            way, rpy = subtract(there, here), frame.rpy
            if back and model.jnt_type[j] == self._turns:
                turned, by = np.empty(4), np.empty(4)
                self._mujoco.mju_axisAngle2Quat(by, model.jnt_axis[j], -back)
                self._mujoco.mju_mulQuat(turned, quaternion, by)
                rpy = _angles(turned)
            elif back:
                way = subtract(way, scale(_number(back), _triple(model.jnt_axis[j])))
            x, y, z = (decimal(c, DIGITS) for c in frame_at(frame, Fraction(0)).point(vector(way)))
            yield self._moving(j, parent, child, Origin((x, y, z), rpy)), there
            parent, here, frame, quaternion = child, there, Origin(), UPRIGHT
        if is_apart:  # an end is the frame of its body
            step = (f"{own}_end", "fixed", parent, own, Origin(subtract(ZEROS, here)), ZEROS, self._place)
            yield UrdfJoint(*step), ZEROS

    def _at_rest(self, j: int) -> float:
        """The position at which the file has a joint."""
        return float(self._model.qpos0[self._model.jnt_qposadr[j]])

    def _moving(self, j: int, parent: str, child: str, origin: Origin) -> UrdfJoint:
        model, turns = self._model, self._model.jnt_type[j] == self._turns
        axis, dof = model.jnt_axis[j], int(model.jnt_dofadr[j])
        lower, upper = _exact(model.jnt_range[j])
        of_dof = (getattr(model, f"dof_{key}")[dof] for key in ("damping", "frictionloss", "armature"))
        damping, friction, armature = map(_number, of_dof)
        kind = "prismatic" if not turns else "revolute" if model.jnt_limited[j] else "continuous"
        limits, effort = (lower, upper) if model.jnt_limited[j] else None, self._effort(j)
        place = (self.name("joint", j), kind, parent, child, origin, _triple(axis), self._place)
        own = UrdfJoint(*place, limits, effort, damping=damping, friction=friction, armature=armature)
        for k in self.active:  # q_1 = a_0 + a_1 q_2, both from where the file has the joints
            if model.eq_obj1id[k] == j and model.eq_type[k] not in self._closing:
                (offset, factor), other = _exact(model.eq_data[k][:2]), int(model.eq_obj2id[k])
                offset += _number(self._at_rest(j)) - factor * _number(self._at_rest(other))
                return replace(own, mimics=self.name("joint", other), multiplier=factor, offset=offset)
        return own

    def _effort(self, j: int) -> Fraction | None:
        """The largest torque of a joint, or of the only motor on it."""
        model = self._model
        if model.jnt_actfrclimited[j]:
            return max(map(abs, _exact(model.jnt_actfrcrange[j])))
        if len(motors := [k for k, joint in self.motors if joint == j]) != 1:
            return None
        gear = model.actuator_gear[k := motors[0]][0]
        if model.actuator_forcelimited[k]:
            return max(map(abs, _exact(model.actuator_forcerange[k] * gear)))
        is_plain = not model.actuator_biastype[k] and not model.actuator_gaintype[k] and model.actuator_ctrllimited[k]
        most = model.actuator_ctrlrange[k] * gear * model.actuator_gainprm[k][0]
        return max(map(abs, _exact(most))) if is_plain else None


def _number(value: float) -> Fraction:
    """A float as the decimal that it prints as."""
    return Fraction(repr(float(value)))


def _triple(values: Any) -> Triple:
    x, y, z = map(_number, values)
    return x, y, z


def _exact(values: Any) -> tuple[Fraction, ...]:
    return tuple(map(_number, values))


def _angles(quaternion: Any) -> Triple:
    w, x, y, z = _exact(quaternion)
    return angles_of(x, y, z, w)
