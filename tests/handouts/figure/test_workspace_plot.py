"""The plot of a workspace as a file."""

import pytest

from derive.handouts.figure.workspace_plot import workspace_bytes
from derive.robot.robot import Robot
from derive.workspace.poses import RobotPoses
from derive.workspace.views import find_workspace

pytest.importorskip("shapely")
pytest.importorskip("matplotlib")


@pytest.mark.filterwarnings("error")
def test_a_workspace_of_one_point_is_plotted_without_a_warning() -> None:
    found = find_workspace(RobotPoses(Robot.load("dh-modified-deluca")))
    assert all(view.reachable.region.is_empty for view in found.views)
    assert workspace_bytes(found.views, ".svg", "a point").startswith(b"<?xml")
