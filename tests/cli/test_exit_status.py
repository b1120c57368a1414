"""Exit status 0 done, 1 a check failed, 2 wrong input with one message on standard error."""

import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from derive.cli import schema
from derive.cli.main import main
from derive.errors import RobotFileError, VerificationError
from tests.cli.command import derive_process, environment, is_one_message, refused
from tests.robot.hostile import HOSTILE


def test_output_on_an_ascii_terminal_is_escaped(tmp_path: Path) -> None:
    robot = "\N{GREEK SMALL LETTER ALPHA}.yaml"
    outcome = derive_process("show", robot, "T", folder=tmp_path, PYTHONIOENCODING="ascii")
    assert outcome.status == 2
    assert is_one_message(outcome.stderr), outcome.stderr
    assert "\\u03b1.yaml" in outcome.stderr
    refused("show", "a\x1b[31mb\nc", "T", folder=tmp_path)


def test_reader_that_goes_away_is_no_fault(tmp_path: Path) -> None:
    command = f"{shlex.quote(sys.executable)} -m derive schema | head -n 1; echo ${{PIPESTATUS[0]}}"
    done = subprocess.run(
        ["bash", "-c", command], cwd=tmp_path, env=environment(), capture_output=True, text=True, timeout=300
    )
    assert done.stderr == ""
    assert done.stdout.splitlines()[-1] in ("0", "141")


@pytest.mark.parametrize(
    ("error", "status", "message"),
    [
        (RuntimeError("two\nlines"), 70, "internal fault, RuntimeError: two\\nlines; please report it"),
        (RecursionError("too deep"), 70, "internal fault, RecursionError: too deep; please report it"),
        (MemoryError(), 70, "internal fault, MemoryError"),
        (KeyboardInterrupt(), 130, "interrupted\n"),
        (PermissionError(13, "Permission denied", "out"), 2, "out: Permission denied\n"),
        (VerificationError("off by 1"), 1, "off by 1\n"),
        (RobotFileError("no joints", remedy="add one"), 2, "no joints; add one\n"),
    ],
)
def test_every_error_ends_in_one_line_and_its_status(
    error: BaseException, status: int, message: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def fail(arguments: object) -> int:
        raise error

    monkeypatch.setattr(schema, "run", fail)
    assert main(["schema"]) == status
    printed = capsys.readouterr().err
    assert is_one_message(printed)
    assert printed.startswith(f"derive: error: {message}")


@pytest.mark.parametrize("command", ["show", "build", "verify", "check", "handout", "plot", "convert"])
@pytest.mark.parametrize("name", ["import", "tag-object", "tabs", "unknown-key"])
def test_a_broken_robot_file_meets_every_command_the_same_way(command: str, name: str, tmp_path: Path) -> None:
    (tmp_path / "arm.yaml").write_bytes(HOSTILE[name][0])
    more = {"show": ["T"], "plot": ["-o", "arm.svg"]}.get(command, [])
    outcome = refused(command, "arm.yaml", *more, folder=tmp_path)
    assert outcome.stdout == ""
    assert "Traceback" not in outcome.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["arm.yaml"]
