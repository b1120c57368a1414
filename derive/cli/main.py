"""The command ``derive``: reads the arguments, runs one command, turns errors into a message and an exit status."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence
from importlib import import_module
from keyword import iskeyword
from typing import Any, NoReturn

from derive.version import __version__

COMMANDS = {
    "list": "list the built-in robots, or motion plans",
    "show": "print quantities of a robot: T, J, B, C, g, A[1], ...",
    "plot": "draw the arm with its frames, or its workspace",
    "build": "derive, generate and verify models; the main job",
    "handout": "a sheet to hand out: LaTeX, PDF and web page",
    "check": "compare printed formulas with derived ones",
    "style": "find the style of a book from some of its formulas",
    "verify": "compare generated functions with an independent recursion",
    "move": "a motion from via points: speeds, torques, work; plots, films, simulation",
    "import": "a robot file from a URDF, with a proven bound of its error",
    "export": "a robot for another program: URDF, MJCF, MATLAB, ...",
    "convert": "the same arm in the other Denavit-Hartenberg convention",
    "new": "write a commented robot file, or a motion plan, to start from",
    "schema": "print the JSON Schema of the robot file or the motion plan",
}
"""What each command does; its module `derive.cli.NAME`, or `NAME_`, is imported when it is asked for."""

OF_A_ROBOT = ("show", "plot", "build", "handout", "check", "verify", "convert", "export", "move", "new")
"""Commands that read robot files."""

ONE_THREAD = ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
"""Set to 1 unless the user has set them; NumPy reads them when it is imported, here and in the processes of ``--jobs``.

A fit of a hundred rows takes half a millisecond on one thread, and up to a hundred on two that wait for a core.
"""

_DESCRIPTION = "From a Denavit-Hartenberg table to closed-form equations and verified NumPy, CasADi and LaTeX models."
_EPILOG = """\
ROBOT is the path of a robot file or a name that `derive list` shows.
exit status: 0 done, 1 a check failed, 2 wrong input

examples:
  derive show scara-perugia T B      the equations, as the notes print them
  derive new my-arm                  a commented robot file to start from
  derive build my-arm.yaml           NumPy, CasADi and LaTeX in generated/my_arm, verified
  derive import arm.urdf -o my.yaml  a robot file from a URDF
"""


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command.

    Args:
        argv: Arguments without the program's name; ``sys.argv[1:]`` by default.

    Returns:
        The exit status: 0 done, 1 a check failed, 2 wrong input, 130 interrupted.

    Raises:
        SystemExit: For ``--help`` and ``--version`` (status 0) and unusable arguments (status 2).
    """
    for stream in (sys.stdout, sys.stderr):  # a title in Greek must not end in an exception on an ASCII terminal
        reconfigure = getattr(stream, "reconfigure", None)
        if reconfigure is not None:
            reconfigure(errors="backslashreplace")
    for name in ONE_THREAD:
        os.environ.setdefault(name, "1")
    arguments = _parser().parse_args(argv)
    from derive.cli.terminal import BROKEN_PIPE, explain, print_error, remarks_told  # help needs none of it

    try:
        with remarks_told(strict=getattr(arguments, "strict", False)):
            status = int(arguments.run(arguments))
        sys.stdout.flush()
        return status
    except BrokenPipeError:  # the reader has gone; keep the interpreter's last flush from complaining
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return BROKEN_PIPE
    except (Exception, KeyboardInterrupt) as error:
        reason, status = explain(error)
        print_error(reason)
        return status


class _Parser(argparse.ArgumentParser):
    """Usage errors are one line too: what a user typed may hold anything, and a usage block buries the reason."""

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:
        """Parse; a formula or an angle that begins with a minus sign is the value of the option before it.

        Options may stand anywhere, also between a robot and its quantities.

        Args:
            args: Arguments as typed.
            namespace: Where values are put.

        Returns:
            The namespace and what was not understood.
        """
        typed = list(sys.argv[1:] if args is None else args)
        known = self._option_string_actions
        options: list[str] = []
        others: list[str] = []
        without_value: list[str] = []
        while typed:
            text = typed.pop(0)
            if text == "--":
                others += [text, *typed]
                break
            # what follows a command is its own parser's to put in order
            is_option = text.partition("=")[0] in known and not (self._subparsers and others)
            if is_option and text in known and known[text].nargs is None:
                if not typed or typed[0] in {*known, "--"}:
                    without_value.append(text)
                    continue
                text = f"{text}={typed.pop(0)}"
            (options if is_option else others).append(text)
        return super().parse_known_args([*options, *others, *without_value], namespace)

    def error(self, message: str) -> NoReturn:
        """Refuse the arguments.

        Args:
            message: What is wrong with them.

        Raises:
            SystemExit: Always, with the status of wrong input.
        """
        from derive.cli.terminal import WRONG_INPUT, one_line

        self.exit(WRONG_INPUT, f"{self.prog}: error: {one_line(message)}; see '{self.prog} --help'\n")


class _Command(_Parser):
    """The parser of a command, which has its arguments when it is asked for them, so that help answers at once."""

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:
        """Import the command's module, which says what its arguments are, and parse.

        Args:
            args: Arguments behind the command's name.
            namespace: Where values are put.

        Returns:
            The namespace and what was not understood.
        """
        name = self.prog.split()[-1]
        module = import_module(f"derive.cli.{name}" + "_" * iskeyword(name))
        self.description = module.DESCRIPTION
        module.configure(self)
        if name in OF_A_ROBOT:
            self.add_argument("--strict", action="store_true", help="remarks on the robot file are errors")
        self.set_defaults(run=module.run)
        return super().parse_known_args(args, namespace)


def _parser() -> argparse.ArgumentParser:
    """The parser of all commands."""
    form: dict[str, Any] = {"formatter_class": argparse.RawDescriptionHelpFormatter, "allow_abbrev": False}
    parser = _Parser(prog="derive", description=_DESCRIPTION, epilog=_EPILOG, **form)
    parser.add_argument("--version", action="version", version=f"derive {__version__}")
    commands = parser.add_subparsers(metavar="COMMAND", required=True, dest="command", parser_class=_Command)
    for name, summary in COMMANDS.items():
        commands.add_parser(name, help=summary, **form)
    return parser
