"""Robots from URDF, from Python."""

import re
from dataclasses import replace
from pathlib import Path
from unittest import mock

import numpy as np
import pytest

import derive
from derive.api.importing import import_all, import_urdf, verify_import
from derive.errors import DeriveError, RobotFileError, VerificationError
from derive.exchange.from_urdf import snap_of
from derive.model.identification.witness import NoSuchBodies
from derive.robot.description import End
from derive.robot.expression import ZERO, to_text
from derive.robot.robot import Robot
from derive.verification.oracle.functions import Oracle
from tests.exchange.urdfs import HALF, J, Reading, body, pose, urdf

TORSO = [
    J("0 0 1", axis="0 0 1", link="torso"),
    J("0 0.2 0", "1.57 0 0", link="left", inertial=body("2", "0.1 0 0", moments="0.1 0.1 0.1 0 0 0")),
    J("0.3 0 0", "0 0.2 0", link="left_hand"),
    J("0 -0.2 0", "-1.57 0 0", link="right", parent="torso"),
    J("0.3 0 0", "0 0.2 0", link="right_hand"),
    J("0 0 0", type="floating", link="head", parent="torso"),
]


@pytest.fixture
def torso(tmp_path: Path) -> Path:
    path = tmp_path / "torso.urdf"
    path.write_text(urdf(TORSO, name="torso"))
    return path


def test_lengths_have_names_on_request(torso: Path, tmp_path: Path) -> None:
    file = tmp_path / "named.yaml"
    named = import_urdf(torso, tip="left_hand", symbols=True, inertia="possible", folder=tmp_path)
    plain = derive.Robot.from_urdf(torso, tip="left_hand")
    assert type(plain) is derive.Robot
    values = dict(named.robot.parameters)
    for i, (joint, row) in enumerate(zip(named.robot.joints, plain.joints, strict=True), 1):
        for key in ("d", "a"):
            cell, number = getattr(joint, key), getattr(row, key)
            assert to_text(cell) == ("0" if number == ZERO else f"{key}{i}")
            assert values.get(f"{key}{i}", number) == number
    assert {"d1", "g"} < set(values)
    q = (0.3, -0.4, 1.1)
    assert np.abs(pose(named.robot, q) - pose(plain, q)).max() < 1e-15
    tau, wanted = (Oracle.of(robot).evaluate("inverse_dynamics", q, q, q) for robot in (named.robot, plain))
    assert np.abs(tau - wanted).max() < 1e-12
    file.write_text(named.text)
    checked = verify_import(file)
    assert checked.found == named.certificate.printed


def test_the_snap_that_takes_cut_off_angles_is_named_with_its_price(tmp_path: Path) -> None:
    file = tmp_path / "arm.urdf"
    file.write_text(urdf([J("0 0 0.5"), J("0 0 0.3", "1.5708 0 0"), J("0.4 0 0")]))
    (hint,) = (note for note in import_urdf(file).notes if "almost" in note)
    found = re.fullmatch(r"1\.5708 \(joint .*\): almost .*; --snap (\S+) would .* by up to (\S+) m and (\S+) rad", hint)
    wider = import_urdf(file, snap=found[1])
    assert to_text(wider.robot.joints[0].alpha) == "pi/2"
    assert wider.certificate.position == pytest.approx(float(found[2]), rel=0.1)
    assert wider.certificate.rotation == pytest.approx(float(found[3]), rel=0.1)
    assert not any("almost" in note for note in (*wider.notes, *import_urdf(file, snap=0).notes))


def test_every_tip_gets_an_arm_or_a_reason(torso: Path) -> None:
    found = import_all(torso)
    assert [arm.robot.name for arm in found.arms] == ["torso-left-hand", "torso-right-hand"]
    assert "is floating" in found.refused["head"]


def test_a_joint_that_urdf_does_not_have_refuses_the_chains_through_it_alone() -> None:
    ball = J("0 0.1 0", "0.2 0 0", type="ball", link="toe", parent="left_hand", inertial=body("1", "0 0 0.1"))
    found = import_all(urdf([*TORSO, ball], name="torso").encode())
    assert [arm.robot.name for arm in found.arms] == ["torso-right-hand"]
    assert "<stdin>:41" in found.refused["toe"]
    assert "of type 'ball'" in found.refused["toe"]
    assert any("of type 'ball' (line 41)" in note for note in found.arms[0].notes)
    left, fixed = (
        import_urdf(urdf([*TORSO, replace(ball, type=kind)]).encode(), tip="left_hand") for kind in ("ball", "fixed")
    )
    assert left.robot == replace(fixed.robot, digest=left.robot.digest, comments=left.robot.comments)
    assert any(re.fullmatch(r"held at zero: .*\bj7\b.*", note) for note in left.notes)


@pytest.mark.parametrize("mass", ["-2", "-40", "0"])
def test_a_negative_mass_is_taken_where_bodies_that_exist_have_its_torques(mass: str) -> None:
    """The first link turns about an upright axis, which knows its moment of inertia alone."""
    pytest.importorskip("clarabel")
    first = J("0 0 0.3", inertial=body(mass, moments="0.5 0.5 0.4 0 0 0"))
    second = J("0.2 0 0", f"{HALF} 0 0", inertial=body("2", "0.1 0 0", moments="0.1 0.1 0.1 0 0 0"))
    text = urdf([first, second]).encode()
    if mass.startswith("-"):
        with pytest.raises(RobotFileError, match=f"'l1' .* weigh {mass} kg; .*--inertia possible"):
            import_urdf(text)
    found = import_urdf(text, inertia="possible")
    heavy = urdf([replace(first, inertial=body("3", moments="0.5 0.5 0.4 0 0 0")), second])
    state = np.random.default_rng(2).uniform(-2, 2, (3, 2))
    torque = Oracle.of(found.robot).evaluate("inverse_dynamics", *state)
    assert np.abs(torque - Reading(heavy, ("j1", "j2")).torque(*state)).max() < 1e-12
    assert not any(remark.is_of_bodies for remark in found.robot.remarks)


def test_a_negative_mass_that_torques_notice_is_refused_with_a_witness() -> None:
    pytest.importorskip("clarabel")
    text = urdf([J("0 0 1", type="prismatic", inertial=body("-2"))], name="lift").encode()
    with pytest.raises(NoSuchBodies, match="lift: no bodies have these torques"):
        import_urdf(text, inertia="possible")
    with pytest.raises(RobotFileError, match="no bodies have these torques"):
        import_all(text, inertia="possible")


def test_a_chain_may_go_up_the_tree_first(torso: Path) -> None:
    robot = import_urdf(torso, base="left_hand", tip="right_hand").robot
    reading = Reading(torso.read_text(), ("j1", "j2", "j3", "j4", "j5"))
    q = np.random.default_rng(1).uniform(-1, 1, 4)
    q_of_file = np.array([0.3, q[1], q[0], q[2], q[3]])
    wanted = reading.pose(q_of_file, "right_hand", "left_hand")
    assert np.abs(pose(robot, q) - wanted).max() < 1e-12


@pytest.mark.parametrize(
    ("options", "found"),
    [
        ({}, "left_hand, right_hand, head"),
        ({"tip": "left_hnd"}, "did you mean 'left_hand'"),
        ({"tip": "head"}, "is floating"),
        ({"tip": "left_hand", "base": "left_hand"}, "no joint moves between"),
        ({"tip": "left_hand", "convention": "modifed"}, "did you mean 'modified'"),
        ({"tip": "left_hand", "snap": "2"}, "a number from 0 to 0.1"),
        ({"tip": "left_hand", "name": "My Arm"}, "is not a robot name"),
    ],
)
def test_wrong_wishes_are_refused_with_what_is_allowed(torso: Path, options: dict[str, str], found: str) -> None:
    with pytest.raises(DeriveError, match=found) as refused:
        import_urdf(torso, **options)
    assert "\n" not in str(refused.value)


def test_a_snap_that_moves_the_arm_too_far_is_refused_with_one_that_does_not() -> None:
    text = urdf([J(), J("0.5 0 0", "0.3 0 0"), J("0.5 0.5 0", type="fixed")]).encode()
    with pytest.raises(
        RobotFileError, match=r"by up to 0\.\d+ m; allowed: at most 1% of the reach, 0.012 m"
    ) as refused:
        import_urdf(text, snap="0.05")
    assert refused.value.remedy.startswith("write --snap ")
    assert import_urdf(text, snap=refused.value.remedy.split()[-1]).certificate.position < 0.012


def test_what_a_file_promises_is_tested_again(torso: Path, tmp_path: Path) -> None:
    (tmp_path / "robots").mkdir()
    path = tmp_path / "robots" / "left.yaml"
    text = import_urdf(torso, tip="left_hand", folder=path.parent).text
    path.write_text(text)
    check = verify_import(path)
    assert check.found == check.promised
    assert not check.changed

    named = text.replace("d: 1.5100468643017033", "d: far")
    path.write_text(named.replace("parameters:", "parameters:\n  far: 1.5100468643017033"))
    assert verify_import(path) == check

    path.write_text(text.replace("d: 1.51004", "d: 1.51005"))
    with pytest.raises(VerificationError, match=r"1e-05 m|e-05 m"):
        verify_import(path)

    turning = r"type: revolute, q: q2, theta: q2[^,]*, d: (\S+),"
    slide, count = re.subn(turning, r"type: prismatic, q: q2, theta: 0, d: q2 + \1,", text)
    assert count == 1
    path.write_text(slide)
    with pytest.raises(VerificationError, match=r"joints RPR?, but those of .* are RRR?"):
        verify_import(path)

    path.write_text(text)
    with mock.patch.dict("sys.modules", {"lxml": None}):
        check = verify_import(path)
    assert "lxml" in str(check)
    assert check.found is None
    torso.write_text(torso.read_text().replace("0.3 0 0", "0.31 0 0"))
    with pytest.raises(VerificationError, match="promised"):
        verify_import(path)

    torso.unlink()
    check = verify_import(path)
    assert check.found is None
    assert "not tested" in str(check)


def test_an_arm_that_has_become_a_tree_is_not_tested(
    torso: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "left.yaml"
    path.write_text(import_urdf(torso, tip="left_hand", folder=tmp_path).text)
    robot = Robot.load(path)
    tree = replace(robot, ends=(End("hand", robot.joints[-1].label, robot.tool),))
    monkeypatch.setattr(Robot, "from_text", lambda text, source: tree)
    check = verify_import(path)
    assert check.found is None
    assert "its arm has become a tree, so the promised pose error was not tested" in str(check)


def test_the_promise_holds_for_the_table_in_the_other_convention(torso: Path, tmp_path: Path) -> None:
    """The head of the file is kept by `derive convert`."""
    path = tmp_path / "left.yaml"
    path.write_text(import_urdf(torso, tip="left_hand", folder=tmp_path).text)
    derive.convert(path, "modified", tmp_path / "modified.yaml")
    check = verify_import(tmp_path / "modified.yaml")
    assert check.found is not None


def test_robots_that_were_not_imported_promise_nothing() -> None:
    assert verify_import("scara-perugia") is None


def test_gravity_is_that_of_the_root_wherever_the_chain_begins(tmp_path: Path) -> None:
    """Seen from a link that lies on its side."""
    heavy = body("2", "0.1 0.2 0.3", moments="0.1 0.1 0.1 0 0 0")
    text = urdf([J(rpy=f"{HALF} 0 0", type="fixed", link="side"), J("0 0 1", "0.3 0 0", inertial=heavy)])
    robot = import_urdf(text.encode(), base="side").robot
    torque = Oracle.of(robot).evaluate("gravity_vector", [0.4])
    assert torque == pytest.approx(Reading(text, ["j2"]).torque(np.array([0.4]), np.zeros(1), np.zeros(1)))
    assert [to_text(cell) for cell in robot.gravity or ()] == ["0", "-g", "0"]


def test_a_snap_is_read_exactly() -> None:
    assert snap_of("1e-6") * 10**6 == 1
    with pytest.raises(DeriveError):
        snap_of("nan")
