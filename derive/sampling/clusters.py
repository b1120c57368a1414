"""Where blocks of work are computed: threads of this process, or a Dask cluster."""

from __future__ import annotations

import os
import time
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass
from importlib import import_module
from importlib.util import find_spec
from itertools import islice
from typing import Any, TypeVar

from derive.errors import DeriveError, optional

PATIENCE = 10
"""Seconds in which a scheduler must answer."""

_AHEAD = 4  # blocks under way for each thread: enough that none waits for the next, few enough to bound memory

Block = TypeVar("Block")
Result = TypeVar("Result")
Tell = Callable[[str, str], None]  # called with what is computed and how far it is


@dataclass(frozen=True, slots=True)
class Cluster:
    """An executor, the number of its threads, and Dask's client where there is one."""

    executor: Executor
    threads: int
    client: Any = None

    def shared(self, value: Any) -> Any:
        """A large argument of all blocks, sent to every worker once."""
        return value if self.client is None else self.client.scatter(value, broadcast=True)

    def in_order(
        self,
        work: Callable[..., Result],
        blocks: Sequence[Block],
        *shared: Any,
        what: str = "",
        tell: Tell | None = None,
    ) -> Iterator[Result]:
        """``work(block, *shared)`` for each block, in the order of the blocks; few are under way at a time."""
        since, waiting = time.monotonic(), deque[Future[Result]]()
        coming = iter(blocks)
        try:
            for done in range(len(blocks)):
                wanted = _AHEAD * self.threads - len(waiting)
                waiting.extend(self.executor.submit(work, block, *shared) for block in islice(coming, wanted))
                yield waiting.popleft().result()
                if tell is not None:
                    left = (time.monotonic() - since) / (done + 1) * (len(blocks) - done - 1)
                    tell(what, f"{100 * (done + 1) / len(blocks):.0f} %, {left:.0f} s left,")
        finally:  # after an error or an interrupt
            for future in waiting:
                future.cancel()


@contextmanager
def cluster(workers: int | None = None, scheduler: str | None = None) -> Iterator[Cluster]:
    """Threads, which suffice for compiled functions, or a scheduler's workers, which Dask's collections use, too."""
    if scheduler is None:
        count, dask = workers or os.cpu_count() or 1, import_module("dask") if find_spec("dask") else None
        with ThreadPoolExecutor(count) as pool, dask.config.set(pool=pool) if dask else nullcontext():
            yield Cluster(pool, count)
        return
    if workers is not None:
        raise DeriveError("--workers with --scheduler", remedy="leave one out: the cluster has its own workers")
    try:  # as the default, a client that finds no scheduler would take all that is computed afterwards, and wait
        distributed = optional("distributed", "many configurations on Dask need distributed", "data")
        found = distributed.Client(scheduler, timeout=PATIENCE, set_as_default=False)
    except (OSError, ValueError) as error:
        raise DeriveError(
            f"no Dask scheduler answers at {scheduler!r} within {PATIENCE} s",
            allowed="allowed: an address such as tcp://127.0.0.1:8786",
            remedy="start one with 'dask scheduler', or leave out --scheduler",
        ) from error
    with found as client, client.as_current():
        threads = sum(client.nthreads().values())
        if not threads:
            raise DeriveError(f"the scheduler at {scheduler!r} has no workers", remedy="start one: dask worker ADDRESS")
        yield Cluster(client.get_executor(), threads, client)
