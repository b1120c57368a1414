"""The command ``derive``: reads the arguments, runs one command, turns errors into a message and an exit status."""

import argparse
import atexit
import gc
import os
import signal
import sys
from collections.abc import Iterable, Mapping, Sequence
from importlib import import_module
from itertools import pairwise
from keyword import iskeyword
from typing import Any, NoReturn

from derive.version import __version__

# What each command does; its module `NAME`, or `NAME_`, of `derive.cli` or its `data` is imported when it is used.
COMMANDS = {
    "list": "list the built-in robots, or motion plans",
    "show": "print quantities of a robot: T, J, B, C, g, A[1], ...",
    "plot": "draw the arm with its frames, or its workspace",
    "build": "derive the equations, generate code and verify it",
    "handout": "write a handout: LaTeX, PDF and web page",
    "check": "compare printed formulas with derived ones",
    "style": "find the style of a book from some of its formulas",
    "verify": "compare generated functions with an independent recursion",
    "move": "compute a motion: speeds, torques, work, plots, animations, simulation",
    "excite": "find a motion that tells the parameters of a robot",
    "identify": "identify masses, inertias and friction from a log",
    "sample": "reduce functions over many configurations: extremes, means, quantiles",
    "map": "map the workspace: poses reached, postures, manipulability, margins",
    "import": "convert a URDF to a robot file, with a proven error bound",
    "export": "write a robot for another program: URDF, MJCF, MATLAB, ...",
    "convert": "convert a robot to the other Denavit-Hartenberg convention",
    "new": "write a commented robot file or motion plan to start from",
    "schema": "print the JSON Schema of the robot file or the motion plan",
    "completion": "print a completion script for the shell",
}
OF_DATA = ("excite", "identify", "map", "sample")
OF_NO_ROBOT = ("list", "import", "schema", "completion")  # commands that read no robot file
# Set to 1 unless the user has set them; NumPy reads them when it is imported, here and in the processes of ``--jobs``.
# A fit of a hundred rows takes half a millisecond on one thread, and up to a hundred on two that wait for a core.
ONE_THREAD = ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")

# Objects after which Python looks for garbage; its own 700 cost a tenth of a command that is mostly imports.
COLLECTED_AFTER = (500_000, 10, 10)
_DESCRIPTION = "Turn a Denavit-Hartenberg table into symbolic equations and verified NumPy, CasADi, C and LaTeX files."
_EPILOG = """\
ROBOT is the path of a robot file or a name that `derive list` shows.
exit status: 0 done, 1 a check failed, 2 wrong input; derive help check tells of 3

examples:
  derive show scara-perugia T B      the equations, as the notes print them
  derive new my-arm                  a commented robot file to start from
  derive build my-arm.yaml           NumPy, CasADi and LaTeX in generated/my_arm, verified
  derive import arm.urdf -o my.yaml  a robot file from a URDF
  derive help show                   what a command does, with examples
"""


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command."""
    for stream in (sys.stdout, sys.stderr):  # a title in Greek must not end in an exception on an ASCII terminal
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="backslashreplace")
    for name in ONE_THREAD:
        os.environ.setdefault(name, "1")
    gc.set_threshold(*COLLECTED_AFTER)
    atexit.register(gc.freeze)  # looking for garbage once more before the end takes a tenth of a second
    typed = list(sys.argv[1:] if argv is None else argv)
    try:
        # ``derive help COMMAND`` is ``derive COMMAND --help``, and nothing at all ``derive --help``.
        of_help = [*(word for word in typed[1:] if word != "help"), "--help"]
        arguments = _parsers()[0].parse_args(typed if typed and typed[0] != "help" else of_help)
        from derive.cli.terminal import remarks_told  # help needs none of it

        with remarks_told(strict=getattr(arguments, "strict", False)):
            status = arguments.run(arguments) or 0
        sys.stdout.flush()
        atexit.register(signal.signal, signal.SIGINT, signal.SIG_IGN)  # all is done: an interrupt comes too late
        return status
    except BrokenPipeError:  # the reader has gone; keep the interpreter's last flush from complaining
        from derive.cli.terminal import BROKEN_PIPE

        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return BROKEN_PIPE
    except (Exception, KeyboardInterrupt) as error:
        from derive.cli.terminal import error_dict, explain, print_error, print_json

        reason, status = explain(error)
        # Whether a program reads the output is told from the arguments as typed: they may be unusable otherwise.
        if "--json" in typed or "--format=json" in typed or ("--format", "json") in pairwise(typed):
            print_json({"error": error_dict(error, reason, status)})
        print_error(reason)
        return status


class _Parser(argparse.ArgumentParser):
    """Usage errors are errors like others, in one line: a usage block would bury the reason."""

    old: Mapping[str, str] = {}  # names that options had before, with those that they have

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:
        """Parse options, which may stand anywhere; a value of one may begin with a minus sign, as formulas do."""
        typed = list(sys.argv[1:] if args is None else args)
        known = self._option_string_actions
        options: list[str] = []
        others: list[str] = []
        without_value: list[str] = []
        while typed:
            text = typed.pop(0)
            name, equals, value = text.partition("=")
            if name in self.old:
                name, text = self.old[name], self.old[name] + equals + value
            elif text[:2] in self.old:  # the value of one with a single letter may follow at once
                name, text = self.old[text[:2]], f"{self.old[text[:2]]}={text[2:]}"
            if text == "--":
                others += [text, *typed]
                break
            of_command = self._subparsers and others  # its own parser puts in order what follows a command
            if not of_command and text[:1] == "-" != text and not {name, text[:2]} & known.keys():
                early = bool(self._subparsers and typed)
                self.error(f"no option {name!r}{' before the command' * early}", name, () if early else known)
            if of_command or name not in known:
                others.append(text)
                continue
            if text in known and known[text].nargs is None:
                if not typed or typed[0] in {*known, *self.old, "--"}:
                    without_value.append(text)
                    continue
                text = f"{text}={typed.pop(0)}"
            options.append(text)
        return super().parse_known_args([*options, *others, *without_value], namespace)

    def _get_value(self, action: argparse.Action, arg_string: str) -> Any:
        """The value of an option, which may be refused as those of the Python API are."""
        from derive.errors import DeriveError

        try:
            return super()._get_value(action, arg_string)
        except DeriveError as error:
            raise argparse.ArgumentError(action, str(error)) from None

    def _check_value(self, action: argparse.Action, value: Any) -> None:
        """Refuse a word that is none of those allowed, with the nearest that is."""
        if action.choices is None or value in action.choices:
            return
        name = str(action.metavar).lower()
        what = f"{value!r} as {action.option_strings[-1]}" if action.option_strings else f"no {name} {value!r}"
        self.error(f"{what}; allowed: {', '.join(map(str, action.choices))}", str(value), map(str, action.choices))

    def error(self, message: str, word: str = "", allowed: Iterable[str] = ()) -> NoReturn:
        from derive.errors import DeriveError, near_miss

        raise DeriveError(message, allowed=near_miss(word, allowed), remedy=f"see '{self.prog} --help'")


class _Command(_Parser):
    """The parser of a command, which has its arguments when it is asked for them, so that help answers at once."""

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:
        self.configured()
        found, surplus = super().parse_known_args(args, namespace)
        return (found, surplus) if not surplus else self.error(f"{surplus[0]!r} is an argument too many")

    def configured(self) -> None:
        """Import the command's module, which says what its arguments are."""
        from derive.cli.terminal import OLD, add_shared  # help needs none of it

        name = self.prog.split()[-1]
        folder = "derive.cli.data" if name in OF_DATA else "derive.cli"
        module = import_module(f"{folder}.{name}" + "_" * iskeyword(name))
        self.description, _, examples = module.DESCRIPTION.rpartition("\n\n")
        self.epilog = f"examples:\n{examples}"
        module.configure(self)
        if name not in OF_NO_ROBOT:
            add_shared(self, "strict")
        self.old = OLD.get(name, {})
        self.set_defaults(run=module.run)


def whole_parser() -> tuple[argparse.ArgumentParser, list[argparse.ArgumentParser]]:
    """The parser of all commands, and theirs with all arguments."""
    parser, commands = _parsers()
    for command in commands:
        command.configured()
    return parser, [*commands]


def _parsers() -> tuple[argparse.ArgumentParser, list[_Command]]:
    """The parser of all commands, and theirs, which have no arguments yet."""
    form: dict[str, Any] = {"formatter_class": argparse.RawDescriptionHelpFormatter, "allow_abbrev": False}
    parser = _Parser(prog="derive", description=_DESCRIPTION, epilog=_EPILOG, **form)
    parser.add_argument("-V", "--version", action="version", version=f"derive {__version__}")
    commands = parser.add_subparsers(metavar="COMMAND", required=True, dest="command", parser_class=_Command)
    return parser, [commands.add_parser(name, help=summary, **form) for name, summary in COMMANDS.items()]
