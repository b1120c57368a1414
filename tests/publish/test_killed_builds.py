"""A build killed at any moment leaves the complete old folder or the complete new one."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.places import ROOT

pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="kills are tested on POSIX systems")


def states(mode: str, folder: Path, *options: str) -> list[str]:
    """Runs the driver; what the folder was after every kill.

    A build that is killed over the compiler leaves a temporary folder, which goes with the folder of the test.
    """
    temporary = folder / "temporary"
    temporary.mkdir()
    command = [sys.executable, "tests/publish/kill_driver.py", mode, str(folder / "out" / "arm"), *options]
    environment = {"PYTHONPATH": str(ROOT), "PATH": "/usr/bin:/bin", "TMPDIR": str(temporary)}
    done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, timeout=600, check=False)
    assert done.returncode == 0, done.stderr
    found: list[str] = json.loads(done.stdout)
    return found


@pytest.mark.slow
@pytest.mark.parametrize(("swap", "allowed"), [("swap", {"old", "new"}), ("rename", {"old", "new", "backup"})])
def test_death_before_any_operation_on_files_is_harmless(tmp_path: Path, swap: str, allowed: set[str]) -> None:
    """Every operation in turn is the last one; without an atomic exchange the next build puts the old folder back."""
    found = states("steps", tmp_path, swap)
    assert len(found) > 50
    assert set(found) <= allowed
    assert {"old", "new"} <= set(found)
    assert [path.name for path in (tmp_path / "out").iterdir()] == ["arm"]


@pytest.mark.sweep
def test_kills_from_outside_are_harmless(tmp_path: Path) -> None:
    found = states("moments", tmp_path, "swap")
    assert len(found) > 50
    assert set(found) == {"old", "new"}


@pytest.mark.slow
@pytest.mark.parametrize("kills", [2, pytest.param(25, marks=pytest.mark.sweep)])
def test_killed_builds_leave_a_whole_folder(tmp_path: Path, kills: int) -> None:
    """Whole builds, verification included, killed on the way."""
    found = states("builds", tmp_path, "swap", str(kills))
    assert len(found) == kills
    assert set(found) <= {"old", "new"}
    assert "old" in found
