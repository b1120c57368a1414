"""Nothing of a URDF is passed over without a word: what changes the arm for others changes ours, or is told."""

import random
from collections.abc import Callable
from copy import deepcopy
from xml.etree import ElementTree as Xml

import numpy as np
import pytest

from derive.errors import DeriveError, RobotFileError
from derive.exchange.from_urdf import Imported
from derive.exchange.reading.urdf import READ
from derive.verification.oracle.functions import Oracle
from tests.exchange.urdfs import J, Reading, body, imported, urdf
from tests.random_robots import swept

LINKS = [
    J("0 0 0.3", inertial=body("2", "0.1 0 0.05", "0.3 0 0.1", "0.02 0.03 0.025 0.001 0 0.002")),
    J("0.1 0 0", "1.5707963267948966 0 0.2", "0 1 0", "fixed", inertial=body("0.4", "0 0.1 0", moments="1 1 1 0 0 0")),
    J("0.3 0 0.02", "0.4 -0.2 0", "0 0.6 0.8", "prismatic", inertial=body("1.5", "0 0.1 0", "0 0.5 0")),
    J("0 0.2 0", "0 1.2 -0.7", "1 0 0", "continuous", 'effort="9" velocity="3"', body("0.7", "0 0 0.1")),
]
GOOD = urdf(LINKS, top='<material name="grey"/>')


def differs(text: str, found: Imported) -> bool:
    """Whether Pinocchio sees another arm at a random state, or none that moves as ours."""
    try:
        reading, oracle = Reading(text, found.joints), Oracle.of(found.robot)
    except ValueError:  # it refuses the file
        return True
    q, qd, qdd = np.random.default_rng(1).uniform(-1, 1, (3, found.robot.n))
    if reading.model.nv != found.robot.n:
        return True
    pose = reading.pose(q, found.links[1]) - oracle.evaluate("forward_kinematics", q)
    if not found.robot.links:
        return bool(np.abs(pose).max() > 1e-5)
    friction = [float(str(cell)) for link in found.robot.links for cell in (link.viscous.value, link.coulomb.value)]
    lost = np.array(friction[::2]) * qd + np.array(friction[1::2]) * np.sign(qd)
    torque = reading.torque(q, qd, qdd) + lost - oracle.evaluate("inverse_dynamics", q, qd, qdd)
    return bool(max(np.abs(pose).max(), np.abs(torque).max() / 50) > 1e-5)


NAMES = ("quat_wxyz", "xyz", "rpy", "scale", "unit", "origin", "Axis", "orign", "pose", "density", "foo", "x:y")
NUMBERS = ("1e0", "+.5", "1.", "-1e-400", "1e300", "0x1", "1,5", "nan", "", "2 3", "-0.3", "0", "1e-7", "0.7")


def mutated(source: random.Random) -> str:
    """The file with one or two slips in its elements and attributes."""
    root = Xml.fromstring(GOOD.replace("<robot ", '<robot version="1.1" ' if source.random() < 0.5 else "<robot "))
    for _ in range(source.randint(1, 2)):
        parent = source.choice([element for element in root.iter() if len(element)])
        source.choice(SLIPS)(source, parent, source.choice([*parent, *root.iter()]))
    return Xml.tostring(root, encoding="unicode").replace("<x:y", '<x:y xmlns:x="u"')


def key(element: Xml.Element, source: random.Random) -> str:
    return source.choice([*element.attrib] or [""])


def quaternions(source: random.Random, parent: Xml.Element, child: Xml.Element) -> None:
    for origin in [*parent.iter("origin"), *child.iter("origin")]:
        if source.random() < 0.5:
            origin.set("quat_xyzw", "0.1 0.7 0.1 0.7")


def reversed_key(source: random.Random, parent: Xml.Element, child: Xml.Element) -> None:
    name = key(child, source)
    child.set(name[::-1] or "a", child.attrib.pop(name, "0"))


def other_value(source: random.Random, parent: Xml.Element, child: Xml.Element) -> None:
    name = key(child, source)
    child.set(name or "a", changed(child.get(name, ""), source))


SLIPS: list[Callable[[random.Random, Xml.Element, Xml.Element], object]] = [
    lambda source, parent, child: child.attrib.pop(key(child, source), None),
    lambda source, parent, child: parent.remove(child) if child in list(parent) else None,
    lambda source, parent, child: parent.insert(source.randrange(len(parent) + 1), twin(child, source)),
    lambda source, parent, child: child.set(source.choice(NAMES[:-1]), "0 0 0.1"),
    lambda source, parent, child: Xml.SubElement(child, source.choice(NAMES[:-1]), value="0.1", xyz="0 0 1"),
    lambda source, parent, child: setattr(child, "tag", source.choice(NAMES)),
    lambda source, parent, child: child.append(deepcopy(parent[0])),
    lambda source, parent, child: setattr(child, "text", "0 0 1"),
    lambda source, parent, child: child.set("type", source.choice(["fixed", "revolute", "continuous", "ball"])),
    quaternions,
    reversed_key,
    other_value,
    other_value,
]


def twin(element: Xml.Element, source: random.Random) -> Xml.Element:
    made = Xml.Element(element.tag, {k: changed(v, source) for k, v in element.attrib.items()})
    made.extend(deepcopy(list(element)))
    return made


def changed(text: str, source: random.Random) -> str:
    words = text.split() or [""]
    words[source.randrange(len(words))] = source.choice(NUMBERS)
    return " ".join(words)


def silent_difference(text: str, usual: Imported) -> str:
    """How a file differs from what Pinocchio reads without a word of ours; empty where it does not."""
    try:
        found = imported(text)
    except DeriveError as error:
        return "" if str(error) and "\n" not in str(error) else "no message"
    is_told = set(found.notes) != set(usual.notes)
    ours, theirs = ((r.joints, r.links, r.base, r.tool) for r in (found.robot, usual.robot))
    same = ours == theirs
    try:
        Reading(text, ())
    except ValueError:
        return "refused by others, and the same here" if same and not is_told and bare(text) != bare(GOOD) else ""
    return "another arm" if not is_told and differs(text, found) else ""


UNITS = 'ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"'
CHAIN = [*LINKS[:1], J("0.1 0 0", "0 0 0.1", "0 1 0", inertial=body("1"))]


@pytest.mark.parametrize(
    ("old", "new", "found"),
    [
        ('rpy="0 0 0.1"', 'quat_xyzw="0 0 0 1"', "quat_xyzw, which URDF 1.0 does not have"),
        ('<robot name="arm"', '<robot name="arm" version="1.3"', "version '1.3' of URDF"),
        ('<robot name="arm"', '<robot name="arm" scale="0.001"', "robot: 'scale' is not known"),
        ('rpy="0 0 0.1"', 'rpy="0 0 0.1" quat_wxyz="1 0 0 0"', "origin: 'quat_wxyz' is not known"),
        ('<mass value="1"', '<mass unit="g" value="1"', "mass: 'unit' is not known"),
        ('<axis xyz="0 1 0"/>', "<axis>0 1 0</axis>", "axis: '0 1 0' is not known"),
        ('<axis xyz="0 1 0"/>', "<axis/>", "an axis of length 0"),
        ('<axis xyz="0 1 0"/>', '<axes xyz="0 1 0"/><axis2 xyz="1 0 0"/>', "joint: 'axis2' is not known"),
        ('<origin xyz="0.1 0 0" rpy="0 0 0.1"/>', '<orign xyz="0.1 0 0"/>', "'orign' .*did you mean 'origin'"),
        ('<link name="l2">', '<link name="l2"><mass value="2"/>', "link: 'mass' is not known"),
    ],
)
def test_what_could_change_the_arm_and_is_not_known_is_refused(old: str, new: str, found: str) -> None:
    text = urdf(CHAIN)
    assert old in text
    with pytest.raises(RobotFileError, match=found):
        imported(text.replace(old, new, 1))


@pytest.mark.parametrize(
    ("old", "new", "note"),
    [
        ('iyy="1" ', "", "inertia without iyy, taken as 0 (line 10)"),
        (f"<inertia {UNITS}/>", "", "inertial without inertia, a mass at a point: link 'l2' (line 10)"),
        ('"0 1 0"/>', '"0 1 0"/><axis xyz="1 0 0"/>', "2 elements axis in one joint: the first is taken (line 11)"),
        ('"l2"><inertial>', '"l2"><inertial>@</inertial><inertial>', "2 elements inertial in one"),
        ("<limit lower", "<gap lower", "joint 'j1' is revolute and has no limits, without which other programs refuse"),
        ("</robot>", '<link name="x"/></robot>', "2 links hang on no joint: 'l0', 'x'; other programs refuse such a"),
        ('velocity="2"', 'velocity="2" jerk="9" x:a="1" xmlns:x="u"', "not read: jerk of limit, {u}a of limit"),
        ('<link name="l2">', '<link name="l2" type="arm"><origin/><visual/>', "not read: type of link, origin, visual"),
        ('name="arm"', "", "a robot without a name"),
        ('<axis xyz="0 1', 'the axis: <axis xyz="0 1', "not read: the axis: of joint"),
        ('<robot name="arm">', '<robot name="arm"><x:origin xmlns:x="u"/>', "not read: {u}origin"),
        ('effort="80"', 'effort="-1"', "j1: effort of 0 or less is taken as none"),
    ],
)
def test_what_is_passed_over_is_told(old: str, new: str, note: str) -> None:
    text = urdf(CHAIN)
    assert old in text
    inner = text.partition("<inertial>")[2].partition("</inertial>")[0]
    notes = imported(text.replace(old, new.replace("@", inner), 1)).notes
    assert any(note in said for said in notes), notes


@pytest.mark.parametrize("seed", range(12))
def test_quaternions_of_joints_and_bodies_are_the_rotations_that_others_read(seed: int) -> None:
    """At quarter turns too, where roll and yaw are about one axis and rounding leaves each of them free."""
    source, version = random.Random(seed), f' version="1.{1 + seed % 2}"'
    text = GOOD.replace('name="arm"', f'name="arm"{version}')
    while 'rpy="' in text:
        before, _, rest = text.partition('rpy="')
        parts = [source.gauss(0, 1) for _ in range(4)] if seed % 3 else source.choice([(1, 1, -1, 1), (0, 1, 0, 1)])
        size = float(np.linalg.norm(parts)) / (2 if seed == 4 else 1)
        text = f'{before}quat_xyzw="{" ".join(repr(part / size) for part in parts)}"{rest.partition(chr(34))[2]}'
    found = imported(text)
    assert not differs(text, found)
    assert found.certificate.position < 1e-12
    assert any("a quaternion of length 2 is taken with length 1" in note for note in found.notes) == (seed == 4)


def test_frames_may_stand_in_each_other_by_the_hundred() -> None:
    """Balls grow with each turn; at 256 bits nothing was left of the place of the 600th."""
    turns = [J("0.1 0 0.01", "0.1 0.2 0.3", type="fixed", inertial=body("0.1")) for _ in range(600)]
    text = urdf([*turns, *CHAIN])
    found = imported(text)
    assert not differs(text, found)
    assert found.certificate.position < 1e-13


def test_every_element_within_one_that_is_read_is_itself_known() -> None:
    inner = {name for _, elements in READ.values() for name in elements}
    assert inner - READ.keys() == {"dh_table"}


def bare(text: str) -> str:
    return text.replace(' version="1.1"', "")


@pytest.mark.parametrize("seed", [*range(8), *swept(*range(8, 300))])
def test_what_changes_the_arm_for_others_changes_it_here_or_is_told(seed: int) -> None:
    source, usual = random.Random(seed), imported(GOOD)
    for _ in range(20):
        text = mutated(source)
        assert not silent_difference(text, usual), text
