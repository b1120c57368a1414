"""Sheets in other notations and languages are as clean as those in the default one."""

import random
from pathlib import Path

import pytest

from derive.handouts.assemble import context_of, document
from derive.handouts.sheet.language import languages
from derive.handouts.sheet.latex_writer import latex
from derive.robot.load import catalogue_names
from derive.robot.options.handout import (
    AngleLetter,
    Derivation,
    FrameIndices,
    Functions,
    HandoutOptions,
    InertiaLetter,
    NotationOptions,
    SliderLetter,
)
from derive.robot.robot import Robot
from tests.handouts.sheet.test_latex_writer import assert_is_clean
from tests.random_robots import robot_text, seeds

WIDEST = NotationOptions(
    AngleLetter.VARTHETA, SliderLetter.Q, Functions.FULL, frames=FrameIndices.LEFT, inertia=InertiaLetter.M
)


def drawn_options(source: random.Random) -> HandoutOptions:
    notation = NotationOptions(
        source.choice(list(AngleLetter)),
        source.choice(list(SliderLetter)),
        source.choice(list(Functions)),
        source.choice(list(FrameIndices)),
        source.choice(list(InertiaLetter)),
    )
    return HandoutOptions(
        derivation=source.choice(list(Derivation)), language=source.choice(languages()), notation=notation
    )


def sheet(robot: Robot, options: HandoutOptions) -> str:
    context = context_of(robot, options)
    return latex(document(context), context.text)


@pytest.mark.slow
@pytest.mark.parametrize("seed", seeds(12, usual=5))
def test_random_robots_in_any_notation_and_language_are_clean(seed: int, tmp_path: Path) -> None:
    source = random.Random(1000 + seed)
    robot = Robot.from_text(robot_text(source, 1 + seed % 5))
    assert_is_clean(sheet(robot, drawn_options(source)), tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize("name", catalogue_names())
def test_the_catalogue_in_the_widest_notation_is_clean(name: str, tmp_path: Path) -> None:
    robot = Robot.load(name)
    language = random.Random(name).choice(["it", "pt"])
    assert_is_clean(sheet(robot, HandoutOptions(language=language, notation=WIDEST)), tmp_path)


def test_the_letter_of_the_inertia_matrix_is_the_one_asked_for() -> None:
    text = sheet(Robot.load("planar-2r-perugia"), HandoutOptions(notation=WIDEST))
    assert r"\mathbf{M}" in text
    assert r"\mathbf{B}" not in text


def test_nothing_is_abbreviated_where_functions_are_in_full() -> None:
    text = sheet(Robot.load("scara-perugia"), HandoutOptions(notation=WIDEST))
    assert "c_{12}" not in text
    assert r"\cos (\vartheta_{1} + \vartheta_{2})" in text
