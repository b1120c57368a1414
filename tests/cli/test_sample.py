"""``derive sample``: a table, the same as data, and refusals of one line."""

import json
from pathlib import Path

import pytest

from derive.cli.data import sample
from tests.cli.command import accepted, refused

ARM = "name: arm\nconvention: standard\njoints: [{type: revolute, a: 0.5}, {type: revolute, a: 0.4, limits: [0, 1]}]\n"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "arm.yaml").write_text(ARM)
    return tmp_path


def test_a_table_and_the_same_numbers_as_data(folder: Path) -> None:
    name = "manipulability_position"
    asked = ("sample", "arm.yaml", name, "--over", "grid", "--number", "1e4", "--reduce", "max,quantiles")
    done = accepted(*asked, folder=folder)
    assert done.stderr == "derive: warning: no limits of q1: full turns\n"
    rows = [line.split() for line in done.stdout.splitlines()]
    assert rows[0] == ["10000", "configurations", "max", "1%", "5%", "25%", "50%", "75%", "95%", "99%"]
    assert (rows[1][:2], len(rows)) == ([name, "0.168294"], 2)  # 0.2 sin 1
    found = json.loads(accepted(*asked, "--json", folder=folder).stdout)[name]
    assert (found["number"], found["lacking"], found["where"]["max"]["q"][1]) == (10000, 0, 1.0)
    assert sample.DESCRIPTION.startswith("Print")


@pytest.mark.parametrize(
    ("typed", "said"),
    [
        ("dJ/dt --speed fast", "'fast' is not a number, nor numbers with commas between"),
        ("tau", "arm has no inverse_dynamics"),
    ],
)
def test_a_wrong_argument_is_refused_in_one_line(typed: str, said: str, folder: Path) -> None:
    assert said in refused("sample", "arm.yaml", *typed.split(), folder=folder).stderr
