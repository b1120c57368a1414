"""``derive sample``: a table, the same as data, and refusals of one line."""

import json
from pathlib import Path

import pytest

from derive.cli import sample
from tests.cli.command import accepted, refused

ARM = "name: arm\nconvention: standard\njoints: [{type: revolute, a: 0.5}, {type: revolute, a: 0.4, limits: [0, 1]}]\n"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "arm.yaml").write_text(ARM)
    return tmp_path


def test_a_table_and_the_same_numbers_as_data(folder: Path) -> None:
    asked = (
        "sample",
        "arm.yaml",
        "manipulability_position",
        "--over",
        "grid",
        "--number",
        "1e4",
        "--reduce",
        "max,quantiles",
    )
    text = accepted(*asked, folder=folder).stdout.splitlines()
    assert text[0] == "arm: 10000 configurations on a grid within the limits"
    assert text[1].split() == ["max", "1%", "5%", "25%", "50%", "75%", "95%", "99%"]
    assert text[2].split()[:2] == ["manipulability_position", "0.168294"]  # 0.2 sin 1
    assert text[3:] == ["q1 has no limits: a full turn"]
    found = json.loads(accepted(*asked, "--json", folder=folder).stdout)
    function = found["functions"]["manipulability_position"]
    assert (found["number"], function["lacking"], function["where"]["max"]["q"][1]) == (10000, 0, 1.0)
    assert sample.DESCRIPTION.startswith("Print")


@pytest.mark.parametrize(
    ("typed", "said"),
    [
        ("T --number 1.5", "'1.5' is not a whole number such as 1e6"),
        ("T --number many", "'many' is not a whole number such as 1e6"),
        ("dJ/dt --speed fast", "'fast' is not a number, nor numbers with commas between"),
        ("dJ/dt", "qd has no bounds; give --speed: one number or 2 [SI units]"),
        ("tau", "arm has no function inverse_dynamics"),
        ("jacobain", "did you mean 'jacobian'?"),
    ],
)
def test_a_wrong_argument_is_refused_in_one_line(typed: str, said: str, folder: Path) -> None:
    done = refused("sample", "arm.yaml", *typed.split(), folder=folder)
    assert said in done.stderr
    assert done.stderr.count("\n") == 1
