"""Help answers at once and names every command."""

import resource
import subprocess
import sys

import pytest

from derive.cli.main import COMMANDS, main
from derive.version import __version__
from tests.places import ROOT

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
    "derive.api",
    "derive.handouts",
)


def seconds_of_work(*arguments: str) -> float:
    """Processor time of a Python process, the least of five: what else the machine does makes no difference to it."""
    found = []
    for _ in range(5):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run([sys.executable, *arguments], cwd=ROOT, capture_output=True, check=True, timeout=300)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        found.append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
    return min(found)


def test_help_answers_at_once() -> None:
    assert seconds_of_work("-m", "derive", "--help") < 3 * seconds_of_work("-c", "import argparse")


def test_help_imports_no_command() -> None:
    script = (
        "import sys, derive.cli.main\n"
        "try: derive.cli.main.main(['--help'])\n"
        "except SystemExit: pass\n"
        "print(*sorted(m for m in sys.modules if m.startswith('derive')), file=sys.stderr)"
    )
    done = subprocess.run([sys.executable, "-c", script], cwd=ROOT, capture_output=True, text=True, timeout=60)
    assert done.stderr.split() == ["derive", "derive.cli", "derive.cli.main", "derive.version"]


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
