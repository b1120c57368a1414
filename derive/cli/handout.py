"""``derive handout``: the equations of a robot as a sheet to hand out.

Options of ``derive handout`` that override the block ``handout:`` of the robot file.
"""

from __future__ import annotations

import argparse
import sys
import time
from dataclasses import fields, replace
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING

from derive.errors import listed, near_miss, quoted
from derive.robot.style import PARTS, Derivation, HandoutOptions, NotationOptions

if TYPE_CHECKING:
    from derive.handout.render import Format, Handout
    from derive.robot.robot import Robot


_KINDS: dict[str, type[StrEnum]] = {field.name: type(field.default) for field in fields(NotationOptions)}  # type: ignore[misc]


def parts(text: str) -> tuple[str, ...]:
    """Names of parts separated by commas, in the order of the handout; underscores may stand for hyphens."""
    words = [word.strip().replace("_", "-") for word in text.split(",") if word.strip()]
    for word in words:
        if word not in PARTS:
            raise _unknown("part", word, PARTS)
    if not words:
        raise argparse.ArgumentTypeError(f"no part in {quoted(text)}; allowed: {listed(PARTS)}")
    return tuple(part for part in PARTS if part in words)


def notation(text: str) -> tuple[tuple[str, StrEnum], ...]:
    """``angle=vartheta,inertia=M`` as pairs of a name and its value."""
    return tuple(_choice(item.strip()) for item in text.split(",") if item.strip())


def _choice(item: str) -> tuple[str, StrEnum]:
    name, equals, value = (word.strip() for word in item.partition("="))
    if name not in _KINDS:
        raise _unknown("notation", name, _KINDS)
    allowed = [member.value for member in _KINDS[name]]
    if not equals or value not in allowed:
        raise _unknown(f"value of {name}", value, allowed)
    return name, _KINDS[name](value)


def _unknown(what: str, word: str, allowed: tuple[str, ...] | list[str] | dict[str, type[StrEnum]]) -> Exception:
    hint = near_miss(word, allowed)
    message = f"unknown {what} {quoted(word)}; allowed: {listed(allowed)}" + (f"; {hint}" if hint else "")
    return argparse.ArgumentTypeError(message)


def chosen_options(robot: Robot, arguments: argparse.Namespace) -> HandoutOptions:
    """What the robot file says, and over it what the command says."""
    options = robot.handout
    if arguments.parts is not None:
        options = replace(options, parts=arguments.parts)
    if arguments.lang is not None:
        options = replace(options, language=arguments.lang)
    if arguments.derivation is not None:
        options = replace(options, derivation=Derivation(arguments.derivation))
    for choices in arguments.notation or ():
        options = replace(options, notation=replace(options.notation, **dict(choices)))
    return options


SUMMARY = "a sheet to hand out: LaTeX, PDF and web page"
DESCRIPTION = """\
Write the equations of ROBOT as a handout: table, transforms, Jacobian, dynamics, as far as the robot file gives them.

  derive handout scara-perugia --pdf --html --lang it
  derive handout my-arm.yaml --pdf --parts table,transforms,jacobian --derivation steps
  derive handout my-arm.yaml --pdf --exercise
  derive handout my-arm.yaml --fragment B > inertia.tex

Without --tex, --pdf and --html the LaTeX file is written. Options win over the block handout: of the robot file.
Files that derive did not write are not overwritten.
"""


def configure(parser: argparse.ArgumentParser) -> None:
    """The robot, the forms, and what is shown."""
    add = parser.add_argument
    add("robot", metavar="ROBOT", help="robot file or catalogue name")
    add("--tex", action="store_true", help="the LaTeX file; it stands alone (default)")
    add("--pdf", action="store_true", help="the LaTeX file and the PDF; needs latexmk and pdflatex")
    add("--html", action="store_true", help="a web page in one file; needs pip install 'derive-robot[handout]'")
    add("--out", metavar="DIR", type=Path, default=Path("."), help="folder of the files (default: the current one)")
    add("--parts", metavar="A,B", type=parts, help="only these parts, see docs/handout.md")
    add("--lang", metavar="CODE", help="language: en, it, pt or another that has a message catalogue")
    add("--derivation", choices=[choice.value for choice in Derivation], help="results, or the steps to them too")
    add("--notation", metavar="NAME=VALUE", type=notation, action="append", help="such as angle=vartheta,inertia=M")
    add("--exercise", action="store_true", help="an exercise with room for answers, and its solutions")
    add("--fragment", metavar="NAME", help="print the LaTeX of one part or quantity, to \\input into other notes")
    add("-o", dest="fragment_file", metavar="FILE", type=Path, help="write the fragment to FILE instead")
    add("-q", metavar="V1,V2,...", help="joint values that are drawn and computed, in the units of the robot file")
    add("--force", action="store_true", help="overwrite files that derive did not write")
    add("--quiet", action="store_true", help="no report")
    add("--json", action="store_true", help="machine-readable report")


def run(arguments: argparse.Namespace) -> int:
    """Write the handout, or print the fragment."""
    from derive.robot.robot import Robot

    _require_one_purpose(arguments)
    robot = _at_configuration(Robot.load(arguments.robot), arguments.robot, arguments.q)
    if arguments.fragment is not None:
        return _fragment(robot, arguments)
    return _handout(robot, arguments)


def _require_one_purpose(arguments: argparse.Namespace) -> None:
    from derive.errors import OutputError

    if arguments.fragment is None and arguments.fragment_file is not None:
        raise OutputError("-o without --fragment", remedy="name a folder with --out")
    forms = [form for form in ("--tex", "--pdf", "--html", "--exercise", "--json") if getattr(arguments, form[2:])]
    if arguments.fragment is not None and forms:
        raise OutputError(f"--fragment with {forms[0]}", allowed="a fragment is LaTeX on standard output or in -o FILE")


def _at_configuration(robot: Robot, name: str, text: str | None) -> Robot:
    """The robot with another configuration to draw."""
    if text is None:
        return robot
    from derive.robot.cells import joint_values

    q = joint_values(robot, text.split(","))
    return replace(robot, figure=replace(robot.figure, q=q))


def _fragment(robot: Robot, arguments: argparse.Namespace) -> int:
    from derive.handout.fragment import fragment_text
    from derive.publish.publish import write_files

    text = fragment_text(robot, chosen_options(robot, arguments), arguments.fragment)
    target: Path | None = arguments.fragment_file
    if target is None:
        sys.stdout.write(text)
    else:
        write_files({target.name: text.encode()}, target.parent, force=arguments.force)
    return 0


def _handout(robot: Robot, arguments: argparse.Namespace) -> int:
    from derive.cli.terminal import print_json
    from derive.handout.render import handout_files
    from derive.publish.publish import write_files

    started = time.perf_counter()
    options = chosen_options(robot, arguments)
    handout = handout_files(robot, options, _formats(arguments), exercise_sheets=arguments.exercise)
    paths = write_files(handout.files, arguments.out, force=arguments.force)
    seconds = time.perf_counter() - started
    if arguments.json:
        print_json(_report(robot, handout, paths, seconds))
    elif not arguments.quiet:
        _print(handout, paths, seconds)
    return 0


def _formats(arguments: argparse.Namespace) -> tuple[Format, ...]:
    from derive.handout.render import Format

    chosen = [form for form in Format if getattr(arguments, form.value)]
    if not chosen or Format.PDF in chosen:
        chosen = [Format.TEX, *(form for form in chosen if form is not Format.TEX)]
    return tuple(chosen)


def _report(robot: Robot, handout: Handout, paths: list[Path], seconds: float) -> dict[str, object]:
    files = [
        {"path": str(path), "bytes": len(handout.files[path.name]), "pages": handout.pages.get(path.name)}
        for path in paths
    ]
    return {"robot": robot.name, "files": files, "parts": list(handout.parts), "seconds": round(seconds, 3)}


def _print(handout: Handout, paths: list[Path], seconds: float) -> None:
    for path in paths:
        pages = handout.pages.get(path.name)
        print(f"{path}: {pages} page{'' if pages == 1 else 's'}" if pages else path)
    print(f"{len(handout.parts)} parts in {seconds:.1f} s")
