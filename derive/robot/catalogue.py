"""The built-in robots: one YAML file each, under ``derive/robot/catalogue``."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from importlib.resources.abc import Traversable

from derive.errors import UnknownRobotError, near_miss, quoted

_SUFFIX = ".yaml"
_TITLE = re.compile(r'^title: "(.*)"$', re.MULTILINE)
_ROW = re.compile(r"^  - \{type: (?:revolute|prismatic)\b", re.MULTILINE)


@dataclass(frozen=True, slots=True)
class CatalogueEntry:
    """A line of ``derive list``.

    Attributes:
        name: Name to load it by.
        title: Its title.
        joints: Number of joints.
        has_dynamics: Whether it has link parameters.
    """

    name: str
    title: str
    joints: int
    has_dynamics: bool


@cache
def catalogue_names() -> tuple[str, ...]:
    """Names of the built-in robots, sorted."""
    stems = (entry.name.removesuffix(_SUFFIX) for entry in _folder().iterdir() if entry.name.endswith(_SUFFIX))
    return tuple(sorted(stems))


def catalogue_text(name: str) -> str:
    """The robot file of a built-in robot.

    Raises:
        UnknownRobotError: No such robot.
    """
    if name not in catalogue_names():
        raise UnknownRobotError(
            f"no catalogue robot {quoted(name)}",
            allowed="allowed: a name from derive list",
            remedy=near_miss(name, catalogue_names()),
        )
    return (_folder() / f"{name}{_SUFFIX}").read_text(encoding="utf-8")


def catalogue_entries() -> tuple[CatalogueEntry, ...]:
    """All built-in robots with their titles, read off the texts without parsing them; a test compares both."""
    return tuple(_entry(name, catalogue_text(name)) for name in catalogue_names())


def _folder() -> Traversable:
    return files("derive.robot") / "catalogue"


def _entry(name: str, text: str) -> CatalogueEntry:
    title = _TITLE.search(text)
    return CatalogueEntry(
        name=name,
        title=title.group(1) if title else name,
        joints=len(_ROW.findall(text)),
        has_dynamics="\nlinks:" in text,
    )
