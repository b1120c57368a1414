"""From a Denavit-Hartenberg table to a verified robot model."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from derive.version import __version__

if TYPE_CHECKING:
    from derive.errors import DeriveError
    from derive.notebook import Model
    from derive.robot.robot import Robot

__all__ = ["DeriveError", "Model", "Robot", "__version__"]

_HOMES = {
    "DeriveError": "derive.errors",
    "Model": "derive.notebook",
    "Robot": "derive.robot.robot",
}


def __getattr__(name: str) -> Any:
    """Import the public classes on first use, so that ``import derive`` stays cheap."""
    if name not in _HOMES:
        raise AttributeError(f"module 'derive' has no attribute {name!r}")
    from importlib import import_module

    return getattr(import_module(_HOMES[name]), name)
