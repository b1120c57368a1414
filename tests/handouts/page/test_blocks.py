"""Blocks as HTML: names in plain letters, formulas as text."""

from __future__ import annotations

import pytest

from derive.handouts.page.writer import formula, unicode_name


@pytest.mark.parametrize(
    ("latex", "name"),
    [
        ("b_{12}", "b₁₂"),
        (r"\dot{\vartheta}_{1}", "ϑ\u0307₁"),
        (r"\mathbf{T}_{4}^{0}", "T₄⁰"),
        (r"c_{ijk}", "cᵢⱼₖ"),
        (r"{}^{0}A_{1}", "⁰A₁"),
        (r"c_{1,23}", "c_1,23"),
    ],
)
def test_names_of_entries_in_plain_letters(latex: str, name: str) -> None:
    assert unicode_name(latex) == name


def test_a_formula_is_its_latex_and_no_markup() -> None:
    assert formula(r"a < b \& c", display=True) == r"<div class=math>a &lt; b \&amp; c</div>"
