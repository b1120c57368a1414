"""Coupled joints and closed loops on sheets, in figures and on pages: as the oracle has them, and closed."""

import random
from ast import literal_eval
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import sympy

from derive.handouts.assemble import context_of
from derive.handouts.figure.scene import arm_scene
from derive.handouts.notation.notation import Notation
from derive.handouts.parts.closure import closure, closure_lines, closure_parts
from derive.handouts.parts.example import configuration
from derive.handouts.sheet.document import Figure, SheetFormula
from derive.inverse.loops import without_parallelograms
from derive.model.model import Model
from derive.robot.load import robot_file_bytes
from derive.robot.names import free_symbols
from derive.robot.robot import Robot
from derive.verification.oracle.functions import Oracle
from derive.verification.samples import oracle_of
from derive.workspace.poses import RobotPoses
from tests.cli.command import refused
from tests.handouts.page import test_browser_viewer as viewers
from tests.handouts.reading import part, words
from tests.handouts.test_trees import COUPLED, LOOPS, assert_same, joined, printed, sections
from tests.inverse.loops.test_rod import with_rod
from tests.random_robots import seeds
from tests.random_trees import coupled, random_tree
from tests.verification.oracle.test_loops import mechanism

browser = viewers.browser
FOUR = robot_file_bytes("four-bar").decode()
STIFF = FOUR.replace("l1: 0.1 ", "l1: 0.5 ")  # its crank no longer goes around
NAMELESS, ROD = FOUR.partition("parameters:")[0], with_rod("four-bar")


def drawn(robot: Robot) -> tuple[Robot, RobotPoses, Oracle]:
    robot = without_parallelograms(robot)
    poses = RobotPoses(robot)
    values = dict.fromkeys(free_symbols(robot), 1.0) | {name: float(x) for name, x in poses.values.items()}
    return robot, poses, oracle_of(robot, values)


@pytest.mark.parametrize("name", COUPLED)
@pytest.mark.first(1)
def test_formulas_are_those_of_the_model_and_the_example_those_of_the_oracle(name: str) -> None:
    robot, poses, oracle = drawn(Robot.load(name))
    sheet, model = sections(robot), Model(robot)
    assert ("closure" in sheet, "left out" in words(sheet["inverse"])) == (name in LOOPS, True)
    values = {entry.name: entry.python for entry in formulas(sheet["example"].blocks)}
    if robot.has_dynamics and name != "five-bar":
        assert_same(printed(sheet["inertia"], "inertia_matrix"), model.B, symmetric=True)
        q = poses.zero if robot.loops else configuration(robot)[1]
        found = np.array(literal_eval(values["\\mathbf{B}"]))
        assert np.allclose(found, oracle.evaluate("inertia_matrix", np.array(q)), rtol=1e-9)
        gravity = [float(values[f"g_{{{k}}}"]) for k in range(1, robot.dof + 1)]
        assert np.allclose(gravity, oracle.evaluate("gravity_vector", np.array(q)), atol=1e-9)


def formulas(blocks: Any) -> list[Any]:
    return [entry for block in blocks if isinstance(block, SheetFormula) for entry in block.entries()]


@pytest.mark.parametrize("name", LOOPS)
@pytest.mark.first(2)
def test_printed_derivatives_are_the_rates_of_the_passive_joints(name: str) -> None:
    robot, poses, _ = drawn(Robot.load(name))
    q, names = np.array(poses.zero), [joint.variable for joint in robot.joints]
    steps = 1e-6 * np.eye(robot.dof)
    moved = [np.subtract(poses.joints(q + step), poses.joints(q - step)) / 2e-6 for step in steps]
    assert np.allclose(poses.rates(q), np.transpose(moved), atol=1e-7)
    at = dict(zip(names, poses.joints(q), strict=True)) | {k: float(v) for k, v in poses.values.items()}
    entries = {entry.name: entry.python for entry in formulas(closure(context_of(robot)))}
    glyph = context_of(robot).notation.glyph
    for joint in robot.passive:
        for variable, slope in joint.follows:
            rate = poses.rates(q)[names.index(joint.variable)][[v.variable for v in robot.variables].index(variable)]
            text = entries.get(glyph(slope.name).box.tex, "0")
            assert float(sympy.sympify(text, locals={}).subs(at)) == pytest.approx(rate, abs=1e-9)


@pytest.mark.parametrize("text", [*COUPLED, STIFF, NAMELESS, ROD], ids=[*COUPLED, "stiff", "nameless", "rod"])
@pytest.mark.first(3)
def test_figures_are_where_the_oracle_is_and_closed(text: str) -> None:
    robot, poses, oracle = drawn(Robot.from_text(text) if "\n" in text else Robot.load(text))
    frames = np.array(poses.frames(poses.zero))
    wanted = oracle.evaluate("link_transforms", np.array(poses.zero))
    assert np.allclose(frames[1 : robot.n + 1], wanted, atol=1e-9)
    scene = arm_scene(robot, frames.tolist())
    pins = sum(loop.by.value == "revolute" for loop in robot.loops)
    assert (len(scene.joints), joined(scene)) == (robot.n + pins, 1)
    assert any(isinstance(block, Figure) for block in part(robot, "figure").blocks)


@pytest.mark.parametrize("seed", seeds(40, 2, 40))
def test_random_couplings_are_drawn_where_their_joints_are(seed: int) -> None:
    rng = random.Random(seed)
    robot, matrix = coupled(rng, random_tree(rng).robot)
    q = np.random.default_rng(seed).uniform(-1.0, 1.0, robot.dof)
    own = replace(robot, coupled=(), joints=tuple(replace(joint, drive=()) for joint in robot.joints))
    found, wanted = RobotPoses(robot).frames(q.tolist()), RobotPoses(own).frames((matrix @ q).tolist())
    assert np.allclose(found[: robot.n + 1], wanted[: robot.n + 1], atol=1e-9)


@pytest.mark.sweep
def test_frames_of_the_arm_of_a_loop_have_numbers_of_their_own_where_a_constant_transform_makes_it_a_tree() -> None:
    assert "('$2$', '$1$', 'revolute'" in str(part(mechanism("rods", 2), "closure").blocks)


def test_where_loops_are_open_is_said(tmp_path: Path) -> None:
    (tmp_path / "r.yaml").write_text(STIFF, encoding="utf-8")
    assert "whose loops are open" in refused("plot", "r.yaml", "--at", "3", "-o", "r.svg", folder=tmp_path).stderr
    open_robot = Robot.from_text(f"{STIFF}figure: {{q: [3]}}\n")
    assert all("loops are open" in words(part(open_robot, name)) for name in ("figure", "example"))


@pytest.mark.sweep
@pytest.mark.parametrize("text", [FOUR, STIFF])
def test_the_page_moves_passive_joints_and_says_where_loops_are_open(text: str, browser: Any, tmp_path: Path) -> None:
    figure = viewers.Figure(browser, tmp_path, Robot.from_text(text))
    _, poses, _ = drawn(figure.robot)
    for q in (0.4, 0.9):
        figure.set([q])
        assert np.allclose(figure.pose(), poses.frames([q])[-1], atol=1e-9)
    figure.set([3.0])
    assert figure.page.locator(".viewer-open").is_visible() == (text == STIFF)
    figure.close()


@pytest.mark.parametrize("name", ["four-bar", "slider-crank"])
def test_a_branch_is_told_as_the_formula_that_the_sign_of_the_file_takes(name: str) -> None:
    robot = Robot.load(name)
    model = Model(robot)
    lines = closure_lines(model.closure, "text", Notation.of(robot))
    (part,) = closure_parts(model.closure)
    assert any(line.startswith("branch of the file: ") and "+-" not in line for line in lines)
    assert part["by"] == "revolute"
    assert len(part["branch"]) == 1
    assert part["no_value_where_zero"]
    assert "2 solutions (complete)" in lines
