"""The JavaScript module: what it exports, and arguments named."""

from collections.abc import Iterator

import numpy as np
import pytest

from derive.targets.javascript import camel_case
from derive.verification.oracle.functions import FUNCTIONS
from tests.targets.generated_models import OF_LOOPS, planar
from tests.targets.languages import JavaScriptModel, running
from tests.targets.test_inverse import elbow, program_of


@pytest.fixture(scope="module")
def model() -> Iterator[JavaScriptModel]:
    with running("javascript", planar()) as found:
        yield found


@pytest.fixture(scope="module")
def solver() -> Iterator[JavaScriptModel]:
    with running("javascript", elbow(), program_of(elbow())) as found:
        yield found


def test_exports_every_function_and_constant(model: JavaScriptModel) -> None:
    constants = ("DOF", "JOINT_NAMES", "JOINT_TYPES", "LIMITS", "PARAMETERS")
    assert model.names == (*constants, *(camel_case(name) for name in FUNCTIONS if name != OF_LOOPS))
    assert model.value("model.LIMITS") == [[-np.pi, 2], None]
    assert model.value("model.PARAMETERS") == ["m1", "m2"]


def refusal(model: JavaScriptModel, call: str) -> str:
    return model.context.eval(f"(() => {{ try {{ model.{call}; return ''; }} catch (e) {{ return String(e); }} }})()")


WANTED, PARAMS = "q must be an array of 2 numbers", "params must be an object by name or an array"


@pytest.mark.parametrize(
    ("call", "message"),
    [
        ("forwardKinematics([1])", f"RangeError: forwardKinematics: {WANTED}; got 1"),
        ("forwardKinematics()", f"TypeError: forwardKinematics: {WANTED}; got undefined"),
        ("forwardKinematics([1, '2'])", f"TypeError: forwardKinematics: {WANTED}; entry 2 is no number"),
        ("inertiaMatrix([1, 2])", "RangeError: inertiaMatrix: missing in params: m1, m2"),
        ("inertiaMatrix([1, 2], {m1: 1, m2: '2'})", "TypeError: inertiaMatrix: params: m2 must be a number"),
        ("jacobian([1, 2], {m3: 1})", "RangeError: jacobian: unknown in params: m3; the parameters are [m1, m2]"),
        ("gravityVector([1, 2], [1])", "RangeError: gravityVector: params must have 2 entries, [m1, m2]; got 1"),
        ("gravityVector([1, 2], 3)", f"TypeError: gravityVector: {PARAMS}; got number"),
        (
            "wrenchTorques([1, 2], [1])",
            f"RangeError: wrenchTorques: {WANTED.replace('q', 'h').replace('2', '6')}; got 1",
        ),
        ("inverseDynamics([1, 2], [1], [0, 0])", f"RangeError: inverseDynamics: {WANTED.replace('q', 'qd')}; got 1"),
    ],
)
def test_wrong_arguments_are_named(model: JavaScriptModel, call: str, message: str) -> None:
    assert refusal(model, call) == message


UNIT = "[[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]"


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (f"({UNIT.replace('1,0', '1.1,0', 1)}, [0.5])", "its rotation is not orthonormal (error 2.1e-1 > "),
        (f"({UNIT}, [0.5], [0, NaN, 0, 0])", "near must be finite numbers"),
        (f"Nearest({UNIT}, [0, Infinity, 0, 0], [0.5])", "q must be finite numbers"),
        (f"({UNIT.replace('0]', '1e200]', 1)}, [0.5])", "1e+200 m away"),
    ],
)
def test_what_is_no_pose_is_refused(solver: JavaScriptModel, call: str, message: str) -> None:
    assert message in refusal(solver, f"inverseKinematics{call}")


def test_parameters_come_by_name_in_order_or_as_typed_arrays_and_arguments_stay(model: JavaScriptModel) -> None:
    named = model.value("model.inertiaMatrix([0.1, 0.2], {m2: 1.5, m1: 2})")
    assert named == model.value("model.inertiaMatrix(new Float64Array([0.1, 0.2]), [2, 1.5])")
    assert model.value("(() => { const q = [0.1, 0.2]; model.jacobian(q); return q; })()") == [0.1, 0.2]
