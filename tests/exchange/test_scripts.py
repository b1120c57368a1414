"""Scripts for other programs, run: the same poses."""

import csv
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import pytest

from derive.exchange.body_chain import body_chain
from derive.exchange.formats import exported
from derive.exchange.scripts import script_text
from derive.mechanics.space import exactly
from derive.programs.build import build_program
from derive.programs.optimise.search_policy import Effort
from derive.robot.expression import number
from derive.robot.robot import Robot
from derive.robot.task_rows import task_rows
from derive.targets.escape import matlab_package
from derive.verification.generated import OCTAVE_OPTIONS, find_octave
from derive.verification.oracle.functions import Oracle
from tests.exchange.arms import EVERY, FEW, dressed, numeric, uneven
from tests.targets.generated_models import needs_octave, numpy_model

STAND_INS = Path(__file__).parent / "octave"


def toolbox(monkeypatch: pytest.MonkeyPatch) -> None:
    """The names that a script imports, which keep what they are given."""
    module, matrices = ModuleType("roboticstoolbox"), ModuleType("spatialmath")
    for name in ("RevoluteDH", "PrismaticDH", "RevoluteMDH", "PrismaticMDH"):
        setattr(module, name, lambda name=name, **cells: SimpleNamespace(kind=name, cells=cells))
    module.DHRobot = lambda links, **more: SimpleNamespace(links=links, **more)  # type: ignore[attr-defined]
    matrices.SE3 = lambda matrix, check: matrix  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "roboticstoolbox", module)
    monkeypatch.setitem(sys.modules, "spatialmath", matrices)


def run_script(text: str) -> Any:
    names: dict[str, Any] = {"__name__": "arm"}
    exec(text, names)  # the script is ours
    return names["robot"]


def link_pose(link: Any, q: float) -> np.ndarray:
    cells = {"d": 0.0, "theta": 0.0, "offset": 0.0} | link.cells
    moved = q + cells["offset"]
    theta, d = (moved, cells["d"]) if link.kind.startswith("Revolute") else (cells["theta"], moved)
    c, s, ca, sa = np.cos(theta), np.sin(theta), np.cos(cells["alpha"]), np.sin(cells["alpha"])
    z = np.array([[c, -s, 0, 0], [s, c, 0, 0], [0, 0, 1, d], [0, 0, 0, 1]])
    x = np.array([[1, 0, 0, cells["a"]], [0, ca, -sa, 0], [0, sa, ca, 0], [0, 0, 0, 1]])
    return x @ z if link.kind.endswith("MDH") else z @ x


@pytest.mark.parametrize("name", EVERY)
def test_the_python_script_makes_the_same_arm(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    toolbox(monkeypatch)
    robot = numeric(name)
    made, q = run_script(exported(robot, "rtb").text), np.linspace(-1, 1.3, robot.n)
    pose = getattr(made, "base", np.eye(4))
    for link, value in zip(made.links, q, strict=True):
        pose = pose @ link_pose(link, value)
    pose = pose @ getattr(made, "tool", np.eye(4))
    assert np.abs(pose - Oracle.of(robot).evaluate("forward_kinematics", q)).max() < 1e-12


def test_motors_are_on_their_side_of_the_gear(monkeypatch: pytest.MonkeyPatch) -> None:
    toolbox(monkeypatch)
    robot = uneven(dressed("planar-2r-perugia", rotors=True, coulomb=True))
    arm, made = Oracle.of(robot).arm, run_script(exported(robot, "rtb").text)
    for i, link in enumerate(made.links):
        cells, ratio = link.cells, arm.ratio[i]
        assert cells["G"] == pytest.approx(ratio, rel=1e-15)
        assert cells["Jm"] * ratio**2 == pytest.approx(arm.rotor_inertia[i] * ratio**2 + arm.armature[i], rel=1e-14)
        assert cells["B"] * ratio**2 == pytest.approx(arm.viscous[i], rel=1e-14)
        assert cells["Tc"][0] * abs(ratio) == pytest.approx(arm.coulomb[0, i], rel=1e-14)
        assert cells["Tc"][1] * abs(ratio) == pytest.approx(-arm.coulomb[1, i], rel=1e-14)
    assert all(link.cells["I"].shape == (3, 3) for link in made.links)  # the toolbox takes no lists
    assert made.links[0].cells["m"] == pytest.approx(arm.mass[0] + arm.rotor_mass[1], rel=1e-15)
    assert made.gravity == [0.3, -9.1, -2.7]


def test_reversed_joints_are_turned_around_and_named() -> None:
    made = exported(dressed("skeleton-modified"), "rtb")
    assert "flip" not in made.text
    assert any(remark.startswith("DHRobot takes reversed joints for poses alone") for remark in made.remarks)
    assert not any("reversed" in remark for remark in exported(dressed("skeleton-modified"), "rigidbodytree").remarks)


@pytest.mark.parametrize(("template", "mark"), [("rtb.py", "#"), ("corke.m", "%"), ("rigidbodytree.m", "%")])
def test_what_a_file_says_first_is_in_comments(template: str, mark: str) -> None:
    with exactly():
        text = script_text(f"exchange/{template}.jinja", body_chain(numeric("planar-2r-perugia")), ["one", "two words"])
    assert f"{mark} one\n{mark} two words\n" in text


def test_what_the_toolboxes_compute_otherwise_is_named() -> None:
    robot = dressed("stanford-deluca")
    shifted = replace(robot.joints[2], d=number("0.1"))
    remarks = exported(replace(robot, joints=(*robot.joints[:2], shifted, *robot.joints[3:])), "rtb").remarks
    assert "rne_python takes no offset of q3; rne does" in remarks
    sliding = exported(dressed("skeleton-root"), "corke").remarks
    assert any("where the first joint slides" in remark for remark in sliding)


@pytest.mark.toolbox
@pytest.mark.parametrize("name", EVERY)
@pytest.mark.usefixtures("roboticstoolbox")
def test_the_toolbox_itself_makes_the_same_arm(name: str) -> None:
    robot = numeric(name)
    made, oracle = run_script(exported(robot, "rtb").text), Oracle.of(robot)
    for q in np.random.default_rng(3).uniform(-3, 3, (5, robot.n)):
        assert np.abs(made.fkine(q).A - oracle.evaluate("forward_kinematics", q)).max() < 1e-12
    robot = uneven(dressed(name, coulomb=True))
    made, oracle = run_script(exported(robot, "rtb").text), Oracle.of(robot)
    for states in np.random.default_rng(4).uniform(-1, 1, (2, 3, robot.n)):
        expected = oracle.evaluate("inverse_dynamics", *states)
        assert np.abs(made.rne_python(*states) - expected).max() < 1e-12 * np.abs(expected).max()


SPATIAL = [name for name in EVERY if len(task_rows(Robot.load(name))) == 6 and Robot.load(name).n <= 7]


@pytest.mark.toolbox
@pytest.mark.parametrize("name", SPATIAL)
@pytest.mark.usefixtures("roboticstoolbox")
def test_the_toolbox_has_the_same_manipulability_hessian_and_inertia_of_the_task(name: str) -> None:
    """Its inertia is in rates of angles, A J; of seven joints it takes a pseudo-inverse of J and is not compared."""
    robot = dressed(name)
    made, model = run_script(exported(robot, "rtb").text), numpy_model(robot, build_program(robot, Effort.QUICK))
    for q in np.random.default_rng(5).uniform(-1.5, 1.5, (5, robot.n)):
        w, to_rates = made.manipulability(q), made.jacob0_analytical(q, "rpy/xyz") @ np.linalg.pinv(made.jacob0(q))
        pairs = {
            "manipulability": w,
            "manipulability_position": made.manipulability(q, axes="trans"),
            "manipulability_orientation": made.manipulability(q, axes="rot"),
            "manipulability_dq": made.jacobm(q).ravel(),
            "jacobian_hessian": np.moveaxis(made.hessian0(q), 0, -1),
            "task_inertia": to_rates.T @ made.inertia_x(q) @ to_rates,
        }
        for function, wanted in list(pairs.items())[: 6 if robot.n == 6 else 5]:
            assert np.abs(getattr(model, function)(q) - wanted).max() < 1e-9 * max(1.0, np.abs(wanted).max()), function


def octave_poses(robots: list[Robot], to: str, folder: Path) -> dict[str, np.ndarray]:
    """The poses of all robots by their scripts and the stand-ins, in one process."""
    lines = [f"addpath('{STAND_INS}'); addpath('{folder}');"]
    for robot in robots:
        name = matlab_package(robot.name)
        (folder / f"{name}.m").write_text(exported(robot, to).text)
        lines += [f"T = pose_of({name}(), (1:{robot.n}) / 3 - 1); printf('%.17g ', T'); printf('\\n');"]
    (folder / "all_poses.m").write_text("\n".join(lines) + "\n")
    command = [*(find_octave() or ()), *OCTAVE_OPTIONS, str(folder / "all_poses.m")]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stderr
    rows = [np.array(line.split(), dtype=float).reshape(4, 4) for line in done.stdout.splitlines()]
    return dict(zip((robot.name for robot in robots), rows, strict=True))


@needs_octave
@pytest.mark.parametrize("to", ["corke", "rigidbodytree"])
def test_the_matlab_scripts_make_the_same_arms(to: str, tmp_path: Path) -> None:
    taken = [replace(numeric("planar-2r-perugia"), name=name) for name in ("end", "pi", "link", "unwind-protect")]
    robots = [*taken, *(dressed(name, rotors=True, coulomb=True) if name in FEW else numeric(name) for name in EVERY)]
    found = octave_poses(robots, to, tmp_path)
    for robot in robots:
        q = np.arange(1, robot.n + 1) / 3 - 1
        assert np.abs(found[robot.name] - Oracle.of(robot).evaluate("forward_kinematics", q)).max() < 1e-12


def test_names_of_joints_never_meet_those_of_fixed_ones() -> None:
    robot = dressed("skeleton-modified")
    names = ("q1_offset", "base_joint", "tool_joint")
    joints = tuple(replace(joint, variable=name) for joint, name in zip(robot.joints, names, strict=False))
    text = exported(replace(robot, joints=(*joints, *robot.joints[3:])), "rigidbodytree").text
    found = [line.partition("('")[2].partition("'")[0] for line in text.splitlines() if "rigidBodyJoint(" in line]
    assert len(found) == len(set(found))
    assert set(names[: len(joints)]) < set(found)


def test_rigid_body_tree_has_inertias_about_the_origins_of_frames() -> None:
    robot = dressed("planar-2r-perugia")
    lines = exported(robot, "rigidbodytree").text.splitlines()
    line = next(line for line in lines if line.startswith("body.Inertia"))
    found = np.array(line.partition("[")[2].partition("]")[0].split(","), dtype=float)
    arm = Oracle.of(robot).arm
    c, m = arm.com[0], arm.mass[0]
    about = arm.inertia[0] + m * (c @ c * np.eye(3) - np.outer(c, c))
    expected = [about[at] for at in ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))]
    assert np.abs(found - expected).max() < 1e-15


def test_the_table_of_numbers_has_every_cell() -> None:
    robot = uneven(dressed("stanford-deluca", rotors=True, coulomb=True))
    joints = (replace(robot.joints[0], limits=(number(-1), number(2)), speed=number(3)), *robot.joints[1:])
    text = exported(replace(robot, joints=joints), "csv").text
    head = [line for line in text.splitlines() if line.startswith("#")]
    rows = list(csv.DictReader(line for line in text.splitlines() if not line.startswith("#")))
    arm = Oracle.of(robot).arm
    assert any(line.startswith("# gravity: 0.3 -9.1 -2.7") for line in head)
    for cell in ("theta", "d", "a", "alpha", "mass", "viscous", "armature"):
        assert np.abs([float(row[cell]) for row in rows] - getattr(arm, cell)).max() < 1e-15
    dry = [[float(row[key]) for row in rows] for key in ("coulomb", "coulomb_minus")]
    assert np.abs(dry - arm.coulomb).max() < 1e-15
    assert [row["type"] for row in rows] == [joint.type.value for joint in robot.joints]
    assert [rows[0][key] for key in ("lower", "upper", "speed", "torque")] == ["-1", "2", "3", ""]
    assert float(rows[2]["motor_ratio"]) == arm.ratio[2]
