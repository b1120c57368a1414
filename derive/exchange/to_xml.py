"""A robot as URDF, and as MJCF, the format of MuJoCo."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import accumulate, pairwise
from math import atan2, hypot
from typing import Any
from xml.sax.saxutils import escape

from flint import arb

from derive.errors import DeriveError, listed
from derive.exchange import body_chain
from derive.exchange.body_chain import TIP, BodyChain, ChainSegment, Part, RigidBody, Rotor, is_world, roll_pitch_yaw
from derive.exchange.certificate import ball
from derive.exchange.numeric import text, texts
from derive.exchange.reading.elements import SLIDE, UNLIMITED, free_name
from derive.exchange.robot_of_arm import table_text
from derive.mechanics.space import NOTHING, WORLD, Frame, Point, length, times
from derive.robot.description import BASE, Joining
from derive.targets.escape import xml_text
from derive.targets.templating import render

ROOT = "base_link"  # the world, which URDF takes as the root link
THICKNESS = 0.06  # radius of the cylinders, of the longest link


def urdf_text(arm: BodyChain, head: list[str]) -> str:
    """The file as URDF."""
    links, joints = _elements(arm)
    radius = THICKNESS * arm.size
    return render(
        "exchange/robot.urdf.jinja",
        name=arm.robot.name,
        head=head,
        table="" if arm.parts or arm.ties.driven else escape(table_text(arm.robot)),
        links=links,
        joints=joints,
        radius=f"{radius:.3g}",
        thick=f"{1.4 * radius:.3g}",
        height=f"{3 * radius:.3g}",
    )


def link_names(arm: BodyChain) -> dict[str, str]:
    """Of the rows of a tree by their labels: the end which is that row's frame, or a name of its own."""
    rows, found = {segment.joint.label: WORLD for segment in arm.segments}, dict[str, str]()
    rows |= {label: part.frame for label, part in arm.rows.items()}
    joined = {name for loop in arm.ties.loops for name in loop.ends}
    ends = [part for part in arm.parts if part.is_end and part.name not in joined]
    at = {end.after: end.name for end in ends if end.after in rows and is_world(end.frame.seen_from(rows[end.after]))}
    taken = {ROOT, "link0", "world", *(end.name for end in ends)}
    for label in rows:
        found[label] = at.get(label) or free_name(f"{label}_link", taken)
        taken.add(found[label])
    return {label: xml_text(name) for label, name in found.items()}


def _elements(arm: BodyChain) -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:
    """Links and joints: of a tree rows by their labels and ends by their names, of a chain links by their numbers."""
    rows, radius = arm.rows, THICKNESS * arm.size
    names = link_names(arm) if arm.parts else {s.joint.label: f"link{i}" for i, s in enumerate(arm.segments, 1)}
    root = ROOT if is_world(arm.base) else "link0"
    links: list[dict[str, Any]] = [{"name": name, "is_frame": True} for name in dict.fromkeys((ROOT, root))]
    joints = [] if root == ROOT else [_fixed(free_name("base-joint", names), ROOT, root, arm.base)]
    if arm.root and arm.root.body:
        links[0] |= {"is_frame": False, "inertial": _weighed(arm.root.body), "rod": None}
    parents = {"": root, BASE: root} | names  # a root that moves in a plane has a row of its own

    def _inside(after: str, frame: Frame) -> Frame:
        return frame.seen_from(rows[after].frame) if after in rows else frame

    for segment in arm.segments:
        name = names[segment.joint.label]
        placed = replace(segment, origin=_inside(segment.after, segment.origin))
        joints.append(_joint(placed, parents[segment.after], name) | {"mimic": _mimic(arm, segment.joint.label)})
        inertial = segment.body and _weighed(segment.body.moved(segment.dh))  # in the frame of the joint
        links.append({"name": name, "is_frame": False, "inertial": inertial, "rod": rod(segment.end, radius)})
    last = joints[-1]["child"]
    for parent, name, frame in () if arm.parts else ((last, "flange", arm.segments[-1].dh), ("flange", TIP, arm.tool)):
        joints.append(_fixed(free_name(f"{name}-joint", names), parent, name, frame))
        links.append({"name": name, "is_frame": True})
    for part in arm.parts:
        if part.is_end and names.get(part.after) == part.name:
            continue
        name = part.name if part.is_end else names[part.name]
        joint = free_name(f"{part.name}_end", names) if part.is_end else xml_text(part.name)
        joints.append(_fixed(joint, parents[part.after], name, _inside(part.after, part.frame)))
        inertial = _weighed(part.body) if part.body else None
        links.append({"name": name, "is_frame": inertial is None, "inertial": inertial, "rod": None})
    return links, joints


def _weighed(body: RigidBody) -> dict[str, Any]:
    entries = zip(("ixx", "iyy", "izz", "ixy", "ixz", "iyz"), map(text, body.entries), strict=True)
    return {"mass": text(body.mass), "xyz": texts(body.com), "inertia": dict(entries)}


def _origin(frame: Frame) -> dict[str, str]:
    return {"xyz": texts(frame.origin), "rpy": texts(roll_pitch_yaw(frame))}


def _fixed(name: str, parent: str, child: str, frame: Frame) -> dict[str, Any]:
    return {"name": name, "type": "fixed", "parent": parent, "child": child, **_origin(frame), "axis": ""}


def _joint(segment: ChainSegment, parent: str, child: str) -> dict[str, Any]:
    """A joint that moves; effort and speed are mandatory where there are limits."""
    joint, link = segment.joint, segment.link
    limits = joint.limits or (None if joint.is_revolute else ())
    kind = "prismatic" if not joint.is_revolute else "continuous" if limits is None else "revolute"
    bounds: dict[str, str] = {}
    if limits is not None:
        ends = [text(ball(cell)) for cell in limits] or [f"-{SLIDE}", str(SLIDE)]
        bounds |= dict(zip(("lower", "upper"), ends, strict=True))
    for key, cell in (("effort", joint.torque), ("velocity", joint.speed)):
        bounds[key] = str(UNLIMITED) if cell is None else text(ball(cell))
    dynamics = {"damping": text(ball(link.viscous)), "friction": text(ball(link.signed[0]))}
    return {
        "name": xml_text(joint.label),
        "type": kind,
        "parent": parent,
        "child": child,
        **_origin(segment.origin),
        "axis": f"0 0 {joint.sign}",
        "limit": bounds,
        "dynamics": dynamics if set(dynamics.values()) != {"0"} else {},
    }


def _mimic(arm: BodyChain, label: str) -> dict[str, str]:
    """The joint that another one follows, and by how much; URDF knows one alone."""
    followed = arm.ties.driven.get(label, ())
    if len(followed) > 1:
        raise DeriveError(
            f"{arm.robot.name}: {label} follows {listed(other for other, _ in followed)}",
            allowed="allowed in URDF: joints that follow one other joint",
            remedy="derive export --format mjcf has the equation",
        )
    return {"joint": xml_text(followed[0][0]), "multiplier": text(followed[0][1])} if followed else {}


def rod(end: Point, radius: float) -> dict[str, str] | None:
    """The cylinder from a frame's origin to a point; None where it would be as short as thick."""
    x, y, z = (float(c) for c in end)
    reach = float(length(end))
    if reach <= radius:
        return None
    middle = " ".join(f"{c / 2:.6g}" for c in (x, y, z))
    turned = f"0 {atan2(hypot(x, y), z):.6g} {atan2(y, x):.6g}"
    return {"xyz": middle, "rpy": turned, "length": f"{reach:.6g}", "to": " ".join(f"{c:.6g}" for c in (x, y, z))}


# -- MJCF
#
# MuJoCo takes no moving body of which mass or a principal moment is nothing. A link that weighs nothing needs none: a
# body may have several joints, which move it one after the other, each about a line that stands in the body where
# all variables are zero. Nested bodies stand at O_1 Z_1 O_2 Z_2, with their places O and motions Z; since
# Z_1 O_2 = O_2 (O_2^-1 Z_1 O_2), that is one body at O_1 O_2 with the motions O_2^-1 Z_1 O_2, about the first axis as
# it is seen from the second link, and Z_2. With nothing between them, nothing else is left out.

DENSITY = 1000  # of the cylinders that stand in for masses where a robot has none [kg/m^3]
# Of masses and principal moments in the file: MuJoCo takes no less [kg, kg m^2]; and what is no distance [m].
LEAST = 1e-15
BESIDE = 2.9  # sum of the cosines of the angles between the axes of two frames that are almost one
MOST_JOINTS = 6  # of a body in MuJoCo
AXIS = "_axis"  # of the names of sites on the axis of a pin that closes a loop
EARTH = "0 0 -9.81"  # gravity where the robot file gives none [m/s^2]


def mjcf_text(arm: BodyChain, head: list[str]) -> str:
    """The file as MJCF."""
    gravity, radius = arm.robot.gravity, THICKNESS * arm.size
    nested = _nested(arm, radius)
    lines = []
    for (depth, body), (following, _) in pairwise([*nested, (0, {})]):
        ended = ["  " * (k + 2) for k in range(depth, following - 1, -1)]  # bodies that end behind this one
        lines.append(("  " * (depth + 2), body, ended))
    joints = [joint for _, body in nested for joint in body["joints"]]
    undriven = {xml_text(label) for label in (*arm.ties.driven, *arm.ties.passive)}
    rotors = []
    names = [xml_text(segment.joint.label) for segment in arm.segments]
    for i, rotor in enumerate(segment.rotor for segment in arm.segments):
        if rotor and coupled_by_tendon(rotor):
            # The inertia of a rotor along drag[0] qd_1 + ... + ratio qd_i.
            pairs = zip(names[: i + 1], [*map(repr, rotor.drag or ()), text(rotor.ratio)], strict=True)
            coefficients = [(name, factor) for name, factor in pairs if abs(float(factor)) > 1e-15]
            rotors.append({"name": f"rotor_{names[i]}", "armature": text(rotor.inertia), "joints": coefficients})
    return render(
        "exchange/robot.mjcf.jinja",
        name=arm.robot.name,
        head=head,
        gravity=EARTH if gravity is None else texts(map(ball, gravity)),
        density=DENSITY,
        bodies=lines,
        motors=[joint for joint in joints if joint["name"] not in undriven],
        threads=[body["first"] for _, body in nested if body["first"] and body["first"]["thread"]],
        rotors=rotors,
        **_equations(arm, [joint["name"] for joint in joints]),
        radius=f"{radius:.3g}",
        thick=f"{1.4 * radius:.3g}",
        half=f"{1.5 * radius:.3g}",
    )


def _equations(arm: BodyChain, order: Sequence[str]) -> dict[str, Any]:
    """What ties joints together: of two joints, of several by a tendon, and of the frames that loops join."""
    driven = {xml_text(label): total for label, total in arm.ties.driven.items()}
    sums = {label: [(xml_text(other), text(f)) for other, f in total] for label, total in driven.items()}
    positions = {xml_text(joint.label): q for joint, q in zip(arm.robot.joints, arm.ties.closed, strict=False)}
    free = ["1.0" if k == 3 else "0.0" for k in range(7 * bool(arm.root))]  # place and quaternion of a root that floats
    return {
        "pairs": {label: total[0] for label, total in sums.items() if len(total) == 1},
        "sums": {label: total for label, total in sums.items() if len(total) > 1},
        "held": [(*loop.ends, repr(loop.stretch)) for loop in arm.ties.loops if loop.by is Joining.DISTANCE],
        "welds": [loop.ends for loop in arm.ties.loops if loop.by is Joining.FIXED],
        "connects": [
            [end + part for end in loop.ends]
            for loop in arm.ties.loops
            if loop.by not in (Joining.FIXED, Joining.DISTANCE)
            for part in ("", AXIS)[: 1 + (loop.by is Joining.REVOLUTE)]  # a pin holds a second point of its axis too
        ],
        "closed": " ".join([*free, *(repr(positions[name]) for name in order)]) if positions else "",
    }


def _sites(arm: BodyChain, name: str) -> list[dict[str, str]]:
    """Those of a frame that a loop joins: where it is, and of a pin a point on its axis."""
    if (loop := next((loop for loop in arm.ties.loops if name in loop.ends), None)) is None:
        return []
    length = arm.size if name == loop.ends[0] else loop.way * arm.size
    heights = {name: "0", name + AXIS: f"{length:.6g}"} if loop.by is Joining.REVOLUTE else {name: "0"}
    return [{"name": site, "pos": f"0 0 {z}", "quat": "1 0 0 0"} for site, z in heights.items()]


def coupled_by_tendon(rotor: Rotor) -> bool:
    """Whether MuJoCo can state the coupling of a rotor: the axes before its joint keep their angles to its own."""
    return rotor.is_coupled and rotor.drag is not None


# A body of the file: its joints, from 0, against the body before, of which the last one's link is the body and the
# others weigh nothing; and what it weighs, in the frame of that link, None without dynamics.
WrittenBody = tuple[range, RigidBody | None]


def written_bodies(arm: BodyChain) -> list[WrittenBody]:
    """The bodies of the file: links with the rotors that they carry; those that weigh nothing go into the next."""
    # What each link weighs, in its own frame. A link that MuJoCo would refuse, but that looks the same however a joint
    # beside it turns, such as a point on the axis, is weighed with the link beyond: the next one, or the one before.
    weights = [s.body.moved(s.dh) for s in arm.segments if s.body is not None]
    joints = [k for k in range(1, len(weights)) if arm.segments[k].parent == k - 1]
    for onwards, joint in (*((True, k) for k in joints), *((False, k) for k in reversed(joints))):
        link, beyond = (joint - 1, joint) if onwards else (joint, joint - 1)
        way = arm.segments[joint].origin
        seen = weights[link].moved(WORLD.seen_from(way)) if onwards else weights[link]
        # Whether it looks the same from all sides around its z axis.
        xx, yy, _, xy, xz, yz = seen.entries
        is_round = all(bool(abs(part) < LEAST) for part in (*seen.com[:2], xx - yy, xy, xz, yz))
        if arm.segments[joint].joint.is_revolute and is_too_thin(seen) and is_round and not _is_nothing(seen):
            weights[beyond] = weights[beyond] + (seen if onwards else seen.moved(way))
            weights[link] = RigidBody(arb(0), WORLD.origin, body_chain.NO_INERTIA)
    last = len(arm.segments) - 1
    found, first = [], 0
    for i in range(last + 1):
        body = weights[i] if weights else None
        # A link on which more than the next one hangs has a body of its own.
        hung = [s.parent for s in arm.segments[1:]] + [part.parent for part in arm.parts]
        is_alone = i == last or arm.segments[i + 1].parent != i or hung.count(i) > 1
        if body is None or not _is_nothing(body) or is_alone or i + 1 - first == MOST_JOINTS:
            found.append((range(first, i + 1), body))
            first = i + 1
    return found


def _is_nothing(body: RigidBody) -> bool:
    return body.is_possible and bool(body.mass < LEAST and body.principal[0][2] < LEAST)


def _nested(arm: BodyChain, radius: float) -> list[tuple[int, dict[str, Any]]]:
    """All bodies, each behind the one that carries it, and how deep it is."""
    found, written, names = [], written_bodies(arm), link_names(arm) if arm.parts else {}

    def _hang(above: Part | None, parent: int, depth: int) -> None:
        # A row behind a row without motion is a body in that one's.
        for part in (part for part in arm.parts if part.parent == parent and arm.rows.get(part.after) is above):
            inside = part.frame if above is None else part.frame.seen_from(above.frame)
            inside = arm.base.then(inside) if parent < 0 and not above else inside
            name = part.name if part.is_end else names[part.name]
            if not (part.is_end and names.get(part.after) == part.name):
                found.append((depth, _frame(name, inside, part.body) | {"sites": _sites(arm, name)}))
            if not part.is_end:
                _hang(part, parent, depth + 1)

    def _add(parent: int, depth: int) -> None:
        _hang(None, parent, depth)
        for joints, weight in written:
            if arm.segments[joints.start].parent == parent:
                body = _body(arm, joints, weight, radius)
                body["name"] = names.get(arm.segments[joints[-1]].joint.label, body["name"])
                found.append((depth, body))
                _add(joints[-1], depth + 1)

    if arm.root:
        found.append((0, _frame(ROOT, WORLD, arm.root.body) | {"is_free": True}))
    _add(-1, 1 if arm.root else 0)
    if not arm.parts:
        found[-1][1]["sites"] = [{"name": TIP, **_place(arm.segments[-1].dh.then(arm.tool))}]
    return found


# Of a body in the file, what most have not.
UNSAID: Mapping[str, Any] = {"joints": [], "sites": [], **dict.fromkeys(("rod", "first", "is_frame", "is_free"))}


def _frame(name: str, frame: Frame, body: RigidBody | None) -> dict[str, Any]:
    """A body without joints."""
    inertial = _inertial(body) if body and not _is_nothing(body) else None
    return {**UNSAID, "name": name, **_place(frame), "inertial": inertial, "is_frame": True}


def _place(frame: Frame) -> dict[str, str]:
    return {"pos": texts(frame.origin), "quat": texts(body_chain.quaternion(frame))}


def _body(arm: BodyChain, joints: range, body: RigidBody | None, radius: float) -> dict[str, Any]:
    """A body with its joints; `first` is what shows the first of several where it is: in the body before."""
    # Places of the frames of all its joints in the body before; each joint's axis is seen from the last one.
    start, *others = (arm.segments[k].origin for k in joints)
    if arm.segments[joints.start].parent < 0:
        start = arm.base.then(start)
    frames = list(accumulate(others, Frame.then, initial=start))
    place = frames[-1]
    *before, last = (arm.segments[k] for k in joints)
    has_thread = any(rod(segment.end, radius) for segment in before)
    return {
        **UNSAID,
        "name": f"link{joints.stop}",
        **_place(place),
        "joints": [_moved(arm, k, frame.seen_from(place)) for k, frame in zip(joints, frames, strict=True)],
        "inertial": None if body is None else _inertial(body),
        "rod": rod(last.end, radius),
        "first": {"name": f"link{joints.start + 1}", **_place(start), "thread": has_thread} if before else None,
    }


def _moved(arm: BodyChain, i: int, axis: Frame) -> dict[str, Any]:
    """A joint about the z axis of a frame, which is given in that of the body."""
    segment = arm.segments[i]
    joint, link, rotor = segment.joint, segment.link, segment.rotor
    armature = ball(link.armature)
    if rotor is not None and not coupled_by_tendon(rotor):
        armature = armature + rotor.reflected
    options = {
        "pos": "" if is_world(axis) else texts(axis.origin),
        "axis": texts(times(axis.z, joint.sign)),
        "range": texts(map(ball, joint.limits)) if joint.limits else "",
        "armature": _unless_zero(armature),
        "damping": _unless_zero(ball(link.viscous)),
        "frictionloss": _unless_zero(ball(link.signed[0])),
    }
    return {
        "name": xml_text(joint.label),
        "type": "hinge" if joint.is_revolute else "slide",
        "options": {key: value for key, value in options.items() if value},
        "force": None if joint.torque is None else text(ball(joint.torque)),
    }


def is_too_thin(body: RigidBody) -> bool:
    """Whether MuJoCo would refuse a body though it is the limit of ones that exist: a point, a thin rod, or nothing."""
    return body.is_possible and bool(not body.mass >= LEAST or body.principal[0][0] < LEAST)


def _inertial(body: RigidBody) -> dict[str, str]:
    (a, b, c), axes = body.principal
    if not body.is_possible:
        return {"mass": text(body.mass), "pos": texts(body.com), "fullinertia": texts(body.entries)}
    # At least LEAST each, and c <= a + b, which MuJoCo checks.
    a, b = max(a, LEAST), max(b, LEAST)
    moments = [a, b, min(max(c, LEAST), a + b)]
    # MuJoCo sees no turn of axes below 1e-6, in a tensor or in a frame beside that of the body: they change places.
    if axes.x[0] + axes.y[1] + axes.z[2] > BESIDE:
        moments, axes = [*moments[1:], moments[0]], Frame(axes.origin, axes.y, axes.z, axes.x)
    mass = text(body.mass) if body.mass >= LEAST else repr(LEAST)
    return {"mass": mass, **_place(axes), "diaginertia": " ".join(repr(float(moment)) for moment in moments)}


def _unless_zero(value: arb) -> str:
    return text(value) if abs(value) > NOTHING else ""
