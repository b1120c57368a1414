"""Every language of generated functions: its files, and how they are run, as `derive.verification` runs them."""

import ctypes
import json
import re
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from derive.programs.program import Program
from derive.publish.render import OPTIONS
from derive.robot.robot import Robot
from derive.targets import c, casadi, javascript, native, numpy, octave
from derive.targets.compiler import compile_shared, find_compiler, require_compiler
from derive.verification.generated import FIRST_FILE, compile_models, find_octave, load_models, running_octave
from tests.targets.generated_models import needs_compiler, needs_octave, source_of, written

TARGETS = {
    "numpy": (numpy.TARGET,),
    "native": (c.TARGET, native.TARGET),
    "casadi": (casadi.TARGET,),
    "casadi-c": (casadi.C_TARGET,),
    "c": (c.TARGET,),
    "octave": (octave.TARGET,),
    "javascript": (javascript.TARGET,),
}
_MARKS = {"native": [needs_compiler], "casadi-c": [needs_compiler], "c": [needs_compiler], "octave": [needs_octave]}


def languages(*names: str) -> list[Any]:
    """Languages as parameters of a test, by default all of them; without what runs them they are skipped."""
    return [pytest.param(name, marks=_MARKS.get(name, [])) for name in names or TARGETS]


def texts_of(language: str, robot: Robot, program: Program | None = None) -> dict[str, str]:
    source = source_of(robot, program)
    return {name: text for target in TARGETS[language] for name, text in target.render(source).items()}


@contextmanager
def running(language: str, robot: Robot, program: Program | None = None) -> Iterator[Any]:
    """The functions of a robot in a language, as a `derive.verification.generated.GeneratedModel`."""
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        written(folder, texts_of(language, robot, program))
        if language == "javascript":
            inverse = source_of(robot, program).program.inverse
            text = (folder / javascript.FILE).read_text(encoding="utf-8")
            yield JavaScriptModel(text, inverse.given if inverse else ())
        elif language == "octave":
            (folder / octave.package_folder(robot) / FIRST_FILE).touch()  # by which a package of ours is known
            with running_octave(folder, find_octave()) as (model,):
                yield model
        else:
            compiler = find_compiler()
            if language == "native":
                options = (*OPTIONS, "-march=native", "-O1")
                compile_shared(require_compiler(), [folder / native.CODE], folder / native.LIBRARY, options)
            yield (load_models(folder) or compile_models(folder, compiler))[0]


class JavaScriptModel:
    """The JavaScript module of a robot in V8, without a browser; its export list becomes an object."""

    target, file, ways = "javascript", javascript.FILE, ("one",)

    def __init__(self, text: str, given: Sequence[int] = ()) -> None:
        py_mini_racer = pytest.importorskip("py_mini_racer")
        body, exports = text.split("\nexport {\n")
        self.names = tuple(name.strip() for name in exports.split("}")[0].split(",") if name.strip())
        self.context = py_mini_racer.MiniRacer()
        self.context.eval(f'"use strict";\n{body}\nglobalThis.model = {{ {", ".join(self.names)} }};\n0')
        self.constants = {**dict.fromkeys(self.names), "inverse_kinematics": (), "GIVEN": given}

    def value(self, expression: str) -> Any:
        return json.loads(self.context.eval(f"JSON.stringify({expression})"))

    def called(self, name: str, inputs: Sequence[Any]) -> Any:
        return self.value(f"model.{name}({', '.join(map(json.dumps, inputs))})")

    def call(self, function: str, arguments: Sequence[Any], parameters: Mapping[str, float]) -> np.ndarray:
        inputs = [*(np.asarray(a, dtype=float).tolist() for a in arguments), dict(parameters)]
        return np.array(self.called(javascript.camel_case(function), inputs), dtype=float)

    def inverse(self, poses: Any, given: Any, parameters: Mapping[str, float]) -> tuple[np.ndarray, np.ndarray]:
        found = []
        for pose, row in zip(poses, given, strict=True):
            inputs = [pose.tolist(), *([row.tolist()] if len(row) else []), dict(parameters)]
            found.append(self.called("inverseKinematics", inputs))
        none = [np.nan] * self.value("model.DOF")
        return np.array([[row or none for row in each["q"]] for each in found]), np.array([f["status"] for f in found])


def nearest(model: Any, poses: np.ndarray, near: np.ndarray, parameters: Mapping[str, float]) -> np.ndarray:
    """The solutions nearest to some configurations, not a number where there is none."""
    numbers = [float(parameters[name]) for name in model.constants.get("PARAMETERS") or parameters]
    match model.target:
        case "numpy" | "native":
            options = {"params": dict(parameters)} if parameters else {}
            return np.asarray(model.module.inverse_kinematics_nearest(poses, near, **options))
        case "octave":
            inputs = [poses.transpose(1, 2, 0), near.T, *([np.array(numbers)[:, None]] if numbers else [])]
            return model.results("inverse_kinematics_nearest", inputs, 1)[0].T
        case "javascript":
            pairs = zip(poses.tolist(), near.tolist(), strict=True)
            rows = [model.called("inverseKinematicsNearest", [*pair, dict(parameters)])["q"] for pair in pairs]
            return np.array([row or near.shape[1] * [np.nan] for row in rows])
    name = re.search(r"^int (\w+_nearest)\(", model.header, re.MULTILINE)[1]  # type: ignore[index]
    function, constants, found = getattr(model.shared, name), np.zeros(64), np.zeros(near.shape)
    if numbers:
        getattr(model.shared, name.replace("nearest", "constants"))(_pointer(np.array(numbers)), _pointer(constants))
    for pose, q, row in zip(poses, near, found, strict=True):
        arrays = [np.ascontiguousarray(pose), np.ascontiguousarray(q), *([constants] if numbers else []), row]
        status = function(*map(_pointer, arrays))
        assert bool(status) == np.isfinite(row).all()
    return found


def _pointer(array: np.ndarray) -> Any:
    return array.ctypes.data_as(ctypes.POINTER(ctypes.c_double))
