"""Files that `derive check` understands, told apart by their keys.

Corpus files have a block ``robot:`` and the list ``expected:`` of what some notes print about it. Every formula is read
here, so that a text that cannot be read is reported with its line and column. One with an unknown name is kept: nothing
can be said about it, but about the others.
"""

import re
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

from derive.checking.comparison import check_file
from derive.checking.formulas import reading
from derive.checking.formulas.findings import FileReport
from derive.checking.formulas.printed import CorpusFile, Factorisation, Identity, Printed, PrintedQuantity
from derive.checking.formulas.reading import NO_ABBREVIATIONS, Abbreviations, read_printed, required_text
from derive.checking.frames_file import NO_ROBOT, check_frames
from derive.checking.inverse.block import read_block
from derive.checking.methods_file import SETS, check_methods
from derive.errors import CheckError, Location, quoted
from derive.robot.load import file_bytes
from derive.robot.reading.document import Node, YamlMapping, YamlScalar, read_tree
from derive.robot.robot import Robot
from derive.robot.tree import require_chain

UNREAD = ("singularities", "trajectory")  # blocks with printed results of a kind that is not compared here
_BLOCKS = ("expected", "identities", "factorisation", "inverse_kinematics", *UNREAD)
_CONTENT = (
    "quantity", "latex", "matrix", "entries", "rest", "status", "kind", "correct", "abbreviations", "abbreviated",
)  # fmt: skip
_REMARKS = ("printed_as", "note", "duplicate", "implied")


def check_path(path: str) -> tuple[FileReport, Robot]:
    """Compare everything that a file prints."""
    source, data = path if path.isprintable() else quoted(path, 200), file_bytes(Path(path))
    root = read_tree(data, source)
    if isinstance(root, YamlMapping) and "robot" not in root.entries:
        if "items" in root.entries:
            return check_frames(root, source), NO_ROBOT
        if any(name in root.entries for name in SETS):
            return check_methods(root, source), NO_ROBOT
    file = corpus_from_bytes(data, source)
    return check_file(file), file.robot


def corpus_from_bytes(data: bytes, source: str) -> CorpusFile:
    """Read a robot and the formulas printed about it."""
    robot = Robot.from_bytes(data, source)
    require_chain(robot, "a check of formulas")
    node = read_tree(data, source)
    if not isinstance(node, YamlMapping) or "robot" not in node.entries:
        found = "no block 'robot:' beside the printed formulas"
        allowed = "allowed: robot: with the DH table, expected: with what is printed"
        remedy = "indent the robot under 'robot:' and add 'expected:'"
        raise CheckError(found, allowed=allowed, remedy=remedy, location=Location(source))
    root = reading.mapping(node, "the file", ("robot",), ("source", "notes", "ocr", "figure_configuration", *_BLOCKS))
    expected = reading.items(reading.child(root, "expected"), "expected")
    identities = reading.items(reading.child(root, "identities"), "identities")
    product = reading.child(root, "factorisation")
    lines = data.decode("utf-8-sig").splitlines()
    solutions, inverse = read_block(reading.child(root, "inverse_kinematics"), robot, lines)
    equal = [reading.mapping(item, "an identity", ("left", "right"), ("status", *_REMARKS)) for item in identities]
    left, right = ([read_printed(required_text(item, side), robot) for item in equal] for side in ("left", "right"))
    return CorpusFile(
        source=source,
        robot=robot,
        expected=tuple(_quantity(item, robot, lines) for item in expected),
        identities=tuple(map(Identity, left, right, map(reading.status, equal))),
        factorisation=_factorisation(product) if product else None,
        unread=tuple(name for name in UNREAD if name in root.entries),
        solutions=tuple(solutions),
        inverse=tuple(inverse),
        document=reading.printed_in(root),
    )


def _quantity(node: Node, robot: Robot, lines: Sequence[str]) -> PrintedQuantity:
    latex = isinstance(node, YamlMapping) and "latex" in node.entries
    item = reading.mapping(node, "an item of expected", () if latex else ("quantity",), (*_CONTENT, *_REMARKS))
    name = required_text(item, "quantity").text if "quantity" in item.entries else ""
    in_latex = reading.printed_text(required_text(item, "latex"), lines) if latex else None
    entries, shape = _content(item, robot)
    corrections = tuple(_at_places(reading.pairs(item, "correct", "an entry"), "correct", robot))
    if corrections and not name:
        remedy = "add quantity:"
        raise CheckError("corrections without a quantity", remedy=remedy, location=item.location)
    for correction in corrections if in_latex is None else ():
        if (correction.row, correction.column) not in {(entry.row, entry.column) for entry in entries}:
            found = f"correction of {correction.row},{correction.column}, which is not among the printed entries"
            raise CheckError(found, remedy="print the wrong entry too", location=correction.location)
    abbreviated: tuple[Printed, ...] = ()
    if "abbreviated" in item.entries:  # the entries as they are printed with the abbreviations of the notes
        short = NO_ABBREVIATIONS
        for key, text in reading.pairs(item, "abbreviations", "an abbreviation"):
            short = short.defining(key.text, read_printed(text, robot, short))
        rows = reading.rows(item.entries["abbreviated"][1], "abbreviated", "a row of 'abbreviated'")
        abbreviated = tuple(_matrix_entries(rows, robot, short))
    return PrintedQuantity(
        quantity=name,
        location=item.location,
        entries=entries,
        shape=shape,
        abbreviated=abbreviated,
        corrections=corrections,
        rest_zero=reading.word(item, "rest", ("zero",), "") == "zero",
        status=reading.status(item),
        remark=reading.remark(item),
        implied=reading.flag(item, "implied"),
        latex=in_latex,
    )


def _content(item: YamlMapping, robot: Robot) -> tuple[tuple[Printed, ...], tuple[int, int] | None]:
    """The printed entries, and rows and columns where the whole matrix is printed."""
    matrix = reading.child(item, "matrix")
    if len([key for key in ("matrix", "entries", "latex") if key in item.entries]) != 1:
        found = "an item of expected needs either 'matrix' or 'entries' or 'latex'"
        remedy = 'write matrix: [["..."]] for all entries, or entries: {"1,4": "..."} for some, or latex: "..."'
        raise CheckError(found, remedy=remedy, location=item.location)
    if "latex" in item.entries:
        return (), None
    if matrix is None:
        return tuple(_at_places(reading.pairs(item, "entries", "an entry"), "entries", robot)), None
    rows = reading.rows(matrix, "matrix", "a row of the matrix")
    if not rows or not rows[0] or len({len(row) for row in rows}) > 1:
        remedy = 'write rows of equal length, a scalar as [["..."]]'
        raise CheckError("matrix whose rows differ in length or are empty", remedy=remedy, location=matrix.location)
    return tuple(_matrix_entries(rows, robot)), (len(rows), len(rows[0]))


def _matrix_entries(rows: list[list[Node]], robot: Robot, short: Abbreviations = NO_ABBREVIATIONS) -> Iterator[Printed]:
    for i, row in enumerate(rows, 1):
        for j, cell in enumerate(row, 1):
            yield read_printed(reading.scalar(cell, "an entry"), robot, short, (i, j))


def _at_places(pairs: Iterable[tuple[YamlScalar, YamlScalar]], what: str, robot: Robot) -> Iterator[Printed]:
    """Formulas under keys such as ``1,4``, or ``3`` for a vector."""
    seen: set[tuple[int, int]] = set()
    for key, text in pairs:
        match = re.fullmatch(r"\s*([0-9]{1,3})\s*(?:,\s*([0-9]{1,3})\s*)?", key.text)
        place = (int(match[1]), int(match[2] or 1)) if match else (0, 0)
        if 0 in place or place in seen:
            found = f"{what}: place {quoted(key.text)}" + (" twice" if place in seen else "")
            allowed = 'allowed: row,column from 1, such as "1,4"; "3" in a vector'
            raise CheckError(found, allowed=allowed, location=key.location)
        seen.add(place)
        yield read_printed(text, robot, place=place)


def _factorisation(node: Node) -> Factorisation:
    item = reading.mapping(node, "factorisation", ("of", "factors"), _REMARKS)
    factors = reading.items(item.entries["factors"][1], "factors")
    if not factors:
        raise CheckError("factorisation without factors", remedy="name two or more", location=item.location)
    names = tuple(reading.scalar(factor, "a factor").text for factor in factors)
    return Factorisation(required_text(item, "of").text, names, item.location)
