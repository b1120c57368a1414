"""The one Jinja environment: templates hold text, loops and flags; everything else is computed before.

Undefined names are errors, blocks leave no blank lines behind, and lines end with a line feed everywhere. The
thresholds of inverse kinematics are ``policy`` in all of them.
"""

from __future__ import annotations

from functools import cache
from importlib.resources import files
from importlib.resources.abc import Traversable
from pathlib import Path

from jinja2 import Environment, FunctionLoader, StrictUndefined

from derive.robot.solution_policy import POLICY


def render(template: str, **context: object) -> str:
    """A template filled in.

    Args:
        template: Path below the template folder, for instance ``numpy/model_numpy.py.jinja``.
        context: What the template asks for.

    Returns:
        The text.
    """
    return environment().get_template(template).render(context)


@cache
def environment() -> Environment:
    """The environment of all templates."""
    found = Environment(
        loader=FunctionLoader(_read),
        undefined=StrictUndefined,
        autoescape=False,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        newline_sequence="\n",
    )
    found.globals["policy"] = POLICY.texts
    return found


def template_folder() -> Traversable:
    """``derive/templates`` of an installed wheel, else ``templates`` beside the package in a checkout."""
    installed = files("derive").joinpath("templates")
    return installed if installed.is_dir() else Path(__file__).parents[2] / "templates"


def _read(name: str) -> str | None:
    path = template_folder()
    for part in name.split("/"):
        path = path.joinpath(part)
    return path.read_text(encoding="utf-8") if path.is_file() else None
