"""Ctrl-C at any moment ends a build with one line and the status 130, and leaves nothing behind."""

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

from derive.publish import many
from derive.publish.manifest import read_manifest
from derive.robot.robot import Robot
from tests.cli.command import heed_interrupts
from tests.places import ROOT
from tests.random_robots import seeds

pytestmark = pytest.mark.skipif(not hasattr(os, "killpg"), reason="interrupts are tested on POSIX systems")

ONE = ("scara-perugia", "--target", "all", "--quiet", "--force")
MANY = ("planar-3r", "skeleton", *ONE, "scara-matlab", "--jobs", "2")
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


@pytest.mark.first(2)
@pytest.mark.skipif(not Path("/proc/self/environ").exists(), reason="looks for processes that were left")
@pytest.mark.parametrize("whom", ["the terminal's group", "the process"])
@pytest.mark.parametrize("build", [ONE, MANY], ids=["one robot", "several"])
@pytest.mark.parametrize("seed", seeds(30, usual=1, swept=6))
def test_an_interrupt_ends_a_build_and_leaves_nothing_behind(
    build: tuple[str, ...], whom: str, seed: int, tmp_path: Path
) -> None:
    moment = random.Random(f"{seed} {build} {whom}").uniform(STARTED, LONGEST)
    mark = random.Random().randrange(1 << 60)
    temporary = tmp_path / "temporary"
    temporary.mkdir()
    process = subprocess.Popen(
        [sys.executable, "-m", "derive", "build", *build],
        cwd=tmp_path,
        env=os.environ | {"PYTHONPATH": str(ROOT), "TMPDIR": str(temporary), "DERIVE_TEST": str(mark)},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        preexec_fn=heed_interrupts,
    )
    time.sleep(moment)
    finished = process.poll() is not None
    if not finished:
        (os.kill if whom == "the process" else os.killpg)(process.pid, signal.SIGINT)
    asked = time.monotonic()
    _, errors = process.communicate(timeout=60)
    assert time.monotonic() - asked < 15
    if finished:
        assert process.returncode == 0
    else:
        assert process.returncode in (130, -signal.SIGINT), errors  # by Python itself after an interrupt inside of exec
        told = [line for line in errors.splitlines() if not line.startswith("derive: warning: ")]
        assert told == ["derive: error: interrupted"]
    assert descendants(mark) == []
    assert list(temporary.iterdir()) == []
    for folder in (tmp_path / "generated").iterdir() if (tmp_path / "generated").exists() else ():
        assert not folder.name.startswith(".")
        manifest = read_manifest(folder)
        assert manifest is not None
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
    done = many._run(die_over_a_file, robots, 2, None)
    assert [str(failure.error) for failure in done] == ["the process that built it was killed"] * 2
    assert list(tmp_path.iterdir()) == []
