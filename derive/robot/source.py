"""YAML text to a tree of texts with positions.

Only YAML's events are used (safe loader): no object is ever constructed, and a scalar is the text that stands in the
file, so ``0.10``, ``1e3``, ``no`` and ``0o17`` never change their meaning.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator

import yaml

from derive.errors import Location, RobotFileError
from derive.robot.document import Document, Mapping, Node, Scalar, Sequence
from derive.robot.limits import FILE_LIMITS
from derive.robot.wording import quoted


def read_document(data: bytes, source: str) -> Document:
    """Parse a robot file; of a lecture corpus file only the block ``robot:`` is kept.

    Args:
        data: Bytes of the file, UTF-8.
        source: Name for messages.

    Raises:
        RobotFileError: Not UTF-8, too large, not YAML, or YAML outside the plain subset that robot files use.
    """
    root = read_tree(data, source)
    return Document(_robot_block(root, Location(source)), source, hashlib.sha256(data).hexdigest())


def read_tree(data: bytes, source: str) -> Node | None:
    """Parse a file to its tree of texts; None where it is empty.

    Args:
        data: Bytes of the file, UTF-8.
        source: Name for messages.

    Raises:
        RobotFileError: Not UTF-8, too large, not YAML, or YAML outside the plain subset that robot files use.
    """
    if len(data) > FILE_LIMITS.size:
        raise RobotFileError(
            f"file larger than {FILE_LIMITS.size} bytes",
            remedy="a robot file holds one robot",
            location=Location(source),
        )
    text = _decoded(data, source)
    try:
        return _Builder(text, source).build()
    except yaml.YAMLError as error:
        raise _yaml_error(error, text, source) from None


def _decoded(data: bytes, source: str) -> str:
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        before = data[: error.start]
        place = Location(source, before.count(b"\n") + 1, error.start - before.rfind(b"\n"))
        raise RobotFileError(
            f"byte 0x{data[error.start]:02x} is not UTF-8", remedy="save the file as UTF-8 text", location=place
        ) from None
    for index, character in enumerate(text):
        if ord(character) < 32 and character not in "\t\n\r":
            raise RobotFileError(
                f"control character U+{ord(character):04X}",
                allowed="allowed: plain text",
                remedy="save the file as UTF-8 text",
                location=_location(text, index, source),
            )
    return text


def _location(text: str, index: int, source: str) -> Location:
    return Location(source, text.count("\n", 0, index) + 1, index - text.rfind("\n", 0, index))


def _robot_block(root: Node | None, start: Location) -> Mapping:
    if root is None:
        raise RobotFileError("empty file", allowed="allowed: a robot", remedy="see derive new NAME", location=start)
    if not isinstance(root, Mapping):
        raise RobotFileError(
            "the file is not a mapping",
            allowed="allowed: keys such as name, convention, joints",
            remedy="see derive new NAME",
            location=root.location,
        )
    inner = root.entries.get("robot")
    if inner is None:
        return root
    if clash := [key for key in ("joints", "convention", "links") if key in root.entries]:
        raise RobotFileError(
            f"'{clash[0]}' beside the block 'robot'",
            allowed="allowed: one robot, either in the block 'robot' or at the top level",
            remedy=f"move '{clash[0]}' into the block",
            location=root.entries[clash[0]][0].location,
        )
    if not isinstance(inner[1], Mapping):
        raise RobotFileError("'robot' is not a mapping", remedy="see derive new NAME", location=inner[1].location)
    return inner[1]


class _Builder:
    """Builds the tree from YAML events with an explicit stack, so that nesting cannot exhaust Python's."""

    def __init__(self, text: str, source: str) -> None:
        self._text = text
        self._source = source
        self._nodes = 0
        self._stack: list[tuple[Sequence | Mapping, Scalar | None]] = []
        self._root: Node | None = None

    def build(self) -> Node | None:
        """The root node, or None for an empty document."""
        documents = 0
        for event in self._events():
            if isinstance(event, yaml.DocumentStartEvent):
                documents += 1
                if documents > 1:
                    raise self._refuse(event, "second YAML document", "one robot per file; remove '---'")
            elif isinstance(event, yaml.AliasEvent):
                raise self._refuse(event, "YAML alias", "write the value out")
            elif isinstance(event, yaml.NodeEvent):
                self._open(event)
            elif isinstance(event, yaml.CollectionEndEvent):
                self._close()
        return self._root

    def _events(self) -> Iterator[yaml.Event]:
        events: Iterator[yaml.Event] = yaml.parse(self._text, Loader=yaml.SafeLoader)
        return events

    def _open(self, event: yaml.NodeEvent) -> None:
        if event.anchor is not None:
            raise self._refuse(event, "YAML anchor", "write the value out where it is needed")
        tag = getattr(event, "tag", None)
        if tag is not None:
            raise self._refuse(event, f"YAML tag {quoted(str(tag))}", "write the plain value")
        self._nodes += 1
        if self._nodes > FILE_LIMITS.nodes:
            raise self._refuse(event, f"more than {FILE_LIMITS.nodes} values", "a robot file holds one robot")
        if isinstance(event, yaml.ScalarEvent):
            self._add(self._scalar(event))
            return
        place = self._location(event.start_mark)
        if len(self._stack) >= FILE_LIMITS.depth:
            raise self._refuse(event, "lists and mappings nested too deeply", f"at most {FILE_LIMITS.depth} levels")
        if self._key_expected():
            raise self._refuse(event, "key that is not a text", "write plain keys such as joints")
        self._stack.append((Sequence(place) if isinstance(event, yaml.SequenceStartEvent) else Mapping(place), None))

    def _close(self) -> None:
        node, _ = self._stack.pop()
        self._add(node)

    def _key_expected(self) -> bool:
        return bool(self._stack) and isinstance(self._stack[-1][0], Mapping) and self._stack[-1][1] is None

    def _add(self, node: Node) -> None:
        if not self._stack:
            self._root = node
            return
        parent, key = self._stack[-1]
        if isinstance(parent, Sequence):
            parent.items.append(node)
        elif key is None and isinstance(node, Scalar):
            self._stack[-1] = (parent, self._new_key(parent, node))
        elif key is not None:
            parent.entries[key.text] = (key, node)
            self._stack[-1] = (parent, None)

    def _new_key(self, parent: Mapping, key: Scalar) -> Scalar:
        if key.text in parent.entries:
            first = parent.entries[key.text][0].location
            raise RobotFileError(
                f"key {quoted(key.text)} twice",
                remedy=f"remove one; the first is in line {first.line}",
                location=key.location,
            )
        return key

    def _scalar(self, event: yaml.ScalarEvent) -> Scalar:
        start = self._location(event.start_mark)
        value = _joined_surrogates(event.value)
        if event.start_mark is None or event.end_mark is None:
            return Scalar(value, start, start, False)
        quotes = 1 if event.style in ("'", '"') else 0
        raw = self._text[event.start_mark.index + quotes : event.end_mark.index - quotes]
        inner = Location(start.source, start.line, start.column + quotes)
        return Scalar(value, start, inner, raw == value)

    def _location(self, mark: yaml.error.Mark | yaml._yaml.Mark | None) -> Location:
        return Location(self._source, mark.line + 1, mark.column + 1) if mark else Location(self._source)

    def _refuse(self, event: yaml.Event, found: str, remedy: str) -> RobotFileError:
        return RobotFileError(found, remedy=remedy, location=self._location(event.start_mark))


def _joined_surrogates(text: str) -> str:
    """JSON writes characters beyond U+FFFF as two escapes; YAML reads them as two halves."""
    if text.isascii() or not any(0xD800 <= ord(character) < 0xE000 for character in text):
        return text
    return text.encode("utf-16-le", "surrogatepass").decode("utf-16-le", "surrogatepass")


def _yaml_error(error: yaml.YAMLError, text: str, source: str) -> RobotFileError:
    """One message with a place for whatever PyYAML found."""
    if isinstance(error, yaml.reader.ReaderError):
        place = _location(text, error.position, source)
        return RobotFileError(
            f"character U+{ord(text[error.position]):04X} is not allowed in YAML", remedy="remove it", location=place
        )
    mark = getattr(error, "problem_mark", None)
    place = Location(source, mark.line + 1, mark.column + 1) if mark else Location(source)
    problem = str(getattr(error, "problem", None) or "not YAML")
    context = str(getattr(error, "context", None) or "")
    remedy = "check indentation, colons, quotation marks and brackets around this place"
    if "\\t" in problem:
        remedy = "indent with spaces, not tabs"
    elif "mapping values are not allowed" in problem:
        remedy = "put a text that contains ': ' in quotation marks; check the indentation"
    found = f"not YAML: {problem}" + (f" ({context})" if context else "")
    return RobotFileError(" ".join(found.split()), remedy=remedy, location=place)
