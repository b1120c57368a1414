"""What is said of formulas that other people published is true: nothing right is called wrong, and no slip is right."""

from pathlib import Path
from typing import Any

import pytest
import yaml

from derive.robot.robot import Robot
from tests.checking.test_pages import checked

FILES = [
    yaml.safe_load(path.read_text(encoding="utf-8")) for path in sorted(Path(__file__).parent.glob("published/*.yaml"))
]
PAGES = [(file["robots"].get(page["robot"]), page) for file in FILES for page in file["pages"]]


@pytest.mark.first(40)
@pytest.mark.parametrize(("robot", "page"), PAGES, ids=[page["id"] for _, page in PAGES])
def test_a_published_page_gets_the_verdicts_that_are_true(robot: str, page: dict[str, Any]) -> None:
    arm = Robot.from_text(robot) if robot else Robot.load(page["robot"])
    report = checked(arm, page["text"], page.get("kind", ".md"))
    assert [finding.entry for finding in report.wrong] == page["wrong"]
    assert (report.equal, len(report.unread)) == (page["equal"], page["unread"]), report.unread
