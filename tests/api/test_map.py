"""`derive.map` and what writes a store: the report, remarks and a picture."""

from pathlib import Path

import pytest

import derive
from derive.api.map import write_map

pytest.importorskip("xarray")
TEXT = """\
name: elbow
convention: standard
joints:
  - {type: revolute, d: 0.3, alpha: pi/2}
  - {type: revolute, a: 0.4, limits: [0, pi]}
  - {type: prismatic, alpha: pi/2}
"""


def test_the_report_counts_cells_and_says_what_was_assumed(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    robot = derive.Robot.from_text(TEXT)
    told: list[tuple[str, str]] = []
    picture = tmp_path / "slice.png"
    found = write_map(
        robot, tmp_path / "s.zarr", grid=0.1, workers=2, picture=picture, progress=lambda *way: told.append(way)
    )
    data = derive.map(robot, grid=0.1)
    assert found.reached == int((data.postures > 0).sum())
    assert 0 < found.reached == found.everywhere < found.cells == data.postures.size == found.poses
    assert found.computed == found.blocks == len(told)
    assert told[-1] == ("map of elbow", "100 %, 0 s left,")
    assert found.remarks[:2] == ("without limits: q1, full turns", "limits assumed: q3 from 0 to 0.4 m")
    assert found.remarks[2].startswith(f"{picture}: elbow: share of orientations reached at y = ")
    assert picture.read_bytes().startswith(b"\x89PNG")
    with pytest.raises(derive.DeriveError, match=r"slice.png exists already"):
        write_map(robot, tmp_path / "t.zarr", picture=picture)


def test_arms_with_infinitely_many_postures_are_refused() -> None:
    with pytest.raises(derive.DeriveError, match="has more joints than its task x, y, z, orientation needs"):
        derive.map("kuka-lwr4")
