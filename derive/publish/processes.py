"""Work done in another process meanwhile, where that is possible: what does not wait for the search runs beside it."""

import multiprocessing
import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import cache
from multiprocessing.connection import Connection
from typing import ParamSpec, TypeVar

from derive.interrupts import uninterrupted

P = ParamSpec("P")
R = TypeVar("R")
T = TypeVar("T")

_WORTH_A_PROCESS = 10_000  # size of work that takes longer than copying a process


@contextmanager
def in_another_process(work: Callable[P, R], *arguments: P.args, **options: P.kwargs) -> Iterator[Callable[[], R]]:
    """Do some work beside what follows.

    It is done in a copy of this process, which ends with it. Where processes cannot be copied safely, where there is
    but one core, in a process that shares its work already, and if anything goes wrong over there, it is done here
    once its result is asked for: with the same result and the same errors.
    """

    def _here() -> R:
        return work(*arguments, **options)

    if not _is_worthwhile():
        yield cache(_here)
        return
    context = multiprocessing.get_context("fork")
    receiver, sender = context.Pipe(duplex=False)
    process = context.Process(target=_do_and_send, args=(_here, sender), daemon=True)

    def _received() -> R:
        try:
            found: tuple[R, ...] = receiver.recv()
        except EOFError:
            found = ()
        return found[0] if found else _here()

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
    """Whether there is a second core, and a copy is safe.

    A copy of a process with threads may wait for ever for a lock that one of them held: no thread may run, neither of
    Python nor of a library. Only Linux tells.
    """
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    try:
        threads = len(os.listdir("/proc/self/task"))
    except OSError:
        return False
    return cores > 1 and threads == 1 and multiprocessing.parent_process() is None


def _do_and_send(work: Callable[[], object], sender: Connection) -> None:
    """Send the result; nothing where there is none."""
    try:
        sender.send((work(),))
    except Exception:  # done again where it is asked for, and told there
        sender.close()


def in_two_processes(work: Callable[[T], R], pieces: Sequence[T], sizes: Sequence[int]) -> Sequence[R]:
    """Do pieces of work that do not depend on each other, half of them in another process."""
    halves: tuple[list[int], list[int]] = ([], [])
    loads = [0, 0]
    for place in sorted(range(len(pieces)), key=lambda place: -sizes[place]):
        lighter = loads.index(min(loads))
        halves[lighter].append(place)
        loads[lighter] += sizes[place]

    def _half(places: Sequence[int]) -> dict[int, R]:
        return {place: work(pieces[place]) for place in sorted(places)}

    if sum(sizes) < _WORTH_A_PROCESS:
        return [work(piece) for piece in pieces]
    with in_another_process(_half, halves[1]) as others:
        done = _half(halves[0]) | others()
    return [done[place] for place in range(len(pieces))]
