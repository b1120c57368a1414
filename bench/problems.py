"""What went wrong, in one line without folders of this machine."""

from __future__ import annotations

import re


def brief(error: BaseException) -> str:
    """The kind of an error and the first line of its message."""
    lines = str(error).strip().splitlines()
    text = re.sub(r"(?<![\w.])/[\w./-]+/", "", lines[0])[:140] if lines else ""
    return f"{type(error).__name__}: {text}".rstrip(": ")
