"""Any file that `derive check` understands, by its keys.

Corpus files: a block ``robot:`` and the list ``expected:`` of what some notes print about it.

Every formula is read here, so that a text that cannot be read is reported with its line and column. One with an unknown
name is kept: nothing can be said about it, but about the others.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

from derive.check import reading
from derive.check.comparison import check_file
from derive.check.findings import FileReport
from derive.check.frames_file import NO_ROBOT, check_frames
from derive.check.methods_file import SETS, check_methods
from derive.check.printed import CorpusFile, Factorisation, Identity, Printed, PrintedQuantity
from derive.check.reading import NO_NAMES, Vocabulary, printed_in, read_printed, remark
from derive.check.solutions import SolutionReader
from derive.errors import CheckError, Location, quoted
from derive.robot import document
from derive.robot.document import Node, read_tree
from derive.robot.load import file_bytes
from derive.robot.robot import Robot

UNREAD = ("singularities", "trajectory")
"""Blocks with printed results of a kind that is not compared here."""

_BLOCKS = ("expected", "identities", "factorisation", "inverse_kinematics", *UNREAD)
_KEYS = ("source", "notes", "ocr", "figure_configuration", *_BLOCKS)
_CONTENT = ("matrix", "entries", "rest", "status", "kind", "correct", "abbreviations", "abbreviated")
_REMARKS = ("printed_as", "note", "duplicate", "implied")
_PLACE = re.compile(r"\s*([0-9]{1,3})\s*(?:,\s*([0-9]{1,3})\s*)?")

Place = tuple[int, int]


def read_corpus_file(path: str) -> CorpusFile:
    """Read a robot and the formulas printed about it.

    Args:
        path: Path of the file.

    Raises:
        RobotFileError: The file cannot be read, or its block ``robot:`` is no robot.
        ExpressionError: A cell of the robot is outside the grammar.
        CheckError: A printed formula, or the structure around it, cannot be read.
    """
    return corpus_from_bytes(file_bytes(Path(path)), path if path.isprintable() else quoted(path, 200))


def corpus_from_bytes(data: bytes, source: str) -> CorpusFile:
    """Read the bytes of a corpus file; see `read_corpus_file`."""
    robot = Robot.from_bytes(data, source)
    node = read_tree(data, source)
    if not isinstance(node, document.YamlMapping) or "robot" not in node.entries:
        raise CheckError(
            "no block 'robot:' beside the printed formulas",
            allowed="allowed: robot: with the DH table, expected: with what is printed",
            remedy="indent the robot under 'robot:' and add 'expected:'",
            location=Location(source),
        )
    return _Reader(robot).file(reading.mapping(node, "the file", ("robot",), _KEYS), source)


class _Reader:
    def __init__(self, robot: Robot) -> None:
        self.robot = robot

    def file(self, root: document.YamlMapping, source: str) -> CorpusFile:
        expected = reading.items(reading.child(root, "expected"), "expected")
        identities = reading.items(reading.child(root, "identities"), "identities")
        product = reading.child(root, "factorisation")
        return CorpusFile(
            source=source,
            robot=self.robot,
            expected=tuple(self.quantity(item) for item in expected),
            identities=tuple(self.identity(item) for item in identities),
            factorisation=self.factorisation(product) if product else None,
            unread=tuple(name for name in UNREAD if name in root.entries),
            solutions=SolutionReader(self.robot).solutions(reading.child(root, "inverse_kinematics")),
            document=printed_in(root),
        )

    def quantity(self, node: Node) -> PrintedQuantity:
        item = reading.mapping(node, "an item of expected", ("quantity",), (*_CONTENT, *_REMARKS))
        name = reading.scalar(item.entries["quantity"][1], "quantity").text
        entries, shape = self.content(item)
        return PrintedQuantity(
            quantity=name,
            location=item.location,
            entries=entries,
            shape=shape,
            abbreviated=self.abbreviated(item),
            corrections=self.corrections(item, {(entry.row, entry.column) for entry in entries}),
            rest_zero=reading.word(item, "rest", ("zero",), "") == "zero",
            status=reading.word(item, "status", ("ok", "erratum"), "ok"),
            remark=remark(item),
            implied=reading.flag(item, "implied"),
        )

    def content(self, item: document.YamlMapping) -> tuple[tuple[Printed, ...], tuple[int, int] | None]:
        matrix, entries = reading.child(item, "matrix"), reading.child(item, "entries")
        if (matrix is None) == (entries is None):
            raise CheckError(
                "an item of expected needs either 'matrix' or 'entries'",
                remedy='write matrix: [["..."]] for all entries, or entries: {"1,4": "..."} for some',
                location=item.location,
            )
        if entries is not None:
            return tuple(self.placed(entries, "entries")), None
        assert matrix is not None
        rows = [reading.items(row, "a row of the matrix") for row in reading.items(matrix, "matrix")]
        if not rows or not rows[0] or len({len(row) for row in rows}) > 1:
            raise CheckError(
                "matrix whose rows differ in length or are empty",
                remedy='write rows of equal length, a scalar as [["..."]]',
                location=matrix.location,
            )
        return tuple(self.matrix(rows)), (len(rows), len(rows[0]))

    def matrix(self, rows: list[list[Node]], short: Vocabulary = NO_NAMES) -> Iterator[Printed]:
        for i, row in enumerate(rows, 1):
            for j, cell in enumerate(row, 1):
                yield read_printed(reading.scalar(cell, "an entry"), self.robot, short, (i, j))

    def placed(self, node: Node, what: str) -> Iterator[Printed]:
        """Formulas under keys such as ``1,4``, or ``3`` for a vector."""
        seen: set[Place] = set()
        for key, value in reading.mapping(node, what).entries.values():
            match = _PLACE.fullmatch(key.text)
            place = (int(match[1]), int(match[2] or 1)) if match else (0, 0)
            if 0 in place or place in seen:
                raise CheckError(
                    f"{what}: place {quoted(key.text)}" + (" twice" if place in seen else ""),
                    allowed='allowed: row,column from 1, such as "1,4"; "3" in a vector',
                    location=key.location,
                )
            seen.add(place)
            yield read_printed(reading.scalar(value, "an entry"), self.robot, place=place)

    def abbreviated(self, item: document.YamlMapping) -> tuple[Printed, ...]:
        node = reading.child(item, "abbreviated")
        if node is None:
            return ()
        short = NO_NAMES
        names = reading.child(item, "abbreviations")
        for key, value in reading.mapping(names, "abbreviations").entries.values() if names else ():
            short = short.defining(key.text, read_printed(reading.scalar(value, "an abbreviation"), self.robot, short))
        rows = [reading.items(row, "a row of 'abbreviated'") for row in reading.items(node, "abbreviated")]
        return tuple(self.matrix(rows, short))

    def corrections(self, item: document.YamlMapping, wrong: set[Place]) -> tuple[Printed, ...]:
        node = reading.child(item, "correct")
        if node is None:
            return ()
        found = tuple(self.placed(node, "correct"))
        for correction in found:
            if (correction.row, correction.column) not in wrong:
                raise CheckError(
                    f"correction of {correction.row},{correction.column}, which is not among the printed entries",
                    remedy="print the wrong entry too",
                    location=correction.location,
                )
        return found

    def identity(self, node: Node) -> Identity:
        item = reading.mapping(node, "an identity", ("left", "right"), ("status", *_REMARKS))
        left, right = (
            read_printed(reading.scalar(item.entries[side][1], side), self.robot) for side in ("left", "right")
        )
        return Identity(left, right, reading.word(item, "status", ("ok", "erratum"), "ok"))

    def factorisation(self, node: Node) -> Factorisation:
        item = reading.mapping(node, "factorisation", ("of", "factors"), _REMARKS)
        factors = reading.items(item.entries["factors"][1], "factors")
        if not factors:
            raise CheckError("factorisation without factors", remedy="name two or more", location=item.location)
        names = tuple(reading.scalar(factor, "a factor").text for factor in factors)
        return Factorisation(reading.scalar(item.entries["of"][1], "of").text, names, item.location)


def check_path(path: str) -> tuple[FileReport, Robot]:
    """Compare everything that a file prints, and the robot whose notation it uses.

    Args:
        path: A corpus file with ``robot:``, a file of frames with ``items:``, or one of Newton-Euler equations.

    Raises:
        DeriveError: The file cannot be read.
    """
    source = path if path.isprintable() else quoted(path, 200)
    data = file_bytes(Path(path))
    root = read_tree(data, source)
    if isinstance(root, document.YamlMapping) and "robot" not in root.entries:
        if "items" in root.entries:
            return check_frames(root, source), NO_ROBOT
        if any(name in root.entries for name in SETS):
            return check_methods(root, source), NO_ROBOT
    file = corpus_from_bytes(data, source)
    return check_file(file), file.robot
