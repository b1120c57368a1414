"""``methods.yaml``: printed Newton-Euler equations, each with the intermediate vectors of the recursion put in.

A printed equation is right when it gives, from what the recursion knows at that step, what the recursion computes; it
must do so for every link of some arms with revolute and prismatic joints, odd twists and full inertia tensors.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator, Mapping
from functools import cache
from typing import Any

import numpy as np

from derive.mechanics.floats import FloatDomain
from derive.mechanics.printed_newton_euler import LinkStep, PrintedRecursion, newton_euler_base, newton_euler_link
from derive.robot.robot import Robot
from tests.lectures.results import Result, document, is_counted
from tests.lectures.vector_formula import vector_value

METHODS = document("methods.yaml")
SETS: Mapping[str, Callable[..., PrintedRecursion[float]]] = {
    "newton_euler_base": newton_euler_base,
    "newton_euler_link": newton_euler_link,
}
Values = dict[str, Any]


@cache
def method_results(name: str) -> tuple[Result, ...]:
    """The equations of one set."""
    return tuple(_equation(name, item) for item in METHODS[name])


def _equation(name: str, item: Mapping[str, Any]) -> Result:
    correct = item.get("correct")
    return Result(
        entry=f"{name} {item['id']} ({item['joint']})",
        item=f"{name} {item['id']} {item['joint']}",
        ok=item["status"] == "ok",
        equal=_holds(name, item, item["printed"]),
        corrected=None if correct is None else _holds(name, item, correct),
        counted=is_counted(item),
    )


def variants() -> Iterator[tuple[str, bool]]:
    """Each single slip of an equation with two, and whether it would still hold."""
    for name in SETS:
        for item in METHODS[name]:
            for text in item.get("variants", ()):
                yield f"{name} {item['id']}: {text}", _holds(name, item, text)


def _holds(name: str, item: Mapping[str, Any], text: str) -> bool:
    cases = [values for values in known_values(name) if item["joint"] in ("any", values["joint"])]
    assert cases
    name_of_result = item["result"]
    return all(np.allclose(vector_value(text, case), case["result"][name_of_result], atol=1e-10) for case in cases)


@cache
def known_values(name: str) -> tuple[Values, ...]:
    """For every link of the arms, the names of the equations of one set and what they stand for."""
    return tuple(
        values
        for robot in arms()
        for recursion in [recursion_of(name, robot)]
        for i in range(robot.n)
        for values in [_values(recursion.links, i)]
    )


def _values(links: tuple[LinkStep[float], ...], i: int) -> Values:
    step = links[i]
    data, previous, motion = step.data, step.previous, step.motion
    rotation, before = np.array(data.rotation), np.array(data.before)
    after = np.array(links[i + 1].data.before).T if i + 1 < len(links) else np.eye(3)
    z0 = np.array([0.0, 0.0, 1.0])
    found = {"w": motion.w, "wd": motion.wd, "vd": motion.vd, "a": step.a, "F": step.F, "N": step.N}
    found |= {"f": step.wrench.f, "n": step.wrench.n, "tau": step.tau}
    known = {"w_prev": previous.w, "wd_prev": previous.wd, "vd_prev": previous.vd, "v_prev": previous.v}
    known |= {"v": motion.v, "p": data.p, "s": data.s, "m": data.mass, "I": data.inertia, "b": data.viscous}
    known |= {"qd": data.qd, "qdd": data.qdd, "f_next": step.following.f, "n_next": step.following.n}
    frames = {"Rp": before, "Rn": after, "R0": rotation.T, "z0": z0, "z_prev": rotation @ before @ z0}
    arrays = {key: np.array(value) for key, value in {**found, **known}.items()}
    return {
        **arrays,
        **frames,
        "p_in_next": after.T @ arrays["p"],
        "joint": "revolute" if data.revolute else "prismatic",
        "result": {key: arrays[key] for key in found},
    }


def recursion_of(name: str, robot: Robot) -> PrintedRecursion[float]:
    rng = random.Random(robot.name)
    q, qd, qdd = ([rng.uniform(-1.5, 1.5) for _ in range(robot.n)] for _ in range(3))
    return SETS[name](robot, FloatDomain(robot, q), qd, qdd)


@cache
def arms() -> tuple[Robot, ...]:
    return arm("rpr", 1), arm("rrp", 2), arm("prrpr", 3)


def arm(types: str, seed: int) -> Robot:
    """A numeric arm with odd twists, full inertia tensors and viscous friction."""
    rng = random.Random(seed)

    def cell(scale: float = 1.0) -> float:
        return round(rng.uniform(0.2, 1.2) * scale, 3)

    lines = [f"name: arm-{types}", "convention: standard", "joints:"]
    for letter in types:
        own = {"r": "d", "p": "theta"}[letter]
        kind = {"r": "revolute", "p": "prismatic"}[letter]
        lines.append(f"  - {{type: {kind}, {own}: {cell()}, a: {cell()}, alpha: {cell()}}}")
    lines += ["gravity: [0, 0, -9.8062]", "links:"]
    for _ in types:
        moments = ", ".join(f"{axes}: {2 + cell()}" for axes in ("xx", "yy", "zz"))
        tensor = moments + "".join(f", {axes}: {cell(0.1)}" for axes in ("xy", "xz", "yz"))
        body = f"mass: {cell()}, com: [{cell()}, {cell()}, {cell()}], inertia: {{{tensor}}}"
        lines.append(f"  - {{{body}, friction: {{viscous: {cell()}}}}}")
    return Robot.from_text("\n".join(lines) + "\n")
