"""Trees to and from URDF and MJCF, beside Pinocchio and MuJoCo, which read the same files on their own."""

import random
from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction

import mujoco
import numpy as np
import pinocchio as pin
import pytest

import derive
from derive.errors import DeriveError
from derive.exchange.file_tree import FileTree, agreement
from derive.exchange.formats import exported
from derive.exchange.from_tree import ImportedTree, import_tree, in_order
from derive.exchange.from_urdf import ImportOptions
from derive.exchange.reading.mjcf import IS_MJCF, read_mjcf
from derive.exchange.reading.urdf import read_urdf
from derive.robot.description import IDENTITY, Link, RootType
from derive.robot.expression import ZERO, Expression, add, number
from derive.robot.robot import Robot
from derive.robot.tree import ends
from derive.verification.oracle.functions import Oracle
from tests.exchange.urdfs import HALF, Array, J, body, turned, urdf
from tests.random_trees import random_tree

SEEDS = [pytest.param(seed, marks=[] if seed < 4 else pytest.mark.sweep) for seed in range(60)]
EARTH = (ZERO, ZERO, number("-9.81"))
Reader = Callable[[Array, Array, Array], tuple[dict[str, Array], Array]]


def rates(q: Array, qd: Array, *, local: bool) -> Array:
    """Of a free joint at x, y, z, yaw, pitch, roll: linear velocity, along own axes or the world's, and angular one."""
    yaw, pitch, roll = (turned(2 - k, q[3 + k]) for k in range(3))
    about = np.stack([(pitch @ roll).T[:, 2], roll.T[:, 1], np.eye(3)[0]], axis=1)
    return np.concatenate([(yaw @ pitch @ roll).T @ qd[:3] if local else qd[:3], about @ qd[3:6], qd[6:]])


def free(q: Array, *, local: bool) -> tuple[Array, Array]:
    """Place and quaternion x, y, z, w of a free joint, and its velocities by our rates."""
    rotation = turned(2, q[3]) @ turned(1, q[4]) @ turned(0, q[5])
    place = np.concatenate([q[:3], pin.Quaternion(rotation).coeffs()])
    return place, np.stack([rates(q, unit, local=local) for unit in np.eye(len(q))], axis=1).real


def gain(q: Array, qd: Array, qdd: Array, *, local: bool) -> Array:
    """Accelerations of a program's velocities."""
    return np.asarray(rates(q, qdd, local=local).real + rates(q + 1e-30j * qd, qd, local=local).imag / 1e-30)


def pinocchio(text: str, names: Sequence[str], ends: Sequence[str], floats: bool) -> Reader:
    """Ends, and torques by Newton and Euler; joints by their names, whatever the order of the program."""
    model = pin.buildModelFromXML(text, pin.JointModelFreeFlyer()) if floats else pin.buildModelFromXML(text)
    data, own = model.createData(), 6 * floats

    def _read(q: Array, qd: Array, qdd: Array) -> tuple[dict[str, Array], Array]:
        place, turn = free(q, local=True) if floats else (q[:0], np.eye(len(q)))
        v, a = (rates(q, qd, local=True).real, gain(q, qd, qdd, local=True)) if floats else (qd, qdd)
        full, (rate, accel) = pin.neutral(model), np.zeros((2, model.nv))
        full[: len(place)], rate[:own], accel[:own] = place, v[:own], a[:own]
        columns = list(range(own))
        for name, value, speed, more in zip(names, q[own:], v[own:], a[own:], strict=True):
            joint = model.joints[model.getJointId(name)]
            turns = [value] if joint.nq == 1 else [np.cos(value), np.sin(value)]
            full[joint.idx_q : joint.idx_q + joint.nq] = turns
            rate[joint.idx_v], accel[joint.idx_v] = speed, more
            columns.append(joint.idx_v)
        pin.framesForwardKinematics(model, data, full)
        frames = {end: data.oMf[model.getFrameId(end, pin.FrameType.BODY)].homogeneous for end in ends}
        return frames, turn.T @ pin.rnea(model, data, full, rate, accel)[columns]

    return _read


def mujocos(text: str, names: Sequence[str], ends: Sequence[str], floats: bool) -> Reader:
    """Ends, and torques, the same way."""
    model = mujoco.MjModel.from_xml_string(text)
    data, own = mujoco.MjData(model), 6 * floats

    def _read(q: Array, qd: Array, qdd: Array) -> tuple[dict[str, Array], Array]:
        place, turn = free(q, local=False) if floats else (q[:0], np.eye(len(q)))
        v, a = (rates(q, qd, local=False).real, gain(q, qd, qdd, local=False)) if floats else (qd, qdd)
        if floats:
            data.qpos[:7], data.qvel[:6] = place[[0, 1, 2, 6, 3, 4, 5]], v[:6]
            data.qacc[:6] = a[:6]
        columns = list(range(own))
        for name, value, speed, more in zip(names, q[own:], v[own:], a[own:], strict=True):
            joint = model.joint(name)
            data.qpos[joint.qposadr], data.qvel[joint.dofadr], data.qacc[joint.dofadr] = value, speed, more
            columns.append(int(joint.dofadr[0]))
        mujoco.mj_inverse(model, data)
        frames = {end: np.eye(4) for end in ends}
        for end, frame in frames.items():
            frame[:3, :3], frame[:3, 3] = data.body(end).xmat.reshape(3, 3), data.body(end).xpos
        return frames, turn.T @ data.qfrc_inverse[columns]

    return _read


def bare(robot: Robot, armature: Expression | None = None) -> Robot:
    """The tree with bodies that exist, without rotors, friction, limits, and armature where a format has none."""

    def _sound(link: Link) -> Link:
        more = {key: add(getattr(link.inertia, key), number(5)) for key in ("xx", "yy", "zz")}
        link = replace(link, inertia=replace(link.inertia, **more), motor=None, coulomb=ZERO, viscous=ZERO)
        return link if armature is None else replace(link, armature=armature)

    own = len(robot.root.variables) if robot.root else 0
    root = robot.root and replace(robot.root, link=_sound(robot.root.link or Link()))
    fixed = [replace(row, link=_sound(row.link)) if row.link else row for row in robot.fixed]
    base = IDENTITY if root and root.type is RootType.FLOATING else robot.base
    joints = tuple(replace(joint, limits=None) for joint in robot.joints)
    links = (*robot.links[:own], *map(_sound, robot.links[own:]))
    return replace(robot, joints=joints, links=links, fixed=tuple(fixed), root=root, base=base)


def worst(robot: Robot, read: Reader, links: Sequence[str]) -> float:
    """Largest difference of ends and of torques, relative, at three states."""
    oracle, source, found = Oracle.of(robot), np.random.default_rng(5), [0.0]
    for q, qd, qdd in source.uniform(-1.2, 1.2, (3, 3, robot.n)):
        frames, torque = read(q, qd, qdd)
        for name, link in zip(oracle.arm.ends, links, strict=True):
            pose = oracle.evaluate(f"forward_kinematics_{name}".rstrip("_"), q)
            found.append(np.abs(pose - frames[link]).max() / max(1, np.abs(pose).max()))
        expected = oracle.evaluate("inverse_dynamics", q, qd, qdd)
        found.append(np.abs(torque - expected).max() / max(1, np.abs(expected).max()))
    return float(max(found))


def floats(robot: Robot) -> bool:
    return robot.root is not None and robot.root.type is RootType.FLOATING


@pytest.mark.first(3)
@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("to", ["urdf", "mjcf"])
def test_other_programs_move_an_exported_tree_as_we_do_and_it_comes_back(to: str, seed: int) -> None:
    read = Robot.from_text(random_tree(random.Random(seed)).table.text)
    if not read.is_tree:
        pytest.skip("a chain")
    tree = bare(read, ZERO) if to == "urdf" else bare(read)
    tree = replace(tree, gravity=EARTH) if to == "urdf" else tree
    text, links = exported(tree, to).text, [end.name or "tool" for end in ends(tree)]
    names = [joint.label for joint in tree.joints][6 * floats(tree) :]
    reader = (pinocchio if to == "urdf" else mujocos)(text, names, links, floats(tree))
    assert worst(tree, reader, links) < 1e-10
    urdf = (read_urdf if to == "urdf" else read_mjcf)(text.encode(), "tree")
    back = import_tree(urdf, "floating" * floats(tree), links, ImportOptions(snap=0)).robot
    labels = [joint.label for joint in back.joints][6 * floats(tree) :]
    order = [*range(6 * floats(tree)), *(6 * floats(tree) + labels.index(name) for name in names)]
    ours, theirs = Oracle.of(tree), Oracle.of(back)

    def _same(q: Array, qd: Array, qdd: Array) -> tuple[dict[str, Array], Array]:
        values = [np.empty(tree.n) for _ in range(3)]
        for own, given in zip(values, (q, qd, qdd), strict=True):
            own[order] = given
        named = zip(links, theirs.arm.ends, strict=True)
        frames = {e: theirs.evaluate(f"forward_kinematics_{name}".rstrip("_"), values[0]) for e, name in named}
        return frames, theirs.evaluate("inverse_dynamics", *values)[order]

    assert ours.arm.n == theirs.arm.n
    assert worst(tree, _same, links) < 1e-10


STONE = body("1.7", "0.02 -0.01 0.05", "0.1 0.2 -0.3", "0.02 0.03 0.025 0.001 -0.002 0.003")
LEG = [J("0 0.1 0", axis="1 0 0"), J("0.05 0 0", axis="0 -1 0"), J("0 0 -0.2", f"0 0.1 {HALF}", "1 1 0")]
FOOT = J("0 0 -0.2", "0.3 -0.2 0.1", type="fixed")


def limbs(names: Sequence[str], start: J, *rows: J) -> list[J]:
    """The same limb several times, each turned a little further on the trunk."""
    found = [J(type="fixed", inertial=STONE, name="trunk_joint", link="trunk")]
    for k, name in enumerate(names):
        first = replace(start, xyz=f"{0.2 * k} 0.1 0", rpy=f"0 0.{k} 0.5", parent="trunk")
        found += [replace(j, name=f"{name}_j{i}", link=f"{name}_{i}") for i, j in enumerate([first, *rows])]
    return [
        replace(joint, inertial=STONE) if not joint.inertial and joint.type != "fixed" else joint for joint in found
    ]


THUMB = J("0 0 0.1", axis="0 0 -1", type="continuous", limit="")
ROBOTS = {
    "quadruped": limbs(("lf", "rf", "lh", "rh"), *LEG, FOOT),
    "hand": limbs(("thumb", "index", "ring"), THUMB, J("0.03 0 0", axis="0.3 -0.2 0.9", type="prismatic"), FOOT),
    "humanoid": [
        *limbs(("left", "right"), *LEG, FOOT),
        J("0 0 0.5", "0.2 0 0", "0 -1 0", name="neck", link="head-1", parent="trunk", inertial=STONE),
    ],
    "millipede": limbs([f"leg{k}" for k in range(24)], *LEG, FOOT),
}


def imported(text: str, root: str = "", *ends: str) -> ImportedTree:
    return import_tree(read_urdf(text.encode(), "robot.urdf"), root, ends)


@pytest.mark.first(2)
@pytest.mark.parametrize("root", ["", "floating"])
@pytest.mark.parametrize("name", ROBOTS)
def test_an_imported_tree_moves_as_pinocchio_says(name: str, root: str) -> None:
    text = urdf(ROBOTS[name], name)
    made = imported(text, root)
    names = [joint.label for joint in made.robot.joints][6 * bool(root) :]
    assert names == list(made.joints) == [j.name for j in ROBOTS[name] if j.type != "fixed"]
    assert (
        worst(made.robot, pinocchio(text, names, list(made.ends.values()), bool(root)), list(made.ends.values()))
        < 1e-10
    )
    assert max(made.agreement.position, made.agreement.inertia, made.agreement.torques) < 1e-13
    assert str(made.agreement) in made.text


def test_the_agreement_tells_a_robot_that_is_not_that_of_the_file() -> None:
    text = urdf(ROBOTS["hand"])
    file, made = read_urdf(text.encode(), "hand.urdf"), imported(text)
    tree, links = FileTree.of(file, in_order(file)[1], None), list(made.ends.values())
    heavy = replace(made.robot, links=(replace(made.robot.links[0], mass=number(2)), *made.robot.links[1:]))
    first = replace(made.robot.joints[0], theta=number("0.01"))
    turned = replace(made.robot, joints=(first, *made.robot.joints[1:]))
    assert agreement(tree, heavy, links).torques > 1e-7 > 1e-12 > agreement(tree, heavy, links).position
    assert agreement(tree, turned, links).rotation == pytest.approx(0.01)


@pytest.mark.parametrize("seed", [2, 25, 34, 57])
def test_rotors_of_a_tree_turn_in_mujoco_where_it_can_say_so(seed: int) -> None:
    read = Robot.from_text(random_tree(random.Random(seed)).table.text)
    links = (replace(b, motor=a.motor) for a, b in zip(read.links, bare(read).links, strict=True))
    tree = replace(bare(read), links=tuple(links))
    made, ours = exported(tree, "mjcf"), [end.name or "tool" for end in ends(tree)]
    names = [joint.label for joint in tree.joints][6 * floats(tree) :]
    assert not any("depends on q" in remark for remark in made.remarks)
    assert worst(tree, mujocos(made.text, names, ours, floats(tree)), ours) < 1e-10


def test_comments_before_the_robot_cost_no_time() -> None:
    assert not IS_MJCF.match(b"<!-- a -->\n" * 5000 + b"<robot/>")
    assert IS_MJCF.match(b"<?xml version='1.0'?>\n<!-- <robot> -->\n<mujoco>")


def test_ends_are_at_the_ends_of_limbs_or_those_that_are_named() -> None:
    camera = J("0 0 0.1", type="fixed", name="camera_joint", link="camera", parent="trunk")
    text = urdf([*ROBOTS["humanoid"], camera])
    made = imported(text)
    assert dict(made.ends) == {"left_3": "left_3", "right_3": "right_3", "head_1": "head-1"}
    assert [row.name for row in made.robot.fixed] == ["trunk_joint", "left_j3", "right_j3"]
    assert any("left out" in note and "camera" in note for note in imported(text, "floating").notes)
    assert dict(imported(text, "floating", "camera", "left_1").ends) == {"camera": "camera", "left_1": "left_1"}
    fingers = [replace(j, name=f"f{k}", parent="l0") for k, j in enumerate([J(link=f"end_{k}") for k in range(14)])]
    many = imported(urdf(fingers))
    assert len(many.ends) == 12
    assert any("14 ends, of which these are left out: end_12, end_13" in note for note in many.notes)
    (name,) = imported(urdf([J(link="pi")])).ends
    assert name == ""


def test_a_root_floats_that_a_floating_joint_moves() -> None:
    legs = [replace(joint, parent=joint.parent or "trunk") for joint in ROBOTS["humanoid"][1:]]
    free = J(type="floating", name="world_joint", link="trunk", inertial=STONE)
    stands = imported(urdf([replace(free, type="fixed"), *legs]), "floating", "head-1").robot
    made = imported(urdf([free, *legs])).robot
    assert made.root is not None
    assert made.root.type is RootType.FLOATING
    assert [joint.label for joint in made.joints] == [joint.label for joint in stands.joints]
    q, qd, qdd = np.random.default_rng(0).uniform(-1, 1, (3, made.n))
    one, other = (Oracle.of(robot).evaluate("inverse_dynamics", q, qd, qdd) for robot in (made, stands))
    assert np.abs(one - other).max() < 1e-12 * np.abs(other).max()


@pytest.mark.parametrize("root", ["", "floating"])
def test_joints_that_follow_others_are_coupled(root: str) -> None:
    heavy = body("2", "0.1 0.2 0.3")
    joints = [
        J(xyz="0 0 1", inertial=heavy),
        J(axis="0 1 0", xyz="0.5 0 0", inertial=heavy, more='<mimic joint="j1" multiplier="-0.5" offset="0.3"/>'),
        J(type="prismatic", axis="1 0 0", inertial=heavy, more='<mimic joint="j2" multiplier="0.2" offset="0.1"/>'),
        J(axis="0.6 0 0.8", rpy="0 1 0", inertial=heavy),
    ]
    robot = imported(text := urdf(joints), root).robot
    own = 6 * bool(root)
    s, offset = np.eye(own + 4)[:, [*range(own + 1), own + 3]], np.zeros(own + 4)
    s[own : own + 3, own], offset[own : own + 3] = (1, -0.5, -0.1), (0, 0.3, 0.16)
    read, oracle = pinocchio(text, ["j1", "j2", "j3", "j4"], ["l4"], bool(root)), Oracle.of(robot)
    q, qd, qdd = np.random.default_rng(1).uniform(-1, 1, (3, own + 2))
    frames, torque = read(s @ q + offset, s @ qd, s @ qdd)
    name = f"forward_kinematics_{robot.ends[0].name}" if root else "forward_kinematics"
    assert oracle.evaluate(name, q) == pytest.approx(frames["l4"], abs=1e-12)
    assert oracle.evaluate("inverse_dynamics", q, qd, qdd) == pytest.approx(torque @ s, abs=1e-10)


@pytest.mark.parametrize(
    ("joints", "root", "found"),
    [
        (
            [J(), J(more='<mimic joint="j3"/>')],
            "",
            r"robot.urdf:\d+.*joint 'j2' follows 'j3', which is none that moves",
        ),
        ([J(), *(J(more=f'<mimic joint="j{k}"/>') for k in (3, 2))], "", "joint 'j3' follows 'j2', in a circle"),
        ([J(), J(more='<mimic joint="j1" multiplier="0"/>')], "", "joint 'j2' follows by 0"),
        ([J(type="floating", xyz="0 0 1"), J()], "", "joint 'j1' is floating"),
        ([J(), J(type="floating")], "", "joint 'j2' is floating"),
        ([J(type="screw")], "", "joint 'j1' of type 'screw'"),
        ([J(type="fixed")], "", "no joint moves"),
        ([J(), J(link="l1b"), J(link="l1", parent="l1b")], "", "hangs on two joints|a second link"),
        ([J()], "flying", "--root 'flying'; allowed: planar, floating"),
        ([J()] * 257, "", "257 rows"),
    ],
)
def test_what_is_no_tree_of_rows_is_refused_by_name(joints: list[J], root: str, found: str) -> None:
    with pytest.raises(DeriveError, match=found):
        imported(urdf(joints), root)


MJCF = """<mujoco model="beetle"><compiler angle="degree"/><option gravity="1 0 -3"/>
<default><joint damping="0.5" armature="0.1"/></default><worldbody>{walls}
<body name="shell" pos="1 0 2"><freejoint/><inertial pos="0.1 0 0" mass="3" diaginertia="1 2 2.5" quat="1 2 3 4"/>
<body name="wing" pos="0 0.2 0.1" euler="20 -30 90"><joint name="flap" type="{kind}" axis="0 1 1" pos="0.1 0.2 0.3"
 range="0 50"/>
<joint name="slip" type="slide" axis="1 0 0" frictionloss="0.2"/><geom type="box" size="0.1 0.2 0.03" pos="0.1 0 0"/>
<body name="tip" pos="0.3 0 0"/></body>
<body name="leg" pos="0 -0.2 0"><joint name="step" axis="1 2 3" pos="0 0.1 0.2"/><geom size="0.1" pos="0 0 0.2"/></body>
</body></worldbody>{more}</mujoco>"""


@pytest.mark.parametrize("places", [{}, {"flap": "40", "slip": "-0.3", "step": "-200"}], ids=["at-zero", "at-ref"])
def test_an_mjcf_with_a_free_joint_and_bodies_by_shape_moves_as_in_mujoco(places: dict[str, str]) -> None:
    text = MJCF.format(
        kind="hinge", walls="", more='<actuator><motor joint="flap" ctrlrange="-4 4" gear="3"/></actuator>'
    )
    for name, ref in places.items():
        text = text.replace(f'joint name="{name}"', f'joint name="{name}" ref="{ref}"')
    made = import_tree(read_mjcf(text.encode(), "beetle.xml"))
    assert (made.robot.root and made.robot.root.type, dict(made.ends)) == (
        RootType.FLOATING,
        {"tip": "tip", "leg": "leg"},
    )
    flap = made.robot.joints[6]
    assert (flap.name, flap.torque, flap.limits and len(flap.limits)) == ("flap", number(12), 2)
    still = replace(made.robot, links=tuple(replace(link, viscous=ZERO, coulomb=ZERO) for link in made.robot.links))
    names = [joint.label for joint in still.joints][6:]
    text = text.replace('range="0 50"', "").replace('frictionloss="0.2"', "").replace('damping="0.5"', "")
    assert worst(still, mujocos(text, names, ["tip", "leg"], True), ["tip", "leg"]) < 1e-10


def test_joints_of_an_mjcf_follow_others_from_where_the_file_has_them() -> None:
    tie = '<equality><joint joint1="step" joint2="flap" polycoef="0.25 0.5 0 0 0"/></equality>'
    text = MJCF.format(kind="hinge", walls="", more=tie).replace('name="step"', 'name="step" ref="90"')
    read = read_mjcf(text.replace('name="flap"', 'name="flap" ref="180"').encode(), "beetle.xml")
    (step,) = (joint for joint in read.joints if joint.mimics)
    assert (step.name, step.mimics, float(step.multiplier)) == ("step", "flap", 0.5)
    assert abs(step.offset - Fraction(1, 4)) < 1e-14


BESIDE = """<worldbody><body name="door" pos="50 0 0"><joint/><joint axis="1 0 0"/><joint axis="0 1 0"/><geom size="1"/>
<body><joint/><geom size="1"/></body></body><body name="hand" mocap="true"/><body name="box" pos="0 50 0"><freejoint/>
<geom size="1"/><body name="lid"><joint/><geom size="1"/></body></body></worldbody>
<actuator><motor joint="flap"/></actuator>"""
HELD = """<tendon><fixed name="rope" stiffness="3"><joint joint="flap" coef="1"/><joint joint="step" coef="2"/></fixed>
</tendon><equality><tendon name="knot" tendon1="rope"/><weld name="grip" body1="shell" body2="hand"/></equality>"""
BOX = """<mujoco><worldbody><body name="box"><freejoint/><geom type="box" size="1 2 3" mass="6"/></body></worldbody>
</mujoco>"""


def test_of_several_robots_in_an_mjcf_that_with_most_motors_is_taken_and_what_is_left_out_is_named() -> None:
    text, scene = (MJCF.format(kind="hinge", walls="", more=more) for more in (BESIDE, BESIDE + HELD))
    made = derive.import_tree(scene.encode())
    assert [note for note in made.notes if note.startswith("not read")] == [
        "not read: bodies that move beside the robot: door, hand, box",
        "not read: tendons that act on joints: rope",
        "not read: equalities of tendons or flexes: knot",
        "not read: equalities to what is left out, or moved from outside: grip",
    ]
    still = replace(made.robot, links=tuple(replace(link, viscous=ZERO, coulomb=ZERO) for link in made.robot.links))
    text = text.replace('range="0 50"', "").replace('frictionloss="0.2"', "").replace('damping="0.5"', "")
    assert worst(still, mujocos(text, list(made.joints), ["tip", "leg"], True), ["tip", "leg"]) < 1e-10
    assert derive.import_tree(scene.encode(), ends=["lid"]).joints == ("joint9",)
    assert len(derive.import_tree(scene.encode(), ends=["door"]).joints) == 4


def test_a_free_body_without_joints_is_a_floating_root() -> None:
    made = derive.import_tree(BOX.encode())
    assert worst(made.robot, mujocos(BOX, [], ["box"], True), ["box"]) < 1e-10


@pytest.mark.parametrize(
    ("change", "found"),
    [
        ({"kind": "ball"}, "joint 'flap' is a ball"),
        (
            {"more": '<equality><joint name="tie" joint1="flap" joint2="slip" polycoef="0 1 2 0 0"/></equality>'},
            "equality 'tie'",
        ),
        ({"more": "<what/>"}, "MuJoCo: XML Error"),
    ],
)
def test_what_ties_joints_of_an_mjcf_is_refused(change: dict[str, str], found: str) -> None:
    with pytest.raises(DeriveError, match=found):
        read_mjcf(MJCF.format(**{"kind": "hinge", "walls": "", "more": ""} | change).encode(), "beetle.xml")
