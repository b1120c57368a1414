"""Exit status 0 done, 1 a check failed, 2 wrong input with one message on standard error."""

import os
import shlex
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from derive.cli import schema
from derive.cli.main import main
from derive.errors import VerificationError
from tests.cli.command import derive_process, environment, heed_interrupts, is_one_message, refused

WRONG = {
    "unknown command": ("frobnicate",),
    "unknown option": ("list", "--frobnicate"),
    "abbreviated option": ("list", "--js"),
    "unknown robot": ("show", "scara-perugai", "T"),
    "unknown quantity": ("show", "scara-perugia", "Q"),
    "index out of range": ("show", "scara-perugia", "A[9]"),
    "index zero": ("show", "scara-perugia", "A[0]"),
    "no dynamics": ("show", "thumb", "B"),
    "folder as robot": ("show", ".", "T"),
    "missing file": ("build", "missing.yaml"),
    "unknown target": ("build", "scara-perugia", "--target", "fortran"),
    "no jobs": ("build", "scara-perugia", "--jobs", "0"),
    "path as name": ("new", "../arm"),
    "capital name": ("new", "Arm"),
    "no joints": ("new", "arm", "--joints", "0"),
    "too many joints": ("new", "arm", "--joints", "65"),
    "control characters": ("show", "a\x1b[31mb\nc", "T"),
}


@pytest.mark.parametrize("arguments", WRONG.values(), ids=WRONG.keys())
def test_wrong_input_is_refused_in_one_line_with_status_2(arguments: tuple[str, ...], tmp_path: Path) -> None:
    outcome = refused(*arguments, folder=tmp_path)
    assert outcome.stdout == ""
    assert list(tmp_path.iterdir()) == []


def test_output_on_an_ascii_terminal_is_escaped(tmp_path: Path) -> None:
    robot = "\N{GREEK SMALL LETTER ALPHA}.yaml"
    outcome = derive_process("show", robot, "T", folder=tmp_path, PYTHONIOENCODING="ascii")
    assert outcome.status == 2
    assert is_one_message(outcome.stderr), outcome.stderr
    assert "\\u03b1.yaml" in outcome.stderr


def test_reader_that_goes_away_is_no_fault(tmp_path: Path) -> None:
    command = f"{shlex.quote(sys.executable)} -m derive schema | head -n 1; echo ${{PIPESTATUS[0]}}"
    done = subprocess.run(
        ["bash", "-c", command], cwd=tmp_path, env=environment(), capture_output=True, text=True, timeout=300
    )
    assert done.stderr == ""
    assert done.stdout.splitlines()[-1] in ("0", "141")


@pytest.mark.parametrize("jobs", ["1", "2"])
def test_interrupt_from_the_terminal_ends_every_process_with_one_line(jobs: str, tmp_path: Path) -> None:
    """A terminal interrupts the whole group; an interrupt inside of ``exec`` lets Python die by the signal itself."""
    process = subprocess.Popen(
        [sys.executable, "-m", "derive", "build", "--force", "--jobs", jobs],
        cwd=tmp_path,
        env=environment(),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        preexec_fn=heed_interrupts,
    )
    deadline = time.monotonic() + 120
    while not (tmp_path / "generated").exists() and time.monotonic() < deadline:
        time.sleep(0.05)
    os.killpg(process.pid, signal.SIGINT)
    _, errors = process.communicate(timeout=120)
    assert process.returncode in (130, -signal.SIGINT)
    told = [line for line in errors.splitlines() if not line.startswith("derive: warning: ")]
    assert told == ["derive: error: interrupted"]


@pytest.mark.parametrize(
    ("error", "status"),
    [
        (RuntimeError("two\nlines"), 70),
        (RecursionError("too deep"), 70),
        (MemoryError(), 70),
        (KeyboardInterrupt(), 130),
        (PermissionError(13, "Permission denied", "out"), 2),
        (VerificationError("off by 1"), 1),
    ],
)
def test_every_error_ends_in_one_line_and_its_status(
    error: BaseException, status: int, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def fail(arguments: object) -> int:
        raise error

    monkeypatch.setattr(schema, "run", fail)
    assert main(["schema"]) == status
    assert is_one_message(capsys.readouterr().err)
