"""Runs the command: in this process, or in one of its own, as a shell does."""

import contextlib
import io
import os
import subprocess
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from unittest import mock

from derive.cli.main import main
from tests.places import ROOT

PENDULUM = """\
name: pendulum
convention: standard
joints:
  - {type: revolute, a: a1}
gravity: [0, -g, 0]
links:
  - {mass: m1, com: [l1 - a1, 0, 0], inertia: {zz: I1}}
"""
PLANAR = """\
name: planar
convention: standard
joints:
  - {type: revolute, a: 0.5}
  - {type: revolute, a: 0.4, limits: [-pi/2, pi/2]}
"""


@dataclass(frozen=True)
class Outcome:
    """What a command left behind."""

    status: int
    stdout: str
    stderr: str


def derive(*arguments: str, folder: Path, **variables: str) -> Outcome:
    """Run ``derive`` with ``arguments`` in ``folder``, in this process: what imports take is spent once."""
    streams = [_stream() for _ in range(2)]
    status = _run_main(arguments, folder, variables, *streams)
    return Outcome(status, *map(_printed, streams))


def derive_on_terminal(*arguments: str, folder: Path, **variables: str) -> tuple[int, str]:
    """The same with both streams as they follow each other, which is what a reader sees."""
    stream = _stream()
    status = _run_main(arguments, folder, variables, stream, stream)
    return status, _printed(stream)


def _stream() -> io.TextIOWrapper:
    return io.TextIOWrapper(io.BytesIO(), encoding="utf-8", write_through=True)


def _printed(stream: io.TextIOWrapper) -> str:
    return stream.buffer.getvalue().decode("utf-8")  # type: ignore[attr-defined]


def _run_main(arguments: Sequence[str], folder: Path, variables: Mapping[str, str], *streams: io.TextIOWrapper) -> int:
    with (
        contextlib.chdir(folder),
        mock.patch.dict(os.environ, variables),
        contextlib.redirect_stdout(streams[0]),
        contextlib.redirect_stderr(streams[1]),
    ):
        try:
            return main(arguments)
        except SystemExit as stop:
            return int(stop.code or 0)


def derive_process(*arguments: str, folder: Path, **variables: str) -> Outcome:
    """Run ``derive`` with ``arguments`` in ``folder``, in a process of its own: for what processes differ in."""
    done = subprocess.run(
        [sys.executable, "-m", "derive", *arguments],
        cwd=folder,
        env=environment(**variables),
        stdin=subprocess.DEVNULL,
        capture_output=True,
        encoding="utf-8",
        timeout=300,
    )
    return Outcome(done.returncode, done.stdout, done.stderr)


def environment(**variables: str) -> dict[str, str]:
    python_path = os.pathsep.join(filter(None, (str(ROOT), os.environ.get("PYTHONPATH", ""))))
    return {**os.environ, "PYTHONPATH": python_path, **variables}


def contents(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def is_one_message(text: str) -> bool:
    return text.startswith("derive") and ": error: " in text and text.count("\n") == 1


def accepted(*arguments: str, folder: Path, **variables: str) -> Outcome:
    """Run ``derive`` with what it must do: status 0."""
    done = derive(*arguments, folder=folder, **variables)
    assert done.status == 0, done.stderr
    return done


def refused(*arguments: str, folder: Path, **variables: str) -> Outcome:
    """Run ``derive`` with what it must refuse: status 2, and one message."""
    done = derive(*arguments, folder=folder, **variables)
    assert (done.status, is_one_message(done.stderr)) == (2, True), done.stderr
    return done
