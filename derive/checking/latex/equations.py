r"""LaTeX as people have it, taken apart: displays, their rows and equations, and the sides of each.

Nothing is understood here but structure: lines broken inside a sum are joined, ``x = a, \quad y = b`` and the columns
of ``align`` are separate equations, and ``a = b = c`` has three sides, pieces of the text with their places.
"""

import re
from collections.abc import Iterator
from dataclasses import replace
from itertools import chain

from derive.checking.documents import closing_brace
from derive.checking.latex.left import taken_apart
from derive.checking.latex.pieces import EQUATION_ENVIRONMENTS, MATRIX_MARK, RELATION, LatexPiece, display_piece
from derive.checking.latex.typography import ALTERNATIVE, cleaned
from derive.errors import CheckError, Location
from derive.robot.parser import place

_WORDS = (
    "and|or|where|with|so|hence|thus|therefore|then|for|if|since|let|yields|gives|dove|con|quindi|per|allora|onde|com|logo|"
    "então|und|mit|wobei|also|avec|donc|où|y|donde"
)
_SEPARATOR = re.compile(
    r"\\(?:qquad|quad|enspace|Rightarrow|Longrightarrow|implies|rightarrow|Leftrightarrow|iff|therefore|land)(?![A-Za-z])"
    r"|(?<![_^]\{)\\(?:text|textrm|mathrm|mbox|intertext|shortintertext|textnormal)\s*"
    rf"\{{(?:\s*[,;.]?\s*(?:{_WORDS})\s*[:,]?\s*|[^{{}}A-Za-z]*|[^{{}}]*,|\s[^{{}}]*|[^{{}}]*\s|[^{{}}]+\s[^{{}}]+)\}}"
    r"|(?<![A-Za-z\\_^{])(?:where|with|then|and)(?![A-Za-z_^}])"
    r"|(?P<mark>[,;])"
)
# The number of an equation that is typed behind it.
_NUMBERED = re.compile(r"(?:\\q?quad|\v)[\s\v]*\(\s*[0-9]+(?:\.[0-9]+)*[a-z]?\s*\)[\s\v.,;]*$")
# A condition behind a comma that is no equation, such as 0 < \theta_3 < \pi or e \in \{1, -1\}.
_RANGE = re.compile(
    r"(?:[,;][^=,;]*|(?=\\(not)?in))(?:<|>|\\(?:[lg](?:t|eq?)|neq?|(?:not)?in|forall)(?![A-Za-z]))[^=]*$"
)
# Words in brackets behind a formula, which may begin with what they are about.
_REMARK = re.compile(
    r"(?:\(\s*%s\s*|\\q?quad\s*\([^()]*%s[^()=]*)\)\s*$" % ((r"\\(?:text|mathrm|mbox|textrm)\s*\{[^{}]*\}",) * 2)
)
_LIST = re.compile(r"\s*[(\[](.*)[)\]]\s*(?:\^\s*\{?\s*(?:T|\\top|\\intercal)\s*\}?\s*)?", re.DOTALL)  # [0, 0, 1]^T
_SOLUTION = re.compile(r"arc|atan|acos|asin|sqrt|\^\s*\{?\s*-\s*1")
_LEADING = re.compile(r"(?:[\s\v,;]|\\q?quad(?![A-Za-z]))+")
_OPENING, _CLOSING = "([{", ")]}"
_OPERATOR = re.compile(r"[-+*/=]|\\(?:cdot|times|ast)(?![A-Za-z])")
_ENDS_OPEN = re.compile(r"(?:[-+*/=]|\\(?:cdot|times|ast))\s*$")
_PROSE = re.compile(r"(?:[^\W\d_]|(?<=\w)-(?=\w)|[\s.,;:()'\u2019])*")
# A name before the display that it is given, as programs print results: ``M =``.
_NAMED = re.compile(r"^[ \t]*(?P<name>[A-Za-z]\w{0,5}) *= *\n\s*\Z", re.MULTILINE)
_FENCE = re.compile(
    r"\\\[(?P<square>.*?)\\\]|\$\$(?P<double>.*?)\$\$|\\\((?P<round>.*?)\\\)|(?<!\\)\$(?P<single>[^$]*)(?<!\\)\$"
    r"|\\(?P<macro>eq|mx|whole)\s*(?=\{)"
    r"|\\begin\s*\{(?P<name>[A-Za-z]+)(?P<star>\*?)\}(?P<display>.*?)\\end\s*\{(?P=name)(?P=star)\}",
    re.DOTALL,
)
# How a display begins that continues the one right before it.
_CONTINUING = re.compile(
    r"(?:\$\$?|\\\[|\\\(|\\begin\s*\{[a-z]+\*?\})(?:\s|\\q?quad(?![a-z])|\\[ ,;:!]|&)*(?P<sign>[-+=])"
)

Sides = tuple[LatexPiece, ...]  # what stands between equals signs, from left to right; a lone formula is one side


def equations(text: str, start: Location, *, document: bool = False, time: bool = True) -> Iterator[Sides]:
    """The equations of a text."""
    plain = cleaned(text, time)
    for begin, end in _displays(plain, start, document):
        try:
            is_inline = document and re.match(r"\$(?!\$)|\\\(", plain[begin:end]) is not None
            whole = replace(display_piece(plain, begin, end, text, start), inline=is_inline)
        except CheckError:
            if document:
                continue
            raise
        found = _equations(whole)
        yield from chain.from_iterable(map(_alternatives, found)) if document else found


def _displays(plain: str, start: Location, document: bool) -> Iterator[tuple[int, int]]:
    """Where mathematics begins and ends; the whole text where nothing marks it."""
    fences: list[tuple[int, int]] = []
    _, beginning, _ = plain.partition("\\begin{document}") if document else ("", "", "")
    position = plain.index(beginning) + len(beginning)
    while match := _FENCE.search(plain, position):
        name = match["name"]
        if match["macro"]:  # of the handout's fragments; the second group of \\mx says the same entry by entry
            closing = closing_brace(plain, match.end())
            fences.append((match.end() + 1, closing))
            is_pair = match["macro"] == "mx" and plain.startswith("{", closing + 1)
            position = closing_brace(plain, closing + 1) if is_pair else closing
        elif name is None or name in EQUATION_ENVIRONMENTS:
            named = _NAMED.search(plain, position, match.start()) if document else None
            fences.append((named.start("name") if named else match.start(), match.end()))
            position = match.end()
        else:
            position = match.start() + len("\\begin") if document else match.end()
    if document:
        yield from _continued(plain, fences)
        return
    gaps = zip((0, *(end for _, end in fences)), (*(begin for begin, _ in fences), len(plain)), strict=True)
    strange = [(begin, plain[begin:end]) for begin, end in gaps if not _PROSE.fullmatch(plain[begin:end])]
    if fences and not strange:
        yield from fences
        return
    if fences and any(plain.startswith(("$", "\\[", "\\("), begin) for begin, _ in fences):
        offset, text = strange[0]
        where = place(plain, offset + len(text) - len(text.lstrip()), start)
        raise CheckError("formula partly outside the dollar signs", remedy="enclose all of it", location=where)
    yield 0, len(plain)


def _continued(plain: str, fences: list[tuple[int, int]]) -> list[tuple[int, int]]:
    """Displays with those right behind them that go on with a sum, or say what it equals."""
    found: list[tuple[int, int]] = []
    for begin, end in fences:
        match = _CONTINUING.match(plain, begin, end)
        if found and match is not None and not plain[found[-1][1] : begin].strip():
            sign, has_relation = match["sign"], RELATION.search(plain, begin, end) is not None
            in_prose = re.match(r"[ \t]*[^\W\d_]", plain[end:])  # which speaks of a term
            is_sum = RELATION.search(plain, *found[-1]) and not in_prose and (sign == "+" or not has_relation)
            if sign == "=" or is_sum:
                begin, _ = found.pop()
        found.append((begin, end))
    return found


def _equations(display: LatexPiece) -> Iterator[Sides]:
    # blanks for what marks a display, and for the one brace before a system of equations
    text = re.sub(r"\\\[|\\\]|\\\(|\\\)|\$\$?", lambda m: " " * len(m[0]), display.text)
    # a blank line in a display parts equations, each with a left side of its own
    text = re.sub(r"\n(?=[ \t]*\n[ \t]*(?:\\(?:d?dot|theta|varphi)|[A-Za-z])[^\n=+]{0,20}=)", "\f", text)
    if display.inline and RELATION.search(text):
        text = _unbracketed(text)
    inner = text.strip()
    if re.match(r"\{(?!\})", inner) and "\\over" not in inner and closing_brace(inner, 0) == len(inner) - 1:
        text = text.replace("{", " ", 1)
        text = " ".join(text.rsplit("}", 1))
    if text.count("\\{") != text.count("\\}"):
        text = re.sub(r"\\[{}]", "  ", text)
    text = _unbraced(text)
    # rows and what stands side by side in them, then lines of one equation together again
    spans = _joined(text, [span for row in re.finditer("[^\f]+", text) for span in _row_parts(text, row.span())])
    shown, text = text, text.replace("\f", " ").replace("\v", " ")
    for begin, end in spans:
        begin = match.end() if (match := _LEADING.match(text, begin, end)) else begin
        whole = replace(display, text=text)
        if number := _NUMBERED.search(shown[begin:end]):
            end = begin + number.start()
        if remark := _REMARK.search(text, begin, end):
            end = remark.start()
        if (behind := _RANGE.search(text, begin, end)) and _depths(text, begin, behind.start()) == 0:
            end = behind.start()
        printed = text[begin:end].rstrip()
        end = begin + len(printed if printed.endswith("...") else _without_end(printed))
        ends = [begin, *(edge for span in _relations(text, begin, end) for edge in span), end]
        sides = [whole.part(a, b) for a, b in zip(ends[::2], ends[1::2], strict=True)]
        # spaces and words that part nothing are blank; commas stay, for a formula must not have one
        plain = [
            _SEPARATOR.sub(lambda m: m[0] if m["mark"] or ALTERNATIVE.fullmatch(m[0]) else " " * len(m[0]), side.text)
            for side in sides
        ]
        if found := tuple(replace(side, text=text) for side, text in zip(sides, plain, strict=True) if text.strip()):
            yield from _unmerged(found)


def _unbraced(text: str) -> str:
    """A display without the braces around an equation in it: ``{^0_1T = [...]} {^1_2T = [...]}``."""
    for match in re.finditer(r"(?<![A-Za-z\\_^{}])\{(?=\s*[\^_])|(?:^|(?<=\f))\s*\{", text):
        begin = match.end() - 1
        if (end := closing_brace(text, begin)) < len(text) and RELATION.search(text, begin, end):
            text = f"{text[:begin]} {text[begin + 1 : end]} {text[end + 1 :]}"
    return text


def _unbracketed(text: str) -> str:
    """An equation of a line of prose without the brackets around all of it."""
    inner = text.strip()
    ends = [i for i in range(1, len(inner) + 1) if _depths(inner, 0, i) == 0]
    if not (inner.startswith("(") and ends[:1] == [len(inner)]):
        return text
    begin, end = text.index("("), text.rindex(")")
    return f"{text[:begin]} {text[begin + 1 : end]} {text[end + 1 :]}"


def _alternatives(sides: Sides) -> Iterator[Sides]:
    """One equation for each row of alternatives with conditions, and for each pair of ``(x, y) = (a, b)``."""
    *_, last = sides
    if [side.text.strip() for side in sides[:-1]] == [last.text.strip().removeprefix("-")] and "-" in last.text:
        return  # X = -X, what a general formula has in the place of X
    if last.text.strip() == MATRIX_MARK and last.matrices[0].is_cases and len(sides) > 1:
        for cell, *_ in last.matrices[0].rows:
            yield (*sides[:-1], cell.part(0, len(_without_end(cell.text))))
        return
    if len(sides) > 1 and (words := [*ALTERNATIVE.finditer(last.text)]) and _SOLUTION.search(last.text):
        edges = [0, *(edge for word in words for edge in word.span()), len(last.text)]
        yield from ((*sides[:-1], last.part(a, b)) for a, b in zip(edges[::2], edges[1::2], strict=True))
        return
    lists = [listed(side) if side.text.strip().startswith("(") else [] for side in sides]
    count = len(lists[0])
    if len(sides) > 1 and count > 1 and {*map(len, lists)} == {count} and re.search("[a-z]_|sqrt|arc|atan", last.text):
        yield from zip(*lists, strict=True)
    else:
        yield sides


def listed(side: LatexPiece) -> list[LatexPiece]:
    """What stands between the commas of a list in brackets that is a whole side; nothing of another side."""
    text, match = side.text, _LIST.fullmatch(side.text)
    if match is None or any(_depths(text, match.start(1), i) < 0 for i in range(*match.span(1))):
        return []
    begin, end = match.span(1)
    commas = [i for i in range(begin, end) if text[i] == "," and not _depths(text, begin, i)]
    edges = [begin, *(edge for i in commas for edge in (i, i + 1)), end]
    return [side.part(a, b) for a, b in zip(edges[::2], edges[1::2], strict=True)]


def _without_end(text: str) -> str:
    """A formula without the marks and spaces behind it."""
    while (shorter := text.rstrip(" \n\r\v.,;:").removesuffix("\\quad").removesuffix("\\qquad")) != text:
        text = shorter
    return text


def _unmerged(sides: Sides) -> Iterator[Sides]:
    """Equations side by side without a sign between them: the matrix of one, and the name of the next."""
    for i, side in enumerate(sides[1:-1], 1):
        mark = side.text.find(MATRIX_MARK)
        name = taken_apart(side.text[mark + 1 :]) if mark >= 0 and not side.text[:mark].strip() else None
        if name is not None and name.sub + name.sup + name.before and sides[i + 1].text.strip().startswith(MATRIX_MARK):
            yield (*sides[:i], side.part(0, mark + 1))
            yield from _unmerged((side.part(mark + 1, len(side.text)), *sides[i + 1 :]))
            return
    yield sides


def _depths(text: str, begin: int, end: int) -> int:
    """How many brackets are open at the end."""
    part = text[begin:end]
    return sum(map(part.count, _OPENING)) - sum(map(part.count, _CLOSING))


def _relations(text: str, begin: int, end: int) -> list[tuple[int, int]]:
    """Equals signs outside of brackets."""
    found, depth, last = [], 0, begin
    for match in RELATION.finditer(text, begin, end):
        depth, last = depth + _depths(text, last, match.start()), match.end()
        if depth <= 0:
            found.append(match.span())
    return found


def _row_parts(text: str, row: tuple[int, int]) -> Iterator[tuple[int, int]]:
    """The equations that stand side by side in one row."""
    begin, end = row
    cuts: list[tuple[int, int]] = []
    depth, last = 0, begin
    marks = [(m.start(), m.end()) for m in _SEPARATOR.finditer(text, begin, end)]
    marks += [(i, i + 1) for i in range(begin, end) if text[i] == "\v"]
    for first, stop in sorted(marks):
        depth, last = depth + _depths(text, last, first), stop
        if depth > 0:
            continue
        # a separator parts two equations if one is complete before it and another one begins behind it
        done, rest = _relations(text, cuts[-1][1] if cuts else begin, first), _relations(text, stop, end)
        is_mark = text[first] in "\v,;"
        complete = bool(done) and bool(text[done[-1][1] : first].strip(" \v\n\r"))
        words = not is_mark and not re.match(r"\\q?quad|\\enspace", text[first:stop])
        if not complete and not (words and not done):
            continue
        left = text[stop : rest[0][0]].strip(" \v\n\r") if rest else ""
        is_solution = ALTERNATIVE.fullmatch(text[first:stop]) and re.match(rf"(?!\s*{_SEPARATOR.pattern})", left)
        is_solution = is_solution and _SEPARATOR.search(left)  # of two, before another name
        left = "" if is_solution else _SEPARATOR.sub(" ", left).strip(" \v\n\r")
        # behind a space or a comma a minus may begin another one as well: A = a \qquad -B = b
        if left and (not _OPERATOR.match(left) or (left[0] == "-" and text[first] != "\v")):
            cuts.append((first, stop))
    edges = [begin, *(edge for cut in cuts for edge in cut), end]
    yield from zip(edges[::2], edges[1::2], strict=True)


def _joined(text: str, parts: list[tuple[int, int]]) -> list[tuple[int, int]]:
    """Parts of one equation that stand on several lines, together."""
    found: list[tuple[int, int]] = []
    for begin, end in parts:
        part = re.sub(r"^(?:\\q?quad(?![A-Za-z])|[\s\v])+", "", text[begin:end].rstrip(" \v\n\r"))
        if not part:
            continue
        if found:
            first, last = found[-1]
            before = text[first:last].rstrip(" \v\n\r")
            relations, earlier = _relations(text, begin, end), _relations(text, first, last)
            # a row of align with a left side of its own is an equation, even if that begins with a sign: -s1*px &= 0
            is_aligned = all(r and text[: r[0][0]].rstrip(" \n\r").endswith("\v") for r in (relations, earlier))
            is_row = is_aligned and text[begin : relations[0][0]].strip(" \v\n\r")
            # in other displays one that begins with a minus and has a left side is an equation, too: -p_z = a3 s23
            is_new = is_row or (relations and part[0] == "-" and earlier)
            # an operator at the break, an open bracket, or no relation of its own: still the equation before
            is_open = _ENDS_OPEN.search(before) or _depths(text, first, last) > 0 or (not relations and earlier)
            if is_open or (_OPERATOR.match(part) and not is_new):
                found[-1] = (first, end)
                continue
        found.append((begin, end))
    return found
