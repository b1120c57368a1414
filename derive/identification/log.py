"""The log of a robot that moves, from columns to states and torques, block by block so that no log is too long.

A log is a CSV or a Parquet file, or a table in memory. Its columns are found by patterns, in which ``*`` stands for the
number of a joint, from 1 or from 0, or for its name; a unit stands in brackets behind a column's name.

Speeds that are missing come from zero-phase filters: a Butterworth filter forwards and backwards turns no phase. What
it does at a row depends on the rows around it as far as its slowest pole rings, so that blocks which overlap by that
give what the whole log would, to `FORGOTTEN`; as many rows at both ends of a segment are left out. Fewer rows come from
regressor and torques filtered alike, which leaves tau = Y beta true (parallel filtering: Khalil and Dombre, Modeling,
Identification and Control of Robots, ch. 12).
"""

import csv
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from itertools import islice, pairwise, product
from math import ceil, log, pi
from pathlib import Path
from typing import Any

import numpy as np

from derive.arrays import Array, Flags
from derive.errors import DeriveError, Location, listed, optional, quoted, require_known
from derive.robot.robot import Robot

# By quantity the patterns that are tried in this order.
PATTERNS = {"time": "time t", "q": "q* *", "qd": "qd* dq*", "qdd": "qdd* ddq*", "tau": "tau*"}
_UNITS_OF_TIME = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
_LENGTHS, _ANGLES = {"m": 1.0, "mm": 1e-3}, {"rad": 1.0, "deg": pi / 180}
_FORCES, _TORQUES = {"N": 1.0, "mN": 1e-3, "kN": 1e3}, {"Nm": 1.0, "mNm": 1e-3, "kNm": 1e3}
# By quantity the units of slides and of turns.
UNITS: Mapping[str, tuple[Mapping[str, float], Mapping[str, float]]] = {
    "time": (_UNITS_OF_TIME, _UNITS_OF_TIME),
    "q": (_LENGTHS, _ANGLES),
    "qd": ({f"{k}/s": v for k, v in _LENGTHS.items()}, {f"{k}/s": v for k, v in _ANGLES.items()} | {"rpm": pi / 30}),
    "qdd": ({f"{k}/s^2": v for k, v in _LENGTHS.items()}, {f"{k}/s^2": v for k, v in _ANGLES.items()}),
    "tau": (_FORCES, _TORQUES),
}
_HEADER = re.compile(r"(.*?)\s*[\[(]([^\[\]()]*)[\])]\s*")  # a name with a unit in brackets
# What Arrow says of a line of a CSV: the column, from 0, and the cell that is no number; or how many cells there are.
_WRONG = re.compile(r"(?:In CSV column #(\d+): )?.*?Row #(\d+): .*?(?:invalid value '(.*)'$|got (\d+))", re.DOTALL)
BATCH = 65_536  # rows that are read at once
CSV_BLOCK, PARQUET_BUFFER = 4 << 20, 1 << 18  # bytes of a CSV, and of a column of Parquet, that are read at once
JUMP = 1.5  # steps of time above which a gap is between two rows
SHOWN = 12  # columns that a message lists
NEEDED = "reading a log needs pyarrow"
ORDER = 4  # of the filters
FORGOTTEN = 1e-8  # what is left of a row where a filter no longer needs it
CUTOFF = 10.0  # frequency [Hz] up to which positions are kept where nobody says; at most a tenth of the rows' rate
BAND = 0.8  # part of the band of fewer rows that is kept
ROWS, THIN, WIDE = 2000, 8192, BATCH  # rows of a regressor that are worked on at once, filtered at once, and of states
# Central differences of five points for the first and the second derivative, errors h^4/30 and h^4/90.
FIRST, SECOND = np.array([1.0, -8.0, 0.0, 8.0, -1.0]) / 12, np.array([-1.0, 16.0, -30.0, 16.0, -1.0]) / 12
# Times (rows,) [s], or numbers of rows, speeds (rows, n), regressor (rows, n, p), torques (rows, n).
Block = tuple[Array, ...]
LogColumn = tuple[str, float]  # its name in the log, and what takes it to SI units; negative where its sign is turned


@dataclass(frozen=True, eq=False)
class Log:
    """The rows of a log."""

    source: Any  # path of a .csv or .parquet, or a table: a mapping of names to columns, or of pyarrow
    robot: Robot
    patterns: Mapping[str, str] = field(default_factory=dict)  # those that a user gives, with a minus for a turned sign
    drop: bool = False  # whether rows without numbers and gaps are passed over
    cutoff: float | None = None  # [Hz]; None for the usual where speeds or accelerations are missing
    decimate: int = 1  # of so many rows one is kept

    @cached_property
    def path(self) -> Path | None:
        """Its file; None for a table in memory."""
        path = Path(self.source) if isinstance(self.source, str | Path) else None
        if path is not None and not path.is_file():
            raise DeriveError(f"no file {quoted(str(path), 200)}", allowed="allowed: a .csv or a .parquet")
        return path

    @cached_property
    def _csv(self) -> Path | None:
        return self.path if self.path and self.path.suffix.lower() != ".parquet" else None

    @cached_property
    def _store(self) -> Any:
        """A table or a file of Parquet; of a CSV what separates its cells, and those of its first line."""
        if self._csv:
            with self._csv.open(encoding="utf-8-sig", errors="replace") as file:
                line = file.readline().rstrip("\r\n")
            delimiter = max(",;\t", key=line.count)
            return delimiter, next(csv.reader([line], delimiter=delimiter), [])
        arrow, parquet = (optional(f"pyarrow{part}", NEEDED, "data") for part in ("", ".parquet"))
        if self.path is None:
            return arrow.table(dict(self.source)) if isinstance(self.source, Mapping) else self.source
        try:  # what is read ahead would be a whole group of rows
            return parquet.ParquetFile(self.path, buffer_size=PARQUET_BUFFER, pre_buffer=False)
        except arrow.ArrowInvalid as error:
            raise self._error(f"no Parquet: {error}", remedy="check the file; a CSV ends with .csv") from None

    @cached_property
    def names(self) -> list[str]:
        """The names of all columns."""
        if self._csv:
            return list(self._store[1])
        return list((self._store.schema_arrow if self.path else self._store.schema).names)

    @cached_property
    def rows(self) -> int:
        """How many rows it has; of a CSV lines after the first."""
        if not self._csv:
            return int(self._store.metadata.num_rows if self.path else self._store.num_rows)
        with self._csv.open("rb") as file:
            return sum(block.count(b"\n") for block in iter(lambda: file.read(1 << 20), b"")) - 1

    def _error(self, found: str, row: int = -1, *, allowed: str = "", remedy: str = "") -> DeriveError:
        """A refusal; a row is counted from 0, and blank lines of a CSV do not count."""
        place = None
        if self._csv:
            with self._csv.open(encoding="utf-8-sig", errors="replace") as file:
                lines = (number for number, text in enumerate(file, 1) if text.strip("\r\n"))
                place = Location(str(self.path), next(islice(lines, row + 1, None), row + 2))
        text = found if place else f"{self.path or 'the table'}: {found}"
        return DeriveError(text, location=place, allowed=allowed, remedy=remedy)

    # -- columns

    @cached_property
    def columns(self) -> dict[str, tuple[LogColumn, ...]]:
        """By quantity its columns, one for each joint; those of q and tau are there, of the others all or none."""
        for name in self.patterns:
            require_known(name, PATTERNS, f"no quantity {quoted(name)} of a log")
        return {quantity: columns for quantity in PATTERNS if (columns := self._of(quantity))}

    @cached_property
    def _by_name(self) -> dict[str, tuple[str, str]]:
        """By name without its unit the name in the log, and the unit."""
        matches = ((name, _HEADER.fullmatch(name)) for name in self.names)
        return {match[1] if match else name: (name, match[2] if match else "") for name, match in matches}

    def _of(self, quantity: str) -> tuple[LogColumn, ...]:
        given, joints = self.patterns.get(quantity, ""), self.robot.joints
        marks = [(str(k + 1), str(k), joint.label, joint.variable) for k, joint in enumerate(joints)]
        rows = zip(*marks, strict=True) if quantity != "time" else [("*",)]
        # A name may begin with a minus itself.
        patterns = [given, given.removeprefix("-")] if given else PATTERNS[quantity].split()
        tried = [[pattern.replace("*", mark) for mark in row] for pattern, row in product(patterns, rows)]
        best = max(tried, key=lambda names: sum(name in self._by_name for name in names) / len(names))
        if not (missing := [name for name in best if name not in self._by_name]):
            sign = -1.0 if given.startswith("-") and best not in tried[: len(tried) // 2] else 1.0
            pairs = zip(best, joints, strict=False)
            return tuple(self._column(quantity, name, sign, joint.is_revolute) for name, joint in pairs)
        if len(missing) == len(best) and not given and quantity not in ("q", "tau"):
            return ()
        more = f" and {len(self.names) - SHOWN} more" if len(self.names) > SHOWN else ""
        allowed = f"its columns: {listed(map(quoted, self.names[:SHOWN]))}{more}"
        remedy = f"name them with --columns '{quantity}=...*', * for the number or the name of a joint"
        raise self._error(f"no column {listed(missing)}", allowed=allowed, remedy=remedy)

    def _column(self, quantity: str, name: str, sign: float, turns: bool) -> LogColumn:
        units = UNITS[quantity][turns]
        column, unit = self._by_name[name]
        plain = re.sub(r"s2$", "s^2", re.sub(r"[ *·]", "", unit).replace("°", "deg").replace("²", "^2"))
        if unit and plain not in units:
            found = f"unit {quoted(unit)} of column {quoted(column)}"
            raise self._error(found, allowed=f"allowed: {listed(units)}", remedy="convert it")
        return column, sign * (units[plain] if unit else 1.0)

    # -- rows

    def batches(self) -> Iterator[Array]:
        """The rows in SI units, (rows, columns), not a number where the log has none."""
        read = [column for columns in self.columns.values() for column in columns]
        names = [name for name, _ in read]
        try:
            for batch in self._record_batches(names):
                columns = (batch.column(name).to_numpy(zero_copy_only=False) for name in names)
                block = np.column_stack([column.astype(float, casting="same_kind") for column in columns])
                block *= [factor for _, factor in read]
                yield from (block[start : start + BATCH] for start in range(0, len(block), BATCH))
        except (ValueError, TypeError) as error:  # those of Arrow among them
            if not (wrong := _WRONG.match(str(error))):
                found = f"cannot be read: {' '.join(str(error).split())}"
                raise self._error(found, remedy="check the file") from None
            column, line, cell, cells = wrong.groups()
            what = f"{cells} cells" if cells else f"{quoted(cell)} for {self.names[int(column)]}"
            remedy = f"write {len(self.names)}" if cells else "correct the line"
            raise self._error(what, int(line) - 2, allowed="allowed: numbers", remedy=remedy) from None

    def _record_batches(self, names: list[str]) -> Any:
        if self.path is None:
            return self._store.select(names).to_batches(BATCH)
        if not self._csv:
            return self._store.iter_batches(BATCH, columns=names, use_threads=False)
        reader = optional("pyarrow.csv", NEEDED, "data")
        reading = reader.ReadOptions(block_size=CSV_BLOCK, use_threads=False)
        parsing = reader.ParseOptions(delimiter=self._store[0])
        converting = reader.ConvertOptions(column_types=dict.fromkeys(names, "float64"), include_columns=names)
        return reader.open_csv(self.path, reading, parsing, converting)

    def segments(self) -> Iterator[tuple[Array, bool]]:
        """The rows in blocks, and whether something is missing before a block."""
        row, last, starts = 0, np.nan, True
        for batch in self.batches():
            good: Flags = np.asarray(np.isfinite(batch).all(axis=1))
            jumps: Flags = np.zeros(len(batch), dtype=bool)
            if self.step:
                steps = np.diff(batch[:, 0], prepend=last)
                jumps, last = (steps > JUMP * self.step) | (steps <= 0), batch[-1, 0] if good[-1] else np.nan
            if not self.drop and (jumps | ~good).any():
                raise self._broken(batch, good, int(np.argmax(jumps | ~good)), row)
            # A new segment starts behind each bad row and at each jump.
            for start, end in pairwise([0, *np.flatnonzero(jumps[1:] | (good[1:] != good[:-1])) + 1, len(batch)]):
                if good[start]:
                    yield batch[start:end], starts or bool(jumps[start])
                starts = not good[start]
            row += len(batch)

    @cached_property
    def step(self) -> float:
        """The time between two rows [s], the median of the first block; 0 without times, which come first."""
        times = next(self.batches(), np.empty((0, 1)))[:, 0] if "time" in self.columns else np.empty(0)
        steps = np.diff(times[np.isfinite(times)])
        found = float(np.median(steps)) if len(steps) else 0.0
        if len(steps) and not found > 0:
            raise self._error(f"times that do not grow, by {found:g} s from row to row", remedy="sort the rows by time")
        return found

    def _broken(self, batch: Array, good: Flags, at: int, row: int) -> DeriveError:
        """The first place where numbers or rows are missing, and for how long."""
        remedy = "repair the log, or pass over such places with --drop"
        if good[at]:
            gap = batch[at, 0] - batch[at - 1, 0] if at else np.nan
            what = f"a gap of {gap:.4g} s" if not gap <= 0 else f"time goes back by {-gap:.4g} s"
            return self._error(f"{what} before row {row + at + 1}, t = {batch[at, 0]:.6g} s", row + at, remedy=remedy)
        read = [name for columns in self.columns.values() for name, _ in columns]
        names = listed(name for name, cell in zip(read, batch[at], strict=True) if not np.isfinite(cell))
        count = int(np.argmax(np.append(good[at:], True)))
        lasting = f"{count} rows, {count * self.step:.4g} s" if self.step else f"{count} rows"
        return self._error(f"no number in {names} from row {row + at + 1} on ({lasting})", row + at, remedy=remedy)

    # -- states

    @cached_property
    def missing(self) -> tuple[str, ...]:
        """What is differentiated."""
        return tuple(quantity for quantity in ("qd", "qdd") if quantity not in self.columns)

    @cached_property
    def band(self) -> float:
        """Up to which frequency positions, or speeds, are kept [Hz]; 0 where they are not filtered."""
        step = self.step
        if not (self.missing or self.cutoff):
            return 0.0
        if not step:
            lacking = f"{self.path or 'the table'}: no time, by which rows are filtered"
            raise DeriveError(lacking, remedy="add a column time")
        found = min(CUTOFF, 0.1 / step) if self.cutoff is None else self.cutoff
        if not 0 < 2 * found * step < 1:
            allowed = f"allowed: below {0.5 / step:g} Hz, half the rows' rate"
            raise DeriveError(f"a cutoff of {found:g} Hz", allowed=allowed)
        return found

    @cached_property
    def _filters(self) -> list[Any]:
        """Of states, and of regressor and torques: a low-pass filter in sections of second order, or None."""
        edges = 2 * self.band * self.step, BAND / self.decimate if self.decimate > 1 else 0.0  # of half the rate
        return [_signal().butter(ORDER, edge, output="sos") if edge else None for edge in edges]

    @cached_property
    def margin(self) -> int:
        """Rows at both ends of a block that filters and differences need, a multiple of ``decimate``."""
        poles = ([np.roots(s[3:]) for s in each] for each in self._filters if each is not None)
        rows = sum(ceil(log(FORGOTTEN) / log(np.abs(each).max())) for each in poles) + 2 * len(self.missing)
        return -(-rows // self.decimate) * self.decimate

    def windows(self) -> Iterator[tuple[Array, slice]]:
        """Blocks of rows without gaps, and which rows of each are used."""
        margin, most = self.margin, THIN if self.decimate > 1 else WIDE
        size = max(most // self.decimate, 1) * self.decimate
        held = np.empty((0, 0))
        for rows, starts in self.segments():
            if starts:
                yield held, slice(margin, len(held) - margin)
            held = rows if starts else np.concatenate([held, rows])
            while len(held) >= size + 2 * margin:
                yield held[: size + 2 * margin], slice(margin, size + margin)
                held = held[size:]
        yield held, slice(margin, len(held) - margin)

    def states(self, rows: Array) -> tuple[Array, list[Array], Array]:
        """Times, q, qd and qdd, and torques of a block, those near its ends wrong where filters are."""
        step, ends = self.step, np.cumsum([len(columns) for columns in self.columns.values()])
        parts = dict(zip(self.columns, np.split(rows, ends[:-1], axis=1), strict=True))
        if (smooth := self._filters[0]) is not None:
            # What is differentiated; where nothing is, all of the state, so that it stays one motion.
            source = ("q",) if "qd" in self.missing else ("qd",) if self.missing else ("q", "qd", "qdd")
            parts |= {quantity: _both_ways(smooth, parts[quantity]) for quantity in source}
        if "qdd" in self.missing:
            twice = "qd" in self.missing
            parts["qdd"] = _difference(parts["q"], SECOND, step**2) if twice else _difference(parts["qd"], FIRST, step)
        if "qd" in self.missing:
            parts["qd"] = _difference(parts["q"], FIRST, step)
        time = parts["time"][:, 0] if "time" in parts else np.arange(float(len(rows)))
        return time, [parts[key] for key in ("q", "qd", "qdd")], parts["tau"]

    def blocks(self, regressor: Callable[[Array, Array, Array], Array]) -> Iterator[Block]:
        """What tau = Y beta is solved from, in blocks of some thousand rows."""
        thin = self._filters[1]
        for rows, used in self.windows():
            if used.stop <= used.start:
                continue
            time, state, tau = self.states(rows)
            if thin is not None:
                kept = slice(used.start, used.stop, self.decimate)
                yield time[kept], state[1][kept], *(_both_ways(thin, each)[kept] for each in (regressor(*state), tau))
                continue
            for start in range(used.start, used.stop, ROWS):
                part = slice(start, min(start + ROWS, used.stop))
                yield time[part], state[1][part], regressor(*(each[part] for each in state)), tau[part]


def _signal() -> Any:
    return optional("scipy.signal", "filtering a log needs SciPy", "data")


def _both_ways(sections: Any, values: Array) -> Array:
    return np.asarray(_signal().sosfiltfilt(sections, values, axis=0, padlen=min(6 * ORDER, len(values) - 1)))


def _difference(values: Array, weights: Array, unit: float) -> Array:
    """Weighed neighbours of each row over a unit; zero for two rows at both ends."""
    found, inner = np.zeros_like(values), max(len(values) - 4, 0)
    found[2 : 2 + inner] = sum(w / unit * values[k : k + inner] for k, w in enumerate(weights))
    return found
