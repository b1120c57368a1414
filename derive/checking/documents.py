"""Documents as people write them: LaTeX, Markdown, notebooks and plain text, brought into one form that is read."""

from __future__ import annotations

import json
import re
from bisect import bisect_left, bisect_right
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from derive.checking.latex.typography import Spelled, blank, spelled, without_comments
from derive.checking.plain_text import CODE, from_plain_text, is_equation, is_listed
from derive.errors import CheckError, Location, near_miss, quoted

KINDS = {".tex": "LaTeX", ".md": "Markdown", ".rst": "reStructuredText", ".markdown": "Markdown"}
KINDS |= {".ipynb": "a notebook", ".txt": "text"}
LARGEST = 10_000_000  # bytes of a document
MAX_EXPANSIONS = 20_000  # calls of an author's macros that are written out in one document
MAX_DEPTH = 20  # macros inside each other; what is deeper stays as it is, and its formula is not understood
MAX_GROWTH = 4_000_000  # characters that macros may add

_FOREIGN = {b"%PDF": "a PDF", b"PK\x03\x04": "an Office document or an archive"}
_FOREIGN |= dict.fromkeys((b"\x89PNG", b"\xff\xd8\xff"), "a picture")


@dataclass(frozen=True)
class Manuscript:
    """The text of a document in which only mathematics and prose are left."""

    text: str
    name: str  # of the file, for messages
    origins: Sequence[int]  # for each character of the text its offset in the file's text
    starts: tuple[tuple[int, str], ...]  # offsets at which a part begins whose lines count from 1, with the part's name
    typed: str  # the file's text, the cells of a notebook behind each other

    def location(self, offset: int) -> Location:
        """The place of a character in the file; in a notebook the line of its cell."""
        origin = self.origins[min(offset, len(self.origins) - 1)] if self.origins else 0
        begin, part = self.starts[bisect_right([start for start, _ in self.starts], origin) - 1]
        line = self.typed.count("\n", begin, origin) + 1
        column = origin - max(self.typed.rfind("\n", begin, origin) + 1, begin) + 1
        return Location(f"{self.name}, {part}" if part else self.name, line, column)

    def _offset(self, found: Location) -> int:
        return sum(map(len, self.text.splitlines(keepends=True)[: found.line - 1])) + found.column - 1

    def placed(self, found: Location) -> Location:
        """The place in the file of a place in the text."""
        return self.location(self._offset(found))

    def moved(self, error: CheckError) -> CheckError:
        """An error in the text at its place in the file."""
        return error.moved(self.placed(error.location)) if error.location else error

    def section_at(self, found: Location) -> int:
        """The number of the section in which a place of the text stands; 0 before the first heading."""
        offset = self._offset(found)
        return sum(match.start() <= offset for match in _HEADING.finditer(self.text))

    def within(self, lines: tuple[int, int] | None = None, section: str = "") -> Manuscript:
        """Only some lines of the file, or a section with its subsections; the rest is blank."""
        text = self.text
        if lines is not None:
            ends = [match.start() for match in re.finditer("\n", self.typed)]
            kept = (lines[0] <= bisect_left(ends, origin) + 1 <= lines[1] for origin in self.origins)
            text = "".join(c if keep or c == "\n" else " " for c, keep in zip(text, kept, strict=True))
        if section:
            begin, end = self._section(section)
            text = blank(text[:begin]) + text[begin:end] + blank(text[end:])
        return replace(self, text=text)

    def _section(self, title: str) -> tuple[int, int]:
        """Where a section begins and ends: at the next heading of its level or above."""
        found = []
        for match in _HEADING.finditer(self.text):
            level = len(match["marks"]) if match["marks"] else _COMMANDS.index(match["command"])
            found.append((match.start(), level, " ".join((match["plain"] or match["title"] or "").strip(" #").split())))
        wanted = " ".join(title.split()).casefold()
        for index, (begin, level, heading) in enumerate(found):
            if wanted in heading.casefold():
                rest = (start for start, other, _ in found[index + 1 :] if other <= level)
                return begin, next(rest, len(self.text))
        headings = [heading for *_, heading in found]
        allowed = f"allowed: {', '.join(map(quoted, headings[:12]))}" if headings else "the document has no headings"
        what = f"{self.name} has no section {quoted(title)}"
        raise CheckError(what, allowed=allowed, remedy=near_miss(title, headings))


_HEADING = re.compile(
    r"^(?P<marks>\#{1,6})[ \t]+(?P<plain>[^\n]*)$"
    r"|\\(?P<command>chapter|section|subsection|subsubsection|paragraph)\*?\s*(?:\[[^\]]*\])?\{(?P<title>(?:[^{}]|\{[^{}]*\})*)\}",
    re.MULTILINE,
)
_COMMANDS = ("chapter", "section", "subsection", "subsubsection", "paragraph")


def read_document(path: str) -> Manuscript:
    """A document by its path."""
    name = path if path.isprintable() else quoted(path, 200)
    try:
        data = Path(path).read_bytes()
    except OSError as error:
        reason = error.strerror or type(error).__name__
        raise CheckError(f"{quoted(path, 200)} cannot be read: {reason}", remedy="check its name") from None
    if foreign := next((what for start, what in _FOREIGN.items() if data.startswith(start)), ""):
        allowed = f"derive check reads {', '.join(KINDS)}"
        raise CheckError(f"{name} is {foreign}", allowed=allowed, remedy="give its source")
    if len(data) > LARGEST:
        raise CheckError(f"{name} has {len(data)} bytes", allowed=f"allowed: at most {LARGEST}")
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise CheckError(f"{name} is not UTF-8", remedy="save the file as UTF-8 text") from None
    return document_of(text, name, Path(path).suffix.lower())


def is_document(text: str) -> bool:
    """Whether a text has mathematics between words, or says itself that it is a document."""
    if re.search(r'(?m)\\documentclass|\\begin\s*\{document\}|^\#{1,6} |^\s*\{\s*"(?:cells|metadata|nbformat)"', text):
        return True
    mathematics = r"(?s)\$\$.*?\$\$|\$[^$]*\$|\\\[.*?\\\]|\\\(.*?\\\)|\\begin\s*\{(\w+\*?)\}.*?\\end\s*\{\1\}"
    prose = re.sub(mathematics, "", text)
    return prose != text and len(re.findall(r"(?<![\\\w])[^\W\d_]{2,}", prose)) >= 2


def document_of(text: str, name: str, suffix: str = "") -> Manuscript:
    """The text of a document; without a suffix what it holds says what it is."""
    text = text.replace("\r\n", "\n").replace("\r", "\n")
    if suffix not in KINDS:
        suffix = ".ipynb" if text.lstrip().startswith("{") and '"cells"' in text else ""
        suffix = suffix or (".tex" if re.search(r"\\(?:documentclass|begin\{document\}|section)", text) else ".md")
    typed, starts = _cells(text, name) if suffix == ".ipynb" else (text, ((0, ""),))
    plain = without_comments(typed) if suffix == ".tex" else _markdown(typed)
    plain = _UNREAD.sub(lambda match: blank(match[0]), plain)
    origins: Sequence[int] = range(len(plain))
    for step in (from_plain_text, lambda written: (_balanced(written), range(len(written))), expanded, spelled):
        plain, places = step(plain)
        origins = [origins[place] for place in places]
    return Manuscript(plain, name, origins, starts, typed)


def _cells(text: str, name: str) -> tuple[str, tuple[tuple[int, str], ...]]:
    """The Markdown cells of a notebook behind each other, and where each begins."""
    whole, starts = "", []
    try:
        for number, cell in enumerate(json.loads(text)["cells"], 1):
            starts.append((len(whole), f"cell {number}"))
            is_prose = cell["cell_type"] in ("markdown", "raw")
            whole += ("".join(cell["source"]) if is_prose else _displayed(cell)) + "\n\n"
    except (ValueError, TypeError, KeyError, RecursionError):
        raise CheckError(f"{name} is not a notebook", allowed="allowed: JSON with a list of cells") from None
    return whole, tuple(starts) or ((0, ""),)


def _displayed(cell: Mapping[str, Any]) -> str:
    """The formulas that a code cell has shown; a name alone is the left side of the matrix after it."""
    data = (output.get("data", {}).get("text/latex") for output in cell.get("outputs", ()))
    shown = "\n\n".join("".join(latex) for latex in data if latex)
    return re.sub(r"\$\\displaystyle ([^$=]{1,30})\$\s+\$\\displaystyle (?=\\left\[\\begin)", r"$\1 = ", shown)


_CODE = re.compile(
    r"^(?P<fence>```+|~~~+)[ \t]*(?P<language>\{?[A-Za-z-]*\}?)[^\n]*\n(?P<body>.*?)^(?P=fence)[ \t]*$"
    r"|:math:`(?P<role>[^`\n]+)`|<!--.*?-->|\$`(?P<math>[^`]{1,4000})`\$|(?<!`)`(?P<inline>[^`\n]+)`(?!`)|<(?:script|style)\b.*?</(?:script|style)>"
    r"|<(?:br|/?(?:p|div|span|center|sup|sub|b|i|em|strong|table|tr|td|th|img|a|h[1-6]|li|ul|ol))\b[^<>\n]*>",
    re.DOTALL | re.MULTILINE | re.IGNORECASE,
)
_UNREAD = re.compile(
    r"\\begin\{(comment|verbatim\*?|lstlisting|minted)\}.*?\\end\{\1\}|\\iffalse\b.*?\\fi\b|\\verb\*?([^\w\s]).*?\2",
    re.DOTALL,
)
_OF_CODE = ("{code", "{literalinclude", "{image", "{eval", "{bibliography", "{toctree", "{raw")
# An equation in two formulas, $a$ = $b$ or **$a =$** $b$, or in a list with a colon, $\theta_5$: $\arccos(r_{33})$.
_PARTED = re.compile(
    r"(?<!\$)(\$[^$\n]+)\$([ \t]*=[ \t]*|(?<==\$)[ \t*]*)\$(?=[^$\n]+\$(?!\$))"
    r"|(?<!\$)(\$(?:\\(?:var)?theta|q|d)_\{?\w\}?)(\$:)[ \t]*\$(?=[^$=\n]*(?:cos|tan|sin)[^$=\n]*\$)"
)
# The next factor of a product in a formula of its own, $^3_6R = ^0_3R^T$ $^0_6R$.
_FACTOR = re.compile(r"(?<!\$)(\$[^$\n]*=[^$\n]*)\$[ \t]+\$(?=(?:\{\})?[_^][^$=\n]*\$(?!\$))")
# A row of a table, | $x$ | $l_1 \cos\theta_1$ |.
_IN_CELLS = re.compile(
    r"^(\|[ \t]*\$[^$|=\n]+)\$[ \t]*\|[ \t]*\$(?=[^$|=\n]*(?:\\(?:sin|cos|frac|sqrt)|[csCS]_)[^$|=\n]*\$[ \t]*\|)", re.M
)
_DISPLAYED = re.compile(r"\$|\\\[|\\\(|\\begin\{(?:equation|align|gather|displaymath|eqnarray|document)")


def _markdown(text: str) -> str:
    r"""Markdown with blanks for code and HTML; ``\\(`` and ``\\[`` are how it writes ``\(`` and ``\[``."""

    def without_code(match: re.Match[str]) -> str:
        if match["role"]:
            return f"      ${match['role']}$"
        if match["math"]:
            return f"$ {match['math']} $"  # as GitHub writes it
        language = (match["language"] or "").casefold()
        begin, end = match.start("body") - match.start(), match.end("body") - match.start()
        if language.strip("{}") == "math" or (language in ("latex", "tex") and not _DISPLAYED.search(match["body"])):
            body = re.sub(r"(?m)^:[a-z-]+:[^\n]*$", lambda option: blank(option[0]), match["body"])
            return _marked(match[0][:begin]) + body + _marked(match[0][end:])
        is_prose = language.startswith("{") and not language.startswith(_OF_CODE)  # in a box, as MyST has them
        if language in ("latex", "tex") or is_prose:
            return blank(match[0][:begin]) + _CODE.sub(without_code, match["body"]) + blank(match[0][end:])
        if match["inline"] and is_equation(match["inline"]):
            return f"{CODE}{match['inline']}{CODE}"
        if match["fence"] and language in ("", "text") and is_listed(match["body"]):
            return blank(match[0][:begin]) + match["body"] + blank(match[0][end:])
        return blank(match[0])

    text = _CODE.sub(without_code, re.sub(r"(?m)^ {0,3}>(?: ?>)*", lambda quote: blank(quote[0]), text))
    text = _PARTED.sub(lambda m: (f"{m[1]} {m[2].replace('*', ' ')} " if m[1] else f"{m[3]} = ").ljust(len(m[0])), text)
    text = _FACTOR.sub(lambda m: m[1].ljust(len(m[0])), text)
    text = _IN_CELLS.sub(lambda m: f"{m[1]} =".ljust(len(m[0])), text)
    doubled = len(re.findall(r"(?<!\\)\\\\[A-Za-z]{2}", text))
    if doubled > 4 * len(re.findall(r"(?<!\\)\\[A-Za-z]{2}", text)):  # a site that asks for \\frac
        text = re.sub(r"(?:\\\\)+", lambda m: (len(m[0]) // 2 * "\\").rjust(len(m[0])), text)
    return re.sub(r"\\\\(?=[\[\]()](?!\s*-?[0-9.]+\s*(?:pt|em|ex|mm|cm)\s*\]))", " \\\\", text)


def _marked(text: str) -> str:
    blanks = blank(text)
    at = len(text) - len(text.lstrip("\n"))
    return blanks[:at] + "$$" + blanks[at + 2 :]


def _balanced(text: str) -> str:
    """The text with blanks for dollar signs that open or close nothing: each costs one formula at most."""
    marks, dropped, index = list(re.finditer(r"(?<!\\)\$\$?", text)), list[re.Match[str]](), 0
    while index < len(marks):
        mark = marks[index]
        # a display may have blank lines, but no paragraph of prose; mathematics inside a line ends with its paragraph
        closing = next((j for j in range(index + 1, len(marks)) if marks[j][0] == mark[0]), None)
        inner = text[mark.end() : marks[closing].start()] if closing is not None else ""
        ends = r"\n[ \t]*\n\s*(?:[^\W\d_]+[ ,.;:]+){3}" if mark[0] == "$$" else r"\n[ \t]*\n"
        if closing is None or re.search(ends, inner):
            dropped.append(mark)
            index += 1
        else:
            dropped += marks[index + 1 : closing]
            index = closing + 1
    letters = list(text)
    for mark in dropped:
        letters[mark.start() : mark.end()] = " " * len(mark[0])
    return "".join(letters)


@dataclass(frozen=True, slots=True)
class Macro:
    """A macro that a document defines."""

    count: int  # its arguments
    default: str | None  # the first argument where none is given in square brackets; None where all are in braces
    body: str


_DEFINITION = re.compile(
    r"\\(?:re|provide)?newcommand\*?\s*(?:\{\s*\\(?P<braced>[A-Za-z]+)\s*\}|\\(?P<bare>[A-Za-z]+))\s*"
    r"(?:\[(?P<count>[0-9])\])?\s*(?:\[(?P<default>[^\]]*)\])?\s*(?=\{)"
    r"|\\[gex]?def\s*\\(?P<def>[A-Za-z]+)\s*(?P<arguments>(?:#[0-9])*)\s*(?=\{)"
    r"|\\DeclareMathOperator\*?\s*\{?\s*\\(?P<operator>[A-Za-z]+)\s*\}?\s*(?=\{)"
    r"|\\providecommand\*?\s*\{?\s*\\(?P<provided>[A-Za-z]+)\s*\}?\s*(?:\[(?P<number>[0-9])\])?\s*(?=\{)"
)


def expanded(text: str) -> tuple[str, Sequence[int]]:
    """The text with the author's macros written out, and the offset from which each of its characters comes."""
    macros, position = dict[str, Macro](), 0
    while match := _DEFINITION.search(text, position):
        end = closing_brace(text, match.end())
        body = text[match.end() + 1 : end]
        name = match["operator"] or match["def"] or match["braced"] or match["bare"] or match["provided"]
        count = len(match["arguments"] or "") // 2 or int(match["count"] or match["number"] or 0)
        macros[name] = Macro(count, match["default"], f"\\operatorname{{{body}}}" if match["operator"] else body)
        text = text[: match.start()] + blank(text[match.start() : end + 1]) + text[end + 1 :]
        position = end
    return _Expansion(macros).written(text, list(range(len(text))))


# Macros of packages and lectures whose definitions are elsewhere, and words for matrices of arguments or of rows.
_USUAL = dict.fromkeys(("pdv", "pdiff", "pder", "pderiv"), r"\frac{\partial #1}{\partial #2}") | {"norm": r"\|#1\|"}
_USUAL |= dict.fromkeys(("dv", "deriv", "odv"), r"\frac{d #1}{d #2}") | {"abs": "|#1|", "qty": "(#1)"}
_USUAL |= dict.fromkeys(("vb", "va"), r"\mathbf{#1}") | {"atantwo": r"\operatorname{atan2}"}
_GRID_NAME = re.compile(r"(?P<row>r(?:ow)?|)(?:c|col|column)?vec(?:two|three)?|[bp]?mat(?!h|rix$)[a-z]*|[bp]?mqty")


def _usual(call: re.Match[str]) -> Macro | None:
    r"""What a macro is that nothing here defines, by its name and its arguments: ``\cvec{a}{b}``."""
    name, end, groups = call[1], call.end(), list[str]()
    match, body = _GRID_NAME.fullmatch(name), _USUAL.get(name)
    while (match or body) and call.string.startswith("{", end):
        begin, end = end + 1, closing_brace(call.string, end) + 1
        groups.append(call.string[begin : end - 1])
    count = len(groups)
    if body or match is None or not (1 < count < 10 or re.search(r"&|\\\\", "".join(groups))):
        return Macro(count, None, body) if body and count == body.count("#") else None
    width = {4: 2, 9: 3}.get(count, 1) if "ma" in name else count if match["row"] else 1
    cells = [f"#{k}" + ("&" if k % width else r"\\") for k in range(1, count + 1)]
    return Macro(count, None, rf"\begin{{bmatrix}}{''.join(cells)[:-1].rstrip(chr(92))}\end{{bmatrix}}")


class _Expansion:
    """Writes macros out, within bounds."""

    def __init__(self, macros: Mapping[str, Macro]) -> None:
        self._macros, self._left, self._room = macros, MAX_EXPANSIONS, MAX_GROWTH

    def written(self, text: str, origins: list[int], depth: int = 0) -> tuple[str, list[int]]:
        """The text written out, and the place in the file of each of its characters, as they are given for the text."""
        pieces, places, last = [], [], 0
        for match in re.finditer(r"\\([A-Za-z]+)", text):
            begin, name = match.start(), match[1]
            macro, here = self._macros.get(name) or _usual(match), origins[begin]
            if macro is None or begin < last:
                continue  # inside an argument, which is written out with its macro
            found = self._arguments(macro, match, origins)
            if found is None or depth >= MAX_DEPTH or self._left <= 0 or self._room <= 0:
                continue
            arguments, end = found
            self._left -= 1
            # the body with the arguments in it; what the body itself says comes from the place of the call
            filled: list[Spelled] = []
            for part in re.split(r"(#[1-9])", macro.body):
                number = int(part[1:]) if re.fullmatch(r"#[1-9]", part) else 0
                filled.append(arguments[number - 1] if 0 < number <= len(arguments) else (part, [here] * len(part)))
            body, inner = "".join(said for said, _ in filled), [place for _, at in filled for place in at]
            self._room -= len(body)
            body, inner = self.written(body, inner, depth + 1)
            # a letter behind the call must not lengthen the name of a macro that ends the text written out
            gap = " " if re.search(r"\\[A-Za-z]+$", body) and text[end : end + 1].isalpha() else ""
            pieces += [text[last:begin], body, gap]
            places += [*origins[last:begin], *inner, *([here] if gap else [])]
            last = end
        return "".join([*pieces, text[last:]]), [*places, *origins[last:]]

    def _arguments(self, macro: Macro, call: re.Match[str], origins: list[int]) -> tuple[list[Spelled], int] | None:
        """The arguments of a call, and where it ends; None where they are not all there."""
        text, end, found = call.string, call.end(), list[Spelled]()
        for index in range(macro.count):
            begin = end
            while text[begin : begin + 1].isspace():
                begin += 1
            if index == 0 and macro.default is not None:
                if (closing := text.find("]", begin) if text[begin : begin + 1] == "[" else -1) < 0:
                    found.append((macro.default, [origins[call.start()]] * len(macro.default)))
                    continue
                inside = slice(begin + 1, closing)
                end = closing + 1
            elif text[begin : begin + 1] == "{":
                inside = slice(begin + 1, closing_brace(text, begin))
                end = inside.stop + 1
            elif token := re.compile(r"\\[A-Za-z]+|[^\s{}\\$&]").match(text, begin):
                inside = slice(*token.span())
                end = token.end()
            else:
                return None
            found.append((text[inside], origins[inside]))
        return found, end


def closing_brace(text: str, opening: int) -> int:
    """Where the brace is that closes the one at a place; the end of the text where there is none."""
    depth = 0
    for match in re.compile(r"\\.|[{}]", re.DOTALL).finditer(text, opening):
        depth += {"{": 1, "}": -1}.get(match[0], 0)
        if depth == 0:
            return match.start()
    return len(text)
