"""A broken or hostile robot file meets every command the same way: one line, status 2, nothing written."""

from pathlib import Path

import pytest

from derive.cli.main import main
from tests.cli.command import derive, is_one_message
from tests.robot.hostile import HOSTILE


@pytest.mark.parametrize("name", HOSTILE)
def test_build_refuses_in_one_line_and_writes_nothing(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "arm.yaml").write_bytes(HOSTILE[name][0])
    status = main(["build", "arm.yaml", "--out", "out"])
    captured = capsys.readouterr()
    assert status == 2
    assert is_one_message(captured.err), captured.err
    assert "arm.yaml:" in captured.err
    assert captured.out == ""
    assert [path.name for path in tmp_path.iterdir()] == ["arm.yaml"]


@pytest.mark.parametrize("command", ["show", "build", "verify", "check", "handout", "plot"])
@pytest.mark.parametrize("name", ["import", "tag-object", "tabs", "unknown-key"])
def test_every_command_refuses(command: str, name: str, tmp_path: Path) -> None:
    (tmp_path / "arm.yaml").write_bytes(HOSTILE[name][0])
    more = {"show": ["T"], "plot": ["-o", "arm.svg"]}.get(command, [])
    outcome = derive(command, "arm.yaml", *more, folder=tmp_path)
    assert outcome.status == 2
    assert is_one_message(outcome.stderr), outcome.stderr
    assert outcome.stdout == ""
    assert "Traceback" not in outcome.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["arm.yaml"]
