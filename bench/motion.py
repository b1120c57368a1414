"""Times of motions beside their bars: `python -m bench.motion`."""

from __future__ import annotations

import argparse
import importlib
import resource
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from time import perf_counter, process_time
from typing import Any

import numpy as np

from bench.environment import environment
from bench.peers.toolbox import robot_of
from bench.problems import brief
from bench.results import FOLDER, write_json
from bench.robots import FOLDER as ROBOTS
from bench.robots import load
from bench.tables import ABSENT, environment_line, section, table
from bench.terminal import say
from derive.motion.motion import Motion
from derive.motion.output.film import Film
from derive.motion.simulation.simulation import Run
from derive.motion.torques.functions import Functions

TOOLBOX = "roboticstoolbox"

COMPILED, NUMPY = 1e9, 0.0
"""Calls that are worth a compiler, and that are not."""

ENOUGH = 5
"""Most turns of what takes a second or more."""

START = (0.0, 0.8, -1.5, 0.2, 0.3, 0.5)
"""Where the PUMA 560 is let go [rad]."""

FALL = f"""\
robot: {{}}
points: {{{{a: {list(START)}}}}}
path: [a, {{{{to: a, time: {{}}}}}}]
friction: {{}}
"""

FOLLOWING = """\
robot: puma560-corke
points: {a: [0, 45, -90, 0, 30, 0], b: [60, 60, -120, 40, -30, 90]}
path: [a, {to: b, time: 10}]
control: {law: computed-torque, kp: 100, kd: 20, period: 0.001}
"""

CORNERS = ((0.0, 0.8, -1.5, 0.2, 0.3, 0.5), (1.2, 0.2, -0.6, -0.5, 0.9, 0.1), (0.4, 1.3, -2.0, 0.3, -0.4, 1.0))

LARGEST = (97.6, 186.4, 89.4, 24.2, 20.1, 21.3)
"""Torques of the motors behind their gears [N m]."""

FASTEST = f"""\
robot: {ROBOTS / "puma560-numeric.yaml"}
profile: fastest
torque: {list(LARGEST)}
points: {{{", ".join(f"{name}: {list(q)}" for name, q in zip("abc", CORNERS, strict=True))}}}
path: [a, {{to: b, via: pass}}, c]
"""

PLAN, FILES = "scara-pick-and-place", ("--csv", "run.csv", "--plot", "run.svg", "--html", "run.html")

_RULES = """\
Seconds of a processor, which other work on the machine changes little, the least of {rounds} turns; the time that
passed is in `motion.json`. Simulations are timed when the functions of the arm are there (compiled, but for the row
that says NumPy); commands from the start of their process. The PUMA 560 falls from where it is let go; its dry friction
is `f tanh(qd/1e-4)` (smooth), or sticks (exact)."""


@dataclass(frozen=True, slots=True)
class Row:
    """A figure and what it should be.

    Attributes:
        what: What is measured.
        bar: What is allowed, with its unit.
        ours: What was measured, with its unit.
        theirs: The other tool's figure.
        numbers: All that was measured, in SI units.
    """

    what: str
    bar: str
    ours: str
    theirs: str
    numbers: dict[str, float]


def seconds(work: Callable[[], object], rounds: int) -> dict[str, float]:
    """The processor's time, the least of some turns, and the least that passed; what is slow has fewer turns."""
    spent: list[float] = []
    passed: list[float] = []
    while len(spent) < (min(rounds, ENOUGH) if spent and min(spent) > 1 else rounds):
        before, start = _processor(), perf_counter()
        work()
        passed.append(perf_counter() - start)
        spent.append(_processor() - before)
    return {"processor": float(f"{min(spent):.4g}"), "passed": float(f"{min(passed):.4g}")}


def _processor() -> float:
    """Of this process and of those that it has started and that have ended."""
    children = resource.getrusage(resource.RUSAGE_CHILDREN)
    return process_time() + children.ru_utime + children.ru_stime


def rows(quick: bool, rounds: int) -> Iterator[Row]:
    """All rows, one after the other.

    Args:
        quick: Whether the toolbox's minutes are left out.
        rounds: Turns of each row.
    """
    yield from _simulations(quick, rounds)
    yield from _commands(rounds)
    yield _timed("pick and place of document 004 as GIF", "4 s", lambda: Film(Motion.load(PLAN)).gif(), rounds)
    yield _fastest()


def _timed(what: str, bar: str, work: Callable[[], object], rounds: int, theirs: str = ABSENT) -> Row:
    found = seconds(work, rounds)
    return Row(what, bar, f"{found['processor']:.3g} s", theirs, found)


def _simulations(quick: bool, rounds: int) -> Iterator[Row]:
    fall, rough = ROBOTS / "puma560-numeric.yaml", ROBOTS / "puma560-friction.yaml"
    theirs = ABSENT if quick else _toolbox("puma560-friction", 1.0, {})
    for kind in ("smooth", "exact"):
        motion = Motion.from_text(FALL.format(rough, 1, kind))
        motion.simulate(calls=COMPILED)
        what = f"PUMA 560 falls for 1 s, Coulomb friction {kind}"
        yield _timed(what, "0.05 s", partial(motion.simulate, calls=COMPILED), rounds, theirs)
    motion = Motion.from_text(FALL.format(fall, 10, "none"))
    theirs = _toolbox("puma560-numeric", 10.0, {"method": "DOP853", "rtol": 1e-10, "atol": 1e-10})
    for words, calls, bar in (("native", COMPILED, "0.1 s"), ("NumPy", NUMPY, ABSENT)):
        run = motion.simulate(calls=calls)
        found = seconds(partial(motion.simulate, calls=calls), rounds)
        found["drift"] = drift = _drift(run)
        bars = f"{bar}, 1e-8 J" if bar != ABSENT else "1e-8 J"
        what = f"PUMA 560 falls for 10 s without friction, {words}"
        yield Row(what, bars, f"{found['processor']:.3g} s, drift {drift:.1g} J", theirs, found)
    motion = Motion.from_text(FOLLOWING)
    motion.simulate(calls=COMPILED)
    what = "PUMA 560 follows for 10 s, the controller looks every 1 ms"
    yield _timed(what, "1 s", partial(motion.simulate, calls=COMPILED), rounds)


def _drift(run: Run) -> float:
    return float(np.ptp(run.energy))


def _toolbox(name: str, time: float, options: dict[str, Any]) -> str:
    """Seconds of the toolbox's `fdyn`."""
    if find_spec(TOOLBOX) is None:
        return "not installed"
    case = load(name)
    robot = robot_of(case)
    for link, ours in zip(robot.links, case.robot.links, strict=True):
        dry, viscous, motor = (float(getattr(ours, kind).value) for kind in ("coulomb", "viscous", "armature"))
        link.G, link.Jm, link.B, link.Tc = 1.0, motor, viscous, [dry, -dry]
    say(f"{TOOLBOX}: {name}, {time} s")
    solver = {"solver": options.pop("method")} if options else {}
    try:
        found = seconds(lambda: robot.fdyn(time, np.array(START), solver_args=options, dt=0.01, **solver), 1)
    except Exception as error:
        return brief(error)
    return f"{found['processor']:.3g} s"


def _commands(rounds: int) -> Iterator[Row]:
    with tempfile.TemporaryDirectory(prefix="derive-") as folder:
        yield _timed("document 004: table, CSV, plots and page", "3 s", _command(folder, "move", PLAN, *FILES), rounds)
        size = (Path(folder) / FILES[-1]).stat().st_size
        yield Row("its page", "3 MB", f"{size / 1e6:.2f} MB", ABSENT, {"bytes": size})
        yield _timed("document 004: the table", ABSENT, _command(folder, "move", PLAN), rounds)
        bare = seconds(lambda: subprocess.run([sys.executable, "-c", "pass"], check=True), rounds)["processor"]
        yield _timed("derive --help", f"0.05 s (Python alone {bare:.2g} s)", _command(folder, "--help"), rounds)


def _command(folder: str, *arguments: str) -> Callable[[], object]:
    command = [sys.executable, "-m", "derive", *arguments]
    return lambda: subprocess.run(command, cwd=folder, stdout=subprocess.DEVNULL, check=True)


def _fastest() -> Row:
    """The duration beside that of toppra with the same torques on the same path, which it may exceed between points."""
    what, bar = "fastest motion of the PUMA 560 through three points, longer than toppra's", "1 %"
    if find_spec("toppra") is None:
        return Row(what, bar, ABSENT, "not installed", {})
    found = seconds(lambda: Motion.from_text(FASTEST).duration, 1)
    motion = Motion.from_text(FASTEST)
    ours = motion.duration
    theirs = _toppra_duration(motion)
    longer = 100 * (ours / theirs - 1)
    said = f"{longer:.2f} % ({ours:.5f} s, found in {found['processor']:.2g} s)"
    return Row(what, bar, said, f"toppra {theirs:.5f} s", {"ours": ours, "theirs": theirs, **found})


def _toppra_duration(motion: Motion) -> float:
    spline = importlib.import_module("toppra").SplineInterpolator
    constraint = importlib.import_module("toppra.constraint").JointTorqueConstraint
    algorithm = importlib.import_module("toppra.algorithm").TOPPRA
    functions = Functions(motion.plan.robot, frozenset({"inverse_dynamics"}), motion.values)
    corners, most = np.array(CORNERS), np.array(LARGEST)
    ways = np.linalg.norm(np.diff(corners, axis=0), axis=1)
    knots = np.concatenate([[0.0], np.cumsum(ways) / ways.sum()])
    path = spline(knots, corners, bc_type="natural")
    bound = constraint(lambda *state: functions("inverse_dynamics", *state), np.stack([-most, most], axis=1), most * 0)
    grid = np.linspace(0, 1, 501)
    return float(algorithm([bound], path, gridpoints=grid).compute_trajectory(0, 0).duration)


def motion_markdown(results: dict[str, Any]) -> str:
    """The whole page.

    Args:
        results: The content of ``motion.json``.
    """
    lines = [[row["what"], row["bar"], row["ours"], row["theirs"]] for row in results["rows"]]
    parts = [
        "# Motions",
        f"Written by `python -m bench.motion`. {environment_line(results['environment'])}",
        _RULES.format(rounds=results["rounds"]),
        section("Times and their bars", table(("", "bar", "derive", f"{TOOLBOX} or toppra"), lines)),
    ]
    return "\n\n".join(parts) + "\n"


def run(quick: bool) -> dict[str, Any]:
    """The content of ``motion.json``.

    Args:
        quick: Whether fewer turns will do.
    """
    rounds, found = 3 if quick else 9, []
    for row in rows(quick, rounds):
        say(f"{row.what}: {row.ours} (bar {row.bar}; {TOOLBOX} or toppra: {row.theirs})")
        found.append({name: getattr(row, name) for name in Row.__slots__})
    return {"environment": environment(), "rounds": rounds, "rows": found}


def write_motion(quick: bool) -> str:
    """Measure and write ``results/motion.json`` and ``results/motion.md``.

    Args:
        quick: Whether fewer turns will do.

    Returns:
        The page.
    """
    results = run(quick)
    page = motion_markdown(results)
    write_json("motion", results)
    (FOLDER / "motion.md").write_text(page, encoding="utf-8")
    return page


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure, write the results and print the table."""
    parser = argparse.ArgumentParser(prog="python -m bench.motion", description=__doc__)
    parser.add_argument("--quick", action="store_true", help=f"fewer turns, and without the minutes of {TOOLBOX}")
    parser.add_argument("--no-write", action="store_true", help="print the table and write nothing")
    options = parser.parse_args(arguments)
    print(motion_markdown(run(options.quick)) if options.no_write else write_motion(options.quick), end="")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
