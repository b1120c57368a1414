"""``derive completion``: scripts of shells, asked in the shells themselves."""

import shutil
import subprocess
from pathlib import Path

import pytest

from derive.cli.completion import SHELLS
from derive.cli.main import COMMANDS
from derive.robot.load import catalogue_names
from tests.cli.command import derive

BASH = """\
source ./script
COMP_WORDS=(%s)
COMP_CWORD=$(( ${#COMP_WORDS[@]} - 1 ))
_shtab_derive
printf '%%s\\n' "${COMPREPLY[@]}"
"""
FISH = "source ./script; complete -C '%s' | cut -f 1"

TYPED = {
    "derive ''": set(COMMANDS),
    "derive show puma": {name for name in catalogue_names() if name.startswith("puma")} | {"puma.yaml"},
    "derive show thumb detJv": {"detJv"},
    "derive show thumb worksp": {"workspace"},
    "derive show thumb --digi": {"--digits"},
    "derive show thumb --format ''": {"text", "latex", "python", "json"},
    "derive export thumb --format mj": {"mjcf"},
    "derive export thumb --t": set(),
    "derive build thumb --target nat": {"native"},
    "derive handout thumb --lang i": {"it"},
    "derive move scara-pick-and": {"scara-pick-and-place"},
    "derive import pum": {"puma.yaml"},
}


@pytest.fixture(scope="module")
def scripts(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    folder = tmp_path_factory.mktemp("shells")
    return {shell: derive("completion", shell, folder=folder).stdout for shell in SHELLS}


@pytest.mark.parametrize(("typed", "expected"), TYPED.items())
@pytest.mark.parametrize(("shell", "program"), [("bash", BASH), ("fish", FISH)])
def test_what_is_typed_is_completed(
    shell: str, program: str, typed: str, expected: set[str], scripts: dict[str, str], tmp_path: Path
) -> None:
    if shutil.which(shell) is None:
        pytest.skip(f"{shell} is not installed")
    (tmp_path / "script").write_text(scripts[shell])
    (tmp_path / "puma.yaml").touch()
    words = typed if shell == "bash" else typed.replace("''", "")
    printed = subprocess.check_output([shell, "-c", program % words], cwd=tmp_path, text=True, timeout=60)
    assert set(printed.split()) == expected


@pytest.mark.parametrize("shell", SHELLS)
def test_every_script_names_every_command_robot_and_no_old_option(shell: str, scripts: dict[str, str]) -> None:
    assert all(one in scripts[shell] for one in (*COMMANDS, *catalogue_names(), "christoffel", "scara-pick-and-place"))
    assert "--to " not in scripts[shell]


def test_zsh_reads_its_script(scripts: dict[str, str], tmp_path: Path) -> None:
    if shutil.which("zsh") is None:
        pytest.skip("zsh is not installed")
    (tmp_path / "_derive").write_text(scripts["zsh"])
    subprocess.run(["zsh", "-n", "_derive"], cwd=tmp_path, timeout=60, check=True)
