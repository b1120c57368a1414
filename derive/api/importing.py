"""Robots from URDF and xacro, from Python: what ``derive import`` makes and ``derive verify`` tests again."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from decimal import Decimal, InvalidOperation
from fractions import Fraction
from itertools import takewhile
from pathlib import Path

from derive.errors import (
    DeriveError,
    OutputError,
    RobotFileError,
    TargetError,
    VerificationError,
    quoted,
)
from derive.exchange.arm import arm_of, moving_tips
from derive.exchange.certificate import Certificate, certify
from derive.exchange.convert import convention_named
from derive.exchange.from_urdf import MOST_SNAP, Imported, robot_name
from derive.exchange.from_urdf import import_urdf as of_urdf
from derive.exchange.possible import possible, wants_possible
from derive.exchange.slanted import cut_off, named, snap_for
from derive.exchange.source import Source, open_urdf, opened, relative
from derive.exchange.space import exactly
from derive.publish.atomic_folder import write_files
from derive.robot.description import Convention, Description
from derive.robot.expression import ZERO, Name, is_constant
from derive.robot.load import is_robot_name, robot_file_bytes
from derive.robot.names import robot_symbols
from derive.robot.robot import Robot
from derive.robot.writer import robot_text

SNAP = "1e-6"
"""How near an angle is to a simple fraction of pi that it is taken for [rad]."""


def import_urdf(
    file: str | Path | bytes,
    *,
    tip: str | None = None,
    base: str | None = None,
    convention: str | Convention = Convention.STANDARD,
    snap: str | float = SNAP,
    name: str | None = None,
    packages: Sequence[str | Path] = (),
    arguments: Mapping[str, str] | None = None,
    inertia: str = "given",
    symbols: bool = False,
    folder: str | Path = ".",
) -> Imported:
    """The robot of a chain of a URDF, as ``derive import`` makes it.

    Args:
        file: Path of a URDF or a .xacro file, or the contents of a URDF.
        tip: Last link; None where only one carries no other.
        base: Link that stands; None for the one on which everything hangs.
        convention: ``standard`` or ``modified``.
        snap: Angles closer to simple fractions of pi are taken for them [rad].
        name: Of the robot; None for that of the URDF.
        packages: Folders in which xacro looks for packages, or ``NAME=DIR``.
        arguments: Of xacro.
        inertia: ``given``, or ``possible``: the nearest bodies that exist and move the same.
        symbols: Whether lengths are named, d1, a2, ..., with their numbers as parameters.
        folder: Where the robot file will be: it names the URDF from there.

    Returns:
        Text of the robot file, the robot, the proven bound of its pose error, and what a reader should know.

    Raises:
        RobotFileError: The file is no URDF, has no such chain, or a joint of it has no place in a table.
        TargetError: lxml or xacrodoc is not installed.
    """
    if name is not None and not is_robot_name(name):
        raise RobotFileError(f"{quoted(name)} is not a robot name", allowed="allowed: a-z, 0-9 and -, not first")
    return _Importer(file, convention, snap, packages, arguments, inertia, symbols, folder).arm(base, tip, name)


@dataclass(frozen=True, slots=True)
class AllTips:
    """Every arm of a URDF.

    Attributes:
        arms: One for each tip.
        refused: Why other tips have none, by their names.
    """

    arms: tuple[Imported, ...]
    refused: Mapping[str, str]


def import_all(
    file: str | Path | bytes,
    *,
    convention: str | Convention = Convention.STANDARD,
    snap: str | float = SNAP,
    name: str | None = None,
    packages: Sequence[str | Path] = (),
    arguments: Mapping[str, str] | None = None,
    inertia: str = "given",
    symbols: bool = False,
    folder: str | Path = ".",
) -> AllTips:
    """The robots of all chains from the root of a URDF to a tip.

    Args:
        file: Path of a URDF or a .xacro file, or the contents of a URDF.
        convention: ``standard`` or ``modified``.
        snap: Angles closer to simple fractions of pi are taken for them [rad].
        name: What the names of the robots begin with; None for that of the URDF.
        packages: Folders in which xacro looks for packages, or ``NAME=DIR``.
        arguments: Of xacro.
        inertia: ``given``, or ``possible``: the nearest bodies that exist and move the same.
        symbols: Whether lengths are named, d1, a2, ..., with their numbers as parameters.
        folder: Where the robot files will be.

    Returns:
        The robots, called by name and tip, and why a tip has none.

    Raises:
        RobotFileError: The file is no URDF, or no tip has a table.
        TargetError: lxml or xacrodoc is not installed.
    """
    importer = _Importer(file, convention, snap, packages, arguments, inertia, symbols, folder)
    urdf = importer.opened.urdf
    arms: list[Imported] = []
    refused: dict[str, str] = {}
    for tip in moving_tips(urdf):
        called = robot_name(f"{name or urdf.name or 'arm'}-{tip}")
        taken = any(arm.robot.name == called for arm in arms)
        try:
            arms.append(importer.arm(None, tip, f"{called}-{len(arms) + 1}" if taken else called))
        except RobotFileError as error:
            refused[tip] = str(error)
    if not arms:
        reason = next(iter(refused.values()), "no joint moves")
        raise RobotFileError(f"{urdf.source}: no arm: {reason}")
    return AllTips(tuple(arms), refused)


@dataclass(frozen=True, slots=True)
class ImportCheck:
    """What an imported robot file promises, tested again.

    Attributes:
        source: Path of the URDF.
        promised: The bound in the file.
        found: The bound of the robot as it is now; None where it could not be tested.
        changed: Whether the URDF is another than at import.
        lack: Why it could not be tested.
    """

    source: str
    promised: Certificate
    found: Certificate | None
    changed: bool = False
    lack: str = ""

    def __str__(self) -> str:
        if self.found is None:
            return f"{self.source}: {self.lack}, so the promised pose error was not tested"
        return f"{self.source}: {self.found}" + (" (the URDF has changed since)" if self.changed else "")

    def as_dict(self) -> dict[str, object]:
        """Plain data, for JSON."""
        position = None if self.found is None else self.found.position
        rotation = None if self.found is None else self.found.rotation
        return {"source": self.source, "position_error": position, "rotation_error": rotation, "changed": self.changed}


def verify_import(file: str | Path) -> ImportCheck | None:
    """Test the certificate in the head of a robot file again, against the URDF that it names.

    Args:
        file: Path of a robot file.

    Returns:
        What was found; None for a robot that was not imported.

    Raises:
        VerificationError: The table's poses may be farther from the URDF's than the file says.
        RobotFileError: One of both files cannot be read.
    """
    text = robot_file_bytes(file).decode("utf-8", "replace")
    told = Source.of(text)
    if told is None:
        return None
    source, promised = told
    path = source.beside(Path(file))
    if not source.file or not path.is_file():
        return ImportCheck(source.file or "standard input", promised, None, lack="not there")
    folders = [_moved(folder, path.parent, Path()) for folder in source.packages]
    try:
        urdf = open_urdf(path, folders, dict(source.arguments))
    except TargetError as error:
        return ImportCheck(str(path), promised, None, lack=f"{error.found} ({error.remedy})")
    robot = Robot.from_text(text, str(file))
    with exactly():
        arm = arm_of(urdf.urdf, source.base, source.tip, Fraction(0))
    ours, theirs = (
        "".join("R" if joint.is_revolute else "P" for joint in joints) for joints in (robot.joints, arm.axes)
    )
    if ours != theirs:
        raise VerificationError(f"{file}: joints {ours}, but those of {path} are {theirs}", remedy="import it again")
    found = certify(arm, robot).printed
    if found.position > promised.position or found.rotation > promised.rotation:
        raise VerificationError(
            f"{file}: poses may be up to {found.position:.2g} m and {found.rotation:.2g} rad from those of {path}",
            allowed=f"promised: {promised.position:.2g} m and {promised.rotation:.2g} rad",
            remedy="import it again",
        )
    return ImportCheck(str(path), promised, found, changed=urdf.sha256 != source.sha256)


class _Importer:
    """A URDF and how its arms are wanted."""

    def __init__(
        self,
        file: str | Path | bytes,
        convention: str | Convention,
        snap: str | float,
        packages: Sequence[str | Path],
        arguments: Mapping[str, str] | None,
        inertia: str,
        symbols: bool,
        folder: str | Path,
    ) -> None:
        self._possible, self._symbols = wants_possible(inertia), symbols
        self._convention, self._snap = convention_named(str(convention)), snap_of(snap)
        self._path, self._arguments = "", tuple((arguments or {}).items())
        self._folders: tuple[str, ...] = ()
        if isinstance(file, bytes):
            self.opened = opened(file, "<stdin>")
            return
        path = Path(file)
        if not path.is_file():
            found = f"no file {quoted(str(file), 200)}"
            raise RobotFileError(found, allowed="allowed: a URDF or a .xacro file, or - for standard input")
        self.opened = open_urdf(path, list(map(str, packages)), arguments)
        self._path = relative(path, Path(folder))
        self._folders = tuple(_moved(str(package), Path(), path.parent) for package in packages)

    def arm(self, base: str | None, tip: str | None, name: str | None) -> Imported:
        """One of its chains.

        Args:
            base: Name of the link that stands.
            tip: Name of the last link.
            name: Of the robot.
        """
        found = self._with_hint(of_urdf(self.opened.urdf, base, tip, self._convention, self._snap, name, self._head))
        found = with_possible_bodies(found) if self._possible and found.robot.links else found
        return with_named_lengths(found) if self._symbols else found

    def _with_hint(self, arm: Imported) -> Imported:
        """The arm with a note on angles such as 1.5708 that stay so: which snap takes them for pi/2, at what cost."""
        told, urdf = Source.of(arm.text), self.opened.urdf
        if told is None or not self._snap:
            return arm
        ends = told[0].base, told[0].tip
        with exactly():
            cut = cut_off(urdf, *ends, self._snap)
            if not cut or any(named(cut, taken) in arm.notes for taken in (False, True)):
                return arm
            wider = snap_for(cut)
        try:
            other = of_urdf(urdf, *ends, self._convention, wider)
        except RobotFileError:  # poses would move too far
            return arm
        ours, theirs = ((made.robot.joints, made.robot.base, made.robot.tool) for made in (arm, other))
        if ours == theirs:
            return arm
        price = f"--snap {float(wider):g} would take them for these and move poses by up to"
        return replace(arm, notes=(*arm.notes, f"{named(cut, False)}; {price} {other.certificate.position:.2g} m"))

    def _head(self, base: str, tip: str) -> str:
        return Source(self._path, base, tip, self.opened.sha256, self._folders, self._arguments).line


def with_possible_bodies(arm: Imported) -> Imported:
    """The arm with the nearest bodies that exist and give the same torques.

    Args:
        arm: As imported.

    Returns:
        It with these links, which its notes tell of.

    Raises:
        DeriveError: There are none, or the packages of the extra are missing.
    """
    found = possible(arm.robot)
    return _rewritten(arm, found.robot, found.report)


def with_named_lengths(arm: Imported) -> Imported:
    """The arm with d_i and a_i by name, as books have them, and their numbers as parameters.

    Args:
        arm: As imported.

    Returns:
        The same arm; numbers whose name is taken stay.
    """
    robot = arm.robot
    taken = {*robot_symbols(robot), *(joint.variable for joint in robot.joints)}
    rows = list(enumerate(robot.joints, 1))
    cells = {f"{key}{i}": getattr(joint, key) for i, joint in rows for key in ("d", "a")}
    values = {name: cell for name, cell in cells.items() if cell != ZERO and is_constant(cell) and name not in taken}
    named = {name: Name(name) if name in values else cell for name, cell in cells.items()}
    joints = tuple(replace(joint, d=named[f"d{i}"], a=named[f"a{i}"]) for i, joint in rows)
    return _rewritten(arm, replace(robot, joints=joints, parameters=(*values.items(), *robot.parameters)))


def _rewritten(arm: Imported, robot: Description, notes: Sequence[str] = ()) -> Imported:
    """The import with another robot, and what is to be said of it."""
    head = [line.removeprefix("# ") for line in takewhile(lambda line: line.startswith("#"), arm.text.splitlines())]
    text = robot_text(robot, [*head, *notes])
    return replace(arm, text=text, robot=Robot.from_text(text, f"{robot.name}.yaml"), notes=(*arm.notes, *notes))


def _moved(package: str, from_folder: Path, to_folder: Path) -> str:
    """A folder, or ``NAME=DIR``, seen from another folder."""
    name, sign, folder = package.rpartition("=")
    return f"{name}{sign}{relative(from_folder / folder, to_folder)}"


def snap_of(text: str | float) -> Fraction:
    """A distance of angles, exactly.

    Args:
        text: Such as ``1e-6``; from 0 to 0.1 [rad].

    Raises:
        DeriveError: Anything else.
    """
    try:
        value = Decimal(str(text))
    except InvalidOperation:
        value = Decimal("nan")
    if value.is_finite() and 0 <= value <= 1 and abs(value.adjusted()) < 100 and Fraction(value) <= MOST_SNAP:
        return Fraction(value)
    raise DeriveError(f"--snap {quoted(str(text))}", allowed="allowed: a number from 0 to 0.1", remedy=f"write {SNAP}")


def write(arms: Mapping[Path, Imported], *, force: bool = False) -> list[Robot]:
    """Write robot files, all or none.

    Args:
        arms: By path.
        force: Whether to write over files that are there.

    Returns:
        The robots, as read from the files.

    Raises:
        OutputError: A file is there already, or the system refused to write.
    """
    taken = next((path for path in arms if path.exists() or path.is_symlink()), None)
    if taken is not None and (taken.is_dir() or not force):
        remedy = "name a file" if taken.is_dir() else "write another -o, or --force"
        raise OutputError(f"{taken} exists already", remedy=remedy)
    folders = {
        path.parent: {p.name: arm.text.encode() for p, arm in arms.items() if p.parent == path.parent} for path in arms
    }
    for folder, files in folders.items():
        write_files(files, folder, force=True)
    return [Robot.from_text(arm.text, str(path)) for path, arm in arms.items()]
