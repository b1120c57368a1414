"""A refusal says what to write instead, in the user's own numbers; the hint itself is right."""

import re

import pytest

from derive.errors import DeriveError
from derive.robot.reading.hints import cell_hint, choice_hint, file_hint, key_hint, shape_hint
from derive.robot.robot import Robot
from tests.refusals import one_message

HEAD = "name: arm\nconvention: standard\n"

CELLS = {
    "0,4": "write 0.4, with a decimal point",
    "1,234.5": "write 1234.5, without the comma",
    "90deg": "or pi/2",
    "-45 degrees": "or pi/4",
    "30°": "or pi/6",
    "q1°": "leave the sign out",
    "400mm": "write 0.4, in metres, or 400 and units: {length: mm}",
    "40 cm": "write 0.4, in metres",
    "0.4 m": "write 0.4: numbers are in SI units",
    "pi/2 rad": "leave the unit out",
    "sin q1": "write sin(q1)",
    "np.pi/2": "write pi/2, without the module",
    "math.sqrt(2)": "write sqrt(2), without the module",
    "deg2rad(90)": "or pi/2",
    "acos(0.5)": "inverse functions are not available",
    "$a_1$": "LaTeX is not read here",
    r"\frac{\pi}{2}": "LaTeX is not read here",
    "π/2": "write pi/2",
    "θ1": "write theta1",
    "l₁": "write l1",
    "½": "write 1/2",
    "2a1": "write the product as 2*a1",
    "1/2 pi": "write the product as 1/2*pi",
}


@pytest.mark.parametrize(("cell", "words"), CELLS.items())
def test_a_cell_from_habit_is_refused_with_what_to_write(cell: str, words: str) -> None:
    with one_message(DeriveError, r"arm.yaml:5:\d+", words):
        Robot.from_text(f"{HEAD}joints:\n  - type: revolute\n    a: '{cell}'\n", "arm.yaml")


@pytest.mark.parametrize("cell", [cell for cell in CELLS if re.search(r"write [^:{]*[0-9a-z)](,|$)", CELLS[cell])])
def test_what_is_to_be_written_is_read(cell: str) -> None:
    with pytest.raises(DeriveError) as caught:
        Robot.from_text(f"{HEAD}joints:\n  - type: revolute\n    d: '{cell}'\n", "arm.yaml")
    found = re.search(r"write (?:the product as )?([^,;:]+)", str(caught.value).rpartition("; ")[2])
    Robot.from_text(f"{HEAD}joints:\n  - {{type: prismatic, q: x, a: '{found[1].replace('q1', 'b')}'}}\n")


@pytest.mark.parametrize(
    ("key", "value", "words"),
    [
        ("limits", "180", "limits: [-180, 180]"),
        ("limits", "±90", "limits: [-90, 90]"),
        ("limits", "-90..45", "limits: [-90, 45]"),
        ("limits", ["-180 170"], "limits: [-180, 170]"),
        ("limits", {"min": "-1", "max": "2"}, "limits: [-1, 2]"),
        ("inertia", [["1", "4", "5"], ["4", "2", "0"], ["5", "0", "3"]], "{xx: 1, yy: 2, zz: 3, xy: 4, xz: 5}"),
        ("inertia", ["1", "2", "3"], "{xx: 1, yy: 2, zz: 3}"),
        ("inertia", "0.1", "{zz: 0.1}"),
        ("inertia", ["1", "2", "3", "0", "0", "0"], "xx: ..., yy: ..."),
        ("com", {"x": "0.5"}, "com: [0.5, 0, 0]"),
        ("gravity", "9.81", "gravity: [0, 0, -9.81]"),
        ("tool", ["0", "0", "0.1"], "[0, 0, 1, 0.1]"),
        ("runtime", "m1", "runtime: [m1]"),
        ("row", ["q1", "0", "a1", "0"], "{type: revolute, theta:"),
    ],
)
def test_a_block_of_another_shape_is_rewritten(key: str, value: object, words: str) -> None:
    assert words in shape_hint(key, value)


@pytest.mark.parametrize(
    ("key", "text", "words"),
    [
        ("type", "R", "type: revolute"),
        ("type", "linear", "type: prismatic"),
        ("type", "free", "root: {type: floating}"),
        ("convention", "Craig", "convention: modified"),
        ("angle", "degrees", "angle: deg"),
        ("length", "cm", "m or mm"),
        ("style", "pretty", ""),
    ],
)
def test_other_words_are_known(key: str, text: str, words: str) -> None:
    choices = ("revolute", "prismatic", "fixed", "standard", "modified", "rad", "deg", "m", "mm", "compact")
    assert words in choice_hint(key, text, choices)
    assert words or not choice_hint(key, text, choices)


def test_unknown_keys_are_told_by_their_block() -> None:
    assert key_hint("r", "joints", ["d"]) == "write d, the offset along z"
    assert key_hint("r", "links", ["com"]) == "write com"
    assert key_hint("alpha:0", "joints", ["alpha"]) == "put a space after the colon: 'alpha: 0'"
    assert key_hint("nonsense", "joints", ["alpha"]) == ""


@pytest.mark.parametrize(
    ("text", "what"),
    [
        ('<?xml version="1.0"?>\n<!-- x -->\n<robot name="panda">\n</robot>\n', "a URDF"),
        ('<mujoco model="x">\n</mujoco>\n', "a MuJoCo model (MJCF)"),
        ('<sdf version="1.7"/>', "an SDF model"),
        ("<!DOCTYPE html>\n<html></html>", "a web page"),
        ("\\begin{tabular}{c}\n", "LaTeX"),
        ("robot = SerialLink([Link('d', 0)]);\n", "a program"),
        ("import numpy as np\n", "a Python program"),
        ("theta,d,a,alpha\nq1,0,1,0\n", "a table without keys"),
    ],
)
def test_files_of_other_programs_are_named(text: str, what: str) -> None:
    assert file_hint(text)[0] == what
    with pytest.raises(DeriveError, match=re.escape(f"arm.urdf:1:1: this is {what}, not a robot file")) as refused:
        Robot.from_text(text, "arm.urdf")
    assert ("derive import FILE" if what == "a URDF" else "derive new NAME") in str(refused.value)


def test_right_files_and_cells_without_a_habit_have_no_hint() -> None:
    for text in (f"{HEAD}joints: [{{type: revolute}}]\n", '{"name": "arm", "joints": []}', "# from a, b, c\nname: x\n"):
        assert file_hint(text) == ("", "")
    assert cell_hint("a1 +* b") == ""
