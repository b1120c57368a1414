"""The formats of other programs that a robot is written in, and what each of them cannot say."""

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from types import MappingProxyType

from derive.errors import DeriveError, near_miss, quoted
from derive.exchange.body_chain import BodyChain, ChainSegment, Rotor, body_chain, given
from derive.exchange.certificate import ball
from derive.exchange.numeric import with_numbers, with_positive_axes
from derive.exchange.rotors import lost_coupling, with_rotors
from derive.exchange.scripts import csv_text, script_text
from derive.exchange.to_mjcf import DENSITY, LEAST, coupled_by_tendon, is_too_thin, mjcf_text, written_bodies
from derive.exchange.to_urdf import urdf_text
from derive.exchange.urdf import SLIDE
from derive.mechanics.space import NOTHING, exactly
from derive.model.identification.possible import wants_possible, with_chosen_bodies
from derive.robot.expression import Expression
from derive.robot.robot import Robot
from derive.version import __version__

# Gravity along z that programs take for a URDF, and how differently it is rounded, as 9.8 or 9.80665 [m/s^2].
EARTH, ROUNDING_OF_EARTH = -9.81, 0.02
# What a joint or its link may have: in words, and whether it has.
GIVEN: Mapping[str, tuple[str, Callable[[ChainSegment], bool]]] = MappingProxyType(
    {
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
        "rotor": (
            "the rotor inertia times ratio squared",
            lambda segment: segment.rotor is not None and bool(abs(segment.rotor.reflected) > NOTHING),
        ),
        "coupling": (
            "the coupling of the rotor with the joints before it",
            lambda segment: segment.rotor is not None and segment.rotor.is_coupled,
        ),
        "coupling that varies": (
            "the coupling of the rotor with the joints before it, which depends on q,",
            lambda each: each.rotor is not None and each.rotor.is_coupled and not coupled_by_tendon(each.rotor),
        ),
    }
)


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
    if to not in FORMS:
        allowed = f"allowed: {', '.join(FORMS)}"
        raise DeriveError(f"unknown format {quoted(to)}", allowed=allowed, remedy=near_miss(to, FORMS))
    wants_possible(inertia)  # a wrong choice is told before missing numbers are
    form = FORMS[to]
    numeric, changes = with_chosen_bodies(with_numbers(robot, values), inertia if form.has_rotors else "given")
    reversed_joints = [joint.variable for joint in numeric.joints if joint.sign < 0 and not form.reverses]
    with exactly():
        arm = body_chain(with_positive_axes(numeric) if reversed_joints else numeric)
        written = arm
        if not form.has_rotors:
            written, changes = with_rotors(arm, form.says, inertia)
        remarks = (*changes, *_remarks(arm, written, form, reversed_joints))
        head = [f"{numeric.name}, written by derive {__version__} from its robot file", *remarks]
        text = form.write(written, [re.sub("-(?=-)", "- ", line) for line in head])
    return Exported(text, remarks)


def _remarks(arm: BodyChain, written: BodyChain, form: ExportFormat, reversed_joints: Sequence[str]) -> Iterator[str]:
    for key in form.lacks:
        words, has = GIVEN[key]
        if joints := [segment.joint.variable for segment in written.segments if has(segment)]:
            lost = lost_coupling(arm.robot, written, form.says) if key == "coupling that varies" and form.says else 0.0
            size = f"; where accelerations are up to 1, they differ by up to {lost:.2g} without it" if lost else ""
            yield f"{form.program} cannot say {words} of {', '.join(joints)}{size}"
    rotors = [] if form.has_rotors else [segment.rotor for segment in arm.segments[1:] if segment.rotor is not None]
    if any(abs(part) > NOTHING for rotor in rotors for part in (rotor.body.mass, rotor.inertia)):
        yield "rotors are part of the links that carry them, as far as they do not spin"
    if reversed_joints:
        yield (
            f"{form.program} takes reversed joints for poses alone: the axes of {', '.join(reversed_joints)} are "
            "turned around, by pi in the alpha on either side"
        )
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
    bodies = [(str(each.joints.stop), each.body) for each in written if each.body is not None]
    if refused := [link for link, body in bodies if not body.is_possible]:
        yield f"MuJoCo refuses link {', '.join(refused)}: inconsistent inertia; inertia: possible finds a valid one"
    if gone := [str(link) for each in written for link in each.joints[1:]]:
        yield (
            f"MuJoCo has no body for link {', '.join(gone)}, without mass or with mass along a joint's axis alone, "
            "which the link beyond it carries; their joints move the body of the next link"
        )
    if thin := [link for link, body in bodies if is_too_thin(body)]:
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
    down = [float(ball(cell)) for cell in arm.robot.gravity or ()]
    if down and (down[0] or down[1] or abs(down[2] - EARTH) > ROUNDING_OF_EARTH):
        yield f"URDF cannot say the gravity {down[0]:g}, {down[1]:g}, {down[2]:g} m/s^2"
    joints = [segment.joint for segment in arm.segments]
    if bounds := [joint.variable for joint in joints if not (given(joint.torque) and given(joint.speed))]:
        yield f"URDF wants an effort and a velocity: 1000000 where the robot file gives none, of {', '.join(bounds)}"
    if slides := [joint.variable for joint in joints if not joint.is_revolute and joint.limits is None]:
        yield f"URDF wants limits of slides: {SLIDE} m to either side of {', '.join(slides)}"


# By the name that users type.
FORMS: Mapping[str, ExportFormat] = MappingProxyType(
    {
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
        "rtb": ExportFormat(
            "DHRobot",
            ("speed", "torque", "coupling"),
            partial(script_text, "exchange/rtb.py.jinja"),
            partial(_remarks_of_toolboxes, "rne_python", "rne"),
            reverses=False,
        ),
        "corke": ExportFormat(
            "SerialLink",
            ("speed", "torque", "coupling"),
            partial(script_text, "exchange/corke.m.jinja"),
            partial(_remarks_of_toolboxes, "rne", "its compiled form frne"),
            reverses=False,
        ),
        "rigidbodytree": ExportFormat(
            "rigidBodyTree",
            ("speed", "torque", "viscous", "coulomb", "armature", "rotor", "coupling"),
            partial(script_text, "exchange/rigidbodytree.m.jinja"),
        ),
        "csv": ExportFormat("CSV", (), csv_text, has_rotors=True),
    }
)
