"""Where figures were measured: processor and versions, no names of machines or folders."""

from __future__ import annotations

import platform
import shutil
import subprocess
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from derive import __version__

PACKAGES = (
    "EAIK",
    "adam-robotics",
    "casadi",
    "numpy",
    "pin",
    "py-ikgeo-kinematics",
    "roboticstoolbox-python",
    "scipy",
    "skidy",
    "ssik",
    "sympy",
    "toppra",
    "urdf2casadi",
)


def environment() -> dict[str, str]:
    """Names and versions."""
    found = {"derive": __version__, "Python": platform.python_version()}
    for name in PACKAGES:
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            found[name] = "not installed"
    return {**found, "C compiler": _compiler(), "processor": _processor(), "system": platform.system()}


def _processor() -> str:
    information = Path("/proc/cpuinfo")
    lines = information.read_text().splitlines() if information.is_file() else []
    names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return f"{names[0]}, {len(names)} cores" if names else platform.processor() or platform.machine()


def _compiler() -> str:
    command = shutil.which("cc") or shutil.which("gcc")
    if command is None:
        return "none"
    text = subprocess.run([command, "--version"], capture_output=True, text=True, check=False).stdout
    return text.splitlines()[0].replace(Path(command).name, "", 1).strip() if text else "unknown"
