"""What a tool offers to the harness."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from importlib.util import find_spec

from bench.counting.counts import Counts
from bench.robots import Array, Case


@dataclass(frozen=True)
class Counted:
    """A counted program of one quantity.

    Attributes:
        counts: Its operations.
        evaluate: The same program's value for one configuration, from q, qd, qdd as far as it takes them.
    """

    counts: Counts
    evaluate: Callable[..., Array]


@dataclass(frozen=True)
class Timed:
    """Something to be timed.

    Attributes:
        run: One pass over its configurations.
        count: Number of configurations of a pass.
        values: Results of the first few configurations of a pass, (k, ...); called after a pass.
    """

    run: Callable[[], object]
    count: int
    values: Callable[[], Array]


@dataclass(frozen=True)
class Row:
    """One cell of the tables of times before it is measured.

    Attributes:
        label: Name of the row.
        symbol: The quantity.
        batch: Whether it belongs to the table of batches, not of single configurations.
        prepare: Makes it ready; may raise.
    """

    label: str
    symbol: str
    batch: bool
    prepare: Callable[[], Timed]


@dataclass(frozen=True)
class Peer:
    """A tool.

    Attributes:
        name: Name of its rows.
        modules: What must be importable.
        count: Programs of a robot by quantity, or None where a tool yields no program.
        time: Rows of a robot's tables of times; takes the motions of the batch.
    """

    name: str
    modules: tuple[str, ...]
    count: Callable[[Case], Iterator[tuple[str, Callable[[], Counted]]]] | None = None
    time: Callable[[Case, Sequence[Array]], Iterator[Row]] | None = None

    @property
    def missing(self) -> tuple[str, ...]:
        """Modules that are not installed."""
        return tuple(name for name in self.modules if find_spec(name) is None)
