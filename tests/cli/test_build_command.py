"""``derive build`` as scripts and people use it: reports, silence, staleness, several robots."""

import os
import pty
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from derive.publish.targets import targets_named
from tests.cli.command import PENDULUM, contents, derive, derive_process, environment, is_one_message, refused

QUICK = ("--effort", "quick", "--target", "numpy", "--only")


def test_check_names_what_is_stale_or_missing_and_exits_with_1(tmp_path: Path) -> None:
    (tmp_path / "arm.yaml").write_text(PENDULUM)
    assert derive("build", "arm.yaml", folder=tmp_path).status == 0
    assert derive("build", "arm.yaml", "--check", folder=tmp_path).status == 0
    folder = tmp_path / "generated" / "pendulum"
    with (folder / "model_numpy.py").open("a") as file:
        file.write("# mine\n")
    (folder / "sheet.tex").unlink()
    before = contents(tmp_path)
    outcome = derive("build", "arm.yaml", "--check", folder=tmp_path)
    assert outcome.status == 1
    assert "stale model_numpy.py" in outcome.stdout
    assert "missing sheet.tex" in outcome.stdout
    assert contents(tmp_path) == before


def test_quiet_build_prints_nothing_and_a_pipe_sees_no_progress(tmp_path: Path) -> None:
    outcome = derive_process("build", "planar-3r", *QUICK, "--quiet", folder=tmp_path)
    assert (outcome.status, outcome.stdout, outcome.stderr) == (0, "", "")
    assert derive("build", "planar-3r", *QUICK, "--force", folder=tmp_path).stderr == ""


def test_progress_on_a_terminal_leaves_standard_output_alone(tmp_path: Path) -> None:
    process, terminal = pty.fork()
    if process == 0:  # pragma: no cover -- the child
        os.chdir(tmp_path)
        os.dup2(os.open("out.txt", os.O_WRONLY | os.O_CREAT), 1)
        command = [sys.executable, "-m", "derive", "build", "planar-3r", *QUICK]
        os.execve(sys.executable, command, environment(TERM="xterm"))
    shown = b""
    while chunk := _read(terminal):
        shown += chunk
    assert os.waitstatus_to_exitcode(os.waitpid(process, 0)[1]) == 0
    assert re.search(rb"planar-3r: verify  \d+ s", shown)
    assert shown.endswith(b"\r\x1b[K")
    assert "\x1b" not in (tmp_path / "out.txt").read_text()


def _read(terminal: int) -> bytes:
    try:
        return os.read(terminal, 4096)
    except OSError:  # the other end is closed
        return b""


def test_one_failure_does_not_stop_the_rest(tmp_path: Path) -> None:
    (tmp_path / "generated" / "skeleton").mkdir(parents=True)
    (tmp_path / "generated" / "skeleton" / "thesis.txt").write_text("not ours")
    outcome = refused("build", "skeleton", "planar-3r", *QUICK, folder=tmp_path)
    assert "skeleton" in outcome.stderr
    assert (tmp_path / "generated" / "planar_3r" / "model_numpy.py").exists()
    assert [path.name for path in (tmp_path / "generated" / "skeleton").iterdir()] == ["thesis.txt"]


def test_a_target_is_added_to_the_usual_ones_and_only_leaves_the_named_ones(tmp_path: Path) -> None:
    folder = tmp_path / "generated" / "planar_3r"
    usual = {name for target in targets_named() for name in target.files}
    for choice, wanted in (
        (["--target", "numpy,latex", "--only"], {"model_numpy.py", "sheet.tex"}),
        (["--target", "latex", "--target", "numpy", "--only"], {"model_numpy.py", "sheet.tex"}),
        (["--target", "javascript"], {*usual, "model.mjs"}),
        (["--target", "javascript", "--only"], {"model.mjs"}),
    ):
        assert derive("build", "planar-3r", "--effort", "quick", *choice, folder=tmp_path).status == 0
        assert {path.name for path in folder.iterdir()} == {"MANIFEST.json", "__init__.py", *wanted}
        assert derive("build", "planar-3r", "--check", "--effort", "quick", *choice, folder=tmp_path).status == 0


def test_report_on_a_full_disk_is_an_error_of_one_line(tmp_path: Path) -> None:
    full = Path("/dev/full")
    if not full.exists():
        pytest.skip("this system has no /dev/full")
    command = f"{shlex.quote(sys.executable)} -m derive schema > /dev/full"
    done = subprocess.run(["bash", "-c", command], env=environment(), capture_output=True, text=True, timeout=300)
    assert done.returncode == 2
    assert is_one_message(done.stderr), done.stderr
