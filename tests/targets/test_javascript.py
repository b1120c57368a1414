"""The JavaScript module: the same functions as the NumPy one, in agreement with the independent recursion."""

import random

import numpy as np
import pytest

from derive.programs.build import build_program
from derive.programs.optimise.search_policy import Effort
from derive.programs.program import Program
from derive.robot.load import catalogue_names
from derive.robot.robot import Robot
from derive.targets.escape import javascript_comment, javascript_string
from derive.targets.javascript import camel_case, render_javascript
from derive.verification.expectation import expectation
from derive.verification.oracle.functions import FUNCTIONS
from derive.verification.samples import sample_sets
from tests.random_robots import random_robot, seeds
from tests.targets.generated_models import planar, source_of
from tests.targets.javascript_model import JavaScriptModel

TOLERANCE = 1e-12
FITTED = 1e-10
"""The oracle finds base parameters by least squares, which has errors of its own."""


def check(robot: Robot, program: Program, samples: int = 6) -> None:
    model = JavaScriptModel(robot, program)
    for sample_set in sample_sets(robot, samples, np.random.default_rng(robot.n)):
        for name in sample_set.oracle.functions:
            arguments = tuple(sample_set.arguments[kind] for kind in FUNCTIONS[name].arguments)
            expected = expectation(name, sample_set, arguments)
            numbers = dict(sample_set.parameters)
            rows = [model.call(name, *row, params=numbers) for row in zip(*arguments, strict=True)]
            got = np.array(rows, dtype=float) if arguments else np.array(model.call(name, params=numbers), dtype=float)
            assert got.shape == expected.value.shape
            tolerance = FITTED if name == "base_parameters" else TOLERANCE
            assert expected.errors(got).max() <= tolerance, name


@pytest.mark.parametrize("name", catalogue_names())
def test_catalogue_robots_agree_with_the_oracle(name: str) -> None:
    robot = Robot.load(name)
    check(robot, build_program(robot, Effort.QUICK), samples=3)


@pytest.mark.parametrize("seed", seeds(10, usual=3))
def test_random_robots_agree_with_the_oracle(seed: int) -> None:
    robot = Robot.from_text(random_robot(random.Random(900 + seed), 1 + seed % 5).text)
    check(robot, build_program(robot))


@pytest.fixture(scope="module")
def model() -> JavaScriptModel:
    return JavaScriptModel(planar())


def test_exports_every_function_and_constant(model: JavaScriptModel) -> None:
    constants = ("DOF", "JOINT_NAMES", "JOINT_TYPES", "LIMITS", "PARAMETERS")
    assert model.names == (*constants, *(camel_case(name) for name in FUNCTIONS))
    assert model.value("model.LIMITS") == [[-np.pi, 2], None]
    assert model.value("model.PARAMETERS") == ["m1", "m2"]


@pytest.mark.parametrize(
    ("call", "message"),
    [
        ("forwardKinematics([1])", "RangeError: forwardKinematics: q must be an array of 2 numbers; got 1"),
        ("forwardKinematics()", "TypeError: forwardKinematics: q must be an array of 2 numbers; got undefined"),
        (
            "forwardKinematics([1, '2'])",
            "TypeError: forwardKinematics: q must be an array of 2 numbers; entry 2 is no number",
        ),
        ("inertiaMatrix([1, 2])", "RangeError: inertiaMatrix: missing in params: m1, m2"),
        ("inertiaMatrix([1, 2], {m1: 1, m2: '2'})", "TypeError: inertiaMatrix: params: m2 must be a number"),
        ("jacobian([1, 2], {m3: 1})", "RangeError: jacobian: unknown in params: m3; the parameters are [m1, m2]"),
        ("gravityVector([1, 2], [1])", "RangeError: gravityVector: params must have 2 entries, [m1, m2]; got 1"),
        (
            "gravityVector([1, 2], 3)",
            "TypeError: gravityVector: params must be an object by name or an array; got number",
        ),
        (
            "inverseDynamics([1, 2], [1], [0, 0])",
            "RangeError: inverseDynamics: qd must be an array of 2 numbers; got 1",
        ),
    ],
)
def test_wrong_arguments_are_named(model: JavaScriptModel, call: str, message: str) -> None:
    found = model.context.eval(f"(() => {{ try {{ model.{call}; return ''; }} catch (e) {{ return String(e); }} }})()")
    assert found == message


def test_parameters_come_by_name_in_order_or_as_typed_arrays(model: JavaScriptModel) -> None:
    named = model.value("model.inertiaMatrix([0.1, 0.2], {m2: 1.5, m1: 2})")
    assert named == model.value("model.inertiaMatrix(new Float64Array([0.1, 0.2]), [2, 1.5])")


def test_arguments_are_not_modified(model: JavaScriptModel) -> None:
    assert model.value("(() => { const q = [0.1, 0.2]; model.jacobian(q); return q; })()") == [0.1, 0.2]


def test_users_names_and_titles_are_inert() -> None:
    names = ["class", "Math", "q", "DOF", "constructor", "arguments", "model"]
    rows = ", ".join(f"{{type: revolute, a: {name}}}" for name in names)
    title = "*/ throw 1; </script><!-- \\u2028 `${1}` "
    robot = Robot.from_text(
        f'name: odd\ntitle: "{title.replace(chr(92), chr(92) * 2)}"\nconvention: standard\njoints: [{rows}]\n'
    )
    model = JavaScriptModel(robot)
    pose = model.call("forward_kinematics", [0.0] * 7, params={name: 1.0 for name in names})
    assert pose[:3, 3] == pytest.approx([7, 0, 0])
    text = render_javascript(source_of(robot))["model.mjs"]
    assert "</script" not in text
    assert "<!--" not in text


@pytest.mark.parametrize("text", ["</script>", "<!-- <script>", '"\\\n\u2028\u2029\x00\x7fé', "${x} `'"])
def test_strings_and_comments_are_inert_in_a_page(text: str) -> None:
    literal = javascript_string(text)
    assert literal.isascii()
    assert "<" not in literal
    assert JavaScriptModel(planar()).value(literal) == text
    assert "</" not in javascript_comment(text)
    assert "<!" not in javascript_comment(text)
