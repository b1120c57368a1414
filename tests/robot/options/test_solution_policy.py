"""Thresholds of closed forms stand in one place, and in generated code as they are there."""

from dataclasses import asdict

from derive.robot.options.solution_policy import POLICY
from derive.targets.templating import template_folder


def test_the_text_of_a_threshold_is_its_value():
    for name, value in asdict(POLICY).items():
        read = tuple(map(float, POLICY.texts[name].split(", ")))
        assert (read if isinstance(value, tuple) else read[0]) == value
    assert POLICY.texts["orthogonal"] == "1e-6"


def test_no_template_repeats_a_threshold():
    own = [POLICY.texts[name] for name in ("far", "reproduced", "elsewhere", "double")]
    for path in template_folder().rglob("*.jinja"):
        text = path.read_text(encoding="utf-8")
        assert not [value for value in own if value in text], path.name
