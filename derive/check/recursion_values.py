"""What the names of printed Newton-Euler equations stand for, on some arms.

Every link of arms with revolute and prismatic joints, odd twists and full inertia tensors is a case: an equation is
right when it gives, from what the recursion knows at that step, what the recursion computes there.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from derive.check.float_domain import FloatDomain
from derive.mechanics.lecture_newton_euler import LinkStep, Recursion, newton_euler_base, newton_euler_link
from derive.robot.robot import Robot

Array = Any

SETS: Mapping[str, Callable[..., Recursion[float]]] = {
    "newton_euler_base": newton_euler_base,
    "newton_euler_link": newton_euler_link,
}
RESULTS = ("w", "wd", "vd", "a", "F", "N", "f", "n", "tau")
"""What an equation may compute."""


@dataclass(frozen=True, slots=True)
class Case:
    """One link in motion.

    Attributes:
        joint: ``revolute`` or ``prismatic``.
        values: What each name stands for.
    """

    joint: str
    values: Mapping[str, Array]


@cache
def cases(name: str) -> tuple[Case, ...]:
    """All links of the arms for one set of equations."""
    found = []
    for types, seed in (("rpr", 1), ("rrp", 2), ("prrpr", 3)):
        robot = _arm(types, seed)
        rng = random.Random(robot.name)
        q, qd, qdd = ([rng.uniform(-1.5, 1.5) for _ in range(robot.n)] for _ in range(3))
        links = SETS[name](robot, FloatDomain(robot, q), qd, qdd).links
        found += [_case(links, i) for i in range(robot.n)]
    return tuple(found)


def _case(links: tuple[LinkStep[float], ...], i: int) -> Case:
    step = links[i]
    data, before, now = step.data, step.previous, step.motion
    after = np.array(links[i + 1].data.before).T if i + 1 < len(links) else np.eye(3)
    values: dict[str, Any] = {"w": now.w, "wd": now.wd, "v": now.v, "vd": now.vd, "a": step.a, "F": step.F, "N": step.N}
    values |= {"f": step.wrench.f, "n": step.wrench.n, "tau": step.tau}
    values |= {"w_prev": before.w, "wd_prev": before.wd, "v_prev": before.v, "vd_prev": before.vd}
    values |= {"p": data.p, "s": data.s, "m": data.mass, "I": data.inertia, "b": data.viscous}
    values |= {"qd": data.qd, "qdd": data.qdd, "f_next": step.following.f, "n_next": step.following.n}
    arrays = {name: np.array(value) for name, value in values.items()}
    return Case("revolute" if data.revolute else "prismatic", {**arrays, **_frames(step, after, arrays["p"])})


def _frames(step: LinkStep[float], after: Array, p: Array) -> dict[str, Array]:
    """Rotations between neighbouring frames and the axes; z_prev in base coordinates in both sets."""
    rotation, before = np.array(step.data.rotation), np.array(step.data.before)
    z0 = np.array([0.0, 0.0, 1.0])
    turns = {"Rp": before, "Rn": after, "R0": rotation.T}
    return {**turns, "z0": z0, "z_prev": rotation @ before @ z0, "p_in_next": after.T @ p}


def _arm(types: str, seed: int) -> Robot:
    rng = random.Random(seed)

    def cell(scale: float = 1.0) -> float:
        return round(rng.uniform(0.2, 1.2) * scale, 3)

    lines = [f"name: arm-{types}", "convention: standard", "joints:"]
    for letter in types:
        own, kind = {"r": ("d", "revolute"), "p": ("theta", "prismatic")}[letter]
        lines.append(f"  - {{type: {kind}, {own}: {cell()}, a: {cell()}, alpha: {cell()}}}")
    lines += ["gravity: [0, 0, -9.81]", "links:"]
    for _ in types:
        moments = ", ".join(f"{axes}: {2 + cell()}" for axes in ("xx", "yy", "zz"))
        tensor = moments + "".join(f", {axes}: {cell(0.1)}" for axes in ("xy", "xz", "yz"))
        body = f"mass: {cell()}, com: [{cell()}, {cell()}, {cell()}], inertia: {{{tensor}}}"
        lines.append(f"  - {{{body}, friction: {{viscous: {cell()}}}}}")
    return Robot.from_text("\n".join(lines) + "\n")
