"""Collects the texts of the handout and brings the message catalogues up to date: ``python -m tests.docs.messages``.

Messages that are new come into ``derive.pot`` and, without a translation, into every catalogue; those that are gone
leave. The files name no date and no line, so that they change only when a text does.
"""

import ast
import io
from collections.abc import Iterator
from pathlib import Path

from babel.messages.catalog import Catalog
from babel.messages.extract import extract_from_file
from babel.messages.pofile import read_po, write_po

from tests.docs.console import ROOT

LOCALE = ROOT / "derive" / "handouts" / "locale"
TEMPLATE = LOCALE / "derive.pot"
HEADER = "# Texts of the handout; see derive/handouts/sheet/language.py."
WIDTH = 100

TRANSLATED = ("_", "_label", "_text", "text", "paragraph", "announced", "answer")
"""Names by which code calls `derive.handouts.sheet.language.Text`, itself or by a `Context`."""

Found = tuple[str, str]
"""File and message."""


def messages() -> Catalog:
    catalog = Catalog(project="derive", charset="utf-8", header_comment=HEADER)
    for place, message in sorted(found(), key=lambda item: (item[1], item[0])):
        catalog.add(message, None, [(place, None)])
    return catalog


def found() -> Iterator[Found]:
    for path in sorted((ROOT / "derive" / "handouts").rglob("*.py")):
        for _, message in literals(path):
            yield str(path.relative_to(ROOT)), message
    for path in sorted((ROOT / "templates").rglob("*.jinja")):
        for _, message, _, _ in extract_from_file("jinja2.ext:babel_extract", path, keywords={"_": None}):
            yield str(path.relative_to(ROOT)), str(message)


def literals(path: Path) -> Iterator[tuple[int, str]]:
    """Line and text of the messages of a file; those inside of f-strings too, which Babel would not see.

    Raises:
        ValueError: A message that is put together at run time, which no catalogue can translate.
    """
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if not isinstance(node, ast.Call) or _called(node.func) not in TRANSLATED or not node.args:
            continue
        match node.args[0]:
            case ast.Constant(value=str(text)):
                yield node.lineno, text
            case _ if _called(node.func) == "_":
                raise ValueError(f"{path}:{node.lineno}: the text of a message is one literal, values go into places")


def _called(function: ast.expr) -> str:
    match function:
        case ast.Name(id=name) | ast.Attribute(attr=name):
            return name
    return ""


def catalogues(folder: Path = LOCALE) -> list[Path]:
    return sorted(folder.glob("*.po"))


def read(path: Path) -> Catalog:
    with path.open("rb") as file:
        return read_po(file, locale=path.stem, abort_invalid=True)


def updated(path: Path, template: Catalog) -> bytes:
    catalog = read(path)
    catalog.update(template, no_fuzzy_matching=True, update_header_comment=False)
    catalog.obsolete.clear()
    return written(catalog)


def written(catalog: Catalog) -> bytes:
    for message in catalog:
        message.flags.discard("python-brace-format")  # LaTeX is full of braces
    body = io.BytesIO()
    write_po(body, catalog, width=WIDTH, omit_header=True, sort_output=True, ignore_obsolete=True, include_lineno=False)
    head = "\n".join([HEADER, 'msgid ""', 'msgstr ""', *_headers(catalog), "", ""])
    return head.encode() + body.getvalue()


def _headers(catalog: Catalog) -> Iterator[str]:
    language = [("Language", str(catalog.locale))] if catalog.locale else []
    for key, value in (*language, ("MIME-Version", "1.0"), ("Content-Type", "text/plain; charset=utf-8")):
        yield f'"{key}: {value}\\n"'


def wanted() -> dict[Path, bytes]:
    template = messages()
    return {TEMPLATE: written(template), **{path: updated(path, template) for path in catalogues()}}


def main() -> None:
    for path, content in wanted().items():
        if not path.exists() or path.read_bytes() != content:
            print(path.relative_to(ROOT))
            path.write_bytes(content)
    for path in catalogues():
        open_messages = [message for message in read(path) if message.id and not message.string]
        if open_messages:
            print(f"{path.relative_to(ROOT)}: {len(open_messages)} messages without a translation")


if __name__ == "__main__":
    main()
