"""Texts of the handout in the reader's language.

Every text is written in English where it is used, as ``_("Link %(index)s", index=3)``; a message catalogue
``derive/emit/handout/locale/<language>.po`` translates it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True)
class Text:
    """Translates the handout's messages.

    Attributes:
        language: Code of the language.
        messages: English text -> translation.
    """

    language: str = "en"
    messages: Mapping[str, str] = field(default_factory=dict)

    def __call__(self, message: str, **values: object) -> str:
        """The message in the language, its ``%(name)s`` places filled in; English where there is no translation."""
        return (self.messages.get(message) or message) % values
