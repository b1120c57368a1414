"""The one Jinja environment: templates hold text, loops and flags; everything else is computed before."""

import sys
from contextlib import suppress
from functools import cache
from importlib.resources import files
from importlib.resources.abc import Traversable
from importlib.util import cache_from_source
from pathlib import Path

from jinja2 import Environment, FileSystemBytecodeCache, FunctionLoader, StrictUndefined
from jinja2.bccache import Bucket

from derive.robot.load import catalogue_names
from derive.robot.options.solution_policy import POLICY


def render(template: str, **context: object) -> str:
    """A template filled in."""
    context["argument"] = robot_argument(str(context.get("name", "")))
    return environment().get_template(template).render(context)


class _Compiled(FileSystemBytecodeCache):
    """Templates as Python compiles them, beside the byte code of this module; each is looked up by its text."""

    def dump_bytecode(self, bucket: Bucket) -> None:
        """Keep a template, where Python, too, keeps byte code: compiling them takes a tenth of a build."""
        if not sys.dont_write_bytecode:
            with suppress(OSError):  # a folder that nobody may write, where Python keeps nothing either
                super().dump_bytecode(bucket)


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
        bytecode_cache=_Compiled(str(Path(cache_from_source(__file__)).parent), "template-%s.pyc"),
    )
    found.globals["policy"] = POLICY.texts
    return found


def robot_argument(name: str) -> str:
    """How commands in hints name a robot: built-in ones by name, others by the file that ``derive new`` would make."""
    return name if name in catalogue_names() else f"{name}.yaml"


def template_folder() -> Traversable:
    """``derive/templates`` of an installed wheel, else ``templates`` beside the package in a checkout."""
    installed = files("derive").joinpath("templates")
    return installed if installed.is_dir() else Path(__file__).parents[2] / "templates"


def _read(name: str) -> str | None:
    return path.read_text(encoding="utf-8") if (path := template_folder().joinpath(name)).is_file() else None
