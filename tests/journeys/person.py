"""Somebody at a terminal: commands typed in one folder, files written by hand, and what comes out."""

import shlex
from dataclasses import dataclass
from pathlib import Path

from tests.cli.command import Outcome, derive
from tests.interpreters import printed_by


@dataclass(frozen=True)
class Person:
    """Somebody who works in a folder of their own."""

    folder: Path

    def writes(self, name: str, text: str) -> None:
        (self.folder / name).write_text(text, encoding="utf-8")

    def types(self, command: str, status: int = 0) -> Outcome:
        program, *arguments = shlex.split(command)
        assert program == "derive"
        done = derive(*arguments, folder=self.folder)
        assert done.status == status, f"{command}\n{done.stdout}{done.stderr}"
        return done

    def runs(self, text: str) -> str:
        return printed_by(text, self.folder)
