"""The built-in robots: one YAML file each, under ``derive/robot/catalogue``."""

from __future__ import annotations

from functools import cache
from importlib.resources import files

from derive.errors import UnknownRobotError, near_miss, quoted

_FOLDER = files("derive.robot") / "catalogue"
_SUFFIX = ".yaml"


@cache
def catalogue_names() -> tuple[str, ...]:
    """Names of the built-in robots, sorted."""
    found = (entry.name for entry in _FOLDER.iterdir())
    return tuple(sorted(name.removesuffix(_SUFFIX) for name in found if name.endswith(_SUFFIX)))


def catalogue_text(name: str) -> str:
    """The robot file of a built-in robot.

    Args:
        name: One of `catalogue_names`.

    Returns:
        The YAML text.

    Raises:
        UnknownRobotError: No such robot.
    """
    if name not in catalogue_names():
        raise UnknownRobotError(
            f"no catalogue robot {quoted(name)}",
            allowed="allowed: a name from derive list",
            remedy=near_miss(name, catalogue_names()),
        )
    return (_FOLDER / f"{name}{_SUFFIX}").read_text(encoding="utf-8")
