"""From a Denavit-Hartenberg table to a verified robot model."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from derive.errors import DeriveError
    from derive.mechanics.model import Model
    from derive.robot.robot import Robot

__version__ = "0.1.0"

__all__ = ["DeriveError", "Model", "Robot", "__version__"]

_HOMES = {
    "DeriveError": "derive.errors",
    "Model": "derive.mechanics.model",
    "Robot": "derive.robot.robot",
}


def __getattr__(name: str) -> Any:
    """Import the public classes on first use, so that ``import derive`` stays cheap."""
    if name not in _HOMES:
        raise AttributeError(f"module 'derive' has no attribute {name!r}")
    from importlib import import_module

    if name == "Model":
        import_module("derive.notebook").install()
    return getattr(import_module(_HOMES[name]), name)
