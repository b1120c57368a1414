"""A Denavit-Hartenberg table that a document prints, in LaTeX or Markdown, as a robot file."""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from derive.checking.documents import Manuscript
from derive.checking.frames_file import rotation, translation
from derive.errors import CheckError, DeriveError, Location, quoted
from derive.lecture.sympy_conversion import expression_from_sympy, expression_to_sympy
from derive.robot.parser import parse_expression
from derive.robot.robot import Robot
from derive.robot.writer import cell_text

COLUMNS = ("theta", "d", "a", "alpha")
DEGREES_FROM = 7  # a plain number in a column of angles that is as large as this is meant in degrees
_LATEX = re.compile(r"\\begin\{(?P<kind>tabular\*?|array|longtable)\}(?P<body>.*?)\\end\{(?P=kind)\}", re.DOTALL)
_HEADS = {
    "theta": re.compile(r"(?:theta|th|q)(?:i|j|k|n)?"),
    "d": re.compile(r"(?:d|b)(?:i|j|k|n)?|(?:link)?offset"),
    "a": re.compile(r"[alr](?:i|j|k|n)?(?:-1)?|(?:link)?length"),
    "alpha": re.compile(r"alpha(?:i|j|k|n)?(?:-1)?|(?:link)?twist"),
}
_NUMBER = r"(?<![A-Za-z0-9_.])([0-9]+(?:\.[0-9]+)?)"
_UNITS = re.compile(r"\(([^()]*)\)|\[([^\[\]]*)\]")
_SIGNS = {"\u03b8": "theta", "\u03d1": "theta", "\u03b1": "alpha", "\u03c0": "pi"}
_SIGNS |= {"\u2212": "-", "\u2013": "-", "\u00b0": "^circ", "\u00b7": "*", "\u1d62": "i", "(i-1)": "i-1"}
_SIGNS |= {chr(0x2080 + digit): str(digit) for digit in range(10)}


@dataclass(frozen=True)
class _Row:
    """One row: its cells by column as expressions in text, and the names that are marked as variables."""

    cells: Mapping[str, str]
    marked: frozenset[str]
    where: Location


def robot_of_table(document: Manuscript, name: str) -> tuple[str, Location]:
    """The robot file of the one table in a document, and where the table begins."""
    if len(tables := list(_tables(document))) != 1:
        places = ", ".join(f"line {where.line}" for where, _, _ in tables)
        found = f"{len(tables)} Denavit-Hartenberg tables ({places})" if tables else "no Denavit-Hartenberg table"
        remedy = "choose one with --lines" if tables else "its head names theta, d, a and alpha"
        raise CheckError(found, allowed="allowed: one", remedy=remedy, location=Location(document.name))
    where, is_modified, rows = tables[0]
    text = "\n".join(_lines(name, is_modified, rows, where)) + "\n"
    try:
        Robot.from_text(text)
    except DeriveError as error:
        raise CheckError(f"a table that is no robot: {error}", location=where) from None
    return text, where


def _tables(document: Manuscript) -> Iterator[tuple[Location, bool, list[_Row]]]:
    """Tables whose head names all four columns."""
    typed = document.typed
    kept = {document.origins[i] for i, c in enumerate(document.text) if not c.isspace()}
    for match in (*_LATEX.finditer(typed), *re.finditer(r"(?m)(?:^[ \t]*\|?[^\n|]*\|[^\n]*\n)+", typed)):
        if not any(match.start() <= origin < match.end() for origin in kept):
            continue
        lines = list(_split(match))
        start, head = next(((i, head) for i, (_, cells) in enumerate(lines) if (head := _head(cells))), (0, None))
        if head is None:
            continue
        where = _location(document, lines[start][0])
        # Khalil and Kleinfinger (1986): d is the length and r the offset, and a column may have the kinds of joints
        names = [_column_name(cell) for cell in lines[start][1]]
        has_kinds = any(name.startswith(("sigma", "\u03c3")) for name in names)
        is_khalil = names[head["a"]].startswith("r") and names[head["d"]].startswith("d")
        is_khalil &= has_kinds or head["alpha"] < head["d"] < head["theta"] < head["a"]
        if is_khalil:
            head = head | {"a": head["d"], "d": head["a"]}
        modified = is_khalil or any("-1" in names[head[kind]] for kind in ("a", "alpha"))
        body = [(offset, cells) for offset, cells in lines[start + 1 :] if len(cells) > max(head.values())]
        large = {k for k in ("theta", "alpha") if any(_largest(cells[head[k]]) >= DEGREES_FROM for _, cells in body)}
        rows = [_row(_location(document, offset), cells, lines[start][1], head, large) for offset, cells in body]
        yield where, modified, rows


def _location(document: Manuscript, origin: int) -> Location:
    line = document.typed.count("\n", 0, origin) + 1
    return Location(document.name, line, origin - document.typed.rfind("\n", 0, origin))


def _split(match: re.Match[str]) -> Iterator[tuple[int, list[str]]]:
    """The rows of a table as cells, each with its offset."""
    is_latex = "kind" in match.re.groupindex
    offset, lines = match.start(), match[0].splitlines(keepends=True)
    if is_latex:
        offset, lines = match.start("body"), re.split(r"(\\\\(?:\[[^\]]*\])?|\\tabularnewline)", match["body"])
    for line in lines:
        row = re.sub(r"\\(?:hline|toprule|midrule|bottomrule)|\\c(?:line|midrule)\{[^}]*\}", "", line)
        if "&" in row if is_latex else not re.fullmatch(r"[\s|:\-]*", line):
            cells = re.split(r"(?<!\\)&", row) if is_latex else line.strip().strip("|").split("|")
            yield offset + len(line) - len(line.lstrip()), cells
        offset += len(line)


def _head(cells: Sequence[str]) -> dict[str, int] | None:
    """The places of the four columns; None where this is no head."""
    names = [_column_name(cell) for cell in cells]
    found = {kind: [i for i, n in enumerate(names) if pattern.fullmatch(n)] for kind, pattern in _HEADS.items()}
    return {kind: places[0] for kind, places in found.items()} if all(len(p) == 1 for p in found.values()) else None


def _column_name(cell: str) -> str:
    """What the head of a column says, without its unit."""
    return _plain(_UNITS.sub("", _plain(cell))).casefold()


def _row(
    where: Location, cells: Sequence[str], heads: Sequence[str], head: Mapping[str, int], degrees: set[str]
) -> _Row:
    """A row, in radians and metres."""
    found, marked = {}, set()
    for kind, i in head.items():
        text = _plain(cells[i]).partition("=")[0]
        marked.update(re.findall(r"([A-Za-z][A-Za-z0-9]*)\^?\*(?![A-Za-z0-9(])", text))
        text = re.sub(r"\^\*|\*(?=[-+)]|$)", "", text)
        unit = " ".join(part for pair in _UNITS.findall(heads[i]) for part in pair).casefold()
        found[kind] = _in_units(text, kind, kind in degrees or "deg" in unit or "°" in unit or "circ" in unit, unit)
        if not re.fullmatch(r"[-+*/().0-9A-Za-z ]+", found[kind]):
            remedy = "write a number, a symbol, or a sum of them"
            raise CheckError(f"cell {quoted(cells[i].strip())} of column {kind}", remedy=remedy, location=where)
    return _Row(found, frozenset(marked), where)


def _plain(text: str) -> str:
    r"""A cell on one line: ``$\theta_{2} - 90^\circ$`` as theta2-90^circ."""
    for sign, name in _SIGNS.items():
        text = text.replace(sign, name)
    text = re.sub(r"\s*\\degree(?![A-Za-z])", "^circ", text)
    text = re.sub(r"\\(?:displaystyle|left|right|,|;|!|:)|[$~`]|\\\s|\*\*(?=\w|$)|(?<=\w)\*\*", "", text)
    text = re.sub(r"\\(?:text|mathrm|mathit|mathbf|boldsymbol|bm|operatorname)\s*\{([^{}]*)\}", r"\1", text)
    while (inner := re.sub(r"\\[dt]?frac\s*\{([^{}]*)\}\s*\{([^{}]*)\}", r"((\1)/(\2))", text)) != text:
        text = inner
    text = re.sub(r"\\(?:ast|star)", "*", text).replace("\\circ", "circ").replace("\\cdot", "*")
    text = re.sub(r"\\(?:var)?([A-Za-z]+)", r"\1", text)
    text = re.sub(r"\^\s*\{?\s*o\s*\}?(?![A-Za-z])", "^circ", text)
    text = re.sub(r"\^\s*\{\s*(\*|circ)\s*\}", r"^\1", text)
    text = re.sub(r"[_{}\s,]", "", text)
    return re.sub(r"(?<=[0-9)])(?=pi\b)", "*", text)


def _largest(cell: str) -> float:
    """The largest plain number of an angle; 0 of one with a unit or with pi."""
    text = _plain(cell)
    return 0.0 if "pi" in text or "circ" in text else max(map(float, re.findall(_NUMBER, text)), default=0.0)


def _in_units(text: str, kind: str, is_degrees: bool, unit: str) -> str:
    """A cell in radians and metres."""
    if kind in ("theta", "alpha"):
        plain = re.sub(_NUMBER + r"(?:\^?circ|deg)", _of_pi, text)
        return re.sub(_NUMBER, _of_pi, plain) if is_degrees and "pi" not in plain else plain
    scale = {"mm": Fraction(1, 1000), "cm": Fraction(1, 100)}.get(unit.strip())
    return re.sub(_NUMBER, lambda m: str(float(Fraction(m[1]) * scale)), text) if scale else text


def _of_pi(match: re.Match[str]) -> str:
    """An angle in degrees as a multiple of pi."""
    turn = Fraction(match[1]) / 180
    whole = "pi" if turn.numerator == 1 else f"{turn.numerator}*pi" if turn else "0"
    return whole if turn.denominator == 1 else f"{whole}/{turn.denominator}"


def _lines(name: str, is_modified: bool, rows: Sequence[_Row], where: Location) -> Iterator[str]:
    yield f"# From the table at {where}, read as the {'modified' if is_modified else 'standard'} convention."
    yield f"name: {name}"
    yield f"convention: {'modified' if is_modified else 'standard'}"
    yield "joints:"
    for i, row in enumerate(rows, 1):
        kind, variable = _joint(row, i)
        if kind:
            cells = ", ".join(f"{column}: {row.cells[column]}" for column in COLUMNS)
            yield f"  - {{type: {kind}, q: {variable}, {cells}}}"
        elif i < len(rows):
            remedy = "mark its variable with a star; a row without one may only stand last, as the tool"
            raise CheckError(f"row {i} has no variable", remedy=remedy, location=row.where)
        else:
            theta, d, a, alpha = (expression_to_sympy(parse_expression(row.cells[c], row.where)) for c in COLUMNS)
            turn, tilt = translation(0, 0, d) * rotation("z", theta), translation(a, 0, 0) * rotation("x", alpha)
            yield "tool:"
            for entries in (tilt * turn if is_modified else turn * tilt).tolist():
                yield f"  - [{', '.join(repr(cell_text(expression_from_sympy(entry))) for entry in entries)}]"


def _joint(row: _Row, index: int) -> tuple[str, str]:
    """Type and variable of a joint; empty of a row in which nothing moves."""
    theta, d = row.cells["theta"], row.cells["d"]
    names = [re.findall(r"[A-Za-z][A-Za-z0-9]*", text) for text in (theta, d)]
    for kind, found in (("revolute", names[0]), ("prismatic", names[1])):
        if variable := next((n for n in found if n in row.marked), ""):
            return kind, variable
    if variable := next((n for n in names[0] if re.fullmatch(r"(?:theta|th|q)[0-9]*", n)), ""):
        return "revolute", variable
    slide = names[1][0] if re.fullmatch(r"[-+0-9./*() pi]*", theta) and len(names[1]) == 1 else ""
    return ("prismatic", slide) if re.fullmatch(rf"[dqrs](?:{index}|[A-Z])?", slide) else ("", "")
