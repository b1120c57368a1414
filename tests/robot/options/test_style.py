"""The options of a style: by name, as text, as a block of the robot file; and what is refused."""

import random
from dataclasses import fields

import pytest

from derive.errors import QuantityError, RobotFileError
from derive.robot.options.style import NAMED_STYLES, STYLE_OPTIONS, Contraction, Grouping, Style
from derive.robot.reading.schema import StyleRow
from derive.robot.reading.structure import model_of
from derive.robot.robot import Robot

ARM = "name: arm\nconvention: standard\njoints: [{type: revolute, a: a1}]\n"


@pytest.mark.parametrize("seed", range(20))
def test_what_a_style_says_of_itself_makes_the_same_style(seed: int) -> None:
    rng = random.Random(seed)
    style = Style.of({name: rng.choice(list(kind)).value for name, kind in STYLE_OPTIONS.items()})
    assert Style.of(str(style)) == style
    assert Style.of(style.options()) == style
    block = "".join(f"  {name}: {value}\n" for name, value in style.options().items())
    assert Robot.from_text(f"{ARM}style:\n{block}").style == style


def test_a_set_by_name_says_its_name_and_the_file_has_a_key_for_every_option() -> None:
    assert [str(style) for style in NAMED_STYLES.values()] == list(NAMED_STYLES)
    assert Style().options() == {}
    assert Style.of("by-geometry, gravity: body").options() == {"name": "by-geometry", "gravity": "body"}
    rows = dict(model_of(StyleRow).model_fields)
    assert rows.pop("name").default == "compact"
    assert list(rows) == [option.name for option in fields(Style)]
    assert {name: row.annotation for name, row in rows.items()} == {n: k | None for n, k in STYLE_OPTIONS.items()}


def test_a_file_says_the_style_as_a_name_a_block_or_a_name_with_changes() -> None:
    assert Robot.from_text(ARM).style == Style()
    assert Robot.from_text(f"{ARM}style: expanded\n").style == NAMED_STYLES["expanded"]
    assert Robot.from_text(f"{ARM}style: {{gravity: body}}\n").style == Style(gravity=Grouping.BODY)
    changed = Robot.from_text(f"{ARM}style: {{name: by-geometry, gravity: body}}\ncontraction: opposed\n").style
    assert changed.inertia is Grouping.GEOMETRY
    assert changed.gravity is Grouping.BODY
    assert changed.contraction is Contraction.OPPOSED


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("roman", r"style 'roman'; allowed: compact, by-geometry, expanded, or options such as gravity: body"),
        ("by-geometri", r"did you mean 'by-geometry'\?"),
        ("gravty: body", r"style option 'gravty'; allowed: rotations.*; did you mean 'gravity'\?"),
        ("gravity: mass", r"unknown gravity of a style 'mass'; allowed: usual, body, geometry"),
        ("gravity: body, gravity: body", r"'gravity' twice"),
        ("", r"style ''"),
    ],
)
def test_an_unknown_set_option_or_value_is_refused_with_those_that_there_are(text: str, message: str) -> None:
    with pytest.raises(QuantityError, match=message):
        Style.of(text)


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        ("style: roman", r"<text>:4:8: style: found 'roman'; allowed: 'compact', 'by-geometry' or 'expanded'"),
        ("style: {gravty: body}", r"<text>:4:9: style: unknown key 'gravty'.*did you mean 'gravity'\?"),
        ("style: {gravity: mass}", r"<text>:4:18: style, gravity: found 'mass'; allowed: 'usual', 'body'"),
        ("style: {name: by-geometri}", r"<text>:4:15: style, name: .*did you mean 'by-geometry'\?"),
        ("style: [compact]", r"<text>:4:8: style: found a list"),
        ("style: {contraction: opposed}\ncontraction: opposed", r"style, contraction: given twice"),
    ],
)
def test_a_wrong_style_in_a_file_is_refused_at_its_place(lines: str, message: str) -> None:
    with pytest.raises(RobotFileError, match=message):
        Robot.from_text(f"{ARM}{lines}\n")
