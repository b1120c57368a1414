"""CasADi's own C export: the same text every time, behind a heading of ours, with the values of the oracle."""

import re
from dataclasses import replace
from pathlib import Path

import pytest

from derive.publish.build import build_robot
from derive.targets.casadi import render_casadi_c
from tests.targets.c_models import needs_compiler
from tests.targets.generated_models import planar, source_of
from tests.targets.test_numpy import TITLES


def test_the_text_is_the_same_every_time_and_names_no_folder() -> None:
    first, second = (render_casadi_c(source_of(planar())) for _ in range(2))
    assert first == second
    assert not any(re.search(r"/tmp|derive-\w{8}", text) for text in first.values())


@pytest.mark.parametrize("title", TITLES)
def test_titles_stay_inert(title: str) -> None:
    usual = render_casadi_c(source_of(planar()))
    for file, text in render_casadi_c(source_of(replace(planar(), title=title))).items():
        heading, end, rest = text.partition("*/\n")
        assert "/*" not in heading[2:]
        assert rest == usual[file].partition(end)[2]


@needs_compiler
def test_a_build_compiles_and_verifies_it(tmp_path: Path) -> None:
    report = build_robot(planar(), tmp_path, ["casadi-c"], only=True).report
    assert report is not None
    assert {row.target for row in report.rows} == {"casadi-c"}
    assert report.worst < 1e-12
