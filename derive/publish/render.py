"""All files of one robot: texts, a pure function of the robot file and the tool's version, and libraries from them."""

import filecmp
import shutil
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

from derive.errors import OutputError, QuantityError, TargetError
from derive.inverse.closed.solve import solve
from derive.programs.build import build_program
from derive.programs.optimise.search_policy import Effort
from derive.programs.program import Program
from derive.publish.manifest import FILE as MANIFEST
from derive.publish.manifest import manifest_text
from derive.publish.processes import in_another_process, in_two_processes
from derive.robot.robot import Robot
from derive.targets import templating
from derive.targets.compiler import Command, compile_shared
from derive.targets.escape import python_docstring
from derive.targets.target import Source, Target
from derive.version import __version__

PACKAGE = "__init__.py"

# Products and sums may be fused and nobody reads `errno` or traps; nothing here changes the order of operations.
OPTIONS = ("-std=c99", "-O3", "-ffp-contract=fast", "-fno-math-errno", "-fno-trapping-math")
# GCC optimises parts of one file at once: two thirds of the time on two cores, and the code is as fast.
_IN_PARTS = ("-flto=2", "--param=lto-min-partition=1000", "--param=lto-partitions=4")
# Options that not every compiler knows, tried in this order; the second and third name the processor at hand.
ATTEMPTS = (("-march=native", *_IN_PARTS), ("-march=native",), ("-mcpu=native",), ())


@dataclass(frozen=True, slots=True)
class Rendered:
    """The contents of a generated folder."""

    files: dict[str, bytes]  # contents by file name, the manifest included, in the order of writing
    operations: dict[str, dict[str, int]]  # operation counts by function


@contextmanager
def rendering(
    robot: Robot,
    targets: Sequence[Target],
    effort: Effort = Effort.FULL,
    compiling: Callable[[Mapping[str, bytes]], None] = lambda files: None,
) -> Iterator[tuple[Rendered, Callable[[], Rendered]]]:
    """What is made of the program, and what waits for everything: each with a manifest of its own."""
    early = [target for target in targets if not target.needs_program]
    sources = {name for target in targets for names in target.compiled.values() for name in names}
    rendered: dict[str, dict[str, bytes]] = {}
    if early and len(early) < len(targets):  # program and sheet start from one graph, derived before this is copied
        with suppress(QuantityError):  # told by whoever asks for it
            solve(robot)
    with in_another_process(_render_early, robot, early) as early_texts:
        source = source_of(robot, targets, effort)
        heading = {"title": python_docstring(robot.title), "name": robot.name, "version": __version__}
        package = templating.render("package/__init__.py.jinja", **heading).encode()

        def _made() -> Rendered:
            files = {PACKAGE: package}
            for target in targets:
                files |= rendered.get(target.name, {})
            files[MANIFEST] = manifest_text(source, targets, files, effort).encode()
            return Rendered(files, source.program.operations)

        def _whole() -> Rendered:
            rendered.update({name: _encoded(texts) for name, texts in early_texts().items()})
            return _made()

        by_program = [target for target in targets if target.needs_program]
        for target in sorted(by_program, key=lambda target: sources.isdisjoint(target.files)):
            rendered[target.name] = _encoded(target.render(source))
            written = {name: data for texts in rendered.values() for name, data in texts.items()}
            if sources and sources <= written.keys():
                compiling({name: written[name] for name in sources})
                sources.clear()
        yield _made(), _whole


def render_robot(robot: Robot, targets: Sequence[Target], effort: Effort = Effort.FULL) -> Rendered:
    """Every file of every target, the package file and the manifest, in memory."""
    with rendering(robot, targets, effort) as (_, whole):
        return whole()


def _encoded(texts: Mapping[str, str]) -> dict[str, bytes]:
    return {name: text.encode() for name, text in texts.items()}


def _render_early(robot: Robot, targets: Sequence[Target]) -> dict[str, dict[str, str]]:
    """The files of targets that need no program, by target."""
    source = Source(robot, Program((), ()), __version__)
    return {target.name: target.render(source) for target in targets}


def source_of(robot: Robot, targets: Sequence[Target], effort: Effort = Effort.FULL) -> Source:
    """What the targets are rendered from."""
    names = (PACKAGE, *(name for target in targets for name in target.names(robot)), MANIFEST)
    return Source(
        robot, build_program(robot, effort, inverse=True, spread=in_two_processes), __version__, tuple(sorted(names))
    )


def library_names(targets: Iterable[Target]) -> tuple[str, ...]:
    """Names of the libraries that a build compiles."""
    return tuple(name for target in targets for name in target.compiled)


def compile_libraries(folder: Path, targets: Iterable[Target], compiler: Command, former: Path | None = None) -> None:
    """Compile the libraries of some targets."""
    try:
        for target in targets:
            for name, sources in target.compiled.items():
                if former and _is_same(folder, former, name, sources):
                    shutil.copy2(former / name, folder / name)
                else:
                    _compile(compiler, folder / sources[0], folder / name)
    except OSError as error:
        raise OutputError(f"cannot write {folder}: {error.strerror or error}", remedy="make room") from error


def take_libraries(names: Iterable[str], origin: Path, folder: Path) -> None:
    """Copy libraries that were compiled elsewhere."""
    try:
        for name in names:
            shutil.copy2(origin / name, folder / name)
    except OSError as error:
        raise OutputError(f"cannot write {folder}: {error.strerror or error}", remedy="make room") from error


def _is_same(folder: Path, former: Path, library: str, sources: Iterable[str]) -> bool:
    """Whether an earlier folder holds a library of the same sources."""
    paths = [former / library, *(former / source for source in sources)]
    if any(path.is_symlink() or not path.is_file() for path in paths):
        return False
    return all(filecmp.cmp(folder / source, former / source, shallow=False) for source in sources)


def _compile(compiler: Command, source: Path, library: Path) -> None:
    """Compile for the processor at hand, by the first options that the compiler knows."""
    for options in ATTEMPTS:
        try:
            return compile_shared(compiler, [source], library, (*OPTIONS, *options))
        except TargetError:
            if not options:
                raise
