"""A file as a tree of texts, each with its place."""

from __future__ import annotations

from dataclasses import dataclass, field

from derive.errors import Location, RobotFileError
from derive.robot.wording import path_text

Path = tuple[str | int, ...]


@dataclass(frozen=True, slots=True)
class Scalar:
    """A text in the file.

    Attributes:
        text: The text, quotes removed.
        location: Where the value begins, its quotation mark included.
        inner: Where its first character stands; offsets into ``text`` are columns from here.
        verbatim: Whether ``text`` stands in the file character by character, so that offsets are exact.
    """

    text: str
    location: Location
    inner: Location
    verbatim: bool


@dataclass(frozen=True, slots=True)
class Sequence:
    """A list and where it begins."""

    location: Location
    items: list[Node] = field(default_factory=list)


@dataclass(frozen=True, slots=True)
class Mapping:
    """A mapping, its keys with their own positions, and where it begins."""

    location: Location
    entries: dict[str, tuple[Scalar, Node]] = field(default_factory=dict)


Node = Scalar | Sequence | Mapping


@dataclass(frozen=True, slots=True)
class Document:
    """A parsed file.

    Attributes:
        root: The robot block.
        source: Name for messages.
        digest: SHA-256 of the file's bytes.
    """

    root: Mapping
    source: str
    digest: str

    def find(self, path: Path) -> Node | None:
        """The node at a path such as ``("joints", 0, "theta")``, or None."""
        node: Node | None = self.root
        for part in path:
            node = _child(node, part)
        return node

    def scalar(self, path: Path) -> Scalar | None:
        """The text at a path, or None where the file has none."""
        node = self.find(path)
        return node if isinstance(node, Scalar) else None

    def length(self, path: Path) -> int:
        """Number of items of the list at a path; 0 where there is none."""
        node = self.find(path)
        return len(node.items) if isinstance(node, Sequence) else 0

    def key_location(self, path: Path) -> Location:
        """Where the key (or list item) at the end of a path stands."""
        parent = self.find(path[:-1])
        if isinstance(parent, Mapping) and path[-1] in parent.entries:
            return parent.entries[str(path[-1])][0].location
        return self.location(path)

    def location(self, path: Path) -> Location:
        """Where the value at a path begins, or the nearest place around it that exists."""
        for end in range(len(path), -1, -1):
            node = self.find(path[:end])
            if node is not None:
                return node.location
        return self.root.location

    def error(self, path: Path, found: str, allowed: str = "", remedy: str = "") -> RobotFileError:
        """An error at the value of a path, which the message names."""
        return RobotFileError(
            f"{path_text(path)}: {found}", allowed=allowed, remedy=remedy, location=self.location(path)
        )


def _child(node: Node | None, part: str | int) -> Node | None:
    if isinstance(node, Mapping):
        entry = node.entries.get(str(part))
        return entry[1] if entry else None
    if isinstance(node, Sequence) and isinstance(part, int) and 0 <= part < len(node.items):
        return node.items[part]
    return None
