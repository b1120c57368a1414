"""The CasADi module: named inputs and outputs, fit for optimisation and code export; and CasADi's own C export."""

import re
from pathlib import Path

import casadi
import pytest

from derive.publish.build import build_robot
from derive.robot.robot import Robot
from derive.targets.casadi import render_casadi_c
from tests.targets.generated_models import FUNCTIONS, PARAMETERS, casadi_model, needs_compiler, planar, source_of
from tests.targets.test_inverse import elbow, program_of

MODEL = casadi_model(planar())


@pytest.mark.parametrize("name", FUNCTIONS)
def test_functions_have_named_inputs_and_outputs(name: str) -> None:
    function = getattr(MODEL, name)
    assert isinstance(function, casadi.Function)
    assert (function.name(), function.is_a("SXFunction"), function.n_out()) == (name, True, 1)
    assert (function.name_in()[0], function.name_in()[-1]) == ("q", "params")
    assert (function.size_in("q"), function.size_in("params")) == ((2, 1), (len(PARAMETERS), 1))


def test_inverse_kinematics_has_a_function_for_each_branch() -> None:
    for k, branch in enumerate(casadi_model(elbow(), program_of(elbow())).inverse_kinematics, 1):
        assert (branch.name(), branch.name_in()[0]) == (f"inverse_kinematics_{k}", "T")
        assert branch.name_out() == ["q", "status"]


def test_no_parameters_no_input() -> None:
    robot = Robot.from_text("name: one\nconvention: standard\njoints: [{type: revolute, a: 0.5}]\n")
    assert casadi_model(robot).forward_kinematics.name_in() == ["q"]
    assert casadi_model(Robot.load("scara-matlab")).base_parameters.n_in() == 0


def test_functions_differentiate_and_export(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert MODEL.inverse_dynamics.jacobian().n_out() >= 3
    MODEL.inverse_dynamics.generate("torque.c")
    assert "double" in (tmp_path / "torque.c").read_text()


def test_the_export_is_the_same_every_time_and_names_no_folder() -> None:
    first, second = (render_casadi_c(source_of(planar())) for _ in range(2))
    assert first == second
    assert not any(re.search(r"/tmp|derive-\w{8}", text) for text in first.values())


@needs_compiler
def test_a_build_compiles_and_verifies_the_export(tmp_path: Path) -> None:
    report = build_robot(planar(), tmp_path, ["casadi-c"], only=True).report
    assert report is not None
    assert {row.target for row in report.rows} == {"casadi-c"}
    assert report.worst < 1e-12
