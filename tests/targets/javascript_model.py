"""Generated JavaScript run in V8, without a browser."""

import json
from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest

from derive.programs.program import Program
from derive.robot.robot import Robot
from derive.targets.javascript import camel_case, render_javascript
from tests.targets.generated_models import source_of

py_mini_racer = pytest.importorskip("py_mini_racer")


class JavaScriptModel:
    """The JavaScript module of a robot; its export list becomes an object."""

    def __init__(self, robot: Robot, program: Program | None = None) -> None:
        text = render_javascript(source_of(robot, program))["model.mjs"]
        body, exports = text.split("\nexport {\n")
        self.names = tuple(name.strip() for name in exports.split("}")[0].split(",") if name.strip())
        self.context = py_mini_racer.MiniRacer()
        self.context.eval(f'"use strict";\n{body}\nglobalThis.model = {{ {", ".join(self.names)} }};\n0')

    def value(self, expression: str) -> Any:
        return json.loads(self.context.eval(f"JSON.stringify({expression})"))

    def call(self, name: str, *arguments: Any, params: Mapping[str, float] | None = None) -> np.ndarray:
        given = [json.dumps(np.asarray(a, dtype=float).tolist()) for a in arguments]
        return np.array(self.value(f"model.{camel_case(name)}({', '.join([*given, json.dumps(params)])})"))
