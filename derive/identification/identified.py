"""Identification from end to end: a robot and its log, and what came of them."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from derive.arrays import Array, Flags
from derive.errors import DeriveError, listed
from derive.identification.log import Block, Log
from derive.identification.regression import SMALLEST, Factors, Method, estimate, refuse_strange_torques
from derive.identification.standard import Unknowns
from derive.programs.build import build_program
from derive.programs.optimise.search_policy import Effort
from derive.publish.modules import loaded
from derive.robot.expression import Expression, to_text
from derive.robot.robot import Robot
from derive.robot.writer import robot_text
from derive.targets.target import Source
from derive.version import __version__

SAVED, COMPILING = 2.2e-9, 2.0  # what compiled code saves an operation of a row, and what a compiler takes [s]
SHOWN = 500  # rows whose residuals are drawn
QUANTILE = 1.96  # of the normal distribution, for 95 %
JOINT_HEAD = ("joint", "torque RMS", "residual before", "residual", "held out")
PARAMETER_HEAD = ("parameter", "value", "+- 95 %", "prior", "groups")


@dataclass(frozen=True, eq=False)
class Identified:
    """What a log says of a robot: p base parameters of n joints, in SI units."""

    robot: Robot  # with the identified links
    source: Robot  # the robot that was given
    method: Method  # how they are estimated
    names: tuple[str, ...]  # of the base parameters, each that of the parameter that takes others over
    formulas: tuple[Expression | None, ...]  # what each groups, ``Izz1 + a2**2*m3``; None where that is no polynomial
    prior: Array  # (p,) their values in the robot file that was given
    values: Array  # (p,) the identified ones
    deviations: Array  # (p,) their standard deviations; zero where a value is kept
    kept: Flags  # (p,) whether the log does not excite it, so that it keeps its prior
    rows: int  # how many rows were used
    torques: Array  # (n,) root mean square of each joint's torques [N m or N]
    before: Array  # (n,) root mean square of what the given robot leaves of them [N m or N]
    residuals: Array  # (n,) the same of the identified robot
    held_out: Array | None  # (n,) the same of rows that were not used; None where none were held out
    shown: tuple[Array, ...]  # of some rows time [s] or number, (rows,), speeds and residuals, (rows, n)
    notes: tuple[str, ...]  # what a reader should know, in sentences

    @property
    def text(self) -> str:
        """The robot file, with what was done in its head."""
        errors = listed(f"{each:.3g}" for each in self.residuals)
        head = f"derive identify, {self.method}, {self.rows} rows; residuals by joint {errors} (RMS, N m or N)"
        return robot_text(self.robot, (*self.source.comments, head, *self.notes))

    def joint_rows(self) -> list[tuple[str, ...]]:
        """For each joint the texts of `JOINT_HEAD`."""
        held = [""] * self.robot.n if self.held_out is None else [f"{each:.4g}" for each in self.held_out]
        numbers = zip(self.robot.joints, self.torques, self.before, self.residuals, held, strict=True)
        return [(joint.label, *(f"{each:.4g}" for each in row), own) for joint, *row, own in numbers]

    def parameter_rows(self) -> list[tuple[str, ...]]:
        """For each base parameter the texts of `PARAMETER_HEAD`."""
        ranges = ("kept" if kept else f"{QUANTILE * d:.2g}" for kept, d in zip(self.kept, self.deviations, strict=True))
        groups = (to_text(each, lambda value: f"{float(value):.4g}") if each else "" for each in self.formulas)
        rows = zip(self.names, self.values, ranges, self.prior, groups, strict=True)
        return [(name, f"{value:.6g}", own, f"{prior:.6g}", group) for name, value, own, prior, group in rows]

    def as_dict(self) -> dict[str, object]:
        """Plain data, for JSON."""
        keys = ("prior", "values", "deviations", "kept")
        columns = {key: getattr(self, key).tolist() for key in (*keys, "torques", "before", "residuals")}
        held = None if self.held_out is None else self.held_out.tolist()
        words = {"method": str(self.method), "rows": self.rows, "names": list(self.names), "notes": list(self.notes)}
        return words | columns | {"held_out": held}


def identified(unknowns: Unknowns, method: Method, logs: Sequence[Log], *, part: float, trusted: bool) -> Identified:
    """The parameters of a robot from a part of the first log; the rest, and further ones, are held out."""
    log, *others = logs
    program = build_program(unknowns.wide, Effort.QUICK, names={"base_regressor"})
    saved = log.rows * SAVED * sum(program.operations["base_regressor"].values())
    source = Source(unknowns.wide, program, __version__)
    module, folder = loaded(source, compiled=saved > COMPILING)  # the folder goes when it is no longer held
    n, count = unknowns.robot.n, len(unknowns.prior)
    # A torque does not depend on what is zero at random states.
    random = np.random.default_rng(1).uniform(-2, 2, (3, 16, n))
    there = np.broadcast_to(module.base_regressor(*random), (16, n, count)) != 0
    used, held = (Factors(tuple(np.flatnonzero(there[:, j].any(axis=0)) for j in range(n)), count) for _ in range(2))
    shown = _gather(log, module.base_regressor, used, held, part)
    for other in others:
        _gather(other, module.base_regressor, held, held, 1.0)
    del folder
    if used.rows * n < count:
        short = f"{log.path or 'the table'}: {used.rows} rows of {n} torques for {count} base parameters"
        raise DeriveError(short, remedy="give a longer log")
    if not trusted:
        refuse_strange_torques(used, unknowns.prior, [joint.label for joint in unknowns.robot.joints])
    found = estimate(used, method, unknowns.prior, unknowns.largest)
    beta, notes = found.beta, _notes(log, unknowns, found.kept)
    if method is not Method.POSSIBLE:
        standard = unknowns.nearest(beta)
    else:
        standard = unknowns.nearest_possible(found)
        beta = unknowns.prior + unknowns.grouping @ (standard - unknowns.given)
        least = np.maximum(used.deviations(found.beta), SMALLEST * used.deviations(np.zeros(count)))
        cost = float((used.deviations(beta) / least).max()) - 1
        notes.append(f"bodies that exist: residuals up to {max(cost, 0.0):.2%} larger than without this limit")
    return Identified(
        robot=Robot.of(unknowns.robot_of(standard)),
        source=unknowns.robot,
        method=method,
        names=tuple(parameter.name for parameter in unknowns.base.parameters),
        formulas=unknowns.formulas,
        prior=unknowns.prior,
        values=beta,
        deviations=found.deviation,
        kept=found.kept,
        rows=used.rows,
        torques=used.deviations(np.zeros(count)),
        before=used.deviations(unknowns.prior),
        residuals=used.deviations(beta),
        held_out=held.deviations(beta) if held.rows else None,
        shown=(*shown[:2], shown[3] - shown[2] @ beta),
        notes=tuple(notes),
    )


def _gather(log: Log, regressor: Callable[..., Array], used: Factors, held: Factors, part: float) -> Block:
    """Take in a part of a log, the rest as held out, and keep some rows."""
    total = max(log.rows - 2 * log.margin, 0) // log.decimate  # if there are no gaps
    row, every, kept = 0, total // SHOWN + 1, list[Block]()
    for block in log.blocks(regressor):
        cut = len(block[0]) if part == 1 else min(max(round(part * total) - row, 0), len(block[0]))
        for factors, own in ((used, slice(cut)), (held, slice(cut, None))):
            factors.add(block[2][own], block[3][own])
        kept.append(tuple(each[-row % every :: every].copy() for each in block))
        row += len(block[0])
    if not kept:
        found = f"{log.path or 'the table'}: {log.rows} rows, none of them left between gaps and edges of filters"
        raise DeriveError(found, remedy="give a longer log, or raise --cutoff")
    if part < 1 and not held.rows:
        found = f"{log.path or 'the table'}: none of its {row} rows left to be held out"
        raise DeriveError(found, remedy="hold out a larger part, or another log")
    return tuple(np.concatenate(parts) for parts in zip(*kept, strict=True))


def _notes(log: Log, unknowns: Unknowns, kept: Flags) -> list[str]:
    filtered = listed(log.missing or ("q", "qd", "qdd")) if log.band else ""
    how = "by differences" if log.missing else "from the log"
    notes = [f"{filtered} {how}, filtered without delay at {log.band:.3g} Hz"] if filtered else []
    if log.decimate > 1:
        notes.append(f"regressor and torques filtered alike, 1 of {log.decimate} rows kept")
    names = [parameter.name for parameter, own in zip(unknowns.base.parameters, kept, strict=True) if own]
    return notes + ([f"not excited by the log, kept as they were: {listed(names)}"] if names else [])
