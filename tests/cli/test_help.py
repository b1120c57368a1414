"""Help answers at once and names every command."""

from __future__ import annotations

import subprocess
import sys
import time
from pathlib import Path

import pytest

from derive import __version__
from derive.cli.main import COMMANDS, main
from tests.cli.command import ROOT, derive

HEAVY = (
    "sympy",
    "numpy",
    "casadi",
    "flint",
    "pydantic",
    "yaml",
    "jinja2",
    "rich",
    "derive.mechanics",
    "derive.model",
    "derive.targets",
    "derive.handout",
)


def test_help_answers_within_0_3_s(tmp_path: Path) -> None:
    times = []
    for _ in range(5):
        start = time.perf_counter()
        assert derive("--help", folder=tmp_path).status == 0
        times.append(time.perf_counter() - start)
    assert min(times) < 0.3


@pytest.mark.parametrize("arguments", ["--help", "--version", "build --help", "show --help"])
def test_help_imports_nothing_heavy(arguments: str) -> None:
    script = (
        "import sys, derive.cli.main\n"
        "try: derive.cli.main.main(sys.argv[1:])\n"
        "except SystemExit: pass\n"
        f"sys.exit(','.join(m for m in {HEAVY!r} if m in sys.modules) or 0)"
    )
    done = subprocess.run(
        [sys.executable, "-c", script, *arguments.split()], cwd=ROOT, capture_output=True, text=True, timeout=60
    )
    assert done.returncode == 0, done.stderr


def test_help_names_every_command(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["--help"])
    text = capsys.readouterr().out
    assert all(f"    {command} " in text for command in COMMANDS)


@pytest.mark.parametrize("command", COMMANDS)
def test_each_command_explains_itself(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as stop:
        main([command, "--help"])
    assert stop.value.code == 0
    assert f"usage: derive {command}" in capsys.readouterr().out


def test_version_is_the_package_version(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["--version"])
    assert capsys.readouterr().out == f"derive {__version__}\n"
