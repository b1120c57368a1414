"""A difference is called a slip only where something makes certain what the formula is about."""

import pytest

from derive.checking.latex.conditions import AMONG
from derive.robot.robot import Robot
from tests.checking.test_pages import checked

R2 = Robot.load("planar-2r-perugia")
X = "$$x = a_1 c_1 + a_2 c_{12}$$\n"


@pytest.mark.parametrize(
    ("text", "wrong", "told"),
    [
        ("$$x = a_1 s_1 + a_2 c_{12}$$", ["p[1]"], 0),  # one change away
        ("$$x = a_1 c_1 + a_2 c_1 c_2$$", ["p[1]"], 0),  # most of it is that of ours
        ("$$x = 7 s_2 a_1^2$$", [], 1),  # nothing says that this x is ours
        (X * AMONG + "$$x = 7 s_2 a_1^2$$", ["p[1]"], 0),  # formulas of its kind are right
        (r"$$s_1 + 1 = c_2 + a_1 / a_2$$ $$c_1 + 2 = a_1 s_2$$", [], 2),
        (r"$$s_1 + 1 = c_2 + a_1 / a_2$$", [r"s_1 + 1"], 0),  # both sides of the only identity are those of the text
    ],
)
def test_what_is_far_from_ours_is_wrong_only_among_right_formulas(text: str, wrong: list[str], told: int) -> None:
    report = checked(R2, text)
    assert ([finding.entry for finding in report.wrong], len(report.unread)) == (wrong, told)
