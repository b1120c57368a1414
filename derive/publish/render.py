"""All files of one robot: texts, a pure function of the robot file and the tool's version, and libraries from them."""

import filecmp
import multiprocessing
import os
import shutil
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import ParamSpec, TypeVar, cast

from derive.errors import QuantityError, TargetError
from derive.interrupts import uninterrupted
from derive.inverse.closed.solve import solve
from derive.inverse.loops import without_parallelograms
from derive.programs.build import build_program
from derive.programs.optimise.search_policy import Effort
from derive.programs.program import Program
from derive.publish.atomic_folder import system_errors
from derive.publish.manifest import MANIFEST, manifest_text
from derive.robot.robot import Robot
from derive.targets import templating
from derive.targets.compiler import Command, compile_shared
from derive.targets.escape import python_docstring
from derive.targets.target import Source, Target
from derive.version import __version__

P = ParamSpec("P")
R = TypeVar("R")
T = TypeVar("T")

PACKAGE = "__init__.py"
_WORTH_A_PROCESS = 10_000  # size of work that takes longer than copying a process

# Products and sums may be fused and nobody reads `errno` or traps; nothing here changes the order of operations.
OPTIONS = ("-std=c99", "-O3", "-ffp-contract=fast", "-fno-math-errno", "-fno-trapping-math")
# GCC optimises parts of one file at once: two thirds of the time on two cores, and the code is as fast. It leaves out
# what model.c has for others alone.
_IN_PARTS = ("-flto=2", "--param=lto-min-partition=1000", "--param=lto-partitions=4", "-fvisibility=hidden")
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
    robot = without_parallelograms(robot)
    early = [target for target in targets if not target.needs_program]
    sources = {name for target in targets for names in target.compiled.values() for name in names}
    rendered: dict[str, dict[str, bytes]] = {}
    # program and sheet start from one graph, derived before this is copied
    if early and len(early) < len(targets) and not robot.coupled:
        with suppress(QuantityError):  # told by whoever asks for it
            solve(robot)
    without_program = Source(robot, Program((), ()), __version__)
    with in_another_process(lambda: {each.name: each.render(without_program) for each in early}) as early_texts:
        source = source_of(robot, targets, effort)
        heading = {"title": python_docstring(robot.title), "name": robot.name, "version": __version__}

        def _made() -> Rendered:
            files = {PACKAGE: templating.render("package/__init__.py.jinja", **heading).encode()}
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


def source_of(robot: Robot, targets: Sequence[Target], effort: Effort = Effort.FULL) -> Source:
    """What the targets are rendered from."""
    names = (PACKAGE, *(name for target in targets for name in target.names(robot)), MANIFEST)
    program = build_program(robot, effort, inverse=True, spread=in_two_processes)
    return Source(robot, program, __version__, tuple(sorted(names)))


def library_names(targets: Iterable[Target]) -> tuple[str, ...]:
    """Names of the libraries that a build compiles."""
    return tuple(name for target in targets for name in target.compiled)


def compile_libraries(folder: Path, targets: Iterable[Target], compiler: Command, former: Path | None = None) -> None:
    """Compile the libraries of some targets."""
    with system_errors(folder, "make room"):
        for target in targets:
            for name, sources in target.compiled.items():
                if former and _is_same(folder, former, name, sources):
                    shutil.copy2(former / name, folder / name)
                else:
                    _compile(compiler, folder / sources[0], folder / name)


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


# -- work beside the search


@contextmanager
def in_another_process(work: Callable[P, R], *arguments: P.args, **options: P.kwargs) -> Iterator[Callable[[], R]]:
    """Do some work beside what follows, in a copy of this process, which ends with it."""
    # Where processes cannot be copied safely, where there is but one core, in a process that shares its work already,
    # and if anything goes wrong over there, it is done here once its result is asked for: with the same result and the
    # same errors.

    def _here() -> R:
        return work(*arguments, **options)

    def _send() -> None:
        try:
            sender.send((_here(),))
        except Exception:  # done again where it is asked for, and told there
            sender.close()

    if not _is_worthwhile():
        yield cache(_here)
        return
    context = multiprocessing.get_context("fork")
    receiver, sender = context.Pipe(duplex=False)
    process = context.Process(target=_send, daemon=True)

    def _received() -> R:
        try:
            (found,) = receiver.recv()
        except EOFError:
            return _here()
        return cast(R, found)

    try:
        with uninterrupted():
            process.start()
        sender.close()
        yield cache(_received)
    finally:
        if process.pid is not None:
            process.kill()
            process.join()
        receiver.close()
        sender.close()


def _is_worthwhile() -> bool:
    """Whether there is a second core, and a copy is safe."""
    # A copy of a process with threads may wait for ever for a lock that one of them held: no thread may run, neither of
    # Python nor of a library. Only Linux tells.
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    try:
        threads = len(os.listdir("/proc/self/task"))
    except OSError:
        return False
    return cores > 1 and threads == 1 and multiprocessing.parent_process() is None


def in_two_processes(work: Callable[[T], R], pieces: Sequence[T], sizes: Sequence[int]) -> Sequence[R]:
    """Do pieces of work that do not depend on each other, half of them in another process."""
    halves: tuple[list[int], list[int]] = ([], [])
    for place in sorted(range(len(pieces)), key=lambda place: -sizes[place]):
        min(halves, key=lambda half: sum(sizes[k] for k in half)).append(place)  # to the lighter one

    def _half(places: Sequence[int]) -> dict[int, R]:
        return {place: work(pieces[place]) for place in sorted(places)}

    if sum(sizes) < _WORTH_A_PROCESS:
        return [work(piece) for piece in pieces]
    with in_another_process(_half, halves[1]) as others:
        done = _half(halves[0]) | others()
    return [done[place] for place in range(len(pieces))]
