"""Every error that derive raises on purpose: one tree, one base class; its warning; and what messages are made of.

A message says what was found, what is allowed, and what to do, on one line; users' text is quoted in it safely.
"""

from __future__ import annotations

import difflib
import re
import shlex
import sys
from collections.abc import Collection, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any, Self


@dataclass(frozen=True, slots=True)
class Location:
    """A place in a text file; line and column are 1-based."""

    source: str  # file name as the user gave it, or a name such as ``<expression>``
    line: int = 1  # line number, counted from 1
    column: int = 1  # column number, counted from 1

    def __str__(self) -> str:
        return f"{self.source}:{self.line}:{self.column}"


class DeriveError(Exception):
    """Base of all errors of this package.

    The message is one line: ``file:line:column: found; allowed; remedy``.
    """

    exit_status = 2

    def __init__(self, found: str, *, allowed: str = "", remedy: str = "", location: Location | None = None) -> None:
        self.found = found
        self.allowed = allowed
        self.remedy = remedy
        self.location = location
        text = "; ".join(part for part in (found, allowed, remedy) if part)
        super().__init__(f"{location}: {text}" if location else text)

    def at(self, location: Location) -> DeriveError:
        """The same error with a place."""
        return self if self.location is not None else self.moved(location)

    def moved(self, location: Location | None) -> Self:
        """The same error at another place."""
        return type(self)(self.found, allowed=self.allowed, remedy=self.remedy, location=location)


@contextmanager
def placed(location: Location) -> Iterator[None]:
    """Where an error that has no place of its own is said to be."""
    try:
        yield
    except DeriveError as error:
        raise error.at(location) from None


class RobotFileError(DeriveError):
    """A robot file that cannot be read or does not describe a robot."""


class ExpressionError(DeriveError):
    """A cell or formula outside the grammar."""


class UnknownRobotError(DeriveError):
    """Neither a readable file nor a name in the catalogue."""


class QuantityError(DeriveError):
    """A quantity that does not exist, or that this robot does not have."""


class OutputError(DeriveError):
    """The output folder cannot be written."""


class TargetError(DeriveError):
    """An unknown target, or one that cannot be had: of this robot, or without a C compiler."""


class LatexError(DeriveError):
    """LaTeX is missing, or refused a document."""


class CheckError(DeriveError):
    """A printed expression that cannot be read."""


class UnknownNameError(CheckError):
    """A name in a printed expression that the robot does not know: nothing can be decided."""


class VerificationError(DeriveError):
    """Generated code disagrees with the independent recursion."""

    exit_status = 1


class RobotFileWarning(UserWarning):
    """A remark on a robot file that is accepted, such as degrees in a file whose angles are in radians."""

    def __init__(self, text: str, location: Location | None = None) -> None:
        self.location = location
        super().__init__(text)


_LISTS_OF_ROWS = ("joints", "links", "base", "tool", "mount")


def quoted(text: str, length: int = 40) -> str:
    """A user's text in quotes, on one line, with control characters escaped."""
    shown = text if len(text) <= length else text[: length - 3] + "..."
    return "'" + "".join(c if c.isprintable() else c.encode("unicode_escape").decode("ascii") for c in shown) + "'"


def install_extra(extra: str) -> str:
    """The command that installs an optional part of derive where it runs.

    It names packages, which every index has: derive itself may come from a checkout or from the file of a wheel.
    """
    from importlib.metadata import PackageNotFoundError, requires  # nobody else pays for it

    try:
        needed = [text.split(";") for text in requires("derive-robot") or ()]
    except PackageNotFoundError:  # a checkout that is not installed
        return pip_install(f"{Path(__file__).parents[1]}[{extra}]")
    return pip_install(*(text[0].strip() for text in needed if re.search(rf"extra == ['\"]{extra}['\"]", text[-1])))


def optional(module: str, what: str, extra: str, kind: type[DeriveError] = TargetError) -> Any:
    """A module that comes with an optional part of derive; ``what`` says who needs which package."""
    try:
        import_module(module.partition(".")[0])  # a package may be hidden though its modules are there
        return import_module(module)
    except ImportError:
        raise kind(f"{what}, which is not installed", remedy=install_extra(extra)) from None


def pip_install(*packages: str) -> str:
    """The command that installs packages for the Python that runs derive."""
    return shlex.join([sys.executable, "-m", "pip", "install", *packages])


def near_miss(word: str, allowed: Iterable[str]) -> str:
    """A hint at what was meant."""
    by_fold = {candidate.casefold(): candidate for candidate in allowed}
    close = difflib.get_close_matches(word.casefold()[:80], by_fold, n=1, cutoff=0.6)
    return f"did you mean '{by_fold[close[0]]}'?" if close else ""


def require_known(word: str, known: Collection[str], found: str) -> None:
    """Refuse a word that is none of those known, with the nearest that is."""
    if word not in known:
        raise DeriveError(found, allowed=f"allowed: {listed(known)}", remedy=near_miss(word, known))


def listed(words: Iterable[str]) -> str:
    """Words separated by commas."""
    return ", ".join(words)


def path_text(path: tuple[str | int, ...], whole: str = "the robot file") -> str:
    """A place in a robot file, or in a motion plan, as a reader says it."""
    text = ""
    for before, part in zip(("", *path), path, strict=False):
        if isinstance(part, int):
            text += f" {'row' if before in _LISTS_OF_ROWS else 'entry'} {part + 1}"
        else:
            text += (", " if text else "") + part
    return text or whole
