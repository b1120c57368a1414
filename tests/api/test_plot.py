"""`derive.plot` does what the command does."""

import math
from pathlib import Path

import pytest

from derive.api.plot import plot

pytest.importorskip("matplotlib")
pytest.importorskip("shapely")


def test_a_figure_of_the_arm_or_of_its_workspace(tmp_path: Path) -> None:
    drawn = plot("scara-perugia", tmp_path / "arm.svg", q=[0.5, 0.6, 0.3, 0])
    assert drawn.path.read_bytes().startswith(b"<?xml")
    assert drawn.remarks.startswith("scara-perugia at q1 = 0.5 rad, q2 = 0.6 rad, q3 = 0.3 m")
    told: list[tuple[str, str]] = []
    options = {"workspace": True, "progress": lambda *stage: told.append(stage)}
    reached = plot("planar-2r-perugia", str(tmp_path / "reach.png"), **options)  # type: ignore[arg-type]
    assert told == [("planar-2r-perugia", "top view")]
    assert reached.remarks.startswith("workspace of planar-2r-perugia: top view 10.053")
    assert "limits assumed: q1 q2 from -3.142 to 3.142 rad; assumed for the drawing: a1 = 1 m" in reached.remarks
    area = reached.workspace.views[0].reachable.size
    assert abs(area.value - math.pi * (1.8**2 - 0.2**2)) <= area.error
    assert reached.path.read_bytes().startswith(b"\x89PNG")
