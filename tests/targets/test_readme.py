"""The page of a generated folder: its example runs, and no text of the user's becomes markup."""

import re
from pathlib import Path

import pytest

from derive.programs.optimise.search_policy import Effort
from derive.publish.build import build_robot
from derive.publish.render import render_robot
from derive.publish.targets import TARGETS, targets_named
from derive.robot.robot import Robot
from derive.targets.readme import FILES


def page(robot: Robot) -> str:
    return render_robot(robot, targets_named(), Effort.QUICK).files["README.md"].decode()


@pytest.mark.parametrize("name", ["scara-perugia", "thumb", "kuka-kr5", "puma560-corke"])
def test_the_example_runs(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    build_robot(Robot.load(name), tmp_path, verified=False, effort=Effort.QUICK)
    text = (tmp_path / name.replace("-", "_") / "README.md").read_text()
    match = re.search(r"```python\n(.*?)```", text, re.DOTALL)
    assert match is not None
    monkeypatch.syspath_prepend(tmp_path)
    scope: dict[str, object] = {}
    exec(match.group(1), scope)
    assert getattr(scope["T"], "shape", None) == (4, 4)


def test_every_file_of_every_target_has_a_word() -> None:
    assert {name for target in TARGETS.values() for name in target.files} - {"README.md"} <= FILES.keys()


def test_every_file_and_function_is_listed() -> None:
    rendered = render_robot(Robot.load("scara-perugia"), targets_named())
    text = rendered.files["README.md"].decode()
    for name in rendered.files:
        assert f"`{name}`" in text or name == "README.md"
    for name in rendered.operations:
        assert f"`{name}(" in text


def test_titles_are_text() -> None:
    title = "# x [a](http://b) <script>1</script> `c` {{ 7*7 }} | **d**"
    robot = Robot.from_text(f"name: arm\ntitle: '{title}'\nconvention: standard\njoints: [{{type: revolute}}]\n")
    first = page(robot).splitlines()[0]
    assert first.startswith("# ")
    assert "<script>" not in first
    assert "[a]" not in first
    assert "49" not in first


def test_no_tag_is_left() -> None:
    assert not re.search(r"\{\{|\{%|%\}|\}\}", page(Robot.load("puma560-corke")))


ROD = """\
name: rod
convention: standard
joints:
  - {type: revolute, a: a1}
links:
  - {mass: 1.23456, com: [-0.2159, 0, 0], inertia: {zz: 0.019}}
gravity: [0, -g, 0]
parameters: {a1: 0.4318123456789, g: 9.80665}
"""


def test_numbers_are_shown_in_decimals_of_six_digits_and_the_page_says_so() -> None:
    text = page(Robot.from_text(ROD))
    assert "| `a1` | `0.4318123456789` |" in text
    assert "- `Izz1`: `1.23456*a1**2 - 0.533083*a1 + 0.0765463`" in text
    assert "rounded to 6 significant digits" in text
    assert "rounded" not in page(Robot.from_text(ROD.replace("1.23456", "1.2").replace("0.2159", "0.2")))
