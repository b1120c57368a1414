"""Coupled joints and closed loops move in other programs as ours do, by the equations that are written for them."""

import random
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from derive.errors import DeriveError
from derive.exchange.formats import exported
from derive.exchange.from_tree import import_tree
from derive.exchange.numeric import with_numbers
from derive.exchange.reading.mjcf import read_mjcf
from derive.exchange.reading.urdf import read_urdf
from derive.exchange.ties import joins, untied
from derive.inverse.loops import without_parallelograms
from derive.inverse.loops.linkage import linkage, positions
from derive.mechanics.space import exactly
from derive.robot.expression import number
from derive.robot.names import file_symbols
from derive.robot.robot import Robot
from derive.robot.writer import robot_text
from derive.verification.oracle.functions import Oracle
from derive.verification.samples import sample_sets
from tests.exchange.arms import dressed
from tests.exchange.test_trees import bare
from tests.random_trees import coupled
from tests.verification.oracle.test_loops import MECHANISMS, mechanism

mujoco = pytest.importorskip("mujoco")
HEAVY, OF_FILE = number(3), -1  # the latter instead of a seed
BUILT_IN = ("palletiser", "two-finger-gripper", "five-bar", "four-bar", "slider-crank")


def tied(name: str, seed: int) -> Robot:
    """A robot of numbers with bodies that exist."""
    if name in MECHANISMS and seed >= 0:
        return bare(mechanism(name, seed))
    if name == "coupled":
        rng = random.Random(seed)
        arm = dressed(rng.choice(["planar-3r", "kuka-kr5", "scara-perugia"]), calm=True)
        return coupled(rng, replace(arm, joints=tuple(replace(joint, sign=1) for joint in arm.joints)))[0]
    robot = Robot.load(name)
    missing = {
        s: number(f"0.{k % 7 + 2}") for k, s in enumerate(file_symbols(robot)) if s not in dict(robot.parameters)
    }
    made = with_numbers(robot, missing)
    heavy = tuple(replace(link, inertia=replace(link.inertia, xx=HEAVY, yy=HEAVY, zz=HEAVY)) for link in made.links)
    return bare(replace(made, links=heavy))


JOINED = {name: {join[2] for join in joins} for name, (_, *joins) in MECHANISMS.items()}
JOINED = {name: kinds for name, kinds in JOINED.items() if "prismatic" not in kinds}
LOOPS = ("four-bar", "slider-crank", *(name for name, kinds in JOINED.items() if "distance" not in kinds))
CASES = [pytest.param(name, OF_FILE, id=name) for name in BUILT_IN] + [
    pytest.param(name, seed, id=f"{name}-{seed}", marks=[] if seed < 1 else pytest.mark.sweep)
    for name in ("coupled", *JOINED)
    for seed in range(12)
]


@pytest.mark.parametrize(("name", "seed"), CASES)
@pytest.mark.first(4)
def test_mujocos_inertia_and_gravity_along_its_equalities_are_ours(name: str, seed: int) -> None:
    robot = without_parallelograms(tied(name, seed))
    model = mujoco.MjModel.from_xml_string(exported(robot, "mjcf").text)
    data, samples = mujoco.MjData(model), sample_sets(robot, 3, np.random.default_rng(abs(seed)))[0]
    with exactly():
        bare_robot, ties = untied(robot)
    labels = [joint.label for joint in bare_robot.joints]
    places = [int(model.joint(label).dofadr[0]) for label in labels]
    held = np.zeros((robot.dof, model.nv))  # the variables by the positions of the joints
    for row, variable in zip(held, robot.coupled, strict=True):
        own = {joint.label: 1.0 for joint in robot.joints if not joint.drive and joint.variable == variable.variable}
        for label, factor in (own or dict(ties.variables[variable.variable])).items():
            row[places[labels.index(label)]] = float(factor)
    full, _ = positions(robot, linkage(robot), list(samples.arguments["q"].T))
    for q, x in zip(samples.arguments["q"], np.transpose(full), strict=True):
        data.qpos[places] = x
        mujoco.mj_forward(model, data)
        jacobian, inertia = data.efc_J.reshape(-1, model.nv)[data.efc_type == 0], np.zeros((model.nv, model.nv))
        assert np.abs(data.efc_pos[data.efc_type == 0]).max(initial=0) < 1e-9
        for row, unit in zip(inertia, np.eye(model.nv), strict=True):
            mujoco.mj_mulM(model, data, row, unit)
        *_, rows = np.linalg.svd(jacobian)
        free = rows[np.linalg.matrix_rank(jacobian, 1e-9) :].T  # directions that the equalities allow
        slope = free @ np.linalg.inv(held @ free)
        wanted = {"inertia_matrix": slope.T @ inertia @ slope, "gravity_vector": slope.T @ data.qfrc_bias}
        for function, theirs in wanted.items():
            ours = samples.oracle.evaluate(function, q)
            assert np.abs(ours - theirs).max() < 1e-9 * max(1, np.abs(ours).max()), function


@pytest.mark.parametrize(
    ("name", "seed"), [case for case in CASES if case.values[0] in LOOPS and case.id != "five-bar"]
)
@pytest.mark.first(1)
def test_a_loop_comes_back_from_mjcf_in_its_branch_with_the_joints_that_have_motors_as_variables(
    name: str, seed: int
) -> None:
    robot = tied(name, seed)
    back = import_tree(read_mjcf(exported(robot, "mjcf").text.encode(), "loop")).robot
    assert [loop.by for loop in back.loops] == [loop.by for loop in robot.loops]
    ours, theirs = (sample_sets(each, 3, np.random.default_rng(abs(seed)))[0] for each in (robot, back))
    names = [next(j.label for j in robot.joints if j.variable == each.variable) for each in robot.coupled]
    order = [names.index(next(j.label for j in back.joints if j.variable == each.variable)) for each in back.coupled]
    given = [ours.arguments[name] for name in ("q", "qd", "qdd")]
    torques = ours.oracle.evaluate("inverse_dynamics", *given)[:, order]
    found = theirs.oracle.evaluate("inverse_dynamics", *(part[:, order] for part in given))
    assert np.abs(torques - found).max() < 1e-9 * np.abs(torques).max()


GEARED = """
name: geared
convention: standard
joints:
  - {type: revolute, name: one, q: u, a: 1/2, alpha: pi/2, limits: [-1, 2], torque: 7}
  - {type: revolute, name: two, theta: pi/3 - 3/2*u, a: 1/3, alpha: 1/5}
  - {type: prismatic, name: three, q: s, d: s + 1/4, theta: 1, a: 1/7}
  - {type: prismatic, name: four, d: u/8 - 1/9, alpha: -1, a: 1/6}
ends: {hand: {after: four}}
gravity: [0, 0, -9.81]
links:
  - {mass: 2, com: [1/9, 1/8, 1/7], inertia: {xx: 3, yy: 3, zz: 4}}
  - {mass: 3, com: [1/9, 0, 1/7], inertia: {xx: 3, yy: 2, zz: 4}}
  - {mass: 2, com: [0, 1/8, 1/7], inertia: {xx: 3, yy: 3, zz: 4}}
  - {mass: 1, com: [1/9, 1/8, 0], inertia: {xx: 3, yy: 2, zz: 4}}
"""


@pytest.mark.parametrize("to", ["urdf", "mjcf"])
def test_a_joint_that_follows_another_one_goes_out_and_comes_back(to: str) -> None:
    robot = Robot.from_text(GEARED)
    text = exported(robot, to).text
    back = import_tree((read_urdf if to == "urdf" else read_mjcf)(text.encode(), "geared"), "", ["hand"]).robot
    assert [str(each.variable) for each in back.variables] == ["q1", "q3"]
    assert back.variables[0].limits == robot.variables[0].limits
    ours, theirs, given = Oracle.of(robot), Oracle.of(back), np.random.default_rng(4).uniform(-1, 1, (3, 2))
    pose = theirs.evaluate("forward_kinematics", given[0])
    assert np.abs(ours.evaluate("forward_kinematics_hand", given[0]) - pose).max() < 1e-12
    torques = theirs.evaluate("inverse_dynamics", *given)
    assert np.abs(ours.evaluate("inverse_dynamics", *given) - torques).max() < 1e-11 * np.abs(torques).max()


def test_what_formats_cannot_say_of_ties_is_refused_or_told() -> None:
    with pytest.raises(DeriveError, match="wrist follows shoulder, elbow"):
        exported(tied("palletiser", OF_FILE), "urdf")
    with pytest.raises(DeriveError, match="by a slide"):
        exported(bare(mechanism("shaper", 0)), "mjcf")
    told = exported(tied("four-bar", OF_FILE), "urdf").remarks
    assert "a loop is closed: a joint (revolute) joins the frames loop1_first, loop1_second" in " ".join(told)
    told = exported(tied("palletiser", OF_FILE), "mjcf").remarks
    assert "the variable q3 is shoulder + elbow" in " ".join(told)


def test_the_keyframe_of_a_loop_on_a_floating_root_is_closed() -> None:
    stone = "{mass: 9, inertia: {xx: 1, yy: 1, zz: 1}}"
    text = robot_text(tied("four-bar", OF_FILE)).replace("ends:", f"root: {{type: floating, link: {stone}}}\nends:")
    model = mujoco.MjModel.from_xml_string(exported(Robot.from_text(text), "mjcf").text)
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_forward(model, data)
    assert model.nq == 10
    assert np.abs(data.efc_pos[data.efc_type == 0]).max() < 1e-9


def test_only_equalities_of_two_joints_are_read_from_an_mjcf() -> None:
    hinge = '<body{1}><joint name="{0}"/><geom size="1"/></body>'
    text = (
        "<mujoco><worldbody>"
        + hinge.format("a", "")
        + hinge.format("b", ' name="tip"')
        + "</worldbody><equality>{}</equality></mujoco>"
    )
    pair = '<joint joint1="a" joint2="b" polycoef="{}"/>'
    for rows, found in {
        pair.format("0 1 1 0 0"): "no linear function of another one",
        '<joint joint1="a"/>': "no linear function of another one",
        2 * pair.format("0 1 0 0 0"): "a has one already",
    }.items():
        with pytest.raises(DeriveError, match=found):
            read_mjcf(text.format(rows).encode(), "pair.xml")
    held = text.format('<connect body1="body1" body2="tip" anchor="0 0 1"/>').replace("<body>", '<body name="body1">')
    with pytest.raises(DeriveError, match="no motor drives a joint of the loops, a, b"):
        import_tree(read_mjcf(held.encode(), "pair.xml"))
    twice = held.replace("</equality>", '<connect body1="body1" body2="tip" anchor="0 0 1"/></equality>')
    with pytest.raises(DeriveError, match="no motor drives"):  # the same point again is no second one
        import_tree(read_mjcf(twice.encode(), "pair.xml"))
    points = "".join(f'<connect body1="body1" body2="tip" anchor="{at}"/>' for at in ("0 0 1", "0 1 0", "1 0 0"))
    read = read_mjcf(text.format(points).replace("<body>", '<body name="body1">').encode(), "pair.xml")
    with pytest.raises(DeriveError, match="3 points connect body1, tip, which are not on one line"):
        list(joins(read, read.joints, Fraction(0)))
    loose = text.format(pair.format("0 1 0 0 0").replace("/>", ' active="false"/>'))
    assert "equality" in read_mjcf(loose.encode(), "pair.xml").notes[0]
