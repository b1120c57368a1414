"""Name and title of a robot."""

from __future__ import annotations

import keyword
import re
import unicodedata

from derive.robot.document import Document
from derive.robot.limits import FILE_LIMITS
from derive.robot.wording import quoted

_NAME = re.compile(rf"[a-z0-9][a-z0-9-]{{0,{FILE_LIMITS.name_length - 1}}}")
_DEVICES = {"con", "prn", "aux", "nul"} | {f"{port}{k}" for port in ("com", "lpt") for k in range(10)}
_IMPORTED_BY_GENERATED_CODE = {"numpy", "casadi", "math", "derive"}
_FORBIDDEN_CATEGORIES = {"Cc", "Cs"}


def is_robot_name(name: str) -> bool:
    """Whether ``name`` has the right letters and makes an importable folder on every system."""
    taken = _DEVICES | _IMPORTED_BY_GENERATED_CODE
    return _NAME.fullmatch(name) is not None and not keyword.iskeyword(name) and name not in taken


def read_name(document: Document) -> str:
    """The robot's name, which becomes the name of an importable folder.

    Raises:
        RobotFileError: Not ``[a-z0-9][a-z0-9-]*``, or a name that cannot be a folder or a Python package.
    """
    scalar = document.scalar(("name",))
    name = scalar.text if scalar else ""
    if _NAME.fullmatch(name) is None:
        raise document.error(
            ("name",),
            f"{quoted(name)} is not a robot name",
            f"allowed: a-z, 0-9 and -, at most {FILE_LIMITS.name_length} characters",
            f"write for instance {_suggestion(name)}; the title may be any text",
        )
    if not is_robot_name(name):
        raise document.error(
            ("name",), f"'{name}' cannot be the name of a Python package", remedy=f"write for instance {name}-robot"
        )
    return name


def _suggestion(name: str) -> str:
    plain = unicodedata.normalize("NFKD", name).encode("ascii", "ignore").decode("ascii").lower()
    words = re.sub(r"[^a-z0-9]+", "-", plain).strip("-")[: FILE_LIMITS.name_length - 6]
    return words if _NAME.fullmatch(words) else f"robot-{words}".strip("-")


def read_title(document: Document) -> str:
    """The title, an inert text; empty when there is none.

    Raises:
        RobotFileError: Too long, or with control characters other than line breaks and tabs.
    """
    scalar = document.scalar(("title",))
    if scalar is None:
        return ""
    title = scalar.text
    if len(title) > FILE_LIMITS.title_length:
        raise document.error(
            ("title",), f"{len(title)} characters", f"allowed: at most {FILE_LIMITS.title_length}", "shorten it"
        )
    for character in title:
        if character not in "\n\t" and unicodedata.category(character) in _FORBIDDEN_CATEGORIES:
            raise document.error(
                ("title",), f"control character U+{ord(character):04X}", "allowed: text, line breaks and tabs"
            )
    return title
