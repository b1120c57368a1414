"""``derive handout``: the equations of a robot as a sheet to hand out."""

import argparse
import sys
from pathlib import Path

from derive.cli.terminal import STDOUT, add_shared, keywords, print_json, progress
from derive.errors import OutputError
from derive.robot.options.handout import Derivation, NotationOptions, chosen_notation, chosen_pages, chosen_parts

DESCRIPTION = """\
Write the equations of ROBOT as a handout: table, transforms, Jacobian and, where links are given, dynamics.

Without --tex, --pdf and --html the LaTeX file is written. Options take precedence over the robot file's handout: block.

  derive handout scara-perugia --pdf --html --lang it
  derive handout my-arm.yaml --pdf --parts table,transforms,jacobian --derivation steps
  derive handout my-arm.yaml --pdf --exercise
  derive handout my-arm.yaml --fragment B > inertia.tex
"""


def configure(parser: argparse.ArgumentParser) -> None:
    """The robot, the forms, and what is shown."""
    add = parser.add_argument
    add_shared(parser, "robot")
    add("--tex", action="store_true", help="write a complete LaTeX file (default)")
    add("--pdf", action="store_true", help="write LaTeX and PDF; needs latexmk and pdflatex")
    add("--html", action="store_true", help="write a web page in one file")
    add_shared(parser, "folder", help="folder for the files (default: the current one); with --fragment, the file")
    parts = "only these parts, such as table,jacobian,inertia"
    add("--parts", metavar="A,B", type=lambda text: chosen_parts(text.split(",")), help=parts)
    add_shared(parser, "lang")
    add("--derivation", choices=[choice.value for choice in Derivation], help="print results, or the steps as well")
    letters = "such as angle=vartheta,inertia=M"
    add("--notation", metavar="NAME=VALUE", type=_notation, action="append", help=letters)
    grouped = parser.add_mutually_exclusive_group()
    add_shared(grouped, "style", help="how expressions are grouped, as for derive show")
    from_notes = "group expressions as these notes do: a .tex file or a corpus file, see derive style"
    grouped.add_argument("--style-from", metavar="NOTES", help=from_notes)
    pages = "largest number of pages; less important parts are left out (default: 20; 0: no limit)"
    add("--pages", metavar="N", type=chosen_pages, help=pages)
    add("--exercise", action="store_true", help="write an exercise with room for answers, and its solutions")
    add("--plan", metavar="PLAN", help="add a part about this motion plan; the web page plays it")
    add("--fragment", metavar="NAME", help="print the LaTeX of one part or quantity, to \\input into other notes")
    add("--width", metavar="W", help="width of the fragment's lines, such as 84mm (default: that of the document)")
    add_shared(parser, "at", help="joint values for the figure and the numbers, in the units of the robot file")
    add_shared(parser, "force", "quiet", "json")


def _notation(text: str) -> dict[str, str]:
    """``angle=vartheta,inertia=M`` as names and values."""
    chosen = {}
    for item in (item.strip() for item in text.split(",") if item.strip()):
        name, _, value = (word.strip() for word in item.partition("="))
        chosen_notation({name: value}, NotationOptions())
        chosen[name] = value
    return chosen


def run(arguments: argparse.Namespace) -> None:
    """Write the handout, or print the fragment."""
    from derive.api.handout import fragment, handout
    from derive.api.robots import load
    from derive.api.style import find_style
    from derive.publish.atomic_folder import refuse_taken, write_files

    formats = [form for form in ("tex", "pdf", "html") if getattr(arguments, form)]
    of_handouts = [*formats, *(name for name in ("exercise", "json", "plan") if getattr(arguments, name))]
    no_folder = arguments.out and (arguments.out == STDOUT or arguments.out.suffix in (".tex", ".pdf", ".html"))
    if arguments.fragment is None and no_folder:
        allowed = "allowed: a handout goes into a folder, a fragment into a file"
        raise OutputError(f"-o {arguments.out} works only with --fragment", allowed=allowed, remedy="name a folder")
    if arguments.fragment is None and arguments.width is not None:
        raise OutputError("--width works only with --fragment", remedy="leave it out: a handout is as wide as its page")
    if arguments.fragment is not None and of_handouts:
        allowed = "allowed: a fragment is LaTeX on standard output or in -o FILE"
        raise OutputError(f"--fragment with --{of_handouts[0]}", allowed=allowed)
    options = {
        **keywords(arguments, "parts", "derivation", "style"),
        "language": arguments.lang,
        "notation": {name: value for chosen in arguments.notation or () for name, value in chosen.items()},
        "q": ",".join(arguments.at).split(",") if arguments.at else None,
    }
    robot = load(arguments.robot)
    found = None if arguments.style_from is None else find_style(robot, examples=[Path(arguments.style_from)])
    if found is not None:
        options["style"] = found.style
    if arguments.fragment is not None:
        file = None if arguments.out == STDOUT else arguments.out
        refuse_taken([file] if file else [], force=arguments.force)
        text = fragment(robot, arguments.fragment, **options, width=arguments.width)
        if file is None:
            sys.stdout.write(text)
        else:
            write_files({file: text.encode()}, force=arguments.force)
        return
    flags = keywords(arguments, "exercise", "force", "pages", "plan")
    with progress(1, quiet=arguments.quiet or arguments.json) as tell:
        result = handout(robot, arguments.out or Path(), formats=formats, **options, **flags, progress=tell)
    if arguments.json:
        print_json(result.as_dict() | {"remarks": robot.remarks_as_dicts})
    elif not arguments.quiet:
        for file in result.files:
            print(f"{file.path}: {file.pages} page{'' if file.pages == 1 else 's'}" if file.pages else file.path)
        if found is not None:
            print(f"style of {arguments.style_from}: {found.style}; {found.summary}")
        if result.shortened:
            print("shortened to fit --pages; page 1 lists what is missing; --pages 0 prints everything")
        print(f"{len(result.parts)} parts in {result.seconds:.1f} s")
