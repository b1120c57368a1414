"""What is refused is refused in one message, at its place."""

import re
from typing import Any

import pytest


def one_message(kind: Any, place: str, words: str) -> Any:
    """`pytest.raises` of one line that begins with a place, a pattern, and has these words in it."""
    return pytest.raises(kind, match=rf"\A{place}: [^\n]*{re.escape(words)}[^\n]*\Z")
