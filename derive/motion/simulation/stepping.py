"""From one time to the next, with friction that is smooth: by scipy's solvers, or in C under torques that are held."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from pathlib import Path
from typing import Any

import numpy as np

from derive.arrays import Array
from derive.errors import TargetError, optional
from derive.interrupts import TemporaryFolder
from derive.motion.torques.base_torques import BaseTorques
from derive.motion.torques.functions import COMPILING, Functions, bare_robot, program_of
from derive.programs.program import Program
from derive.publish.modules import KEPT
from derive.robot.robot import Robot
from derive.targets.compiler import compile_shared, find_compiler

TOLERANCE = 2e-11  # relative and absolute error of a step
STICTION_SPEED = 1e-4  # speed at which smooth friction has three quarters of its value [rad/s or m/s]: f tanh(qd/1e-4)
STIFF = 5000.0  # decay from which on implicit solvers take fewer steps [1/s], as of light links under large gains
SHORT = 0.1  # time in which no solver takes many steps [s]
ASIDE = 1e-6  # by how much a state is moved to see how its rates change
DEAD = 1e-4  # of the sine of an angle of a loop, or the like: beyond, joints are on a branch that variables cannot tell
DIVERGED = 1e4  # speed beyond which a simulation is given up [rad/s or m/s]
PLANT = frozenset({"forward_dynamics", "inertia_matrix", "kinetic_energy", "potential_energy"})  # of a plant
Law = Callable[[float, Array, Array], Array]  # torques of the motors at a time, position and velocity


@dataclass(frozen=True)
class Plant:
    """The arm that is simulated."""

    functions: Functions  # those of `PLANT`, without dry friction
    viscous: Array  # coefficients of friction by velocity, which the functions hold
    coulomb: Array  # dry friction for qd > 0, and against that for qd < 0, which they do not, (2, n)
    push: Array  # what acts on the joints besides motors and friction [N m or N]
    held: Held | None = None  # its steps in C under held torques; None where that is not worth a compiler
    base: BaseTorques | None = None  # what the motion of the base adds to the torques; None where it stands
    rows: Rows | None = None  # of coupled joints; None where each has its own variable

    def dry(self, way: Array) -> Array:
        """Dry friction by sign(qd), or by a smooth stand-in for it, (n,) [N m or N]; see `Link.signed`."""
        ahead, back = self.coulomb
        return np.asarray(((ahead + back) / 2 + (ahead - back) / 2 * way) * way)

    def friction(self, q: Array, qd: Array, of_joints: Callable[[Array], Array]) -> Array:
        """What variables feel of a friction that joints have by their rates, (n,) [N m or N]: S^T f(S qd)."""
        rates = self.rows(q)[0] if self.rows else None
        return of_joints(qd) if rates is None else np.asarray(rates.T @ of_joints(rates @ qd))

    def felt(self, driven: Array, t: float, q: Array, qd: Array) -> Array:
        """What accelerates joints that motors and pushes drive: less what the motion of the base takes [N m or N]."""
        return driven if self.base is None else driven - np.array(self.base.at(t, q).added(qd.tolist()))

    def ledger(self, driven: Array, losses: Array, t: float, q: Array, rates: tuple[Array, Array]) -> tuple[float, ...]:
        """Power of motors and pushes, what friction takes, and the power of a base that moves [W], by qd and qdd."""
        qd, qdd = rates
        slowed = self.friction(q, qd, lambda rate: self.viscous * rate) if self.viscous.any() else 0.0
        found = float(driven @ qd), float((losses + slowed) @ qd)
        return found if self.base is None else (*found, self.base.at(t, q).power(qd.tolist(), qdd.tolist()))

    def energy(self, q: Array, qd: Array, t: float | Array = 0.0) -> Array:
        """Kinetic and potential energy [J], (...); where the base moves that in the world, at times (...)."""
        if self.base is not None:
            return self.base.energy(np.asarray(t), q, qd)
        return self.functions("kinetic_energy", q, qd) + self.functions("potential_energy", q)


@dataclass(frozen=True, slots=True)
class Divergence:
    """Where a simulation was given up."""

    time: float  # when [s]
    q: Array  # joint variables then, (n,)
    qd: Array  # velocities then, (n,)
    is_dead: bool = False  # whether a loop is at a dead point there, or does not close


# States at the times that are wanted, and where it ended earlier. A state holds positions, velocities, the work of
# motors and pushes, what friction took, and the work of a base that moves.
Steps = tuple[Array, Divergence | None]
# Steps of an arm, from torques of the motors, a state, start and end, to the times that are wanted.
Held = Callable[[Plant, Array, Array, tuple[float, float], Array], Steps]
Rows = Callable[[Array], tuple[Array, float]]  # see `rows_of`
Change = tuple[float, Array]  # time and state at which something else begins


def integrated(
    rates: Callable[[float, Array], Array],
    state: Array,
    span: tuple[float, float],
    times: Array,
    method: str,
    margin: Callable[[float, Array], float] | None = None,
    longest: float = np.inf,
) -> tuple[Array, Change | None, Divergence | None]:
    """A motion by one of scipy's solvers, up to where it changes or diverges."""
    scipy = optional("scipy.integrate", "simulations need scipy", "motion")
    n = (state.size - 2) // 2

    def _bounded(_: float, state: Array) -> float:
        return DIVERGED - float(np.abs(state[n : 2 * n]).max())

    _bounded.terminal = True  # type: ignore[attr-defined]
    # Speeds beyond all sense end a simulation, and so does a change, of which the caller begins anew.
    events: list[Callable[[float, Array], float]] = [_bounded]
    if margin is not None:
        change = partial(margin)  # which may have attributes
        change.terminal, change.direction = True, -1  # type: ignore[attr-defined]
        events.append(change)
    error = {"rtol": TOLERANCE, "atol": TOLERANCE, "max_step": longest}
    with np.errstate(all="ignore"):
        found = scipy.solve_ivp(rates, span, state, method, times, events=events, **error)
    if len(got := np.array(found.y).T.reshape(-1, state.size)) == len(times):
        return got, None, None
    # The caller goes on from a change; a solver that gave up by itself counts as divergence where it stopped.
    if margin is not None and len(found.t_events[1]):
        return got, (float(found.t_events[1][0]), found.y_events[1][0]), None
    if len(found.t_events[0]):
        end, last = float(found.t_events[0][0]), found.y_events[0][0]
    else:
        end, last = (float(found.t[-1]), got[-1]) if len(got) else (span[0], state)
    return got, None, Divergence(end, last[:n], last[n : 2 * n])


def rows_of(robot: Robot, values: Mapping[str, float], functions: Functions) -> Rows:
    """S at the variables, (joints, n), and how far loops are from dead points: |det J_p| by its columns' lengths."""
    from derive.inverse.loops.linkage import constant_rows, linkage, rates  # which few motions need

    matrix, loops = np.array(constant_rows(robot, values)), linkage(robot)

    def _at(q: Array) -> tuple[Array, float]:
        places = matrix @ q
        places[[bool(joint.follows) for joint in robot.joints]] = functions("passive_positions", q) if loops else ()
        found, far = rates(robot, loops, places.tolist(), values)
        return found, float(far)

    return _at


def smooth(plant: Plant, law: Law, state: Array, span: tuple[float, float], times: Array) -> Steps:
    """With friction f tanh(qd/v0): LSODA, or DOP853 where there is no dry friction and no fast decay."""
    n = plant.push.size
    frozen, nothing = np.zeros_like(state), np.zeros(n)
    rough = bool(plant.coulomb.any())

    def _rates(t: float, state: Array) -> Array:
        q, qd = state[:n], state[n : 2 * n]
        if not qd @ qd < 4 * n * DIVERGED**2:
            return frozen
        # B qdd = tau + push - C qd - g - viscous qd - f tanh(qd/v0), and the powers of the ledger beside.
        driven = law(t, q, qd) + plant.push
        slip = plant.friction(q, qd, lambda rate: plant.dry(np.tanh(rate / STICTION_SPEED))) if rough else nothing
        rates = np.empty_like(state)
        rates[:n] = qd
        rates[n : 2 * n] = plant.functions("forward_dynamics", q, qd, plant.felt(driven, t, q, qd) - slip)
        rates[2 * n :] = plant.ledger(driven, slip, t, q, (qd, rates[n : 2 * n]))
        return rates

    def _far(_: float, state: Array) -> float:
        return plant.rows(state[:n])[1] - DEAD if plant.rows else 1.0

    if not _far(span[0], state) > 0:
        return np.empty((0, state.size)), Divergence(span[0], state[:n], state[n : 2 * n], is_dead=True)
    method = "LSODA" if rough else solver(_rates, state, span)
    got, end, divergence = integrated(_rates, state, span, times, method, _far if plant.rows else None)
    if divergence is not None and plant.rows and np.abs(divergence.qd).max() < DIVERGED / 2:  # it does not go on
        return got, replace(divergence, is_dead=True)
    return got, Divergence(end[0], end[1][:n], end[1][n : 2 * n], is_dead=True) if end else divergence


def solver(rates: Callable[[float, Array], Array], state: Array, span: tuple[float, float]) -> str:
    """Which of scipy's solvers takes few steps: an implicit one where something decays fast."""
    if span[1] - span[0] <= SHORT:
        return "DOP853"
    count = (state.size - 2) // 2 * 2
    # Columns of d(qd, qdd)/d(q, qd) by central differences; their largest eigenvalue is how fast something decays.
    aside = ASIDE * np.eye(count, state.size)
    columns = [(rates(span[0], state + a) - rates(span[0], state - a))[:count] / (2 * ASIDE) for a in aside]
    system = np.array(columns).T
    return "LSODA" if np.isfinite(system).all() and np.abs(np.linalg.eigvals(system)).max() > STIFF else "DOP853"


# -- in C: without control, and between two looks of a sampled controller

NAMES = frozenset({"forward_dynamics"})  # generated functions that a step asks for
SAVED = 1e-5  # what C saves an evaluation of the rates of a state [s]
OPTIONS = ("-std=c99", "-O2", "-fno-math-errno")
FIRST = 1e-4  # length of the first step that is tried [s]


class HeldArm:
    """Steps of an arm whose motors hold their torques."""

    def __init__(self, program: Program, library: _Library, values: Mapping[str, float]) -> None:
        self._library, self._step = library, FIRST
        self._constants = np.zeros(library.constant_count)
        params = np.array([float(values[name]) for name in program.parameters])
        library.constants(_pointer(params), _pointer(self._constants))

    def __call__(self, plant: Plant, motors: Array, state: Array, span: tuple[float, float], times: Array) -> Steps:
        """A motion by DOP853 under torques of the motors, (n,), with the usual tolerance and smooth dry friction."""
        clock, rows = np.array([span[0], self._step]), np.empty((times.size, state.size))
        given = [np.ascontiguousarray(part, dtype=float) for part in (times, motors)]
        ahead, back = plant.coulomb
        arm = np.concatenate([plant.push, plant.viscous, (ahead + back) / 2, (ahead - back) / 2])
        others = [arm, self._constants, state.copy(), rows]
        count = self._library.held(_pointer(clock), times.size, *map(_pointer, (*given, *others)))
        self._step = float(clock[1])
        if count == times.size:
            return rows, None
        n, last = plant.viscous.size, others[2]
        return rows[:count], Divergence(float(clock[0]), last[:n], last[n : 2 * n])


def held_arm(robot: Robot, evaluations: float) -> Callable[[Mapping[str, float]], HeldArm] | None:
    """The arm in C, by its numbers; None where there is no compiler, or where it takes longer than it saves."""
    if evaluations * SAVED < COMPILING:
        return None
    bare = bare_robot(robot)
    return None if (library := _compiled(bare)) is None else partial(HeldArm, program_of(bare, NAMES), library)


class _Library:
    """Compiled code, and the folder that holds it as long as it is used."""

    def __init__(self, folder: TemporaryFolder, path: Path, prefix: str) -> None:
        self._folder = folder
        shared = ctypes.CDLL(str(path))
        self.constant_count = ctypes.c_int.in_dll(shared, f"{prefix}held_constant_count").value
        self.held, self.constants = shared[f"{prefix}held"], shared[f"{prefix}held_constants"]
        self.held.argtypes = [ctypes.c_void_p, ctypes.c_int, *[ctypes.c_void_p] * 6]
        self.constants.argtypes, self.constants.restype = [ctypes.c_void_p] * 2, None


@lru_cache(KEPT)
def _compiled(robot: Robot) -> _Library | None:
    from scipy.integrate import DOP853

    from derive.targets import c
    from derive.targets.target import Source
    from derive.targets.templating import render
    from derive.version import __version__

    if (compiler := find_compiler()) is None:
        return None
    temporary = TemporaryFolder()
    folder, source = temporary.path, Source(robot, program_of(robot, NAMES), __version__)
    context = c.c_context(source)
    code = render(
        "motion/held.c.jinja",
        **context,
        stages=DOP853.n_stages,
        weights=[_listed(row) for row in DOP853.A[: DOP853.n_stages]],
        sums=_listed(DOP853.B),
        third=_listed(DOP853.E3),
        fifth=_listed(DOP853.E5),
        tolerance=repr(TOLERANCE),
        stiction=repr(STICTION_SPEED),
        diverged=repr(DIVERGED),
    )
    for name, text in {**c.TARGET.render(source), "held.c": code}.items():
        (folder / name).write_text(text, encoding="utf-8")
    try:
        compile_shared(compiler, [folder / "model.c", folder / "held.c"], folder / "held.so", OPTIONS)
    except TargetError:  # a compiler that does not serve is none
        return None
    return _Library(temporary, folder / "held.so", str(context["prefix"]))


def _listed(numbers: Any) -> str:
    return ", ".join(repr(float(number)) for number in numbers)


def _pointer(array: Array) -> int:
    return int(array.__array_interface__["data"][0])
