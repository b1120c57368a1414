"""Robots from URDF and xacro, from Python: what ``derive import`` makes and ``derive verify`` tests again."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from hashlib import sha256
from pathlib import Path
from typing import Unpack

from derive.errors import RobotFileError, TargetError, VerificationError, quoted
from derive.exchange import from_tree, from_urdf
from derive.exchange.arm import arm_of, moving_tips
from derive.exchange.certificate import Certificate, certify
from derive.exchange.from_urdf import Imported, ImportKeywords, ImportOptions, robot_name
from derive.exchange.reading.elements import Urdf
from derive.exchange.reading.mjcf import IS_MJCF, read_mjcf
from derive.exchange.reading.source import ChainSource, moved, open_urdf, opened, relative
from derive.exchange.reading.urdf import MOST_BYTES
from derive.mechanics.space import exactly
from derive.model.identification.witness import NoSuchBodies
from derive.robot.load import file_bytes, is_robot_name, robot_file_bytes
from derive.robot.robot import Robot


def import_urdf(
    file: str | Path | bytes, *, tip: str | None = None, base: str | None = None, **options: Unpack[ImportKeywords]
) -> Imported:
    """The robot of a chain of a URDF, as ``derive import`` makes it.

    Args:
        file: Path of a URDF or a .xacro file, or the contents of a URDF.
        tip: Last link; None where only one carries no other.
        base: Link that stands; None for the one on which everything hangs.
        options: ``convention``, ``snap``, ``name``, ``inertia``, ``symbols``, ``packages``, ``arguments``, ``folder``:
            see `derive.exchange.from_urdf.ImportOptions`.

    Returns:
        Text of the robot file, the robot, the proven bound of its pose error, and what a reader should know.

    Raises:
        RobotFileError: The file is no URDF, has no such chain, or a joint of it has no place in a table.
        TargetError: lxml or xacrodoc is not installed.
    """
    wanted = _wanted(options)
    urdf, source = _found(file, wanted)
    return from_urdf.import_urdf(urdf, base, tip, wanted, source)


def import_tree(
    file: str | Path | bytes, *, root: str | None = None, ends: Sequence[str] = (), **options: Unpack[ImportKeywords]
) -> from_tree.ImportedTree:
    """The tree of all joints of a URDF or an MJCF, as ``derive import --tree`` makes it.

    Args:
        file: Path of a URDF, a .xacro file or an MJCF, or the contents of a URDF or an MJCF.
        root: ``planar`` or ``floating``: how the link moves on which all hang; None where it stands, or is free in an
            MJCF.
        ends: Links that are ends; without them those behind the last joints of limbs, at most twelve. Of several robots
            in an MJCF that is taken which has them, else the one with most motors.
        options: ``convention``, ``snap``, ``name``, ``packages``, ``arguments``, ``folder``, as of `import_urdf`.

    Returns:
        Text of the robot file, the robot, how far it is from the file at random states, and what a reader should know.

    Raises:
        RobotFileError: The file is neither, is no tree, or a joint of it is no row of a table.
        TargetError: lxml, xacrodoc or mujoco is not installed.
    """
    wanted = _wanted(options)
    path = Path(file) if not isinstance(file, bytes) else None
    data = file if isinstance(file, bytes) else file_bytes(path, MOST_BYTES) if path and path.is_file() else b""
    if IS_MJCF.match(data):
        urdf, digest = read_mjcf(data, str(path or "<stdin>"), path, ends), sha256(data).hexdigest()
    else:
        urdf, source = _found(file, wanted)
        digest = source.sha256
    where = relative(path, Path(wanted.folder)) if path else "standard input"
    head = f"derive import --tree, of {quoted(where, 200)}, sha256 {digest}"
    return from_tree.import_tree(urdf, root or "", ends, wanted, head)


def _wanted(options: ImportKeywords) -> ImportOptions:
    wanted = ImportOptions(**options)
    if wanted.name is not None and not is_robot_name(wanted.name):
        raise RobotFileError(f"{quoted(wanted.name)} is not a robot name", allowed="allowed: a-z, 0-9 and -, not first")
    return wanted


@dataclass(frozen=True, slots=True)
class AllTips:
    """Every arm of a URDF.

    Attributes:
        arms: One for each tip.
        refused: Why other tips have none, by their names.
    """

    arms: tuple[Imported, ...]
    refused: Mapping[str, str]


def import_all(file: str | Path | bytes, **options: Unpack[ImportKeywords]) -> AllTips:
    """The robots of all chains from the root of a URDF to a tip.

    Args:
        file: Path of a URDF or a .xacro file, or the contents of a URDF.
        options: As those of `import_urdf`.

    Returns:
        The robots, called by name and tip, and why a tip has none.

    Raises:
        RobotFileError: The file is no URDF, or no tip has a table.
        TargetError: lxml or xacrodoc is not installed.
    """
    wanted = ImportOptions(**options)
    urdf, source = _found(file, wanted)
    arms: list[Imported] = []
    refused: dict[str, str] = {}
    for tip in moving_tips(urdf):
        called = robot_name(f"{wanted.name or urdf.name or 'arm'}-{tip}")
        called = f"{called}-{len(arms) + 1}" if any(arm.robot.name == called for arm in arms) else called
        try:
            arms.append(from_urdf.import_urdf(urdf, None, tip, replace(wanted, name=called), source))
        except (RobotFileError, NoSuchBodies) as error:
            refused[tip] = str(error)
    if not arms:
        raise RobotFileError(f"{urdf.source}: no arm: {next(iter(refused.values()), 'no joint moves')}")
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
        position, rotation = (self.found.position, self.found.rotation) if self.found else (None, None)
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
    if (told := ChainSource.of(text)) is None:
        return None
    source, promised = told
    path = Path(file).parent / source.file
    if not source.file or not path.is_file():
        return ImportCheck(source.file or "standard input", promised, None, lack="not there")
    try:
        packages = [moved(package, path.parent, Path()) for package in source.packages]
        urdf, now = open_urdf(path, packages, dict(source.arguments))
    except TargetError as error:
        return ImportCheck(str(path), promised, None, lack=f"{error.found} ({error.remedy})")
    robot = Robot.from_text(text, str(file))
    if robot.is_tree:
        return ImportCheck(str(path), promised, None, lack="its arm has become a tree")
    with exactly():
        arm = arm_of(urdf, source.base, source.tip, Fraction(0))
    ours, theirs = ("".join("R" if j.is_revolute else "P" for j in joints) for joints in (robot.joints, arm.axes))
    if ours != theirs:
        raise VerificationError(f"{file}: joints {ours}, but those of {path} are {theirs}", remedy="import it again")
    found = certify(arm, robot).printed
    if found.position > promised.position or found.rotation > promised.rotation:
        raise VerificationError(
            f"{file}: poses may be up to {found.position:.2g} m and {found.rotation:.2g} rad from those of {path}",
            allowed=f"promised: {promised.position:.2g} m and {promised.rotation:.2g} rad",
            remedy="import it again",
        )
    return ImportCheck(str(path), promised, found, changed=now.sha256 != source.sha256)


def _found(file: str | Path | bytes, options: ImportOptions) -> tuple[Urdf, ChainSource]:
    """The URDF that a user names, and how a robot file names it, but for the links at both ends."""
    if isinstance(file, bytes):
        return opened(file, "<stdin>", options.arguments)
    path = Path(file)
    if not path.is_file():
        found = f"no file {quoted(str(file), 200)}"
        raise RobotFileError(found, allowed="allowed: a URDF or a .xacro file, or - for standard input")
    return open_urdf(path, list(map(str, options.packages)), options.arguments, Path(options.folder))
