"""Functions of a robot at many configurations, in bounded memory: what is said of every entry."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from derive.arrays import Array
from derive.errors import QuantityError, TargetError, listed, near_miss
from derive.programs.build import build_program
from derive.programs.functions import INTERFACES
from derive.programs.optimise.search_policy import Effort
from derive.programs.program import Program
from derive.publish.modules import ModuleSources, imported
from derive.robot.evaluate import parameter_values
from derive.robot.robot import Robot
from derive.sampling.clusters import Cluster, Tell
from derive.sampling.configurations import BLOCK, Configurations
from derive.sampling.reductions import Part, joined, part_of, reduced
from derive.targets.compiler import find_compiler
from derive.targets.target import Source
from derive.version import __version__


@dataclass(frozen=True, slots=True)
class Sampling:
    """All that a block needs besides its number; every worker has it once."""

    sources: ModuleSources
    functions: tuple[tuple[str, tuple[str, ...], tuple[int, ...]], ...]  # name, arguments and shape of each
    parameters: Mapping[str, float]  # numbers of the free symbols
    configurations: Configurations
    kinds: tuple[str, ...]  # of reductions

    def values(self, block: int) -> list[Array]:
        """Those of each function in a block, (rows, entries)."""
        module, _folder = imported(self.sources)
        arguments = self.configurations.block(block)
        options = {"params": module.precompute(self.parameters)} if module.PARAMETERS else {}
        found = []
        with np.errstate(all="ignore"):
            for name, taken, _ in self.functions:
                result = getattr(module, name)(*(arguments[each] for each in taken), **options)
                found.append(result.reshape(len(result), -1))
        return found


def parts_of(blocks: range, sampling: Sampling) -> list[Part]:
    """Of each function the part of some blocks."""
    binned = "quantiles" in sampling.kinds
    parts = [[part_of(values, block, binned=binned) for values in sampling.values(block)] for block in blocks]
    return [joined(each, added=False) for each in zip(*parts, strict=True)]


@dataclass(frozen=True, slots=True)
class Sampled:
    """What is known of a function's values.

    Attributes:
        shape: Of one value.
        lacking: How many configurations have no finite value.
        reductions: Arrays of that shape by ``min``, ``mean`` and ``max``; ``quantiles`` has a first axis more.
        where: By ``min`` and ``max`` the arguments at which each entry is so, by name, (*shape, width).
    """

    shape: tuple[int, ...]
    lacking: int
    reductions: Mapping[str, Array]
    where: Mapping[str, Mapping[str, Array]] = field(default_factory=dict)


def program_for(robot: Robot, asked: Sequence[str]) -> Program:
    """The functions of a robot by their names or the symbols of books, those of an end with its name behind."""
    ends = [end.name for end in robot.ends if end.name]
    symbols = {interface.symbol: name for name, interface in [*INTERFACES.items()][::-1]}  # T is the pose first
    known = {**{name: name for name in INTERFACES}, **symbols}
    known |= {f"{word}_{end}": f"{name}_{end}" for word, name in known.items() for end in ends}
    if unknown := [word for word in asked if word not in known]:
        allowed = near_miss(unknown[0], known) or f"allowed: {listed(INTERFACES)}, and symbols such as tau, J, T"
        raise QuantityError(f"no function {unknown[0]!r}", allowed=allowed)
    names = {known[word] for word in asked}
    stems = {
        name: next(stem for stem in INTERFACES if name in (stem, *(f"{stem}_{end}" for end in ends))) for name in names
    }
    found = build_program(robot, Effort.QUICK, names=frozenset(stems.values()))
    chosen = tuple(each for each in found if {each.name, each.interface.any_end} & names)
    for name in names:
        if not any(name in (each.name, each.interface.any_end) for each in chosen):
            raise QuantityError(f"{robot.name} has no function {name}", remedy="see derive show for what it has")
    if still := next((each.name for each in chosen if not each.arguments), ""):
        raise QuantityError(f"{still} is the same in every configuration")
    return Program(chosen, found.parameters)


def sampling(
    robot: Robot, program: Program, points: Configurations, kinds: Sequence[str], parameters: Mapping[str, float]
) -> Sampling:
    """What to do, compiled if there is a compiler."""
    source = Source(robot, program, __version__)
    numbers = parameter_values(robot, parameters)
    if missing := [name for name in program.parameters if name not in numbers]:
        remedy = f"write parameters: {{{missing[0]}: ...}} in the robot file"
        raise QuantityError(f"no number for {listed(missing)} of {robot.name}", remedy=remedy)
    sources = ModuleSources.of(source, compiled=find_compiler() is not None)
    try:
        imported(sources)
    except TargetError:  # a compiler that does not serve is none
        sources = ModuleSources.of(source, compiled=False)
    functions = tuple((each.name, each.arguments, each.shape) for each in program)
    return Sampling(
        sources, functions, {name: float(numbers[name]) for name in program.parameters}, points, tuple(kinds)
    )


def sampled(work: Sampling, cluster: Cluster, chunk: int, what: str, tell: Tell | None) -> dict[str, Sampled]:
    """The reductions of each function."""
    step, count = max(1, chunk // BLOCK), work.configurations.blocks
    chunks = [range(start, min(start + step, count)) for start in range(0, count, step)]
    total: list[Part] = []
    for parts in cluster.in_order(parts_of, chunks, cluster.shared(work), what=what, tell=tell):
        pairs = zip(total, parts, strict=True) if total else ((part,) for part in parts)
        total = [joined(pair, added=True) for pair in pairs]
    found: dict[str, Sampled] = {}
    for place, ((name, _, shape), part) in enumerate(zip(work.functions, total, strict=True)):
        if not part.rows:
            raise QuantityError(f"{name} has no finite value in any of {part.lacking} configurations")
        reductions = {
            kind: values.reshape((*values.shape[:-1], *shape)) for kind, values in reduced(part, work.kinds).items()
        }
        extremes = {"min": part.low_at, "max": part.high_at}
        where = {kind: _located(work, place, kind, extremes[kind]) for kind in work.kinds if kind in extremes}
        found[name] = Sampled(shape, part.lacking, reductions, where)
    return found


def _located(work: Sampling, place: int, kind: str, blocks: Any) -> dict[str, Array]:
    """Arguments at which each entry of a function is extreme, looked for in the block that has it."""
    _, _, shape = work.functions[place]
    best = np.nanargmin if kind == "min" else np.nanargmax
    found = []
    for block in dict.fromkeys(blocks.tolist()):
        values, arguments = work.values(block)[place], work.configurations.block(block)
        values[~np.isfinite(values).all(axis=1)] = np.nan
        for entry in np.flatnonzero(blocks == block):
            row = best(values[:, entry])
            found.append((entry, {name: argument[row] for name, argument in arguments.items()}))
    rows = [row for _, row in sorted(found, key=lambda each: each[0])]
    return {name: np.stack([row[name] for row in rows]).reshape((*shape, -1)) for name in rows[0]}
