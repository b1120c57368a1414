"""A YAML file as a tree of texts, each with its place.

Only YAML's events are used (safe loader): no object is ever constructed, and a scalar is the text that stands in the
file, so ``0.10``, ``1e3``, ``no`` and ``0o17`` never change their meaning.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from dataclasses import dataclass, field

import yaml

from derive.errors import Location, RobotFileError, path_text, quoted
from derive.robot.reading.hints import file_hint
from derive.robot.reading.size_limits import FILE_LIMITS

KeyPath = tuple[str | int, ...]  # a place in the tree by keys and positions from 0: ``("joints", 0, "theta")``


@dataclass(frozen=True, slots=True)
class YamlScalar:
    """A text in the file."""

    text: str  # the text, quotes removed
    location: Location  # where the value begins, its quotation mark included
    inner: Location  # where its first character stands; offsets into ``text`` are columns from here
    verbatim: bool  # whether ``text`` stands in the file character by character, so that offsets are exact


@dataclass(frozen=True, slots=True)
class YamlSequence:
    """A list and where it begins."""

    location: Location
    items: list[Node] = field(default_factory=list)


@dataclass(frozen=True, slots=True)
class YamlMapping:
    """A mapping, its keys with their own positions, and where it begins."""

    location: Location
    entries: dict[str, tuple[YamlScalar, Node]] = field(default_factory=dict)


Node = YamlScalar | YamlSequence | YamlMapping


@dataclass(frozen=True, slots=True)
class Document:
    """A parsed file."""

    root: YamlMapping  # the robot block
    source: str  # name for messages
    digest: str  # SHA-256 of the file's bytes
    what: str = "the robot file"  # what it is, for messages

    def find(self, path: KeyPath) -> Node | None:
        """What stands at a place; None where the file has nothing there."""
        node: Node | None = self.root
        for part in path:
            if isinstance(node, YamlMapping):
                node = node.entries[str(part)][1] if str(part) in node.entries else None
            elif isinstance(node, YamlSequence) and isinstance(part, int) and 0 <= part < len(node.items):
                node = node.items[part]
            else:
                return None
        return node

    def scalar(self, path: KeyPath) -> YamlScalar | None:
        """The text at a place, with its position; None where the file has none."""
        node = self.find(path)
        return node if isinstance(node, YamlScalar) else None

    def text(self, *path: str | int) -> str:
        """The text at a place, without its position."""
        scalar = self.scalar(path)
        return scalar.text if scalar else ""

    def length(self, path: KeyPath) -> int:
        """Number of items of the list at a place."""
        node = self.find(path)
        return len(node.items) if isinstance(node, YamlSequence) else 0

    def key_location(self, path: KeyPath) -> Location:
        """Where the key (or list item) at the end of a path stands."""
        parent = self.find(path[:-1])
        if isinstance(parent, YamlMapping) and path[-1] in parent.entries:
            return parent.entries[str(path[-1])][0].location
        return self.location(path)

    def location(self, path: KeyPath) -> Location:
        """Where the value at the end of a path stands."""
        found = (self.find(path[:end]) for end in range(len(path), -1, -1))
        return next(node.location for node in found if node is not None)

    def error(self, path: KeyPath, found: str, allowed: str = "", remedy: str = "") -> RobotFileError:
        """An error at the value of a path, which the message names."""
        found = f"{path_text(path, self.what)}: {found}"
        return RobotFileError(found, allowed=allowed, remedy=remedy, location=self.location(path))


def read_document(data: bytes, source: str) -> Document:
    """Parse a robot file; of a lecture corpus file only the block ``robot:`` is kept."""
    what, advice = file_hint(data[:4000].decode("utf-8", "replace"))
    if what:
        raise RobotFileError(f"this is {what}, not a robot file", remedy=advice, location=Location(source))
    root = read_tree(data, source)
    remedy = "see derive new NAME"
    if root is None:
        raise RobotFileError("empty file", allowed="allowed: a robot", remedy=remedy, location=Location(source))
    if not isinstance(root, YamlMapping):
        allowed = "allowed: keys such as name, convention, joints"
        raise RobotFileError("the file is not a mapping", allowed=allowed, remedy=remedy, location=root.location)
    if "robot" in root.entries:
        block = root.entries["robot"][1]
        if clash := [key for key in ("joints", "convention", "links") if key in root.entries]:
            rule = "allowed: one robot, either in the block 'robot' or at the top level"
            how, location = f"move '{clash[0]}' into the block", root.entries[clash[0]][0].location
            raise RobotFileError(f"'{clash[0]}' beside the block 'robot'", allowed=rule, remedy=how, location=location)
        if not isinstance(block, YamlMapping):
            raise RobotFileError("'robot' is not a mapping", remedy=remedy, location=block.location)
        root = block
    return Document(root, source, hashlib.sha256(data).hexdigest())


def read_tree(data: bytes, source: str) -> Node | None:
    """Parse a file to its tree of texts; None where the file is empty."""
    if len(data) > FILE_LIMITS.size:
        found = f"file larger than {FILE_LIMITS.size} bytes"
        raise RobotFileError(found, remedy="a robot file holds one robot", location=Location(source))
    remedy = "save the file as UTF-8 text"
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        before = data[: error.start]
        place = Location(source, before.count(b"\n") + 1, error.start - before.rfind(b"\n"))
        raise RobotFileError(f"byte 0x{data[error.start]:02x} is not UTF-8", remedy=remedy, location=place) from None
    for index, character in enumerate(text):
        if ord(character) < 32 and character not in "\t\n\r":
            found, place = f"control character U+{ord(character):04X}", _location(text, index, source)
            raise RobotFileError(found, allowed="allowed: plain text", remedy=remedy, location=place)
    try:
        return _TreeBuilder(text, source).build()
    except yaml.YAMLError as error:
        raise _yaml_error(error, text, source) from None


def _location(text: str, index: int, source: str) -> Location:
    return Location(source, text.count("\n", 0, index) + 1, index - text.rfind("\n", 0, index))


class _TreeBuilder:
    """Builds the tree from YAML events with an explicit stack, so that nesting cannot exhaust Python's."""

    def __init__(self, text: str, source: str) -> None:
        self._text, self._source, self._nodes = text, source, 0
        self._stack: list[tuple[YamlSequence | YamlMapping, YamlScalar | None]] = []
        self._root: Node | None = None

    def build(self) -> Node | None:
        """The root node, or None for an empty document."""
        documents = 0
        events: Iterator[yaml.Event] = yaml.parse(self._text, Loader=yaml.SafeLoader)
        for event in events:
            if isinstance(event, yaml.DocumentStartEvent):
                documents += 1
                if documents > 1:
                    raise self._refuse(event, "second YAML document", "one robot per file; remove '---'")
            elif isinstance(event, yaml.AliasEvent):
                raise self._refuse(event, "YAML alias", "write the value out")
            elif isinstance(event, yaml.NodeEvent):
                self._check(event)
                if isinstance(event, yaml.ScalarEvent):
                    self._add(self._scalar(event))
                else:
                    kind = YamlSequence if isinstance(event, yaml.SequenceStartEvent) else YamlMapping
                    self._stack.append((kind(self._location(event.start_mark)), None))
            elif isinstance(event, yaml.CollectionEndEvent):
                self._add(self._stack.pop()[0])
        return self._root

    def _check(self, event: yaml.NodeEvent) -> None:
        """Refuse what robot files do not need, and what is too much of it."""
        if event.anchor is not None:
            raise self._refuse(event, "YAML anchor", "write the value out where it is needed")
        if (tag := getattr(event, "tag", None)) is not None:
            raise self._refuse(event, f"YAML tag {quoted(str(tag))}", "write the plain value")
        self._nodes += 1
        if self._nodes > FILE_LIMITS.nodes:
            raise self._refuse(event, f"more than {FILE_LIMITS.nodes} values", "a robot file holds one robot")
        if isinstance(event, yaml.ScalarEvent):
            return
        if len(self._stack) >= FILE_LIMITS.depth:
            raise self._refuse(event, "lists and mappings nested too deeply", f"at most {FILE_LIMITS.depth} levels")
        if self._stack and isinstance(self._stack[-1][0], YamlMapping) and self._stack[-1][1] is None:
            raise self._refuse(event, "key that is not a text", "write plain keys such as joints")

    def _add(self, node: Node) -> None:
        """Put a finished node into the list or mapping around it; in a mapping, texts are keys and values by turns."""
        if not self._stack:
            self._root = node
            return
        parent, key = self._stack[-1]
        if isinstance(parent, YamlSequence):
            parent.items.append(node)
        elif key is not None:
            parent.entries[key.text] = (key, node)
            self._stack[-1] = (parent, None)
        elif isinstance(node, YamlScalar):
            if node.text in parent.entries:
                remedy = f"remove one; the first is in line {parent.entries[node.text][0].location.line}"
                raise RobotFileError(f"key {quoted(node.text)} twice", remedy=remedy, location=node.location)
            self._stack[-1] = (parent, node)

    def _scalar(self, event: yaml.ScalarEvent) -> YamlScalar:
        start, text = self._location(event.start_mark), event.value
        if not text.isascii() and any(0xD800 <= ord(character) < 0xE000 for character in text):
            # JSON writes characters beyond U+FFFF as two escapes; YAML reads them as two halves
            text = text.encode("utf-16-le", "surrogatepass").decode("utf-16-le", "surrogatepass")
        if event.start_mark is None or event.end_mark is None:
            return YamlScalar(text, start, start, False)
        quotes = 1 if event.style in ("'", '"') else 0
        raw = self._text[event.start_mark.index + quotes : event.end_mark.index - quotes]
        return YamlScalar(text, start, Location(start.source, start.line, start.column + quotes), raw == text)

    def _location(self, mark: yaml.error.Mark | yaml._yaml.Mark | None) -> Location:
        return Location(self._source, mark.line + 1, mark.column + 1) if mark else Location(self._source)

    def _refuse(self, event: yaml.Event, found: str, remedy: str) -> RobotFileError:
        return RobotFileError(found, remedy=remedy, location=self._location(event.start_mark))


def _yaml_error(error: yaml.YAMLError, text: str, source: str) -> RobotFileError:
    """One message with a place for whatever PyYAML found."""
    if isinstance(error, yaml.reader.ReaderError):
        place = _location(text, error.position, source)
        found = f"character U+{ord(text[error.position]):04X} is not allowed in YAML"
        return RobotFileError(found, remedy="remove it", location=place)
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
