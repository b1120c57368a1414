"""Generated C models, compiled and callable."""

import os
import tempfile
from pathlib import Path

import pytest

from derive.programs.program import Program
from derive.robot.robot import Robot
from derive.targets.c import render_c
from derive.targets.compiler import find_compiler, require_compiler
from derive.verification.c_model import CModel, load_c_model
from tests.targets.generated_models import source_of

REQUIRED = os.environ.get("DERIVE_REQUIRE_COMPILER") == "1"
STRICT = ("-std=c99", "-Wall", "-Wextra", "-pedantic", "-Wshadow", "-Wconversion", "-Wmissing-prototypes", "-Werror")
needs_compiler = pytest.mark.skipif(find_compiler() is None and not REQUIRED, reason="no C compiler")


def write_c_model(folder: Path, robot: Robot, program: Program | None = None) -> dict[str, str]:
    texts = render_c(source_of(robot, program))
    for name, text in texts.items():
        (folder / name).write_text(text, encoding="utf-8")
    return texts


def c_model(robot: Robot, program: Program | None = None) -> CModel:
    with tempfile.TemporaryDirectory() as folder:
        write_c_model(Path(folder), robot, program)
        return load_c_model(Path(folder, "model.c"), require_compiler())
