"""The formats of other programs that a robot is written in, what each cannot say, and where rotors go in those."""

import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from derive.errors import DeriveError, listed, quoted, require_known
from derive.exchange.body_chain import BodyChain, ChainSegment, RigidBody, Rotor, body_chain, given
from derive.exchange.certificate import ball, frame_of
from derive.exchange.numeric import with_numbers, with_positive_axes
from derive.exchange.reading.elements import SLIDE
from derive.exchange.scripts import csv_text, script_text
from derive.exchange.ties import in_words, untied
from derive.exchange.to_xml import DENSITY, LEAST, coupled_by_tendon, is_too_thin, mjcf_text, urdf_text, written_bodies
from derive.inverse.loops import without_parallelograms
from derive.mechanics.space import NOTHING, WORLD, Frame, Real, decimal, exactly
from derive.model.identification.possible import possible, wants_possible, with_chosen_bodies
from derive.model.identification.witness import NoSuchBodies
from derive.robot.description import IDENTITY, Link, RootType
from derive.robot.expression import ZERO, Expression, add, number
from derive.robot.robot import Robot
from derive.robot.tree import require_chain
from derive.verification.oracle.functions import Oracle
from derive.version import __version__

# Formats without rotors:
#
# A rotor of inertia I on the link before joint i turns about the joint's axis at u + k qd_i, where that link turns at
# u. Where the joint turns, the link behind it does so at u + s qd_i, with the sign s = +1 or -1 of its variable. Since
#
#     I (u + k qd)^2 = (I - J) u^2 + J (u + s qd)^2 + (I k^2 - J) qd^2  with  J = s I k,
#
# an inertia J about the axis on the link behind the joint, I - J on the one before it, and an armature I k^2 - J say
# the same in every term of the dynamics, wherever both links are bodies that exist.

TREES = ("urdf", "mjcf")  # formats that have trees
STATES = 100  # at which accelerations are compared
# Part of its largest moment by which a body is inside of what exists, where programs find moments by themselves.
INSIDE = 1e-12
ADDED = 1e-11  # part of its largest moment that is added to a body without a word
# An arm whose bodies hold the rotors that they carry, and what was changed, as sentences.
Written = tuple[BodyChain, tuple[str, ...]]


def with_rotors(arm: BodyChain, is_said: Callable[[Rotor], bool] | None, wanted: str) -> Written:
    """The arm as a format says it, which may say the inertia of some rotors otherwise; None for links alone."""
    # Other rotors may be divided then; the mass of each is part of the link that carries it.
    said = [i for i, s in enumerate(arm.segments) if s.rotor is not None and is_said and is_said(s.rotor)]
    inside = 0.0 if is_said else INSIDE
    chosen: tuple[int, ...] = ()
    found = _chosen(_placed(arm, said, chosen), wanted, inside)
    for i, segment in enumerate(arm.segments if is_said else ()):
        rotor = segment.rotor
        if i in said or rotor is None or segment.body is None or not segment.joint.is_revolute:
            continue
        # It must turn with the joints before its own, in a way that bodies could say.
        if not (rotor.is_coupled and rotor.reflected > _share(segment)):
            continue
        try:
            other = _chosen(_placed(arm, said, (*chosen, i)), wanted, inside)
        except NoSuchBodies:
            continue
        beside = [other[0].segments[k].body for k in (segment.parent, i) if k >= 0]
        beside += [other[0].root.body] if other[0].root and segment.parent < 0 else []
        if all(body.is_possible for body in beside if body):
            found, chosen = other, (*chosen, i)
    return found


def _share(segment: ChainSegment) -> Real:
    """The inertia J of its rotor that goes to the link behind the joint."""
    return segment.joint.sign * segment.rotor.inertia * segment.rotor.ratio if segment.rotor else 0


def _placed(arm: BodyChain, said: Collection[int], divided: Collection[int]) -> BodyChain:
    """Rotors put into bodies: those of joints that are divided are nowhere else then."""
    segments = []

    def _carried(body: RigidBody | None, place: int, inwards: Frame) -> RigidBody | None:
        # The rotors of the joints behind stand on this link: their masses, and I or I - J about their axes.
        for k, beyond in enumerate(arm.segments):
            if body is not None and beyond.rotor is not None and beyond.parent == place:
                inertia = 0 if k in said else beyond.rotor.inertia - (_share(beyond) if k in divided else 0)
                body = body + (beyond.rotor.body + RigidBody.spinning(beyond.rotor.axis, inertia)).moved(inwards)
        return body

    for i, segment in enumerate(arm.segments):
        inwards = WORLD.seen_from(segment.dh)
        body = _carried(segment.body, i, inwards)
        if i in divided and body is not None and segment.rotor is not None:
            # The other side of a division: J about its own axis, and the armature I k^2 - J.
            body = body + RigidBody.spinning(WORLD.z, _share(segment)).moved(inwards)
            armature = number(decimal(segment.rotor.reflected - _share(segment)))
            link = replace(segment.link, motor=None, armature=add(segment.link.armature, armature))
            segment = replace(segment, link=link, rotor=None)
        segments.append(replace(segment, body=body))
    root = arm.root and replace(arm.root, body=_carried(arm.root.body, -1, WORLD))
    return replace(arm, segments=tuple(segments), root=root)


def _chosen(arm: BodyChain, wanted: str, inside: float) -> Written:
    """The arm with its bodies, or with the nearest that exist."""
    if wanted == "given":
        return arm, ()
    links = tuple(s.body.link(replace(s.link, motor=None)) for s in arm.segments if s.body is not None)
    found = possible(replace(arm.robot, links=links))
    repaired = [RigidBody.of(link) for link in found.robot.links]
    bodies = [body.settled(inside) for body in repaired]
    added = [float(sum(b.entries[:3]) - sum(a.entries[:3])) / 2 for a, b in zip(repaired, bodies, strict=True)]
    amounts = [(i, more) for i, more in enumerate(added, 1) if more > ADDED * bodies[i - 1].principal[0][2]]
    sizes = [f"{more:.2g} kg m^2 to link {i}" for i, more in amounts]
    changes = (f"rounding left too little for what exists: {', '.join(sizes)} are added",) if sizes else ()
    if gone := [str(i) for i, body in enumerate(bodies, 1) if not body.is_possible]:
        raise DeriveError(f"{arm.robot.name}: link {', '.join(gone)} does not exist as it would be written")
    segments = tuple(replace(s, body=body) for s, body in zip(arm.segments, bodies, strict=True))
    return replace(arm, segments=segments), (*found.report, *changes)


def lost_coupling(robot: Robot, written: BodyChain, is_said: Callable[[Rotor], bool]) -> float:
    """Error of accelerations that should be up to 1, at random states with speeds up to 1 [rad/s^2, m/s^2]."""
    links = [Link()] * (robot.n - len(written.segments))  # joints of a root that floats
    for segment in written.segments:
        rotor, link = segment.rotor, segment.link
        if rotor is not None and is_said(rotor):
            link = replace(link, motor=link.motor and replace(link.motor, mass=ZERO))
        elif rotor is not None:
            link = replace(link, motor=None, armature=add(link.armature, number(decimal(rotor.reflected))))
        links.append(segment.body.link(link) if segment.body else link)
    q, qd, qdd = np.random.default_rng(0).uniform(-1, 1, (3, STATES, robot.n)) * [[[np.pi]], [[1]], [[1]]]
    fixed = robot.fixed
    if written.root and written.root.body:
        fixed = (replace(fixed[0], link=written.root.body.link(Link())), *fixed[1:])
    ours, theirs = Oracle.of(robot), Oracle.of(replace(robot, links=tuple(links), fixed=fixed))
    # B'^-1 (tau - tau') of accelerations that are wanted: how far the motion of what is written goes astray.
    lack = np.subtract(*(oracle.evaluate("inverse_dynamics", q, qd, qdd) for oracle in (ours, theirs)))
    inverse = np.linalg.pinv(theirs.evaluate("inertia_matrix", q))
    return float(np.abs(np.einsum("kij,kj->ki", inverse, lack)).max())


def _rotor(has: Callable[[Rotor], bool]) -> Callable[[ChainSegment], bool]:
    return lambda segment: segment.rotor is not None and has(segment.rotor)


# Gravity along z that programs take for a URDF, and how differently it is rounded, as 9.8 or 9.80665 [m/s^2].
EARTH, ROUNDING_OF_EARTH = -9.81, 0.02
# What a joint or its link may have: in words, and whether it has.
GIVEN: Mapping[str, tuple[str, Callable[[ChainSegment], bool]]] = {
    "limits": ("the limits", lambda segment: segment.joint.limits is not None),
    "speed": ("the largest speed", lambda segment: given(segment.joint.speed)),
    "torque": ("the largest torque", lambda segment: given(segment.joint.torque)),
    "bodies": ("mass and inertia", lambda segment: segment.body is not None),
    "viscous": ("the viscous friction", lambda segment: given(segment.link.viscous)),
    "coulomb": ("the Coulomb friction", lambda segment: given(segment.link.signed[0])),
    "coulomb by direction": (
        "the Coulomb friction by direction, written as the mean of both ways,",
        lambda segment: given(segment.link.signed[1]),
    ),
    "armature": ("the armature", lambda segment: given(segment.link.armature)),
    "rotor": ("the rotor inertia times ratio squared", _rotor(lambda rotor: bool(abs(rotor.reflected) > NOTHING))),
    "coupling": ("the coupling of the rotor with the joints before it", _rotor(lambda rotor: rotor.is_coupled)),
    "coupling that varies": (
        "the coupling of the rotor with the joints before it, which depends on q,",
        _rotor(lambda rotor: rotor.is_coupled and not coupled_by_tendon(rotor)),
    ),
}


@dataclass(frozen=True, slots=True)
class ExportFormat:
    """A format."""

    program: str  # who reads it
    lacks: tuple[str, ...]  # keys of `GIVEN` that it cannot say
    write: Callable[[BodyChain, list[str]], str]  # makes the text from an arm and the lines of its first comment
    # What else its program takes otherwise of an arm, as sentences.
    remarks: Callable[[BodyChain], Iterable[str]] = lambda arm: ()
    reverses: bool = True  # whether all that its program computes is right where a variable counts against its axis
    has_rotors: bool = False  # whether rotors are bodies of their own
    # Whether it says how a rotor turns, else than by links and armature; None for a format that never does.
    says: Callable[[Rotor], bool] | None = None


@dataclass(frozen=True, slots=True)
class Exported:
    """A robot in another format."""

    text: str  # the file
    remarks: tuple[str, ...]  # what the format cannot say of this robot, and what was put instead


def exported(robot: Robot, to: str, inertia: str = "given", values: Mapping[str, Expression] | None = None) -> Exported:
    """A robot in the format of another program."""
    require_known(to, FORMS, f"unknown format {quoted(to)}")
    if to not in TREES:
        require_chain(robot, "an export")
    wants_possible(inertia)  # a wrong choice is told before missing numbers are
    form = FORMS[to]
    numeric, changes = with_chosen_bodies(with_numbers(robot, values), inertia if form.has_rotors else "given")
    reversed_joints = [joint.variable for joint in numeric.joints if joint.sign < 0 and not form.reverses]
    with exactly():
        numeric, ties = untied(without_parallelograms(numeric))
        if numeric.root and numeric.root.type is RootType.FLOATING:
            # Seen from frame 0: other programs count the place of a root in their own world.
            x, y, z = map(ball, numeric.gravity or (ZERO, ZERO, ZERO))
            x, y, z = (number(decimal(component)) for component in frame_of(numeric.base).turned((x, y, z)))
            numeric = replace(numeric, base=IDENTITY, gravity=numeric.gravity and (x, y, z))
        arm = body_chain(with_positive_axes(numeric) if reversed_joints else numeric)
        written = arm = replace(arm, ties=ties)
        if not form.has_rotors:
            written, changes = with_rotors(arm, form.says, inertia)
        remarks = (*changes, *_remarks(arm, written, form, reversed_joints))
        head = [f"{numeric.name}, written by derive {__version__} from its robot file", *remarks]
        text = form.write(written, [re.sub("-(?=-)", "- ", line) for line in head])
    return Exported(text, remarks)


def _remarks(arm: BodyChain, written: BodyChain, form: ExportFormat, reversed_joints: Sequence[str]) -> Iterator[str]:
    for name, total in arm.ties.variables.items():
        yield f"{form.program} counts positions of joints, of which the variable {name} is {in_words(total)}"
    for key in form.lacks:
        words, has = GIVEN[key]
        if joints := [segment.joint.variable for segment in written.segments if has(segment)]:
            lost = lost_coupling(arm.robot, written, form.says) if key == "coupling that varies" and form.says else 0.0
            size = f"; where accelerations are up to 1, they differ by up to {lost:.2g} without it" if lost else ""
            yield f"{form.program} cannot say {words} of {', '.join(joints)}{size}"
    carried = [s for s in arm.segments if not form.has_rotors and (arm.root or s.parent >= 0)]
    rotors = [segment.rotor for segment in carried if segment.rotor is not None]
    if any(abs(part) > NOTHING for rotor in rotors for part in (rotor.body.mass, rotor.inertia)):
        yield "rotors are part of the links that carry them, as far as they do not spin"
    if reversed_joints:
        around = f"the axes of {', '.join(reversed_joints)} are turned around, by pi in the alpha on either side"
        yield f"{form.program} takes reversed joints for poses alone: {around}"
    pairs = zip(arm.segments, written.segments, strict=True)
    if divided := [one.joint.variable for one, other in pairs if one.rotor is not None and other.rotor is None]:
        yield f"the rotor of {', '.join(divided)} is divided between the links beside the joint, and its armature"
    yield from form.remarks(written)


def _remarks_of_mujoco(arm: BodyChain) -> Iterator[str]:
    if any(given(segment.link.signed[0]) for segment in arm.segments):
        yield (
            "MuJoCo's dry friction is Coulomb's while a joint slips; it is less on a joint that it would stop within "
            "some hundredths of a second, and one that stands creeps under a load"
        )
    written = written_bodies(arm)
    bodies = [(str(joints.stop), body) for joints, body in written if body is not None]
    bodies += [(part.name, part.body) for part in (*arm.parts, *([arm.root] if arm.root else [])) if part.body]
    if refused := [link for link, body in bodies if not body.is_possible]:
        yield f"MuJoCo refuses link {', '.join(refused)}: inconsistent inertia; inertia: possible finds a valid one"
    if gone := [str(link) for joints, _ in written for link in joints[1:]]:
        yield (
            f"MuJoCo has no body for link {', '.join(gone)}, without mass or with mass along a joint's axis alone, "
            "which the link beyond it carries; their joints move the body of the next link"
        )
    if thin := [link for link, body in bodies[: len(written)] if is_too_thin(body)]:
        yield f"MuJoCo wants a little of each: {LEAST:g} kg or kg m^2 where link {', '.join(thin)} has none"
    if not arm.robot.links:
        yield f"the robot has no masses; those of its cylinders, of {DENSITY} kg/m^3, stand in"


def _remarks_of_toolboxes(plain: str, compiled: str, arm: BodyChain) -> Iterator[str]:
    """What two forms of a recursion in Corke's toolboxes take otherwise (1.4.4 for Python, 10.4 for MATLAB)."""
    if not arm.robot.links:
        return
    slides = [segment.joint for segment in arm.segments if not segment.joint.is_revolute]
    if shifted := [joint.variable for joint in slides if given(joint.d)]:
        yield f"{plain} takes no offset of {', '.join(shifted)}; {compiled} does"
    if not arm.robot.joints[0].is_revolute:
        yield f"{compiled} may have other torques where the first joint slides; {plain} has those of the equations"


def _remarks_of_urdf(arm: BodyChain) -> Iterator[str]:
    for loop in arm.ties.loops:
        yield f"URDF cannot say that a loop is closed: a joint ({loop.by}) joins the frames {listed(loop.ends)}"
    down = [float(ball(cell)) for cell in arm.robot.gravity or ()]
    if down and (down[0] or down[1] or abs(down[2] - EARTH) > ROUNDING_OF_EARTH):
        yield f"URDF cannot say the gravity {down[0]:g}, {down[1]:g}, {down[2]:g} m/s^2"
    joints = [segment.joint for segment in arm.segments]
    if bounds := [joint.variable for joint in joints if not (given(joint.torque) and given(joint.speed))]:
        yield f"URDF wants an effort and a velocity: 1000000 where the robot file gives none, of {', '.join(bounds)}"
    if arm.root:
        yield "URDF does not say that a root floats: programs are told, as by derive import --tree --root floating"
    if slides := [joint.variable for joint in joints if not joint.is_revolute and joint.limits is None]:
        yield f"URDF wants limits of slides: {SLIDE} m to either side of {', '.join(slides)}"


def _of_toolbox(program: str, template: str, plain: str, compiled: str) -> ExportFormat:
    remarks = partial(_remarks_of_toolboxes, plain, compiled)
    write = partial(script_text, template)
    return ExportFormat(program, ("speed", "torque", "coupling"), write, remarks, reverses=False)


# By the name that users type.
FORMS: Mapping[str, ExportFormat] = {
    "urdf": ExportFormat(
        "URDF", ("coulomb by direction", "armature", "rotor", "coupling"), urdf_text, _remarks_of_urdf
    ),
    "mjcf": ExportFormat(
        "MJCF",
        ("speed", "coulomb by direction", "coupling that varies"),
        mjcf_text,
        _remarks_of_mujoco,
        says=coupled_by_tendon,
    ),
    "rtb": _of_toolbox("DHRobot", "exchange/rtb.py.jinja", "rne_python", "rne"),
    "corke": _of_toolbox("SerialLink", "exchange/corke.m.jinja", "rne", "its compiled form frne"),
    "rigidbodytree": ExportFormat(
        "rigidBodyTree",
        ("speed", "torque", "viscous", "coulomb", "armature", "rotor", "coupling"),
        partial(script_text, "exchange/rigidbodytree.m.jinja"),
    ),
    "csv": ExportFormat("CSV", (), csv_text, has_rotors=True),
}
