"""What every test of the lecture corpus yields, and how entries are counted.

Counted is every printed entry, zeros and ones included; what another file counts already (``duplicate``) and what a
text only implies (``implied``) is checked but not counted. A Newton-Euler equation counts as one.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

CORPUS = Path(__file__).parent / "corpus"
ROBOT_FILES = tuple(sorted(path.name for path in CORPUS.glob("[0-9]*.yaml")))


@dataclass(frozen=True)
class Result:
    """One comparison.

    Attributes:
        entry: Item and entry, for messages.
        item: The item it belongs to; the errata of one item count as one.
        ok: Whether the corpus says that the printed formula is right.
        equal: Whether it was found right.
        corrected: Whether the correction was found right; None without one.
        counted: Whether it counts.
    """

    entry: str
    item: str
    ok: bool
    equal: bool
    corrected: bool | None = None
    counted: bool = True

    @property
    def confirmed(self) -> bool:
        """The corpus is right about it: right as printed, or wrong as printed and right as corrected."""
        return self.equal if self.ok else not self.equal and self.corrected is True


def document(file: str) -> Any:
    """A file of the corpus as plain data."""
    return yaml.safe_load((CORPUS / file).read_text(encoding="utf-8"))


def is_counted(item: Mapping[str, Any]) -> bool:
    return not (item.get("duplicate") or item.get("implied"))
