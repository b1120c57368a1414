"""Somebody at a terminal: commands typed in one folder, files written by hand, and what comes out."""

import shlex
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

from tests.cli.command import Outcome, derive


@dataclass(frozen=True)
class Person:
    """Somebody who works in a folder of their own."""

    folder: Path

    def writes(self, name: str, text: str) -> None:
        """Save a file."""
        (self.folder / name).write_text(text, encoding="utf-8")

    def types(self, command: str, status: int = 0) -> Outcome:
        """Type a command of derive as one does in a shell."""
        program, *arguments = shlex.split(command)
        assert program == "derive"
        done = derive(*arguments, folder=self.folder)
        assert done.status == status, f"{command}\n{done.stdout}{done.stderr}"
        return done

    def runs(self, text: str) -> str:
        """Run a Python program in the folder, in an interpreter of its own."""
        done = subprocess.run(
            [sys.executable, "-c", text], cwd=self.folder, capture_output=True, text=True, timeout=120, check=False
        )
        assert done.returncode == 0, done.stderr
        return done.stdout
