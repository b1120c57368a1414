"""Programs of trees: operations and base parameters beside SYMORO's, and that a chain is a tree without branches."""

import math
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
import yaml

from derive.model.identification.base_parameters import base_set
from derive.programs.build import build_program
from derive.programs.program import Function
from derive.robot import tree
from derive.robot.inertial_parameters import FRICTION_PARTS
from derive.robot.robot import Robot
from tests.random_robots import sampled

TREES: Mapping[str, Any] = yaml.safe_load(Path(__file__).with_name("trees.yaml").read_text(encoding="utf-8"))
LINK = (
    "{{mass: m{0}, com: [cx{0}, cy{0}, cz{0}], inertia: {{xx: Ixx{0}, yy: Iyy{0}, zz: Izz{0}, xy: Ixy{0}, xz: Ixz{0}, "
    "yz: Iyz{0}}}, armature: ia{0}, friction: {{viscous: fv{0}, coulomb: fs{0}}}}}"
)


@cache
def robot_of(name: str) -> Robot:
    rows, links = [], []
    for j, (q, after, gamma, b, alpha, d, rest) in enumerate(TREES[name]["rows"], start=1):
        kind, other = ("prismatic", "theta") if q.startswith("r") else ("revolute", "d")
        stand = f"after: {after}, gamma: {gamma}, b: {b}"
        rows.append(f"  - {{type: {kind}, q: {q}, {stand}, alpha: {alpha}, a: {d}, {other}: {rest}}}")
        links.append(f"  - {LINK.format(j)}")
    head = f"name: {name}\nconvention: modified\ngravity: [0, 0, -g]\nends: {{tip: {TREES[name]['rows'][-1][0]}}}\n"
    return Robot.from_text("\n".join([f"{head}joints:", *rows, "links:", *links]) + "\n")


@pytest.mark.parametrize("name", TREES)
@pytest.mark.first(2)
def test_operations_beside_those_of_symoro(name: str) -> None:
    wanted = {function: TREES[name][function]["derive"] for function in ("inverse_dynamics", "inertia_matrix")}
    counts = {f.name: f.operations for f in build_program(robot_of(name), names={*wanted})}
    assert {function: count.mul + count.add + count.div for function, count in counts.items()} == wanted
    assert all(wanted[function] < TREES[name][function]["symoro"] for function in wanted)


def rank(name: str) -> int:
    """Of Pinocchio's regressor and of the columns of armatures, at random states."""
    rows, rng, model = TREES[name]["rows"], np.random.default_rng(0), pin.Model()
    words = set("".join(c if c.isalnum() else " " for c in str(rows)).split()) - {"pi", "cos", "sin", "base"}
    values = {word: float(rng.uniform(0.3, 1.2)) for word in sorted(words) if not word.isdigit()}
    joints = {"base": 0}
    for q, after, *cells in rows:
        gamma, b, alpha, d, rest = (eval(str(cell), {**vars(math), **values}) for cell in cells)
        turn, slides = pin.utils.rotate("z", gamma), q.startswith("r")
        place = pin.SE3(turn, np.array([0, 0, b])) * pin.SE3(pin.utils.rotate("x", alpha), np.array([d, 0, 0]))
        place *= pin.SE3(pin.utils.rotate("z", rest * slides), np.array([0, 0, rest * (not slides)]))
        joints[q] = model.addJoint(joints[after], pin.JointModelPZ() if slides else pin.JointModelRZ(), place, q)
    states, data = rng.uniform(-2, 2, (60, 3, model.nv)), model.createData()
    torques = [pin.computeJointTorqueRegressor(model, data, *state) for state in states]
    columns = np.hstack([np.vstack(torques), np.vstack([np.diag(qdd) for _, _, qdd in states])])
    return int(np.linalg.matrix_rank(columns, 1e-9))


@pytest.mark.parametrize("name", TREES)
def test_base_parameters_are_as_many_as_those_of_symoro_and_the_rank_of_pinocchio_s_regressor(name: str) -> None:
    found = base_set(robot_of(name))
    bodies = [parameter for parameter in found.parameters if parameter.part not in FRICTION_PARTS]
    assert (len(bodies), rank(name), found.proven) == (TREES[name]["base_parameters"],) * 2 + (True,)


CHAINS = ("planar-2r-perugia", "scara-perugia", "stanford-deluca", "puma560-corke")


@pytest.mark.parametrize("name", sampled(CHAINS, CHAINS[:2]))
def test_a_chain_is_a_tree_without_branches(name: str) -> None:
    """Every function is the same tape, that of link transforms apart, which counts on nothing between the rows."""
    chain_, branches = Robot.load(name), tree.explicit(Robot.load(name))
    assert (chain_.is_tree, branches.is_tree, tree.plain(branches)) == (False, True, chain_)
    program, other = ({f.name: f for f in build_program(robot)} for robot in (chain_, branches))
    assert {*program} - {*other} <= {"task_inertia"}
    assert [name for name in other if name != "link_transforms" and other[name] != program[name]] == []


def test_a_file_that_says_what_goes_without_saying_is_the_file_that_does_not() -> None:
    head = "name: arm\nconvention: standard\njoints:\n"
    plain = ["{type: revolute, a: a1}", "{type: prismatic, q: s, alpha: pi/2}", "{type: revolute, name: wrist, d: d3}"]
    unit = "[[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]"
    said = [
        f"{row[:-1]}, after: {after}, mount: {unit}}}" for row, after in zip(plain, ("base", "q1", "s"), strict=True)
    ]
    texts = (head + "".join(f"  - {row}\n" for row in rows) for rows in (plain, said))
    one, other = (Robot.from_text(text) for text in texts)
    assert (one.joints, one.is_tree) == (other.joints, other.is_tree)
    assert build_program(one) == build_program(other)


def test_joints_of_different_branches_and_off_the_way_to_an_end_cost_nothing() -> None:
    robot = Robot.load("two-armed-torso")
    wanted, (left, right) = ("forward_kinematics", "jacobian", "jacobian_end"), robot.ends
    program = {f.name: f for f in build_program(robot, names={*wanted, "inertia_matrix"})}
    ways = {end.name: tree.arm(robot, end.name) for end in (left, right)}
    only = {name: {*places} - {0} for name, (_, places) in ways.items()}
    rows = zeros(program["inertia_matrix"])
    assert {(i, j) for i in only["left"] for j in only["right"]} <= {divmod(k, robot.n) for k in rows}
    for name, (arm, places) in ways.items():
        assert {k % robot.n for k in zeros(program[f"jacobian_{name}"])} >= {*range(robot.n)} - {*places}
        for function in build_program(arm, names={*wanted}):
            assert program[f"{function.name}_{name}"].operations.total <= function.operations.total


def zeros(function: Function) -> list[int]:
    """Places of outputs that are the number 0."""
    nodes = [function.tape.nodes[output.node] for output in function.tape.outputs]
    return [k for k, node in enumerate(nodes) if node.value == 0]
