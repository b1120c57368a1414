"""Interpreters of their own, and seeds of the hashes of strings, on which nothing may depend."""

import os
import subprocess
import sys
from pathlib import Path

from tests.places import ROOT


def printed_by(code: str, folder: Path = ROOT, **variables: str) -> str:
    """What the code prints in an interpreter of its own."""
    environment = os.environ | {"PYTHONPATH": str(ROOT)} | variables
    command = [sys.executable, "-c", code]
    done = subprocess.run(command, env=environment, cwd=folder, capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


def another_hash_seed() -> str:
    """A seed that is surely not this process's, which is random unless ``PYTHONHASHSEED`` is set."""
    return "7" if os.environ.get("PYTHONHASHSEED") != "7" else "99"
