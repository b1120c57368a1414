"""Elementary rotations, translations and their products, as the notes print them."""

from __future__ import annotations

import pytest

from tests.lectures.frame_results import FRAMES, frame_results


@pytest.mark.parametrize("name", [item["id"] for item in FRAMES])
def test_the_product_is_as_printed(name: str) -> None:
    assert not [result.entry for result in frame_results(name) if not result.confirmed]
