"""One option, one name in every command: properties over all parsers; help, which answers at once."""

import argparse
import json
import re
import resource
import shlex
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from derive.cli.main import COMMANDS, main, whole_parser
from derive.cli.terminal import OLD, SHARED, file_or_stdout
from derive.version import __version__
from tests.cli.command import derive
from tests.interpreters import printed_by
from tests.places import ROOT

PARSERS = dict(zip(COMMANDS, whole_parser()[1], strict=True))


def options() -> Iterator[tuple[str, argparse.Action]]:
    for name, parser in PARSERS.items():
        yield from ((name, action) for action in parser._actions if action.option_strings)


def test_an_option_has_one_name_and_a_name_one_option() -> None:
    names: dict[str, set[tuple[str, ...]]] = {}
    meanings: dict[str, set[str]] = {}
    for _, action in options():
        names.setdefault(action.dest, set()).add(tuple(action.option_strings))
        for text in action.option_strings:
            meanings.setdefault(text, set()).add(action.dest)
    assert {dest: found for dest, found in names.items() if len(found) > 1} == {}
    assert {text: found for text, found in meanings.items() if len(found) > 1} == {}


def test_shared_options_take_the_same_kind_of_value_everywhere() -> None:
    kinds: dict[str, set[object]] = {}
    for _, action in options():
        if action.dest in SHARED:
            kinds.setdefault(action.dest, set()).add((type(action), action.nargs))
    assert {dest: found for dest, found in kinds.items() if len(found) > 1} == {}
    assert {"out", "at", "json", "quiet", "force", "format", "lang", "strict"} <= kinds.keys()


def test_every_command_answers_a_program_and_every_writer_can_be_forced_and_silenced() -> None:
    having = {dest: {name for name, action in options() if action.dest == dest} for dest in ("json", "force", "quiet")}
    assert having["json"] >= COMMANDS.keys() - {"completion"}
    written = {name for name, action in options() if action.type in (Path, file_or_stdout)} | {"new"}
    assert having["force"] >= written - {"verify"}  # its folder is read
    assert having["quiet"] >= written


@pytest.mark.parametrize("command", OLD)
def test_old_names_mean_the_new_ones_and_are_not_shown(command: str) -> None:
    parser, known = PARSERS[command], PARSERS[command]._option_string_actions
    for old, new in OLD[command].items():
        assert new in known
        assert old not in known
        assert not re.search(rf"{old}\b", parser.format_help())


@pytest.mark.parametrize("at", ["-q 0.5,-0.5", "-q=-0.5,0.5", "-q-0.5,0.5", "-q -0.5,0.5", "--at -0.5,0.5", "--at=0,1"])
@pytest.mark.first(3)
def test_joint_values_are_read_however_they_are_given(at: str, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    values = re.sub(r"(-q|--at)[ =]?", "", at).replace(" ", ",").split(",")
    done = derive("plot", "planar-2r-perugia", *at.split(), "-o", "a.svg", folder=tmp_path)
    assert f"q1 = {float(values[0]):.4g} rad, q2 = {float(values[1]):.4g} rad" in done.stdout, done.stderr


def examples(command: str) -> list[list[str]]:
    """The arguments of each example in a command's help; a line that goes on is indented further."""
    text = PARSERS[command].epilog.partition("examples:\n")[2].replace("\n    ", " ")
    lines = [line.partition(" > ")[0] for line in text.splitlines()]
    return [shlex.split(line) for line in lines]


@pytest.mark.parametrize("command", COMMANDS)
def test_examples_of_help_are_commands_that_parse(command: str) -> None:
    found = examples(command)
    assert found
    for program, name, *arguments in found:
        assert (program, name) == ("derive", command)
        assert argparse.ArgumentParser.parse_known_args(PARSERS[command], arguments)[1] == []


@pytest.mark.parametrize("arguments", ["", "help", "help help"])
def test_help_of_all_is_asked_for_in_every_way(arguments: str, tmp_path: Path) -> None:
    done = derive(*arguments.split(), folder=tmp_path)
    assert done == derive("--help", folder=tmp_path)
    assert all(f"    {command} " in done.stdout for command in COMMANDS)


@pytest.mark.parametrize("command", COMMANDS)
def test_help_of_a_command_is_asked_for_in_both_ways(command: str, tmp_path: Path) -> None:
    done = derive("help", command, folder=tmp_path)
    assert done == derive(command, "--help", folder=tmp_path)
    assert (done.status, "examples:\n  derive " + command in done.stdout) == (0, True)


def test_quiet_leaves_the_report_out_and_no_file(tmp_path: Path) -> None:
    assert derive("new", "arm", "--quiet", folder=tmp_path).stdout == ""
    for typed in ("convert arm.yaml -o a.yaml", "export kuka-kr5 --format csv -o a.csv"):
        done = derive(*typed.split(), "--quiet", folder=tmp_path)
        assert (done.status, done.stdout) == (0, ""), done.stderr
    assert {path.name for path in tmp_path.iterdir()} == {"arm.yaml", "a.yaml", "a.csv"}


def test_a_program_is_told_which_file_was_written(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    assert json.loads(derive("new", "arm", "--json", folder=tmp_path).stdout) == {"file": "arm.yaml"}
    drawn = json.loads(derive("plot", "arm.yaml", "-o", "a.svg", "--json", folder=tmp_path).stdout)
    assert (drawn["robot"], drawn["file"]) == ("arm", "a.svg")


OURS = ("derive.mechanics", "derive.model", "derive.targets", "derive.api", "derive.handouts")
HEAVY = ("sympy", "numpy", "casadi", "flint", "pydantic", "yaml", "jinja2", "rich", *OURS)


def seconds_of_work(*arguments: str) -> float:
    """Processor time of a Python process, the least of five: what else the machine does makes no difference to it."""
    found = []
    for _ in range(5):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run([sys.executable, *arguments], cwd=ROOT, capture_output=True, check=True, timeout=300)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        found.append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
    return min(found)


def test_help_answers_at_once() -> None:
    assert seconds_of_work("-m", "derive", "--help") < 3 * seconds_of_work("-c", "import argparse")


@pytest.mark.parametrize("arguments", ["--help", "--version", "build --help", "show --help"])
def test_help_imports_nothing_heavy_and_that_of_all_no_command(arguments: str) -> None:
    script = (
        "import sys, derive.cli.main\n"
        f"try: derive.cli.main.main({arguments.split()})\n"
        "except SystemExit: pass\n"
        "print(*sorted(sys.modules))"
    )
    found = printed_by(script).splitlines()[-1].split()
    assert not {*HEAVY} & {*found}
    ours = [module for module in found if module.startswith("derive")]
    assert (ours == ["derive", "derive.cli", "derive.cli.main", "derive.version"]) is (arguments[0] == "-")


def test_version_is_the_package_version(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["--version"])
    assert capsys.readouterr().out == f"derive {__version__}\n"
