"""URDFs are read exactly, and what is wrong or harmful is refused in one message."""

import random
import time
from fractions import Fraction

import pytest

from derive.errors import DeriveError, RobotFileError
from derive.exchange.arm import moving_tips
from derive.exchange.from_urdf import ImportOptions, import_urdf
from derive.exchange.reading.urdf import read_urdf
from tests.exchange.urdfs import J, body, urdf
from tests.random_robots import seeds


def test_decimals_are_read_as_they_are_written() -> None:
    text = urdf([J("0 0 0.1", "1e-3 0 -2.5", "0 1 0", inertial=body("2.50", "0 0 1"))])
    read = read_urdf(text.encode(), "arm.urdf")
    (joint,) = read.joints
    assert joint.origin.xyz == (0, 0, Fraction(1, 10))
    assert joint.origin.rpy == (Fraction(1, 1000), 0, Fraction(-5, 2))
    assert (joint.effort, joint.velocity, joint.limits) == (80, 2, (-3, 3))
    found = read.bodies["l1"]
    assert found.mass == Fraction(5, 2)
    assert read.bodies["l0"] is None


DECLARED = '<?xml version="1.0"?>\n' + urdf([J()])


@pytest.mark.parametrize(
    ("text", "line", "found"),
    [
        ("", 1, "an empty file"),
        ("<robot", 1, "not XML"),
        ("<model/>", 1, "the outermost element is 'model'"),
        ("<robot/>", 1, "a robot without links"),
        ('<robot>\n<link name="a"/>\n<link name="a"/>\n</robot>', 3, "a second link 'a'"),
        ("<robot>\n<link/>\n</robot>", 2, "a link without a name"),
        (urdf([J("0 0 nan")]), 5, "'nan' is no number"),
        (urdf([J("0 0")]), 5, "2 numbers"),
        (urdf([J(parent="nobody")]), 5, "parent 'nobody' is no link of the file"),
        (urdf([J(name="a"), J(name="a")]), 10, "a second joint 'a'"),
        (urdf([J(inertial=body("inf"))]), 4, "'inf' is no number"),
        (
            '<!DOCTYPE robot [<!ENTITY a "b">]>\n<robot><link name="a"/></robot>',
            1,
            "a document type definition is not accepted",
        ),
    ],
)
def test_one_message_names_file_line_and_what_was_found(text: str, line: int, found: str) -> None:
    with pytest.raises(RobotFileError) as refused:
        read_urdf(text.encode(), "arm.urdf")
    assert (refused.value.location.source, found in refused.value.found) == ("arm.urdf", True), str(refused.value)
    assert abs(refused.value.location.line - line) <= 2


@pytest.mark.parametrize(
    ("xyz", "remedy"),
    [
        ("0,05 0 0", "write 0.05"),
        ("-,5 0 0", "write -.5"),
        ("0, 0, 1", "separate numbers by spaces alone"),
        ("1.57, 0, 0", "separate numbers by spaces alone"),
        ("0,0,1", "write 3, apart by spaces"),
    ],
)
def test_commas_are_told_what_to_write_instead(xyz: str, remedy: str) -> None:
    with pytest.raises(RobotFileError) as refused:
        read_urdf(urdf([J(xyz)]).encode(), "arm.urdf")
    assert refused.value.remedy == remedy


def test_elements_of_a_default_namespace_are_read_and_remarked() -> None:
    text = urdf([J("0 0 1", inertial=body("2"))], top='<x:gazebo xmlns:x="http://gazebo"/>')
    plain, read = (
        read_urdf(t.encode(), "arm.urdf") for t in (text, text.replace("<robot ", '<robot xmlns="http://ros" '))
    )
    assert (read.bodies, read.joints, read.unread) == (plain.bodies, plain.joints, plain.unread)
    assert read.notes == ("the XML namespace 'http://ros' is passed over",)
    assert plain.notes == ()


@pytest.mark.parametrize(
    ("data", "note"),
    [
        (("\n " + DECLARED).encode(), "space before the XML declaration"),
        (DECLARED.replace("<robot", "<!-- --- base --- -->\n<robot").encode(), "-- within XML comments"),
        (DECLARED.replace("arm", "r\xe9").encode("latin-1"), "not in UTF-8, read as Latin-1"),
        (DECLARED.replace("1.0", "0.0").encode(), "a version of XML that does not exist"),
        (DECLARED.encode() + b"\x1a\n\0", "control characters at the end of the file"),
        (urdf([J()], top="<xacro:x/>").encode(), "the XML prefix xacro is not bound"),
    ],
)
def test_slips_over_which_other_readers_pass_are_remarked(data: bytes, note: str) -> None:
    read = read_urdf(data, "arm.urdf")
    assert read.notes == (note,)
    assert read.joints[0].axis == (0, 0, 1)
    assert read.joints[0].location.line == data[: data.index(b"<joint")].count(b"\n") + 1


def test_infinite_limits_are_the_greatest_numbers_and_nothing_else_is_infinite() -> None:
    text = urdf([J(limit='lower="-inf" upper="1.7976931348623157e+308" effort="Infinity" velocity="1e400"')])
    (joint,) = read_urdf(text.encode(), "arm.urdf").joints
    assert joint.limits == (-(10**60), 10**60)
    assert joint.effort == joint.velocity == 10**60
    for old, new in (("-inf", "nan"), ("-inf", "inf f"), ('xyz="0 0 0"', 'xyz="inf 0 0"')):
        with pytest.raises(RobotFileError):
            read_urdf(text.replace(old, new).encode(), "arm.urdf")


def test_joints_that_no_chain_may_have_are_remarked_with_their_lines() -> None:
    text = urdf([J(axis="0 0 0.0"), J(type="screw"), J(type="floating", axis="0 0 0"), J(more="<mimic/>")])
    read = read_urdf(text.encode(), "arm.urdf")
    assert read.notes == ("joint 'j1': an axis of length 0 (line 5)", "joint 'j2' of type 'screw' (line 11)")
    assert [joint.mimics for joint in read.joints] == [None, None, None, ""]


GOOD = urdf([J("0 0 0.3", inertial=body("2")), J("0.3 0 0", "1.57 0 0", more='<dynamics damping="0.1"/>')])

BOMB = (
    '<!DOCTYPE x [<!ENTITY a0 "xxxxxxxxx">'
    + "".join(f'<!ENTITY a{k} "{f"&a{k - 1};" * 9}">' for k in range(1, 21))
    + ']><robot name="&a20;"/>'
)


FAR = urdf([J(), J("0 0.1 0", "3.14 0 0"), J("0.4 0.1 1e23", "3.1415 0 0"), J("0.4 0 0.1", "1.57 0 0.4"), J("1 0 2")])


def chain(count: int, kind: str) -> str:
    return urdf([J(type=kind, limit="") for _ in range(count)])


@pytest.mark.parametrize(
    ("text", "found"),
    [
        (f'<!DOCTYPE x [<!ENTITY a "{"x" * 99}"><!ENTITY b "{"&a;" * 9999}">]><robot name="&b;"/>', "document"),
        (BOMB, "document"),
        ('<!DOCTYPE x [<!ENTITY a SYSTEM "file:///etc/passwd">]><robot><link name="&a;"/></robot>', "document"),
        ("<robot>" + '<link name="a"/>' * 250_000 + "</robot>", "tags"),
        ('<robot name="' + "a" * 17_000_000 + '"/>', "bytes"),
        ("<robot>" + "<a>" * 3000 + "</a>" * 3000 + "</robot>", "not XML"),
        (chain(3000, "fixed"), "no joint moves"),
        (chain(257, "revolute"), "257 joints move"),
        (urdf([J("1e999999999999 0 0")]), "is no number"),
        (urdf([J("0 0 1e61")]), "is no number"),
        (urdf([J(inertial=body("-1"))]), "weigh -1 kg"),
        (FAR, "joint 'j.': so far"),
        (urdf([J(), J(link="x"), J(link="y", parent="x")]).replace('child link="y"', 'child link="l1"'), "two joints"),
        (urdf([J()]).replace('parent link="l0"', 'parent link="l1"').replace('<link name="l0"/>', ""), "loop"),
    ],
)
def test_it_is_refused_within_two_seconds(text: str, found: str) -> None:
    before = time.process_time()
    with pytest.raises(RobotFileError, match=found) as refused:
        import_urdf(read_urdf(text.encode(), "arm.urdf"), None, None, ImportOptions(snap="1e-6"))
    assert "\n" not in str(refused.value)
    assert time.process_time() - before < 2


def test_names_cannot_write_into_the_robot_file() -> None:
    """Line breaks in names, which XML allows as character references."""
    text = GOOD.replace("l2", "l2&#10;joints: []&#10;&quot;").replace('"arm"', '"&quot;&#10;x: 1 \\ # "')
    imported = import_urdf(read_urdf(text.encode(), "a\n.urdf"), None, None, ImportOptions(snap="1e-6"))
    assert imported.robot.n == 2


@pytest.mark.parametrize("seed", seeds(300, 60, 300))
def test_damaged_files_are_refused_or_read(seed: int) -> None:
    source = random.Random(seed)
    data = bytearray(GOOD.encode())
    for _ in range(source.randint(1, 4)):
        at = source.randrange(len(data))
        match source.randrange(4):
            case 0:
                data[at] = source.randrange(256)
            case 1:
                del data[at : at + source.randrange(40)]
            case 2:
                data[at:at] = data[at : at + source.randrange(60)]
            case 3:
                data[at:at] = source.choice([b"nan", b"-", b"&lt;", b'"', b"<link/>", b"1e400", b"\x00", b"</robot>"])
    message = outcome(bytes(data))
    assert "\n" not in message
    assert not message or "arm.urdf" in message


def outcome(data: bytes) -> str:
    """The message with which a file is refused; empty for one that is read."""
    try:
        read = read_urdf(data, "arm.urdf")
        for tip in moving_tips(read):
            import_urdf(read, None, tip, ImportOptions(snap="1e-6"))
    except DeriveError as error:
        return str(error)
    return ""
