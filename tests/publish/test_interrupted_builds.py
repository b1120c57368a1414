"""Ctrl-C at any moment ends a build with one line and leaves nothing behind; a kill leaves one whole folder."""

import json
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import NoReturn

import pytest

from derive.publish import build
from derive.publish.manifest import read_manifest
from derive.robot.robot import Robot
from tests.places import ROOT
from tests.random_robots import seeds

pytestmark = pytest.mark.skipif(not hasattr(os, "killpg"), reason="interrupts are tested on POSIX systems")

OPTIONS = ("--target", "all", "--quiet", "--force")
ONE = ("scara-perugia",)
GROUP, PROCESS = "the terminal's group", "the process"
MANY = ("planar-3r", "skeleton", "scara-matlab", "scara-perugia")
STARTED, LONGEST = 0.6, 6.0
"""Seconds after which a build is under way, and after which it may be over; it starts where the interpreter does."""


def descendants(group: int) -> list[str]:
    """Command lines of the processes of a session or of one that it has started, wherever they are now."""
    mark = f"DERIVE_TEST={group}".encode()
    found = []
    for process in Path("/proc").iterdir():
        try:
            if process.name.isdecimal() and mark in (process / "environ").read_bytes().split(b"\0"):
                found.append((process / "cmdline").read_text())
        except OSError:
            continue
    return found


@pytest.mark.first(1)
@pytest.mark.skipif(not Path("/proc/self/environ").exists(), reason="looks for processes that were left")
@pytest.mark.parametrize(("robots", "whom"), [(MANY, GROUP), (ONE, PROCESS), (MANY, PROCESS), (ONE, GROUP)])
@pytest.mark.parametrize("seed", seeds(30, usual=1, swept=6))
def test_an_interrupt_ends_a_build_and_leaves_nothing_behind(
    robots: tuple[str, ...], whom: str, seed: int, tmp_path: Path
) -> None:
    moment = random.Random(f"{seed} {robots} {whom}").uniform(STARTED, LONGEST)
    mark = random.Random().randrange(1 << 60)
    temporary = tmp_path / "temporary"
    temporary.mkdir()
    process = subprocess.Popen(
        [sys.executable, "-m", "derive", "build", *robots, "--jobs", "2", *OPTIONS],
        cwd=tmp_path,
        env=os.environ | {"PYTHONPATH": str(ROOT), "TMPDIR": str(temporary), "DERIVE_TEST": str(mark)},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),  # the background ignores them
    )
    time.sleep(moment)
    built = all((tmp_path / "generated" / robot).exists() for robot in robots)
    finished = process.poll() is not None
    if not finished:
        (os.kill if whom == PROCESS else os.killpg)(process.pid, signal.SIGINT)
    asked = time.monotonic()
    _, errors = process.communicate(timeout=60)
    assert time.monotonic() - asked < 15
    if finished or (built and process.returncode == 0):  # the interpreter was going when it was asked
        assert process.returncode == 0
        assert built
    else:
        assert process.returncode in (130, -signal.SIGINT), errors  # by Python itself after an interrupt inside of exec
        told = [line for line in errors.splitlines() if not line.startswith("derive: warning: ")]
        assert told == ["derive: error: interrupted"]
    assert descendants(mark) == []
    assert list(temporary.iterdir()) == []
    for folder in (tmp_path / "generated").iterdir() if (tmp_path / "generated").exists() else ():
        assert not folder.name.startswith(".")
        manifest = read_manifest(folder)
        assert set(manifest["files"]) <= {path.relative_to(folder).as_posix() for path in folder.rglob("*")}


def die_over_a_file(robot: Robot) -> NoReturn:
    """As a process without memory does."""
    Path(tempfile.mkdtemp(), robot.name).write_text("")
    os.kill(os.getpid(), signal.SIGKILL)
    raise AssertionError


def test_processes_that_die_leave_no_temporary_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    robots = [Robot.load("planar-2r-perugia"), Robot.load("scara-perugia")]
    done = build.for_each(die_over_a_file, robots, 2)
    assert [str(failure.error) for failure in done] == ["the process that built it was killed"] * 2
    assert list(tmp_path.iterdir()) == []


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
