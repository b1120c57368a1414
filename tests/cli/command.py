"""Runs the command in a process of its own, as a shell does."""

from __future__ import annotations

import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

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


@dataclass(frozen=True)
class Outcome:
    """What a command left behind."""

    status: int
    stdout: str
    stderr: str


def derive(*arguments: str, folder: Path, **variables: str) -> Outcome:
    """Run ``derive`` with ``arguments`` in ``folder``."""
    python_path = os.pathsep.join(filter(None, (str(ROOT), os.environ.get("PYTHONPATH", ""))))
    done = subprocess.run(
        [sys.executable, "-m", "derive", *arguments],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": python_path, **variables},
        stdin=subprocess.DEVNULL,
        capture_output=True,
        encoding="utf-8",
        timeout=120,
    )
    return Outcome(done.returncode, done.stdout, done.stderr)


def is_one_message(text: str) -> bool:
    """Whether standard error holds one line of ours and no traceback."""
    return text.startswith("derive") and ": error: " in text and text.count("\n") == 1
