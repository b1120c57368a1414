"""`verify` passes what is right, finds planted faults and wrong operators anywhere, and says where."""

import json
import random
import re
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from derive.errors import VerificationError
from derive.programs.build import build_program
from derive.robot.names import free_symbols
from derive.robot.robot import Robot
from derive.targets.casadi import render_casadi
from derive.targets.numpy import render_numpy
from derive.targets.target import Source
from derive.verification.generated import GeneratedModel, load_models
from derive.verification.oracle.functions import FUNCTIONS
from derive.verification.samples import SampleSet, sample_sets
from derive.verification.tolerance import TOLERANCE
from derive.verification.verify import verify
from tests.random_robots import random_robot, seeds
from tests.rows import text_of_rows

HEAD = """
from functools import cache

import numpy as np
from derive.verification.oracle.functions import FUNCTIONS, Oracle
from derive.model.identification.base_parameters import base_set
from derive.robot.inertial_parameters import has_regressor
from derive.robot.robot import Robot

ROBOT = Robot.from_text({text!r})
BASE = base_set(ROBOT).parameters if has_regressor(ROBOT) else None
DOF = {dof}
PARAMETERS = {parameters!r}


def _value(name, arguments, params):
    numbers = {{key: np.asarray(value, dtype=float) for key, value in (params or {{}}).items()}}
    batch = np.broadcast_shapes(*(np.shape(a)[:-1] for a in arguments), *(v.shape for v in numbers.values()))
    columns = [np.broadcast_to(v, batch).reshape(-1, 1) for v in numbers.values()]
    columns += [np.broadcast_to(a, (*batch, np.shape(a)[-1])).reshape(-1, np.shape(a)[-1]) for a in arguments]
    if not columns:
        return _evaluated(name, numbers, np.zeros((1, 0)))[0]
    rows, places = np.unique(np.concatenate(columns, axis=1), axis=0, return_inverse=True)
    sets, kinds = np.unique(rows[:, : len(numbers)], axis=0, return_inverse=True)
    values = None
    for k, chosen in enumerate(sets):
        mine = kinds.reshape(-1) == k
        found = _evaluated(name, dict(zip(numbers, chosen)), rows[mine, len(numbers) :])
        values = np.empty((len(rows), *found.shape[1:])) if values is None else values
        values[mine] = found
    return values[places.reshape(-1)].reshape((*batch, *values.shape[1:]))


@cache
def _oracle(numbers):
    return Oracle.of(ROBOT, dict(numbers), BASE)


def _evaluated(name, numbers, rows):
    oracle = _oracle(tuple((key, float(value)) for key, value in numbers.items()))
    widths = [6 if argument == "h" else DOF for argument in FUNCTIONS[name].arguments]
    arguments = np.split(rows, np.cumsum(widths)[:-1], axis=1) if widths else []
    value = oracle.evaluate(name, *arguments)
    return value if arguments else np.broadcast_to(value, (len(rows), *value.shape))
"""

FUNCTION = """

def {name}({signature}):
    return _value({name!r}, [{arguments}], params)
"""


OF_ARMS = {name: definition for name, definition in FUNCTIONS.items() if name != "passive_positions"}


def write_stand_in(folder: Path, text: str, fault: str = "") -> Robot:
    """Write a ``model_numpy.py`` that is right but for the code ``fault`` at its end."""
    robot = Robot.from_text(text)
    source = HEAD.format(text=text, dof=robot.n, parameters=free_symbols(robot))
    for name, definition in OF_ARMS.items():
        if robot.has_dynamics or not definition.dynamic:
            signature = ", ".join((*definition.arguments, "params=None"))
            source += FUNCTION.format(name=name, arguments=", ".join(definition.arguments), signature=signature)
    (folder / "model_numpy.py").write_text(source + fault, encoding="utf-8")
    return robot


ARM = """
name: two-links
title: Two links
convention: standard
joints: [{type: revolute, a: a1}, {type: revolute, theta: -q2, a: 0.4, alpha: pi/2, limits: [-1, 2]}]
gravity: [0, -9.81, 0]
links:
  - {mass: 2, com: [-0.2, 0, 0], inertia: {zz: 0.1}, motor: {mass: 0.3, inertia: 0.01, ratio: 50}}
  - {mass: m2, com: [-0.2, 0.01, 0], inertia: {xx: 0.01, yy: 0.06, zz: 0.05}, friction: {viscous: 0.5, coulomb: 0.1}}
parameters: {a1: 0.5}
wrench: [world, end]
"""

NAMES = tuple(OF_ARMS)


def altered(function: str, change: str) -> str:
    """Code that wraps a function so that ``value`` is changed on its way out."""
    return f"""
_right = {function}
def {function}(*arguments, params=None):
    value = np.array(_right(*arguments, params=params))
    {change}
    return value
"""


def failure(folder: Path, fault: str, text: str = ARM) -> str:
    robot = write_stand_in(folder, text, fault)
    with pytest.raises(VerificationError) as caught:
        verify(robot, folder, samples=6)
    assert caught.value.exit_status == 1
    return str(caught.value)


def test_right_functions_pass_and_every_one_is_reported(tmp_path: Path) -> None:
    report = verify(write_stand_in(tmp_path, ARM), tmp_path, samples=6)
    assert tuple(row.function for row in report.rows) == NAMES
    assert all(row.target == "numpy" and row.samples > 20 and row.worst < 1e-12 for row in report.rows)
    assert {row.note for row in report.rows if not row.function.startswith(("manipulability", "task"))} == {""}
    assert report.worst <= TOLERANCE
    assert json.loads(json.dumps(report.as_dict()))["rows"][0]["function"] == "forward_kinematics"


@pytest.mark.parametrize("seed", seeds(12, usual=2))
def test_right_functions_of_random_robots_pass(tmp_path: Path, seed: int) -> None:
    rng = random.Random(seed)
    robot = write_stand_in(tmp_path, random_robot(rng, rng.randint(1, 5), dynamics=seed % 3 > 0).text)
    assert verify(robot, tmp_path, samples=4, seed=seed).worst < 1e-11


@pytest.mark.first(4)
@pytest.mark.parametrize("function", NAMES)
def test_a_relative_error_of_1e_8_in_one_entry_is_found(tmp_path: Path, function: str) -> None:
    message = failure(tmp_path, altered(function, "value[(..., -1) if value.ndim else ()] *= 1 + 1e-8"))
    assert f"{function} of model_numpy.py differs: entry [" in message
    assert " instead of " in message
    assert ("q = [" in message) == (function != "base_parameters")
    assert "m2 = " in message


FAULTS = {
    "(a batch)": altered("gravity_vector", "value = value if value.ndim < 2 else value[..., ::-1]"),
    "(a long batch)": altered("jacobian", "value = np.concatenate([value[:4096], 0 * value[4096:]])"),
    "raises AssertionError": altered("coriolis_matrix", "assert arguments[0].shape == arguments[1].shape"),
    "read-only": altered("jacobian", "arguments[0][...] = 0"),
    "jacobian": "\ndel jacobian\n",
    "DOF": "\nDOF = 3\n",
    "PARAMETERS": "\nPARAMETERS = ('m1', 'm2')\n",
    r"model_numpy.py cannot be imported: \w+": "\nimport nowhere_at_all\n",
    "SyntaxError": "\n1 +\n",
    **{f"{name} of .* is nan instead of": altered(name, "value.flat[0] = np.nan") for name in NAMES[::6]},
    **{f"{name} of model_numpy.py returns shape": altered(name, "value = value[..., None]") for name in NAMES[1::6]},
}


@pytest.mark.parametrize(("words", "fault"), FAULTS.items())
@pytest.mark.first(5)
def test_every_fault_is_found_and_named(tmp_path: Path, words: str, fault: str) -> None:
    assert re.search(words if "." in words else re.escape(words), failure(tmp_path, fault))


def test_parameters_that_are_ignored_are_found(tmp_path: Path) -> None:
    fault = "\n\ndef inertia_matrix(q, params=None):\n    return _value('inertia_matrix', [q], {'m2': 1.0})\n"
    assert "inertia_matrix" in failure(tmp_path, fault)


def test_an_error_in_friction_and_another_in_a_small_entry_are_found(tmp_path: Path) -> None:
    fault = altered("inverse_dynamics", "value[..., 1] += 1e-6 * np.sign(arguments[1][..., 1])")
    assert "inverse_dynamics" in failure(tmp_path, fault)
    small = ARM.replace("mass: m2", "mass: 1.0e-6*m2").replace("{xx: 0.01, yy: 0.06, zz: 0.05}", "{zz: 5.0e-8}")
    fault = altered("inertia_matrix", "value[..., 1, 1] *= 1 + 1e-6")
    assert "entry [2,2]" in failure(tmp_path, fault, small)


def test_an_unverified_function_and_an_empty_folder_are_found(tmp_path: Path) -> None:
    with pytest.raises(VerificationError, match=r"does not hold .*model_casadi\.py.*model_numpy\.py"):
        verify(Robot.from_text(ARM), tmp_path)
    (tmp_path / "MANIFEST.json").write_text('{"operations": {"inertia_matrix": {}, "collision_matrix": {}}}')
    assert "not verified: collision_matrix" in failure(tmp_path, "")


def test_the_same_seed_gives_the_same_report_and_nothing_is_left_behind(tmp_path: Path) -> None:
    robot = write_stand_in(tmp_path, ARM, altered("jacobian", "value *= 1 + 1e-12"))
    modules, path = set(sys.modules), list(sys.path)
    first, second = (verify(robot, tmp_path, samples=4, seed=7) for _ in range(2))
    assert first == second
    assert first.worst > 1e-13
    assert not [name for name in set(sys.modules) - modules if "model" in name]
    assert sys.path == path
    assert [file.name for file in tmp_path.iterdir()] == ["model_numpy.py"]


def test_a_robot_whose_inertia_matrix_is_singular_is_verified_but_for_its_accelerations(tmp_path: Path) -> None:
    massless = ARM.replace("mass: m2", "mass: 0*m2").replace("inertia: {xx: 0.01, yy: 0.06, zz: 0.05}", "inertia: {}")
    robot = write_stand_in(tmp_path, massless, altered("forward_dynamics", "raise ZeroDivisionError"))
    report = verify(robot, tmp_path, samples=4)
    rows = {row.function: row for row in report.rows}
    assert rows["forward_dynamics"].samples == 0
    assert "singular" in rows["forward_dynamics"].note
    assert rows["inertia_matrix"].samples > 0


def test_random_parameters_are_possible_and_configurations_within_the_limits() -> None:
    text = ARM.replace("{zz: 0.1}", "{xx: Ixx, yy: Iyy, zz: Izz, xy: Ixy, xz: Ixz}").replace("a1: 0.5", "b: 1")
    text = text.replace("a: a1", "a: sqrt(a1 - 2*b)").replace("parameters: {b: 1}", "parameters: {b: 1}\nruntime: [b]")
    for sample_set in sample_sets(Robot.from_text(text), 6, np.random.default_rng(3)):
        assert (np.linalg.eigvalsh(sample_set.oracle.arm.inertia) > -1e-12).all()
        assert sample_set.parameters["a1"] > 2 * sample_set.parameters["b"]
    for sample_set in sample_sets(Robot.from_text(ARM), 30, np.random.default_rng(1)):
        second = sample_set.arguments["q"][:, 1]
        assert second.min() >= -1
        assert second.max() <= 2


ROUNDED = """
name: rounded-base
convention: modified
base: [[0.707107, -0.707107, 0, 1], [0.707107, 0.707107, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
joints: [{type: revolute}, {type: revolute, a: 0.4, alpha: 0.3}]
tool: [[1, 0, 0, 0.3], [0, 1, 0, 0.2], [0, 0, 1, 0.1], [0, 0, 0, 1]]
"""


def test_a_rounded_base_leaves_the_jacobian_undetermined_by_its_defect_and_no_more(tmp_path: Path) -> None:
    in_world_axes = """
def jacobian(q, params=None):
    frames = link_transforms(q)
    z, r = frames[..., 2], forward_kinematics(q)[..., None, :, 3] - frames[..., 3]
    linear = np.cross(z[..., :3], r[..., :3])
    return np.swapaxes(np.concatenate([linear, z[..., :3]], axis=-1), -1, -2){more}
"""
    robot = write_stand_in(tmp_path, ROUNDED, in_world_axes.format(more=""))
    assert 1e-12 < verify(robot, tmp_path, samples=6).worst <= TOLERANCE
    assert "jacobian" in failure(tmp_path, in_world_axes.format(more=" * (1 + 2e-5)"), ROUNDED)


def test_rounding_in_the_oracle_is_not_taken_for_inertia(tmp_path: Path) -> None:
    """The last link is a point on its own axis, on which the oracle's levers are rounding and not zero."""
    links = "links: [{mass: 0.1, com: [0, 0.1, 0.2], inertia: {yy: 0.02, zz: 0.01}}, {mass: 0.5}]"
    rows = "R a: 0.371752901208, alpha: pi/3 | R d: -0.290053837538"
    text = text_of_rows(rows, f"gravity: [0, 0, -9.81]\n{links}")
    robot = write_stand_in(tmp_path, text, altered("forward_dynamics", "value = value + np.inf"))
    (row,) = (row for row in verify(robot, tmp_path).rows if row.function == "forward_dynamics")
    assert row.samples == 0


STEP = re.compile(r"^\s+t\d+ = \S.*? ([+*-]) ", re.MULTILINE)
"""A line of a kernel with an operator between blanks."""

OTHER = {"+": "-", "-": "+", "*": "+"}

Render = Callable[[Source], dict[str, str]]


@pytest.mark.parametrize(
    ("render", "joints"),
    [
        pytest.param(render_numpy, 2, id="numpy"),
        pytest.param(render_numpy, 4, id="numpy-longer", marks=pytest.mark.sweep),
        pytest.param(render_casadi, 4, id="casadi", marks=pytest.mark.sweep),
    ],
)
def test_a_changed_operator_is_found_unless_it_changes_no_value(tmp_path: Path, render: Render, joints: int) -> None:
    rng, mutants = random.Random(11), 8 if joints > 3 else 4
    robot = Robot.from_text(random_robot(rng, joints).text)
    (file, text), *_ = render(Source(robot, build_program(robot), "0.0.0")).items()
    (tmp_path / file).write_text(text, encoding="utf-8")
    (right,) = load_models(tmp_path)
    verify(robot, tmp_path, samples=6)
    operators = [match.start(1) for match in STEP.finditer(text)]
    assert len(operators) > 100
    found = 0
    for place in rng.sample(operators, mutants):
        mutant = text[:place] + OTHER[text[place]] + text[place + 1 :]
        (tmp_path / file).write_text(mutant, encoding="utf-8")
        try:
            verify(robot, tmp_path, samples=6)
        except VerificationError:
            found += 1
        else:
            (wrong,) = load_models(tmp_path)
            assert_same_values(right, wrong, sample_sets(robot, 60, np.random.default_rng(1))[0])
    assert found >= 3 * mutants // 4


def assert_same_values(one: GeneratedModel, other: GeneratedModel, sample_set: SampleSet) -> None:
    """Some work is redundant: a C matrix has the same value for every split of what cancels in it."""
    for name, definition in OF_ARMS.items():
        arguments = [sample_set.arguments[argument] for argument in definition.arguments]
        values = [model.call(name, arguments, sample_set.parameters) for model in (one, other)]
        assert np.allclose(*values, rtol=1e-9, atol=1e-9)
