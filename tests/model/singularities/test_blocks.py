"""The square blocks by which a robot is judged: their determinants are those of the numbers."""

from __future__ import annotations

import numpy as np
import pytest

from derive.lecture.form import LectureForm
from derive.model.model import Model
from derive.model.singularities.blocks import ALL, square_blocks
from derive.robot.robot import Robot
from tests.evaluate import evaluate

ROBOTS = [
    "planar-2r-perugia",
    "planar-3r",
    "anthropomorphic-arm",
    "spherical-wrist",
    "spherical-arm",
    "stanford-deluca",
]


@pytest.mark.parametrize("name", ROBOTS)
def test_determinants_are_those_of_the_entries(name: str) -> None:
    model = Model(Robot.load(name))
    form = LectureForm(model.domain)
    for block in square_blocks(model.kinematics):
        assert len(block.rows) == len(block.columns) == len(block.entries)
        assert set(block.rows) <= set(ALL)
        entries = [[form.kinematic(p) for p in row] for row in block.entries]
        determinant = form.determinant(block.determinant())
        symbols = {s for row in entries for entry in row for s in getattr(entry, "free_symbols", ())}
        values = {s.name: 0.4 + 0.3 * k for k, s in enumerate(sorted(symbols | determinant.free_symbols, key=str))}
        numbers = np.array([[evaluate(entry, values) for entry in row] for row in entries])
        assert evaluate(determinant, values) == pytest.approx(np.linalg.det(numbers), rel=1e-9, abs=1e-12)
