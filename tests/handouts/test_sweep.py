"""Handouts of all kinds of arms compile in every language, keep to their margins and stay short."""

import random
from dataclasses import replace
from pathlib import Path

import pytest

from derive.handouts.assemble import context_of, document
from derive.handouts.exercise import exercise, solutions
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
from tests.handouts.latex_runner import run_clean
from tests.random_robots import robot_text, sampled, seeds

pytestmark = [pytest.mark.slow, pytest.mark.first(1)]

MOST_PAGES = 40
MOST_PAGES_WITH_STEPS = 64
"""Of random arms of up to seven joints without any parallel axes, derivations and cosines written in full included,
where no page breaks between a sentence and its table."""

LANGUAGES = languages()
RANDOM_ROBOTS = 35
USUAL = catalogue_names()[::3]
WIDEST = NotationOptions(
    AngleLetter.VARTHETA, SliderLetter.Q, Functions.FULL, frames=FrameIndices.LEFT, inertia=InertiaLetter.M
)


def options_of(number: int, language: str) -> HandoutOptions:
    pick = random.Random(number).choice
    notation = NotationOptions(
        pick(list(AngleLetter)),
        pick(list(SliderLetter)),
        pick(list(Functions)),
        pick(list(FrameIndices)),
        pick(list(InertiaLetter)),
    )
    return HandoutOptions(derivation=pick(list(Derivation)), language=language, notation=notation)


def assert_is_clean(
    robot: Robot, options: HandoutOptions, folder: Path, most: int = MOST_PAGES, *, sheets: bool = False
) -> None:
    context = context_of(robot, options)
    whole = document(context)
    made = (exercise(whole, context.text), solutions(whole, context.text)) if sheets else (whole,)
    for sheet in made:
        assert 1 <= run_clean(latex(sheet, context.text), folder).pages <= most


@pytest.mark.parametrize(("number", "name"), list(enumerate(catalogue_names())))
def test_the_catalogue_in_one_language_after_another(number: int, name: str, tmp_path: Path) -> None:
    robot = Robot.load(name)
    assert_is_clean(robot, replace(robot.handout, language=LANGUAGES[number % len(LANGUAGES)]), tmp_path)


@pytest.mark.parametrize("name", sampled(catalogue_names(), USUAL))
def test_the_catalogue_in_the_widest_notation_is_clean(name: str, tmp_path: Path) -> None:
    language = random.Random(name).choice(["it", "pt"])
    assert_is_clean(Robot.load(name), HandoutOptions(language=language, notation=WIDEST), tmp_path)


def test_nothing_is_abbreviated_where_functions_are_in_full() -> None:
    context = context_of(Robot.load("scara-perugia"), HandoutOptions(notation=WIDEST))
    text = latex(document(context), context.text)
    assert "c_{12}" not in text
    assert r"\cos (\vartheta_{1} + \vartheta_{2})" in text


@pytest.mark.parametrize("seed", seeds(RANDOM_ROBOTS, usual=8))
def test_random_robots_in_any_notation(seed: int, tmp_path: Path) -> None:
    robot = Robot.from_text(robot_text(random.Random(7000 + seed), 1 + seed % 7))
    options = options_of(seed, LANGUAGES[seed % len(LANGUAGES)])
    assert_is_clean(robot, options, tmp_path, MOST_PAGES_WITH_STEPS)


@pytest.mark.parametrize("name", ["scara-perugia", "planar-2r-perugia", "stanford-deluca", "kuka-lwr4"])
def test_exercises_and_solutions(name: str, tmp_path: Path) -> None:
    options = HandoutOptions(derivation=Derivation.STEPS, language="it")
    assert_is_clean(Robot.load(name), options, tmp_path, sheets=True)
