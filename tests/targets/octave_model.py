"""Generated packages of MATLAB and Octave, written to a folder and run in one process of Octave."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from derive.programs.program import Program
from derive.robot.robot import Robot
from derive.targets.octave import render_octave
from derive.verification.octave_model import OctaveModel, find_octave, running_octave
from tests.targets.generated_models import source_of

REQUIRED = os.environ.get("DERIVE_REQUIRE_OCTAVE") == "1"
needs_octave = pytest.mark.skipif(find_octave() is None and not REQUIRED, reason="no Octave")


def write_package(folder: Path, robot: Robot, program: Program | None = None) -> dict[str, str]:
    texts = render_octave(source_of(robot, program))
    for name, text in texts.items():
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(text, encoding="utf-8")
    return texts


@contextmanager
def octave_model(folder: Path, robot: Robot, program: Program | None = None) -> Iterator[OctaveModel]:
    write_package(folder, robot, program)
    with running_octave(folder, find_octave()) as (model,):
        yield model
