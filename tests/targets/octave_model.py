"""Generated packages of MATLAB and Octave, written to a folder."""

import os
from pathlib import Path

import pytest

from derive.programs.program import Program
from derive.robot.robot import Robot
from derive.targets.octave import render_octave
from derive.verification.octave_model import find_octave
from tests.targets.generated_models import source_of

REQUIRED = os.environ.get("DERIVE_REQUIRE_OCTAVE") == "1"
needs_octave = pytest.mark.skipif(find_octave() is None and not REQUIRED, reason="no Octave")


def write_package(folder: Path, robot: Robot, program: Program | None = None) -> dict[str, str]:
    texts = render_octave(source_of(robot, program))
    for name, text in texts.items():
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(text, encoding="utf-8")
    return texts
