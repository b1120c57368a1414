"""The C compiler of this system: found by ``$CC`` or by its usual names, and run."""

import os
import shlex
import shutil
import signal
import subprocess
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future
from contextlib import contextmanager, suppress
from pathlib import Path
from queue import SimpleQueue
from threading import Thread
from typing import ParamSpec, TypeVar

from derive.errors import TargetError
from derive.interrupts import TemporaryFolder, uninterrupted

NAMES = ("cc", "gcc", "clang")  # looked for in this order where ``$CC`` is not set
SECONDS = 600  # longest run of a compiler
PATIENCE = 3  # seconds that a compiler which is to end has to clean up
Command = tuple[str, ...]

P = ParamSpec("P")
R = TypeVar("R")
_running: set[subprocess.Popen[str]] = set()  # compilers at work


def find_compiler() -> Command | None:
    """Command of the C compiler: ``$CC``, else the usual names on the path; None if there is none."""
    return find_command("CC", NAMES)


def find_command(variable: str, names: Sequence[str]) -> Command | None:
    """What a variable of this process's environment names, else the first name on its path; None if there is none."""
    given = shlex.split(os.environ.get(variable, ""))
    for command in [given] if given else [[name] for name in names]:
        if found := shutil.which(command[0], path=os.environ.get("PATH", os.defpath)):
            return (found, *command[1:])
    return None


def require_compiler() -> Command:
    """The command of the C compiler of this process's environment."""
    if (compiler := find_compiler()) is None:
        given = os.environ.get("CC")
        found = f"the C compiler of $CC, {given!r}, was not found" if given else f"no C compiler ({', '.join(NAMES)})"
        raise TargetError(found, remedy="install one, for instance gcc or clang, or name it in $CC")
    return compiler


def compile_shared(compiler: Command, sources: Sequence[Path], library: Path, options: Sequence[str] = ()) -> None:
    """Compile C into a shared library; a compiler ends with all that it has started if this is left early."""
    try:
        with TemporaryFolder() as temporary:  # one that is stopped leaves files between its passes behind
            process = subprocess.Popen(
                [*compiler, "-shared", "-fPIC", *options, *map(str, sources), "-o", str(library), "-lm"],
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.PIPE,
                text=True,
                errors="replace",
                env=os.environ | dict.fromkeys(("TMPDIR", "TMP", "TEMP"), str(temporary.path)),
                start_new_session=True,  # an interrupt from the terminal is ours to answer
            )
            _running.add(process)
            try:
                _, said = process.communicate(timeout=SECONDS)
            except BaseException:
                _end(process)
                raise
            finally:
                _running.discard(process)
    except (OSError, subprocess.TimeoutExpired) as error:
        raise TargetError(f"the C compiler {compiler[0]} did not run: {type(error).__name__}: {error}") from error
    if process.returncode != 0:
        reason = next((line for line in said.splitlines() if "error" in line), "without saying why")
        raise TargetError(f"the C compiler {compiler[0]} failed: {reason.strip()}")


def _end(process: subprocess.Popen[str]) -> None:
    """End a compiler and the passes that it has started, which may outlive it."""
    for number in ("SIGTERM", "SIGKILL"):
        with suppress(OSError):  # it has ended meanwhile
            os.killpg(process.pid, getattr(signal, number)) if hasattr(os, "killpg") else process.kill()
        with suppress(subprocess.TimeoutExpired):
            process.wait(timeout=PATIENCE)


@contextmanager
def compiling_meanwhile(work: Callable[P, R], *arguments: P.args, **options: P.kwargs) -> Iterator[Callable[[], R]]:
    """Let compilers work beside what follows; they are stopped if that fails or is interrupted."""
    # An interrupt may leave a lock written in Python held for ever, those of threads, pools and futures among them:
    # none is touched by both threads where one can come.
    outcome: list[Future[R]] = []
    ended: SimpleQueue[None] = SimpleQueue()

    def _work() -> None:
        future: Future[R] = Future()
        try:
            future.set_result(work(*arguments, **options))
        except BaseException as error:
            future.set_exception(error)
        outcome.append(future)
        ended.put(None)

    def _outcome() -> R:
        if not outcome:
            ended.get()
        return outcome[0].result()

    with uninterrupted():
        Thread(target=_work, daemon=True).start()
    try:
        yield _outcome
        _outcome()
    except BaseException:
        with uninterrupted():
            while not outcome:  # it may try another compilation
                for process in tuple(_running):
                    _end(process)
                time.sleep(0.05)
        raise
