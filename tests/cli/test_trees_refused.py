"""What is made of one chain alone refuses a tree in one message, and writes nothing; what takes trees does not."""

import shlex
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import derive as api
from derive.errors import DeriveError
from derive.publish.atomic_folder import write_files
from derive.robot import robot as reading
from derive.robot.description import Description, End, FixedRow, Link, Stand
from derive.robot.load import robot_file_bytes
from tests.cli.command import accepted, contents, refused

MESSAGE = " of torso, whose table is a tree; allowed: robots of one chain; derive show and derive build take trees; "
REFUSED = [
    "handout torso.yaml --fragment conversion",
    *(f"export torso.yaml --format {to}" for to in ("rtb", "corke", "rigidbodytree", "csv")),
    *(f"show torso.yaml {name}" for name in ("singularities", "workspace", "aspects")),
    "plot torso.yaml --workspace -o arm.svg",
    "check torso.yaml --quantity inverse --expression 'q1 = 0'",
    "convert torso.yaml -o other.yaml",
]
CALLS: dict[str, Callable[[Any], object]] = {
    "Robot.convert": lambda robot: robot.convert("modified"),
    "possible": api.possible,
    "singularities": lambda robot: api.Model(robot, assumptions=True).singularities,
}


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    read = reading.description_from_bytes
    monkeypatch.setattr(reading, "description_from_bytes", lambda data, source: branched(read(data, source)))
    text = robot_file_bytes("planar-2r-perugia").decode().replace("planar-2r-perugia", "torso", 1)
    write_files({tmp_path / "torso.yaml": text.encode()}, force=False)
    return tmp_path


def branched(robot: Description) -> Description:
    """The torso with a second end, on a fixed row behind its first joint; other robots as they are."""
    ends = (End("left", robot.joints[-1].label), End("right", "stub"))
    stub = FixedRow("stub", Stand(robot.joints[0].label), link=Link())
    return replace(robot, fixed=(stub,), ends=ends) if robot.name == "torso" else robot


@pytest.mark.parametrize("command", REFUSED)
def test_commands_refuse_a_tree(command: str, folder: Path) -> None:
    before = contents(folder)
    outcome = refused(*shlex.split(command), folder=folder)
    assert (MESSAGE in outcome.stderr, outcome.stdout, contents(folder)) == (True, "", before)


@pytest.mark.parametrize("call", CALLS.values(), ids=CALLS)
def test_python_refuses_a_tree(call: Callable[[Any], object], folder: Path) -> None:
    with pytest.raises(DeriveError, match=MESSAGE):
        call(api.load(folder / "torso.yaml"))


def test_a_tree_is_listed_and_copied(folder: Path) -> None:
    listed = accepted("show", "torso.yaml", folder=folder).stdout
    assert {"singularities", "workspace", "aspects"}.isdisjoint(listed.split())
    accepted("new", "copy", "--from", "torso.yaml", folder=folder)
    assert api.Model(api.load(folder / "torso.yaml"))._repr_latex_() is None
