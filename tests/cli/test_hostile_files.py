"""A broken or hostile robot file meets every command the same way: one line, status 2, nothing written."""

from pathlib import Path

import pytest

from tests.cli.command import refused
from tests.robot.hostile import HOSTILE

COMMANDS = ("show arm.yaml T", "verify arm.yaml", "check arm.yaml", "handout arm.yaml", "plot arm.yaml -o arm.svg")
FEW = ("import", "tag-object", "tabs", "unknown-key")
CASES = [(command, name) for command in (*COMMANDS, "convert arm.yaml") for name in FEW]


@pytest.mark.parametrize(("command", "name"), [*(("build arm.yaml --out out", name) for name in HOSTILE), *CASES])
def test_every_command_refuses_in_one_line_and_writes_nothing(command: str, name: str, tmp_path: Path) -> None:
    (tmp_path / "arm.yaml").write_bytes(HOSTILE[name][0])
    outcome = refused(*command.split(), folder=tmp_path)
    assert "arm.yaml:" in outcome.stderr
    assert outcome.stdout == ""
    assert [path.name for path in tmp_path.iterdir()] == ["arm.yaml"]
