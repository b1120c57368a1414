"""Words for the steps of an inverse kinematics."""

from dataclasses import replace

import pytest

from derive.handouts.assemble import context_of
from derive.handouts.parts.inverse_words import and_list, branch_name, sources, words_alone
from derive.handouts.sheet.language import Text, text_for
from derive.inverse.words.postures import Word
from derive.robot.options.handout import FrameIndices, NotationOptions
from derive.robot.robot import Robot

ARM = Robot.load("anthropomorphic-wrist")


def test_products_are_said_by_the_transforms_of_the_sheet() -> None:
    context = context_of(ARM)
    step = next(step for step in context.entries.model.inverse.steps if str(step.unknown) == "q5")
    words = sources(context, step.equations)
    assert words.startswith("entries $(1,3)$ and $(2,3)$ of $(\\mathbf{T}_{4}^{0})^{-1}\\mathbf{T}")
    assert words.endswith("= \\mathbf{A}_{5}^{4}$")


def test_frames_stand_where_the_notation_has_them() -> None:
    options = replace(ARM.handout, notation=NotationOptions(frames=FrameIndices.LEFT))
    context = context_of(ARM, options)
    step = next(step for step in context.entries.model.inverse.steps if str(step.unknown) == "q5")
    assert "({}^{0}\\mathbf{T}_{4})^{-1}" in sources(context, step.equations)


@pytest.mark.parametrize(("words", "text"), [(["a"], "a"), (["a", "b"], "a and b"), (["a", "b", "c"], "a, b and c")])
def test_a_list_ends_with_and(words: list[str], text: str) -> None:
    assert and_list(Text(), words) == text


@pytest.mark.parametrize("language", ["it", "pt"])
def test_every_word_of_a_branch_is_translated(language: str) -> None:
    notation = context_of(ARM).notation
    text = text_for(language)
    written = {branch_name(text, notation, word) for word in Word}
    assert len(written) == len(Word)
    assert written.isdisjoint(set(Word))


def test_sides_of_zero_are_mathematics_and_numbers_are_left_out_where_they_stand_beside() -> None:
    notation = context_of(ARM).notation
    assert branch_name(Text(), notation, "elbow up, q2 < 0") == "elbow up, $q_{2} < 0$"
    assert branch_name(Text(), notation, "elbow up, #3") == "elbow up, branch 3"
    assert words_alone("elbow up, #2") == "elbow up"
    assert words_alone("#2") == ""
    assert branch_name(Text(), notation, "q2 < 0", lambda symbol: f"<i>{symbol}</i>") == "<i>q_{2}</i> < 0"
