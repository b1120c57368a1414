"""The robot as everything else sees it: frozen, validated, exact, in SI units and radians."""

from dataclasses import dataclass, fields
from html import escape
from pathlib import Path
from typing import Self

from derive.robot.description import FIXED, IDENTITY, Convention, Description, Joint
from derive.robot.expression import to_text
from derive.robot.load import description_from_bytes, robot_file_bytes
from derive.robot.names import free_symbols
from derive.robot.tree import explicit, table
from derive.robot.units import row_in_file_units


@dataclass(frozen=True, slots=True, repr=False)
class Robot(Description):
    """An arm or a tree: the Denavit-Hartenberg table, the frames around it and, if given, its dynamics.

    `load` and `from_text` make one; it shows itself as its table. All cells are exact, in SI units and radians.

    Attributes:
        name: ``[a-z0-9-]+``.
        title: Free text for people.
        convention: Standard or modified.
        joints: One row of the table per joint, those of a root that moves first.
        base: Constant 4x4 transform from the world frame to frame 0.
        tool: Constant 4x4 transform from frame n to the end effector.
        gravity: Acceleration of gravity in the world frame [m/s^2]; None where the file gives none.
        links: Masses, centres of mass, inertias, motors and friction, one per joint; empty without dynamics.
        parameters: Symbols with their exact numbers.
        runtime: Names that stay arguments of generated functions though they have a number.
        wrench: Axes (world, end) of a wrench on the end effector that generated dynamics take as an argument.
        style: How printed expressions are grouped.
        handout: What the handout shows and how.
        figure: Which configuration is drawn.
        inverse: What inverse kinematics is asked for.
        units: Units of plain numbers in the file.
        digest: SHA-256 of the robot file's bytes, hexadecimal.
        source: File name or catalogue name, for messages.
        fixed: Rows without motion.
        ends: The ends of a tree by name; empty for one end behind the last row.
        root: How the root of a tree moves; None where it stands.
        coupled: The variables of a table with coupled joints; else empty, and each joint has its own.
        remarks: What the file says and hardly means, such as 90 rad, each with its place.
        comments: Comments before the first line of the file.
    """

    @property
    def remarks_as_dicts(self) -> list[dict[str, str | int]]:
        """The remarks as plain data, for reports that programs read."""
        return [remark.as_dict() for remark in self.remarks]

    def __repr__(self) -> str:
        before = "" if self.is_tree else "[i-1]"
        names = {"alpha": f"alpha{before}", "a": f"a{before}"} if self.convention is Convention.MODIFIED else {}
        rows = [tuple(names.get(column, column) for column in self._columns), *self._table()]
        widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
        lines = ["  ".join(map(str.ljust, row, widths)).rstrip() for row in rows]
        named = ", ".join(f"{end.name} on {end.after}" for end in self.ends if end.name)
        lines += [f"ends: {named}"] if named else []
        lines += [f"variables: {', '.join(each.variable for each in self.coupled)}"] if self.coupled else []
        free = ", ".join(free_symbols(self)) or "none"
        gravity = ", ".join(map(to_text, self.gravity or ()))
        dynamics = f"{len(self.links)} links, gravity [{gravity}]" if self.links else "none"
        head = f"Robot {self.name}: {' '.join(self.title.split())} {self._heading}"
        return "\n".join([head, *lines, f"dynamics: {dynamics}; free symbols: {free}"])

    def _repr_html_(self) -> str:
        """The DH table for notebooks, in the units of the file; every text of the user's escaped."""
        before = "" if self.is_tree or self.convention is Convention.STANDARD else "<sub>i&minus;1</sub>"
        names = {"theta": "&theta;", "alpha": f"&alpha;{before}", "a": f"a{before}", "gamma": "&gamma;"}
        head = "".join(f"<th>{names.get(column, column)}</th>" for column in self._columns)
        rows = ("".join(f"<td>{escape(cell)}</td>" for cell in row) for row in self._table())
        body = "".join(f"<tr>{row}</tr>" for row in rows)
        caption = f"{escape(self.title)} {self._heading}"
        return f"<table><caption>{caption}</caption><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"

    def _table(self) -> list[tuple[str, ...]]:
        """By `_columns` the cells of all rows as text, those of a root that moves first."""
        roots = self.root.variables if self.root else ()
        rows, number, whole = [], 0, explicit(self)
        for row in (*whole.joints[: len(roots)], *table(whole)):
            row = row_in_file_units(row, self.units)
            cells = row.written(to_text) | {"i": "", "joint": FIXED, "name": row.label, "limits": ""}
            if isinstance(row, Joint):
                number += 1
                limits = " to ".join(map(to_text, row.limits or ()))
                cells |= {"i": str(number), "joint": row.type.value, "limits": limits}
            if stand := row.stand:
                after = stand.after + " + mount" * (stand.mount != IDENTITY)
                cells |= {"after": "root" if row.label in roots else after}
                cells |= {"gamma": to_text(stand.gamma), "b": to_text(stand.b)}
            rows.append(tuple(map(cells.__getitem__, self._columns)))
        return rows

    @property
    def _columns(self) -> tuple[str, ...]:
        order = ("theta", "d", "a", "alpha") if self.convention is Convention.STANDARD else ("alpha", "a", "theta", "d")
        if not self.is_tree:
            return ("i", "joint", *order, "limits")
        khalil = ("gamma", "b") if self.convention is Convention.MODIFIED else ()
        return ("i", "joint", "name", "after", *khalil, *order, "limits")

    @property
    def _heading(self) -> str:
        """The convention, and the units of the table where they are not SI."""
        units = [word for word, is_so in (("deg", self.units.degrees), ("mm", self.units.millimetres)) if is_so]
        numbers = f", numbers in {' and '.join(units)}" if units else ""
        return f"({self.convention.value} Denavit-Hartenberg convention{numbers})"

    @classmethod
    def load(cls, path_or_name: str | Path) -> Self:
        """Load a robot file, or a robot of the catalogue by name.

        Args:
            path_or_name: Path of a YAML file, or a name that ``derive list`` shows.

        Raises:
            RobotFileError: The file cannot be read or does not describe a robot.
            UnknownRobotError: Neither a file nor a catalogue name.
        """
        return cls.from_bytes(robot_file_bytes(path_or_name), str(path_or_name))

    @classmethod
    def from_text(cls, text: str, source: str = "<text>") -> Self:
        """Load a robot from YAML text.

        Args:
            text: Contents of a robot file.
            source: Name to use in messages.

        Raises:
            RobotFileError: The text does not describe a robot.
        """
        return cls.from_bytes(text.encode("utf-8", "surrogatepass"), source)

    @classmethod
    def from_bytes(cls, data: bytes, source: str) -> Self:
        """Load a robot from the bytes of a file.

        Args:
            data: Contents of a robot file, UTF-8.
            source: Name to use in messages.

        Raises:
            RobotFileError: The bytes do not describe a robot.
        """
        return cls.of(description_from_bytes(data, source))

    @classmethod
    def of(cls, description: Description) -> Self:
        """The robot with the data of a description.

        Args:
            description: Validated data, for instance another robot's.
        """
        return cls(**{field.name: getattr(description, field.name) for field in fields(description)})
