"""The CasADi module and CasADi's own C export: named inputs and outputs; and that texts depend on the robot alone."""

import hashlib
import random
import re
from pathlib import Path

import casadi
import pytest

from derive.programs.build import build_program
from derive.publish.build import build_robot
from derive.robot.robot import Robot
from derive.targets.casadi import render_casadi, render_casadi_c
from derive.targets.numpy import render_numpy
from derive.targets.target import Source
from tests.interpreters import another_hash_seed, printed_by
from tests.random_robots import random_robot
from tests.targets import generated_models as models
from tests.targets.test_inverse import elbow, program_of

MODEL = models.casadi_model(models.planar())


@pytest.mark.parametrize("name", models.FUNCTIONS)
def test_functions_have_named_inputs_and_outputs(name: str) -> None:
    function = getattr(MODEL, name)
    assert isinstance(function, casadi.Function)
    assert (function.name(), function.is_a("SXFunction"), function.n_out()) == (name, True, 1)
    assert (function.name_in()[0], function.name_in()[-1]) == ("q", "params")
    assert (function.size_in("q"), function.size_in("params")) == ((2, 1), (len(models.PARAMETERS), 1))


def test_inverse_kinematics_has_a_function_for_each_branch_and_no_parameters_no_input() -> None:
    for k, branch in enumerate(models.casadi_model(elbow(), program_of(elbow())).inverse_kinematics, 1):
        assert (branch.name(), branch.name_in()[0]) == (f"inverse_kinematics_{k}", "T")
        assert branch.name_out() == ["q", "status"]
    robot = Robot.from_text(models.ONE_JOINT)
    assert models.casadi_model(robot).forward_kinematics.name_in() == ["q"]
    assert models.casadi_model(Robot.load("scara-matlab")).base_parameters.n_in() == 0


def test_functions_differentiate_and_export_the_same_text(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert MODEL.inverse_dynamics.jacobian().n_out() >= 3
    MODEL.inverse_dynamics.generate("torque.c")
    assert "double" in (tmp_path / "torque.c").read_text()
    first, second = (render_casadi_c(models.source_of(models.planar())) for _ in range(2))
    assert first == second
    assert not any(re.search(r"/tmp|derive-\w{8}", text) for text in first.values())


@models.needs_compiler
def test_a_build_compiles_and_verifies_the_export(tmp_path: Path) -> None:
    report = build_robot(models.planar(), tmp_path, ["casadi-c"], only=True).report
    assert {row.target for row in report.rows} == {"casadi-c"}
    assert report.worst < 1e-12


def digest(seeds: tuple[int, ...]) -> str:
    found = hashlib.sha256()
    for seed in seeds:
        robot = Robot.from_text(random_robot(random.Random(seed), 1 + seed).text)
        source = Source(robot, build_program(robot), "0")
        for text in (*render_numpy(source).values(), *render_casadi(source).values()):
            found.update(text.encode())
    return found.hexdigest()


@pytest.mark.parametrize("seeds", [(0,), pytest.param((1, 2), marks=pytest.mark.sweep)])
def test_hash_seeds_change_nothing(seeds: tuple[int, ...]) -> None:
    """What this process makes, whose seed is another in every run, is what one with a given seed makes."""
    code = f"from tests.targets.test_casadi import digest; print(digest({seeds}))"
    assert printed_by(code, PYTHONHASHSEED=another_hash_seed()) == digest(seeds)
