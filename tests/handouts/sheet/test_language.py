"""The handout in other languages: catalogues are complete, and translations keep places, formulas and code."""

import re
import shutil
import subprocess
from collections import Counter
from pathlib import Path

import pytest
from babel.messages.catalog import Catalog
from babel.messages.pofile import read_po

from derive.errors import TargetError
from derive.handouts.sheet.language import Text, languages, text_for
from tests.docs import messages
from tests.docs.console import ROOT
from tests.interpreters import printed_by

PLACE = re.compile(r"%\((\w+)\)s")
MATHEMATICS = re.compile(r"\$[^$]*\$")
CODE = re.compile(r"`[^`]*`")
CATALOGUES = messages.catalogues()
NAMES = [path.stem for path in CATALOGUES]


@pytest.mark.parametrize("path", CATALOGUES, ids=NAMES)
def test_no_message_is_missing_or_unconfirmed(path: Path) -> None:
    confirmed = {
        str(message.id) for message in messages.read(path) if message.id and message.string and not message.fuzzy
    }
    assert not {message for _, message in messages.found()} - confirmed


def test_the_files_are_those_that_the_tool_writes() -> None:
    assert not [path.name for path, content in messages.wanted().items() if path.read_bytes() != content]


@pytest.mark.parametrize("path", CATALOGUES, ids=NAMES)
def test_translations_keep_places_formulas_code_and_ends(path: Path) -> None:
    """And have letters that every LaTeX sets."""
    for message in messages.read(path):
        source, target = str(message.id), str(message.string)
        if not source or not target:
            continue
        assert set(PLACE.findall(source)) == set(PLACE.findall(target)), source
        assert "%" not in PLACE.sub("", target), source
        Text(messages={source: target})(source, **dict.fromkeys(PLACE.findall(source), "x"))
        for markup in (MATHEMATICS, CODE):
            assert Counter(markup.findall(source)) == Counter(markup.findall(target)), source
        assert source.count("$") == target.count("$"), source
        assert [end for end in ".:" if source.endswith(end)] == [end for end in ".:" if target.endswith(end)], source
        assert target == target.strip(), source
        assert not (source[0].islower() and target[0].isupper()), source
        assert all(ord(char) < 0x180 for char in target), source


def test_messages_inside_of_f_strings_are_found(tmp_path: Path) -> None:
    """Python's tokenizer takes an f-string for one string."""
    file = tmp_path / "x.py"
    file.write_text("a = f\"<p>{words(_('inside'))}</p>\" + _(\"two\" ' parts', x=1)\n", encoding="utf-8")
    assert {message for _, message in messages.literals(file)} == {"inside", "two parts"}
    file.write_text("_(f'{x} joints')\n", encoding="utf-8")
    with pytest.raises(ValueError, match="one literal"):
        list(messages.literals(file))


def test_english_needs_no_file_and_no_babel() -> None:
    assert text_for("en").messages == {}
    assert text_for("en_GB")("Link %(index)s:", index=3) == "Link 3:"
    code = "import sys; from derive.handouts.sheet.language import text_for; text_for('en'); "
    assert printed_by(f"{code} print('babel' in sys.modules)") == "False"


@pytest.mark.parametrize(
    ("language", "number"), [("en", "0.5"), ("en_GB", "0.5"), ("it", "0,5"), ("it_CH", "0.5"), ("pt_BR", "0,5")]
)
def test_decimals_are_written_as_the_language_does(language: str, number: str) -> None:
    assert text_for(language).number("0.5") == number


def test_a_country_has_the_catalogue_of_its_language() -> None:
    assert text_for("pt_BR").messages == text_for("pt").messages
    assert text_for("pt_BR").language == "pt_BR"


@pytest.mark.parametrize("language", ["de", "xx", "../it", "", "it.po"])
def test_an_unknown_language_is_refused_with_the_known_ones(language: str) -> None:
    with pytest.raises(TargetError, match="allowed: en, it, pt"):
        text_for(language)


def test_a_new_language_is_one_file(tmp_path: Path) -> None:
    """Esperanto, made from the template and half translated: the rest stays English."""
    with messages.TEMPLATE.open("rb") as file:
        catalog: Catalog = read_po(file, locale="eo")
    for message in catalog:
        if message.id:
            message.string = f"eo {message.id}"
    first, second = sorted(str(message.id) for message in catalog if message.id and "%" not in str(message.id))[:2]
    catalog.get(first).string = ""  # type: ignore[union-attr]
    catalog.get(second).flags.add("fuzzy")  # type: ignore[union-attr]
    (tmp_path / "eo.po").write_bytes(messages.written(catalog))
    assert languages(tmp_path) == ("en", "eo")
    text = text_for("eo", tmp_path)
    assert text("Link %(index)s:", index=3) == "eo Link 3:"
    assert (text(first), text(second)) == (first, second)


def test_a_new_language_is_brought_up_to_date(tmp_path: Path) -> None:
    """What is translated stays, what is new is added, what is gone leaves."""
    path = tmp_path / "eo.po"
    path.write_text('msgid "mass"\nmsgstr "maso"\n\nmsgid "gone"\nmsgstr "for"\n', encoding="utf-8")
    path.write_bytes(messages.updated(path, messages.messages()))
    found = {str(message.id): str(message.string) for message in messages.read(path) if message.id}
    assert found["mass"] == "maso"
    assert "gone" not in found
    assert set(found) == {message for _, message in messages.found()}


def test_a_broken_catalogue_is_named(tmp_path: Path) -> None:
    (tmp_path / "eo.po").write_text("msgid mass\n", encoding="utf-8")
    with pytest.raises(TargetError, match=r"the catalogue eo\.po cannot be read"):
        text_for("eo", tmp_path)


def test_catalogues_are_part_of_the_package() -> None:
    if not (ROOT / ".git").exists() or shutil.which("git") is None:
        pytest.skip("no checkout")
    ignored = subprocess.run(
        ["git", "check-ignore", *map(str, CATALOGUES)], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert not ignored.stdout
    assert all(path.is_relative_to(ROOT / "derive") for path in CATALOGUES)
