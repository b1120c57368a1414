"""The blocks ``handout:`` and ``figure:`` of a robot file."""

import json
import re
from fractions import Fraction

import jsonschema
import pytest
import yaml

from derive.errors import DeriveError
from derive.robot.evaluate import evaluate
from derive.robot.options.handout import (
    PARTS,
    USUAL_PARTS,
    AngleLetter,
    Derivation,
    FigureOptions,
    FrameIndices,
    Functions,
    HandoutOptions,
    InertiaLetter,
    NotationOptions,
    PoseEntries,
    SliderLetter,
)
from derive.robot.reading.schema import json_schema
from derive.robot.robot import Robot
from tests.refusals import one_message
from tests.robot.hostile import GOOD

EVERYTHING = """\
handout:
  parts: [inertia, figure, table]
  derivation: steps
  language: pt_BR
  notation: {angle: vartheta, prismatic: q, functions: full, frames: left, inertia: M, pose: columns}
  pages: 12
figure: {q: [pi/6, 0.25], values: {m1: 3, g: 9.81}}
"""

BROKEN = {
    "handout:": "handout: found nothing",
    "handout: [table]": "handout: found a list",
    "handout: {part: [table]}": "did you mean 'parts'",
    "handout: {parts: table}": "allowed: a list",
    "handout: {parts: []}": "no parts",
    "handout: {parts: [[table]]}": "allowed: names of parts",
    "handout: {parts: [inertias]}": "did you mean 'inertia'",
    "handout: {parts: [newton_euler]}": "did you mean 'newton-euler'",
    "handout: {parts: [table, table]}": "'table' twice",
    "handout: {derivation: stpes}": "did you mean 'steps'",
    "handout: {derivation: [steps]}": "allowed: 'result' or 'steps'",
    "handout: {language: italian}": "not a language code",
    "handout: {language: ../../it}": "not a language code",
    "handout: {language: [it]}": "allowed: a text",
    "handout: {pages: many}": "handout, pages: 'many' is not a number of pages; allowed: a whole number such as 20",
    "handout: {pages: -1}": "'-1' is not a number of pages",
    "handout: {pages: 2.5}": "'2.5' is not a number of pages",
    "handout: {pages: [3]}": "handout, pages: found a list; allowed: a whole number",
    "handout: {page: 3}": "did you mean 'pages'",
    "handout: {notation: theta}": "handout, notation: found the text 'theta'",
    "handout: {notation: {angel: q}}": "did you mean 'angle'",
    "handout: {notation: {angle: phi}}": "allowed: 'name', 'theta', 'vartheta' or 'q'",
    "handout: {notation: {prismatic: theta}}": "allowed: 'name', 'd' or 'q'",
    "handout: {notation: {inertia: b}}": "did you mean 'B'",
    "handout: {notation: {inertia: {xx: 1}}}": "found a mapping; allowed: 'B', 'M' or 'D'",
    "figure:": "figure: found nothing",
    "figure: [0, 0]": "allowed: a mapping with the keys q, values",
    "figure: {qs: [0, 0]}": "unknown key 'qs'",
    "figure: {q: pi}": "allowed: a list",
    "figure: {q: [1]}": "1 entry; allowed: exactly 2",
    "figure: {q: [1, 1, 1]}": "3 entries; allowed: exactly 2",
    "figure: {q: [1, q2]}": "name 'q2' in a number",
    "figure: {q: [1, a1]}": "name 'a1' in a number",
    "figure: {q: [1, 1/0]}": "division by zero",
    "figure: {q: [1, tan(pi/2)]}": "figure, q entry 2",
    "figure: {q: [1, $]}": "unexpected character",
    "figure: {q: [1, .nan]}": "unexpected",
    "figure: {values: [m1]}": "allowed: a mapping",
    "figure: {values: {a1: 1}}": "has a number already",
    "figure: {values: {q1: 1}}": "a joint variable",
    "figure: {values: {k: 1}}": "no cell uses this",
    "figure: {values: {m11: 1}}": "did you mean 'm1'",
    "figure: {values: {m1: g}}": "name 'g' in a number",
    "figure: {values: {m1: sqrt(-2)}}": "root of a negative",
    "figure: {values: {2m: 1}}": "is not a name",
}

OF_THE_SCHEMA = [
    text
    for text in BROKEN
    if re.match(r"handout: (\[|{part|{page|{derivation|{language|{notation)|figure: (\[|{qs|{q: pi|{values: \[)", text)
]


def robot(tail: str = "") -> Robot:
    return Robot.from_text(GOOD + tail)


def test_what_is_left_out_has_its_default() -> None:
    assert robot().handout == HandoutOptions() == HandoutOptions(parts=USUAL_PARTS, language="en")
    assert robot().figure == FigureOptions(q=None, values=())
    handout = robot("handout: {notation: {angle: q}}\n").handout
    assert handout == HandoutOptions(notation=NotationOptions(angle=AngleLetter.Q))


def test_every_option_arrives() -> None:
    handout = robot(EVERYTHING).handout
    assert handout.parts == ("figure", "table", "inertia")  # in their usual order
    assert handout.derivation is Derivation.STEPS
    assert handout.language == "pt_BR"
    assert handout.pages == 12
    assert handout.notation == NotationOptions(
        AngleLetter.VARTHETA, SliderLetter.Q, Functions.FULL, FrameIndices.LEFT, InertiaLetter.M, PoseEntries.COLUMNS
    )


def test_the_figure_is_exact_in_the_units_of_the_file_and_values_have_none() -> None:
    figure = robot(EVERYTHING).figure
    assert [evaluate(value, {}) for value in figure.q] == pytest.approx([0.5235987755982988, 0.25])
    assert getattr(figure.q[1], "value", None) == Fraction(1, 4)
    assert [name for name, _ in figure.values] == ["m1", "g"]
    assert getattr(figure.values[1][1], "value", None) == Fraction(981, 100)
    figure = robot("units: {angle: deg, length: mm}\nfigure: {q: [90, 250], values: {m1: 3}}\n").figure
    assert [evaluate(value, {}) for value in figure.q] == pytest.approx([1.5707963267948966, 0.25])
    assert getattr(figure.values[0][1], "value", None) == 3
    with pytest.raises(DeriveError, match="angles are in degrees"):
        robot("units: {angle: deg}\nfigure: {q: [pi, 0]}\n")


def test_a_figure_outside_of_the_limits_is_refused_and_one_at_a_limit_is_not() -> None:
    limited = GOOD.replace("a: a1}", "a: a1, limits: [-pi/2, pi/2]}")
    assert Robot.from_text(limited + "figure: {q: [pi/2, 7]}\n").figure.q is not None
    with pytest.raises(DeriveError, match="figure, q entry 1: outside of the limits of 'q1'"):
        Robot.from_text(limited + "figure: {q: [2, 7]}\n")


@pytest.mark.parametrize("tail", BROKEN)
def test_mistakes_are_refused_in_one_line_at_their_place(tail: str) -> None:
    with one_message(DeriveError, r"arm\.yaml:13:\d+", BROKEN[tail]) as caught:
        Robot.from_text(GOOD + tail + "\n", "arm.yaml")
    assert "found found" not in str(caught.value)
    assert len(str(caught.value)) < 600
    assert str(caught.value).isprintable()


@pytest.mark.parametrize(
    ("tail", "column"),
    [
        ("handout: {part: [table]}", 11),
        ("handout: {parts: [table, inertias]}", 26),
        ("handout: {notation: {angle: phi}}", 29),
        ("figure: {q: [1, q2]}", 17),
        ("figure: {values: {m1: 1, m3: 1}}", 30),
    ],
)
def test_the_column_is_exact(tail: str, column: int) -> None:
    with one_message(DeriveError, f"<text>:13:{column}", ""):
        robot(tail + "\n")


def test_the_schema_accepts_what_the_loader_accepts_and_names_every_part_and_letter() -> None:
    jsonschema.validate(yaml.safe_load(GOOD + EVERYTHING), json_schema())
    text = json.dumps(json_schema())
    words = [*PARTS, *AngleLetter, *SliderLetter, *Functions, *FrameIndices, *InertiaLetter, *PoseEntries, *Derivation]
    assert not [word for word in words if f'"{word}"' not in text]


@pytest.mark.parametrize("tail", OF_THE_SCHEMA)
def test_the_schema_refuses_wrong_structure_too(tail: str) -> None:
    assert not jsonschema.Draft202012Validator(json_schema()).is_valid(yaml.safe_load(GOOD + tail))
