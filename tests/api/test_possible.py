"""`derive.possible`: a robot by name, and the text of a robot file that reads back."""

import pytest

import derive
from derive.api.convert import possible

pytest.importorskip("clarabel")


def test_a_robot_by_name_gets_links_that_exist_and_a_robot_file() -> None:
    found = possible("scara-matlab")
    assert isinstance(found.robot, derive.Robot)
    again = derive.Robot.from_text(found.text, "arm.yaml")
    assert again.links == found.robot.links
    assert again.remarks == ()
    assert "# 1 of 4 links changed; base parameters and torques stay the same\n# link 2 changed by" in found.text
    assert found.text.startswith("# Source: report on the SCARA")
