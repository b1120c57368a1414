"""Files that mean harm, or none: refused or right, in time, with one message."""

from __future__ import annotations

import random
import time

import pytest

from derive.errors import DeriveError, RobotFileError
from derive.exchange.arm import moving_tips
from derive.exchange.from_urdf import ImportOptions, import_urdf
from derive.exchange.read_urdf import read_urdf
from tests.exchange.urdfs import J, body, urdf

GOOD = urdf([J("0 0 0.3", inertial=body("2")), J("0.3 0 0", "1.57 0 0", more='<dynamics damping="0.1"/>')])


BOMB = (
    '<!DOCTYPE x [<!ENTITY a0 "xxxxxxxxx">'
    + "".join(f'<!ENTITY a{k} "{f"&a{k - 1};" * 9}">' for k in range(1, 21))
    + ']><robot name="&a20;"/>'
)


def chain(count: int, kind: str) -> str:
    """A long one."""
    return urdf([J(type=kind, limit="") for _ in range(count)])


@pytest.mark.parametrize(
    ("text", "found"),
    [
        (
            '<!DOCTYPE x [<!ENTITY a "' + "x" * 99 + '"><!ENTITY b "' + "&a;" * 9999 + '">]><robot name="&b;"/>',
            "document",
        ),
        (BOMB, "document"),
        ('<!DOCTYPE x [<!ENTITY a SYSTEM "file:///etc/passwd">]><robot><link name="&a;"/></robot>', "document"),
        ("<robot>" + '<link name="a"/>' * 250_000 + "</robot>", "tags"),
        ('<robot name="' + "a" * 17_000_000 + '"/>', "bytes"),
        ("<robot>" + "<a>" * 3000 + "</a>" * 3000 + "</robot>", "no XML"),
        (chain(3000, "fixed"), "no joint moves"),
        (chain(65, "revolute"), "65 joints move"),
        (urdf([J("1e999999999999 0 0")]), "is no number"),
        (urdf([J("0 0 1e61")]), "is no number"),
        (urdf([J(inertial=body("-1"))]), "weigh -1 kg"),
        (
            urdf(
                [
                    J(),
                    J("0 0.1 0", "3.14 0 0"),
                    J("0.4 0.1 1e23", "3.1415 0 0"),
                    J("0.4 0 0.1", "1.57 0 0.4"),
                    J("1 0 2"),
                ]
            ),
            "joint 'j.': so far",
        ),
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


@pytest.mark.parametrize("seed", range(300))
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
