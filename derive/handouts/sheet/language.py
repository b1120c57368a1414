"""Texts of the handout in the reader's language: English, and one message catalogue for each other."""

from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from importlib.resources import files
from importlib.resources.abc import Traversable

from derive.errors import TargetError, install_extra, listed, near_miss, quoted


@dataclass(frozen=True)
class Text:
    """Translates the handout's messages."""

    language: str = "en"  # code of the language
    messages: Mapping[str, str] = field(default_factory=dict)  # English text -> translation
    comma: bool = False  # whether decimals stand behind a comma, and lists of numbers between semicolons

    def __call__(self, message: str, **values: object) -> str:
        """The message in the language; English where there is no translation."""
        return (self.messages.get(message) or message) % values

    def listing(self, items: Iterable[str]) -> str:
        """A list of numbers for running text."""
        return ("; " if self.comma else ", ").join(items)

    def number(self, decimal: str) -> str:
        """A number for running text."""
        return decimal.replace(".", ",") if self.comma else decimal


ENGLISH = "en"  # the language of the messages in the code
LOCALE = files("derive.handouts") / "locale"
_SUFFIX = ".po"


def languages(folder: Traversable | None = None) -> tuple[str, ...]:
    """Codes of all languages that have a catalogue in a folder, by default that of the package; sorted."""
    names = (entry.name for entry in (folder or LOCALE).iterdir())
    return tuple(sorted({ENGLISH, *(name.removesuffix(_SUFFIX) for name in names if name.endswith(_SUFFIX))}))


def text_for(language: str, folder: Traversable | None = None) -> Text:
    """Translates messages into a language, by the catalogues of a folder, by default that of the package."""
    known = languages(folder)
    if (code := language if language in known else language.partition("_")[0]) == ENGLISH:
        return Text(language)
    if code not in known:
        found = f"no message catalogue for the language {quoted(language)}"
        remedy = near_miss(language, known) or "a new language is one file in derive/handouts/locale"
        raise TargetError(found, allowed=f"allowed: {listed(known)}", remedy=remedy)
    try:
        from babel.core import Locale, UnknownLocaleError
        from babel.messages.pofile import PoFileError, read_po
        from babel.numbers import get_decimal_symbol
    except ImportError:
        raise TargetError(f"the language {quoted(language)} needs Babel", remedy=install_extra("handout")) from None
    try:
        with ((folder or LOCALE) / f"{code}{_SUFFIX}").open("rb") as file:
            messages = read_po(file, abort_invalid=True)
    except (PoFileError, UnicodeDecodeError) as error:
        found = f"the catalogue {code}{_SUFFIX} cannot be read: {error}"
        raise TargetError(found, remedy="compare it with derive.pot") from None
    # Without messages that nobody has confirmed yet.
    pairs = ((message.id, message.string) for message in messages if message.id and not message.fuzzy)
    comma = False
    for name in (code, language):  # the country's own habit, where it is known
        with suppress(UnknownLocaleError, ValueError):
            comma = get_decimal_symbol(Locale.parse(name)) == ","
    return Text(language, {str(source): str(target) for source, target in pairs if target}, comma)
