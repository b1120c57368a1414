"""Functions of a robot at many configurations, in bounded memory: what is said of each entry of their values.

Configuration k is the same whoever asks for it. They are evaluated in blocks, always the same ones, and what is said of
blocks is joined in their order: neither workers nor chunks change a bit of the result.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from math import gcd, isfinite, pi
from typing import Any, NamedTuple

import numpy as np

from derive.arrays import Array
from derive.errors import DeriveError, QuantityError, RobotFileError, RobotFileWarning, listed, near_miss
from derive.programs.build import build_program
from derive.programs.functions import INTERFACES
from derive.programs.optimise.search_policy import Effort
from derive.programs.program import WIDTHS, Program
from derive.publish.modules import ModuleSources, imported
from derive.robot.robot import Robot
from derive.sampling.clusters import Cluster, Tell
from derive.targets.target import joint_bounds, joint_limits

BLOCK = 8192  # configurations that are drawn, evaluated and reduced together
QUANTILES = (0.01, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99)
KINDS = ("min", "mean", "max", "quantiles")
# What arguments other than q are called where their largest magnitudes are asked for.
BOUNDS: Mapping[str, str] = {"qd": "speed", "qdd": "qdd", "tau": "tau", "h": "wrench"}
Bound = float | Sequence[float] | None

_CUT = 42  # of a double's mantissa, 52 bits, those that bins do not tell apart: bins are 2^-10 of their values wide


class Part(NamedTuple):
    """Of the values (rows, entries) of some blocks."""

    rows: int  # those in which every entry is finite; only they count
    lacking: int  # the others
    extremes: Array  # (2, 2 entries): smallest values and largest ones negated, and the first blocks that have them
    sums: Array  # of each block, (blocks, entries); (1, entries) where they are added up
    bins: tuple[Any, ...]  # of each entry bins in order and how many values are in them; or none


@dataclass(frozen=True, slots=True)
class Sampling:
    """All that a block needs besides its number; every worker has it once."""

    sources: ModuleSources
    functions: tuple[tuple[str, tuple[str, ...], tuple[int, ...]], ...]  # name, arguments and shape of each
    parameters: Mapping[str, float]  # numbers of the free symbols
    bounds: Mapping[str, Array]  # lower and upper ones of each argument, (2, width), those of q first
    number: int
    seed: int
    points: int  # of the grid of q along each variable; 0 for random ones
    kinds: tuple[str, ...]  # of reductions

    def arguments(self, block: int) -> dict[str, Array]:
        """Those of a block by name, (rows, width) each."""
        rows = min(BLOCK, self.number - block * BLOCK)
        low, high = np.concatenate([*self.bounds.values()], axis=1)
        # Philox (Salmon et al. 2011) enciphers a counter: the numbers of a block are those from block * 2^64 on.
        shares = np.random.Generator(np.random.Philox(key=self.seed, counter=[0, block, 0, 0])).random((rows, len(low)))
        if self.points:
            widths = (self.points,) * self.bounds["q"].shape[1]
            places = np.stack(np.unravel_index(block * BLOCK + np.arange(rows), widths), axis=-1)
            shares[:, : len(widths)] = places / (self.points - 1) if self.points > 1 else 0.5
        ends = np.cumsum([each.shape[1] for each in self.bounds.values()])[:-1]
        return dict(zip(self.bounds, np.split(low + (high - low) * shares, ends, axis=1), strict=True))

    def values(self, block: int) -> list[Array]:
        """Those of each function in a block, (rows, entries)."""
        module, _folder = imported(self.sources)
        arguments = self.arguments(block)
        options = {"params": module.precompute(self.parameters)} if module.PARAMETERS else {}
        with np.errstate(all="ignore"):
            found = [getattr(module, f)(*(arguments[a] for a in taken), **options) for f, taken, _ in self.functions]
        return [values.reshape(len(values), -1) for values in found]


def parts_of(blocks: Iterable[int], work: Sampling) -> list[Part]:
    """Of each function the part of some blocks."""
    binned = "quantiles" in work.kinds
    parts = [[part_of(values, block, binned=binned) for values in work.values(block)] for block in blocks]
    return [joined(each, added=False) for each in zip(*parts, strict=True)]


def part_of(values: Array, block: int, *, binned: bool) -> Part:
    """Of one block's values."""
    kept = values if isfinite(values.sum()) else values[np.isfinite(values).all(axis=1)]
    lowest = np.concatenate([_along(np.minimum, kept, np.inf), -_along(np.maximum, kept, -np.inf)])
    heads: Any = np.ascontiguousarray(kept.T).view(np.int64) >> _CUT if binned else ()
    bins = tuple(np.unique(entry, return_counts=True) for entry in heads)
    extremes = np.stack([lowest, np.full(len(lowest), float(block))])
    return Part(len(kept), len(values) - len(kept), extremes, _along(np.add, kept, 0.0)[None], bins)


def _along(ufunc: np.ufunc, values: Array, initial: float) -> Array:
    """A reduction of the rows, of several side by side first: a third of the time."""
    together = gcd(len(values), 64)
    wide = values.reshape(len(values) // together, together * values.shape[1])
    found: Array = ufunc.reduce(ufunc.reduce(wide, axis=0, initial=initial).reshape(together, -1), axis=0)
    return found


def joined(parts: Iterable[Part], *, added: bool) -> Part:
    """Of several parts in the order of their blocks, whose sums are kept apart until they are to be ``added``."""
    rows, lacking, extremes, sums, bins = zip(*parts, strict=True)
    lows, total = np.stack(extremes), np.concatenate(sums)
    best = np.take_along_axis(lows, lows[:, :1].argmin(axis=0)[None], axis=0)[0]
    total = np.cumsum(total, axis=0)[-1:] if added else total  # one after the other
    counted = []
    for of_entry in zip(*bins, strict=True):
        keys, counts = (np.concatenate(each) for each in zip(*of_entry, strict=True))
        found, places = np.unique(keys, return_inverse=True)
        counted.append((found, np.bincount(places, counts)))
    return Part(sum(rows), sum(lacking), best, total, tuple(counted))


def quantiles(keys: Any, counts: Any) -> Array:
    """Quantiles of one entry, linear within a bin, whose number is the head of its values' bits."""
    edges = np.sort([(keys << _CUT).view(float), ((keys + 1) << _CUT).view(float)], axis=0)
    low, high = edges[:, order := edges[0].argsort()]
    until = np.cumsum(counts[order])
    ranks = np.array(QUANTILES) * (until[-1] - 1)
    place = np.searchsorted(until, ranks, side="right")
    inside = (ranks + 0.5 - (until - counts[order])[place]) / counts[order][place]
    found = low[place] + inside * (high - low)[place]
    return np.where(np.abs(found) < np.finfo(float).tiny, 0.0, found)  # in the bin of zero


@dataclass(frozen=True, slots=True)
class Sampled:
    """What is known of a function's values.

    Attributes:
        shape: Of the function.
        number: Of the configurations.
        lacking: How many of them have no finite value, and are left out.
        reductions: Arrays of the function's shape by ``min``, ``mean``, ``max``; ``quantiles`` has a first axis more.
        where: By ``min`` and ``max`` the arguments at which each entry is so, by name, (*shape, width).
    """

    shape: tuple[int, ...]
    number: int
    lacking: int
    reductions: Mapping[str, Array]
    where: Mapping[str, Mapping[str, Array]]

    def as_dict(self) -> dict[str, Any]:
        """Plain data, for JSON."""
        reductions = {kind: values.tolist() for kind, values in self.reductions.items()}
        where = {kind: {name: at.tolist() for name, at in each.items()} for kind, each in self.where.items()}
        return {"number": self.number, "lacking": self.lacking, **reductions, "where": where}


def program_for(robot: Robot, asked: Sequence[str]) -> Program:
    """The functions of a robot by their names or the symbols of books; of a tree for every end."""
    known = {interface.symbol: name for name, interface in [*INTERFACES.items()][::-1]}  # T is the pose first
    known |= {name: name for name in INTERFACES}
    for word in asked:
        if word not in known:
            allowed = near_miss(word, known) or f"allowed: {listed(INTERFACES)}, or symbols such as tau, J, T"
            raise QuantityError(f"no function {word!r}", allowed=allowed)
    found = build_program(robot, Effort.QUICK, names={known[word] for word in asked})
    for word in asked:
        own = [each for each in found if each.interface.any_end == known[word]]
        if not own:
            raise QuantityError(f"{robot.name} has no {known[word]}", remedy="derive show lists what it has")
        if own[0].widths:
            why = f"{known[word]} of {robot.name}: loops are solved numerically from the last configuration"
            remedy = "call the generated code along a way, or derive move: random configurations have no last one"
            raise QuantityError(why, remedy=remedy)
        if not own[0].arguments:
            raise QuantityError(f"{known[word]} is the same in every configuration", remedy="leave it out")
    return found


def bounds_of(robot: Robot, program: Program, given: Mapping[str, Bound]) -> dict[str, Array]:
    """Bounds of all arguments, q within its limits, (2, width) each; angles without limits make a full turn."""
    limits = joint_limits(robot)
    free = [variable for variable, pair in zip(robot.variables, limits, strict=True) if pair is None]
    if slides := [variable.label for variable in free if not variable.is_revolute]:
        remedy = "give it limits: [lower, upper] in the robot file"
        raise RobotFileError(f"{slides[0]} of {robot.name} slides without limits", remedy=remedy)
    if free:
        found = f"no limits of {listed(variable.label for variable in free)}: full turns"
        warnings.warn(RobotFileWarning(found), stacklevel=3)
    bounds = {"q": np.transpose([pair or (-pi, pi) for pair in limits])}
    for name, option in BOUNDS.items():
        if not any(name in function.arguments for function in program):
            continue
        width, values = WIDTHS.get(name, robot.dof), given.get(option)
        own: Any = joint_bounds(robot).get({"qd": "SPEED_LIMITS", "tau": "TORQUE_LIMITS"}.get(name, ""), (None,))
        if values is None and None in own:
            raise DeriveError(f"{name} has no bounds", remedy=f"give --{option}: one number or {width} [SI units]")
        most = np.array(own if values is None else values, dtype=float)
        if most.size not in (1, width) or not (np.isfinite(most) & (most >= 0)).all():
            text = listed(f"{value:g}" for value in most.ravel())
            raise DeriveError(f"--{option} {text}", allowed=f"allowed: one number from 0 on, or {width}")
        bounds[name] = np.outer([-1.0, 1.0], np.resize(most, width))
    return bounds


def sampled(work: Sampling, cluster: Cluster, chunk: int, what: str, tell: Tell | None) -> dict[str, Sampled]:
    """The reductions of each function."""
    blocks, step = range(-(-work.number // BLOCK)), max(1, chunk // BLOCK)
    chunks = [blocks[start : start + step] for start in blocks[::step]]
    total: list[Part] = []
    for parts in cluster.in_order(parts_of, chunks, cluster.shared(work), what=what, tell=tell):
        total = [joined(each, added=True) for each in zip(*([total] if total else []), parts, strict=True)]
    found: dict[str, Sampled] = {}
    for place, ((name, _, shape), part) in enumerate(zip(work.functions, total, strict=True)):
        if not part.rows:
            raise QuantityError(f"{name} has no finite value in any of {part.lacking} configurations")
        low, high = np.split(part.extremes[0], 2)
        ways: dict[str, Any] = {"min": low, "mean": part.sums[0] / part.rows, "max": -high}
        if part.bins:
            ways["quantiles"] = np.stack([quantiles(*each) for each in part.bins], axis=-1).clip(low, -high)
        reductions = {kind: ways[kind].reshape((*ways[kind].shape[:-1], *shape)) for kind in work.kinds}
        found[name] = Sampled(shape, work.number, part.lacking, reductions, _where(work, place, part))
    return found


def _where(work: Sampling, place: int, part: Part) -> dict[str, dict[str, Array]]:
    """Arguments at which entries of a function are extreme, looked for in the blocks that have them."""
    shape, rows = work.functions[place][2], []
    for entry, (value, block) in enumerate(part.extremes.T):
        count = part.extremes.shape[1] // 2
        column = work.values(int(block))[place][:, entry % count] * (1 if entry < count else -1)
        row = int(np.argmax(column == value))
        rows.append({name: values[row] for name, values in work.arguments(int(block)).items()})
    found = {name: np.reshape([row[name] for row in rows], (2, *shape, -1)) for name in rows[0]}
    kinds = [(kind, k) for k, kind in enumerate(("min", "max")) if kind in work.kinds]
    return {kind: {name: values[k] for name, values in found.items()} for kind, k in kinds}
