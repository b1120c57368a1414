"""``derive completion``: what lets a shell complete commands, options, robots and quantities."""

import argparse
from collections.abc import Iterable
from typing import Any

DESCRIPTION = """\
Print a script that makes the shell complete commands, options, robots, plans, quantities, targets and files.
The shell reads the script when it starts; derive is not run while you type. Print it again after updating derive.

  derive completion bash > ~/.local/share/bash-completion/completions/derive
  derive completion zsh > ~/.zfunc/_derive
  derive completion fish > ~/.config/fish/completions/derive.fish
"""

SHELLS = ("bash", "zsh", "fish")


def configure(parser: argparse.ArgumentParser) -> None:
    """The shell."""
    parser.add_argument("shell", metavar="SHELL", choices=SHELLS, help=", ".join(SHELLS))


def run(arguments: argparse.Namespace) -> None:
    """Print the script."""
    import shtab

    from derive.api.robots import catalogue
    from derive.cli.main import whole_parser
    from derive.handouts.sheet.language import languages
    from derive.model.quantities import DESCRIBED, REGISTRY
    from derive.plans.catalogue import plan_names
    from derive.publish.targets import EVERY, TARGETS

    # what is completed, by the name that help gives a value, or by that of its option
    offered: dict[object, Any] = {
        "ROBOT": _words("robots", catalogue(), files=True),
        "PLAN": _words("plans", plan_names(), files=True),
        "QUANTITY": _words("quantities", [*REGISTRY, *DESCRIBED]),
        "CODE": _words("languages", languages()),
        "target": _words("targets", [*TARGETS, EVERY]),
        "FILE": shtab.FILE,
        "DIR": shtab.DIRECTORY,
    }
    parser, commands = whole_parser()
    for command in commands:
        for action in command._actions:
            if not action.choices and (found := offered.get(action.metavar) or offered.get(action.dest)):
                action.complete = found  # type: ignore[attr-defined]
    print(shtab.complete(parser, shell=arguments.shell))


def _words(what: str, words: Iterable[str], *, files: bool = False) -> dict[str, Any]:
    """Words, and files beside them, in the languages of the shells; bash takes what is called a file for one."""
    name, listed = f"_derive_{'file_' if files else ''}{what}", " ".join(words)
    bash, zsh, fish = ("; compgen -f -- $1", " 'files:file:_files'", "; __fish_complete_path (commandline -ct)")
    functions = {
        "bash": f"{name}() {{ compgen -W '{listed}' -- $1{bash * files}; }}",
        "zsh": f"{name}() {{ _alternative '{what}:{what}:({listed})'{zsh * files} }}",
        "fish": f"function {name}; printf '%s\\n' {listed}{fish * files}; end",
    }
    return {"bash": name, "zsh": name, "fish": f"({name})", "preamble": functions}
