"""Progress on standard error, when it is a terminal and nobody asked for quiet."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

Tell = Callable[[str, str], None]

_ENDS = ("done", "failed")


@contextmanager
def progress(total: int, *, quiet: bool) -> Iterator[Tell | None]:
    """A bar over ``total`` robots; yields the function to tell a robot's stage, or None where nobody watches."""
    if quiet or not sys.stderr.isatty():
        yield None
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, SpinnerColumn, TextColumn

    columns = (SpinnerColumn(), BarColumn(), MofNCompleteColumn(), TextColumn("{task.description}", markup=False))
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("", total=total)

        def tell(robot: str, stage: str) -> None:
            bar.update(task, description=f"{robot}: {stage}", advance=1 if stage in _ENDS else 0)

        yield tell
