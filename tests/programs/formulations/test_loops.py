"""Passive joints of closed loops in programs: cosines and sines by roots, NaN where a loop does not close."""

from importlib import import_module
from pathlib import Path

import numpy as np
import pytest

from derive import build
from derive.inverse.loops.linkage import linkage, positions
from derive.programs.build import build_program
from derive.programs.formulations.trace import passive_joints
from derive.programs.tape.field import ClosingField, TapeField
from derive.programs.tape.graph import Graph, node_of
from derive.programs.tape.tape import Op
from derive.programs.tape.value import TapeDomain
from derive.robot.load import robot_file_bytes
from derive.robot.robot import Robot
from tests.inverse.loops.test_rod import with_rod


@pytest.mark.parametrize("name", ["four-bar", "slider-crank"])
def test_torques_take_the_sine_and_cosine_of_the_crank_and_one_root_and_no_other_angle(name: str) -> None:
    program = build_program(Robot.load(name), names={"inverse_dynamics"})
    counts = program["inverse_dynamics"].tape.operations.as_dict()
    assert [counts.get(key, 0) for key in ("sin", "cos", "sqrt", "atan2")] == [1, 1, 1, 0]


def test_every_passive_joint_has_numbers_slopes_and_a_bias() -> None:
    robot = Robot.load("delta")
    found = passive_joints(robot, Graph())
    places = {k for k, joint in enumerate(robot.joints) if joint.follows}
    assert {*found.numbers} == {*found.biases} == places
    assert {*found.slopes} == {slope for joint in robot.passive for _, slope in joint.follows}


def test_a_root_is_taken_as_it_is_so_that_an_open_loop_has_no_numbers() -> None:
    graph = Graph()
    domain = TapeDomain(Robot.load("four-bar"), graph)
    radicand = domain.variable("q", 0)
    ops = {kind: graph.op[node_of(kind(domain).sqrt(radicand).ref)] for kind in (ClosingField, TapeField)}
    operands = {kind: graph.op[graph.operands[node_of(kind(domain).sqrt(radicand).ref)][0]] for kind in ops}
    assert set(ops.values()) == {Op.ROOT}
    assert operands == {ClosingField: Op.INPUT, TapeField: Op.MAXIMUM}


@pytest.mark.parametrize("four", [robot_file_bytes("four-bar").decode(), with_rod("four-bar")], ids=["pins", "rod"])
@pytest.mark.parametrize("branch", "+-")
@pytest.mark.first(2)
def test_generated_positions_are_those_of_the_solution_and_no_numbers_where_the_loop_is_open(
    branch: str, four: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = four.replace("l1: 0.1 ", "l1: 0.5 ").replace('"+"', f'"{branch}"')
    robot = Robot.from_text(text.replace("name: four-bar", f"name: open-{'np'[branch == '+']}{len(four)}"))
    build(robot, tmp_path, targets=["numpy"], only=True)
    monkeypatch.syspath_prepend(str(tmp_path))
    generated = import_module(f"{robot.name.replace('-', '_')}.model_numpy")
    q = np.linspace(-3, 3, 60)  # without the dead point at 0
    full, exists = positions(robot, linkage(robot), [q])
    with np.errstate(invalid="ignore"):
        found = generated.passive_positions(q[:, None])
    assert 0 < exists.sum() < len(q)
    assert (np.isfinite(found).all(axis=-1) == exists).all()
    assert np.abs(np.exp(1j * found) - np.exp(1j * np.array(full[1:])).T)[exists].max() < 1e-12
