"""Where an imported robot comes from: URDFs read from files, expanded from xacro, named in the head of a robot file.

The first line of an imported robot file is data, so that what it promises can be tested again.

xacro hands expressions to Python without its builtins. That keeps nobody in: a generator knows the frame that runs it,
and names within a lambda are not looked at, so a file from elsewhere could run any command. Expressions are looked at
before xacro sees them, each time it is about to evaluate one, since one expansion may write the next.
"""

from __future__ import annotations

import ast
import contextlib
import io
import json
import os
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from functools import partial
from hashlib import sha256
from pathlib import Path
from typing import Any

from derive.errors import Location, RobotFileError, optional, quoted
from derive.exchange.certificate import Certificate
from derive.exchange.reading.elements import Urdf
from derive.exchange.reading.urdf import MOST_BYTES, read_urdf
from derive.robot.load import file_bytes

# Stands before the data in the first line; another command may have put its own lines before it.
MARK = "derive import: "
XACRO = ".xacro"

_DATA = re.compile(rf"\A(?:#.*\n)*?# {MARK}(.*)$", re.MULTILINE)
_XACRO = re.compile(rb"<xacro:|\$[{(]")
_KIND = re.compile(r"^<class '[^']*'>: ")
_PROMISE = re.compile(r"^# pose error over all limits <= (\S+) m and (\S+) rad, proven$", re.MULTILINE)
# Names that lead from values to the program that runs.
INNER = re.compile(r"__|(gi|cr|ag|tb)_(frame|code|yieldfrom|await|next)$|f_(back|builtins|code|globals|locals|trace)$")
OPENERS = ("type", "vars")  # functions of xacro that do the same


@dataclass(frozen=True, slots=True)
class ChainSource:
    """A chain of a file."""

    file: str  # its path, from the folder of the robot file; empty for standard input
    base: str  # name of the link that stands
    tip: str  # name of the last link
    sha256: str  # of the file's bytes
    packages: tuple[str, ...] = ()  # folders in which xacro looks for packages
    arguments: tuple[tuple[str, str], ...] = ()  # of xacro

    @property
    def line(self) -> str:
        """The first line of the robot file, without its #."""
        return MARK + json.dumps({key: value for key, value in asdict(self).items() if value or key == "file"})

    @classmethod
    def of(cls, text: str) -> tuple[ChainSource, Certificate] | None:
        """The source and the bound that the head of a robot file promises; None for a file that says neither."""
        line, promise = _DATA.search(text), _PROMISE.search(text)
        if line is None or promise is None:
            return None
        try:
            said = json.loads(line[1])
            pairs = tuple((str(key), str(value)) for key, value in said.get("arguments", ()))
            packages = tuple(map(str, said.get("packages", ())))
            file, base, tip, digest = (str(said[key]) for key in ("file", "base", "tip", "sha256"))
            return cls(file, base, tip, digest, packages, pairs), Certificate(float(promise[1]), float(promise[2]))
        except (ValueError, TypeError, KeyError, AttributeError):
            return None


def open_urdf(
    path: Path, packages: Sequence[str] = (), arguments: Mapping[str, str] | None = None, folder: Path | None = None
) -> tuple[Urdf, ChainSource]:
    """Read a URDF or a xacro file, and say how a robot file of a folder names it, but for the links at both ends."""
    data, name, file = file_bytes(path, MOST_BYTES), str(path), relative(path, folder or Path())
    # What stands outside comments may be something to expand.
    first, *others = data.split(b"<!--") if b"xmlns:xacro" in data else [b""]
    is_xacro = any(_XACRO.search(part) for part in (first, *(other.partition(b"-->")[2] for other in others)))
    if not (path.suffix.lower() == XACRO or is_xacro):
        urdf, source = opened(data, name, arguments)
        return urdf, replace(source, file=file)
    missing = next((f for text in packages if not Path(f := text.rpartition("=")[2]).is_dir()), None)
    if missing is not None:
        raise RobotFileError(f"--packages: no folder {quoted(missing, 200)}", remedy="name one that is there")
    urdf = read_urdf(_expanded(path, packages, arguments or {}), name)
    seen, said = (moved(each, Path(), path.parent) for each in packages), (arguments or {}).items()
    return urdf, ChainSource(file, "", "", sha256(data).hexdigest(), tuple(seen), tuple(said))


def opened(data: bytes, name: str, arguments: Mapping[str, str] | None = None) -> tuple[Urdf, ChainSource]:
    """A URDF that has been read already; it has no file."""
    if arguments:
        found = f"arguments of xacro, {', '.join(map(quoted, arguments))}, for a file without xacro"
        raise RobotFileError(found, remedy="leave out --arg")
    urdf = read_urdf(data, name if name.isprintable() else quoted(name, 200))
    return urdf, ChainSource("", "", "", sha256(data).hexdigest())


def _expanded(path: Path, packages: Sequence[str], arguments: Mapping[str, str]) -> bytes:
    """What xacro makes of a file; what it prints is kept from the terminal."""
    xacrodoc = optional("xacrodoc", "reading xacro needs xacrodoc", "exchange")
    said = io.StringIO()
    xacrodoc.packages.reset()
    xacrodoc.packages.look_in([str(Path(text).resolve()) for text in packages if "=" not in text])
    xacrodoc.packages.update_package_cache(_by_name(packages))
    whole, asked, place = path.resolve(), _Asked(arguments), Location(str(path))
    refused: list[str] = []
    try:
        with (
            contextlib.redirect_stderr(said),
            contextlib.redirect_stdout(said),
            contextlib.chdir(whole.parent),
            guarded() as refused,
        ):
            text = str(xacrodoc.XacroDoc.from_file(str(whole), subargs=asked, resolve_packages=False).to_urdf_string())
    except (Exception, SystemExit) as error:
        if refused:
            found = f"xacro: an expression uses {refused[0]}, which leads out of the file, and is not evaluated"
            raise RobotFileError(found, remedy="write it with numbers and texts alone", location=place) from None
        reason = " ".join(str(error).split()) or " ".join(said.getvalue().split()) or type(error).__name__
        remedy = "give the folder of its packages with --packages DIR, and its arguments with --arg NAME=VALUE"
        found = f"xacro: {quoted(_KIND.sub('', reason), 200)[1:-1]}"
        raise RobotFileError(found, remedy=remedy, location=place) from None
    if unknown := sorted(arguments.keys() - asked.names):
        known = ", ".join(map(quoted, sorted(asked.names))) or "none"
        found = f"it asks for no argument {quoted(unknown[0])}; its arguments: {known}"
        raise RobotFileError(found, remedy="correct or leave out --arg", location=place)
    return text.encode()


def forbidden(expression: str) -> str | None:
    """The name for which an expression is not evaluated; None without one, or for what is no expression."""
    try:
        tree = ast.parse(expression.strip(), mode="eval")
    except (SyntaxError, ValueError):
        return None
    names = (str(getattr(node, "attr", "") or getattr(node, "id", "")) for node in ast.walk(tree))
    return next((name for name in names if INNER.match(name)), None)


@contextlib.contextmanager
def guarded() -> Iterator[list[str]]:
    """Have xacro evaluate no expression that says more than it may, as long as the context lasts."""
    import xacro
    from xacro import substitution_args

    offered: dict[str, Any] = xacro._global_symbols["python"]
    kept, braces, parentheses = dict(offered), xacro.safe_eval, substitution_args._eval
    for name in OPENERS:
        offered.pop(name, None)
    refused: list[str] = []

    def _checked(evaluator: Callable[..., Any], expression: str, *context: Any) -> Any:
        if (name := forbidden(expression)) is not None:
            refused.append(name)
            raise ValueError(f"an expression uses {name}")
        return evaluator(expression, *context)

    xacro.safe_eval, substitution_args._eval = (partial(_checked, each) for each in (braces, parentheses))
    try:
        yield refused
    finally:
        xacro.safe_eval, substitution_args._eval = braces, parentheses
        offered.update(kept)


class _Asked(dict[str, str]):
    """Arguments of xacro, and the names of those for which a file asks: one that is misspelt is asked for by none."""

    def __init__(self, given: Mapping[str, str]) -> None:
        super().__init__(given)
        self.names: set[str] = set()

    def __contains__(self, name: object) -> bool:
        self.names.add(str(name))
        return super().__contains__(name)

    def __getitem__(self, name: str) -> str:
        self.names.add(name)
        return super().__getitem__(name)


def _by_name(packages: Sequence[str]) -> dict[str, Path]:
    """Folders of packages: what ``NAME=DIR`` says, and each folder by its own name, with or without a manifest."""
    found: dict[str, Path] = {}
    for text in packages:
        name, sign, folder = text.rpartition("=")
        if sign:
            found[name] = Path(folder).resolve()
            continue
        whole = Path(text).resolve()
        inner = sorted(whole.iterdir()) if whole.is_dir() else []
        found = {entry.name: entry for entry in (whole, *inner) if entry.is_dir()} | found
    return found


def relative(path: Path, folder: Path) -> str:
    """A path as it is written into a file of a folder."""
    try:
        return Path(os.path.relpath(path, folder)).as_posix()
    except ValueError:  # another drive
        return path.as_posix()


def moved(package: str, from_folder: Path, to_folder: Path) -> str:
    """A folder, or ``NAME=DIR``, seen from another folder."""
    name, sign, folder = package.rpartition("=")
    return f"{name}{sign}{relative(from_folder / folder, to_folder)}"
