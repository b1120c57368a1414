"""roboticstoolbox: a robot from its Denavit-Hartenberg table, numeric; only `rne` takes a trajectory."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np

from bench.peers.passes import one_by_one, whole_batch
from bench.peers.peer import Peer, Row, Timed
from bench.quantities import BY_SYMBOL, arguments
from bench.robots import Array, Case

NAME = "roboticstoolbox"
_FEW = {"tau": 100, "g": 100, "T": 50, "B": 20, "J": 10, "C": 2}
"""Configurations of a pass: some of its functions take milliseconds."""

_SLIDE = (0.0, 10.0)
"""Limits of slides [m], without which it solves no arm backwards."""


def robot_of(case: Case) -> Any:
    """The toolbox's robot."""
    import roboticstoolbox as rtb

    arm = case.oracle.arm
    kinds = (rtb.RevoluteDH, rtb.PrismaticDH) if arm.standard else (rtb.RevoluteMDH, rtb.PrismaticMDH)
    links = []
    for i in range(arm.n):
        inertia = arm.inertia[i]
        common = {
            "a": arm.a[i],
            "alpha": arm.alpha[i],
            "m": arm.mass[i],
            "r": arm.com[i],
            "I": [inertia[0, 0], inertia[1, 1], inertia[2, 2], inertia[0, 1], inertia[1, 2], inertia[0, 2]],
        }
        own = {"d": arm.d[i], "offset": arm.theta[i]} if arm.revolute[i] else {"theta": arm.theta[i], "qlim": _SLIDE}
        links.append(kinds[0 if arm.revolute[i] else 1](**common, **own))
    return rtb.DHRobot(links, gravity=arm.gravity)


def calls(robot: Any) -> dict[str, Callable[..., Array]]:
    """By quantity."""
    return {
        "tau": lambda q, qd, qdd: np.asarray(robot.rne(q, qd, qdd)),
        "B": lambda q: np.asarray(robot.inertia(q)),
        "C": lambda q, qd: np.asarray(robot.coriolis(q, qd)),
        "g": lambda q: np.asarray(robot.gravload(q)),
        "T": lambda q: np.asarray(robot.fkine(q).A),
        "J": lambda q: np.asarray(robot.jacob0(q)),
    }


def _time(case: Case, motions: Sequence[Array]) -> Iterator[Row]:
    functions = calls(robot_of(case))
    for symbol, function in functions.items():
        yield Row(NAME, symbol, False, lambda s=symbol, f=function: _one(case, s, f, motions))  # type: ignore[misc]
    few = [array[:10_000] for array in motions]
    yield Row(f"{NAME}, trajectory", "tau", True, lambda: whole_batch(functions["tau"], few))


def _one(case: Case, symbol: str, function: Callable[..., Array], motions: Sequence[Array]) -> Timed:
    quantity = BY_SYMBOL[symbol]
    taken = arguments(quantity, tuple(motions))
    return one_by_one(function, taken, quantity.shape(case.robot.n), _FEW[symbol])


PEER = Peer(NAME, ("roboticstoolbox",), time=_time)
