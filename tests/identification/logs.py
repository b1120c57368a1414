"""Logs of simulated robots: sums of sines, and torques by the oracle, which shares no code with identification."""

from dataclasses import replace

import numpy as np

from derive.api.robots import load
from derive.arrays import Array
from derive.robot.evaluate import to_float
from derive.robot.expression import Expression, number
from derive.robot.robot import Robot
from derive.verification.oracle.functions import Oracle

Columns = dict[str, Array]


def otherwise(robot: Robot, seed: int = 1, by: float = 0.1) -> Robot:
    """A robot whose masses, centres of mass and friction are others, as a real one's are."""
    random = np.random.default_rng(seed)

    def near(cell: Expression) -> Expression:
        return number(f"{to_float(cell, {}) * (1 + by * random.normal()):.9f}")

    links = []
    for link in robot.links:
        x, y, z = map(near, link.com)
        dry = number(f"{abs(random.normal()):.3f}")
        links.append(replace(link, mass=near(link.mass), com=(x, y, z), viscous=near(link.viscous), coulomb=dry))
    return replace(robot, links=tuple(links))


def states(n: int, rows: int, rate: float, seed: int = 0) -> tuple[Array, Array, Array, Array]:
    """Times [s], and positions, speeds and accelerations, (rows, n) each."""
    random = np.random.default_rng(seed)
    t, q = np.arange(rows) / rate, np.zeros((3, rows, n))
    for k in range(1, 6):
        w, phase = 0.2 * np.pi * k, random.uniform(0, 2 * np.pi, n)
        size = random.normal(1, 0.3, n) / k
        for order in range(3):  # each derivative is a quarter of a turn ahead
            q[order] += size * w**order * np.sin(w * t[:, None] + phase + order * np.pi / 2)
    return t, q[0], q[1], q[2]


def simulated(
    robot: Robot, rows: int = 2000, rate: float = 100.0, noise: float = 0.01, seed: int = 0, still: tuple[int, ...] = ()
) -> tuple[Columns, Array]:
    """A log, and each joint's noise [N m]: a part of its largest torque; some joints, from 0, may stand still."""
    t, q, qd, qdd = states(robot.n, rows, rate, seed)
    for j in still:
        q[:, j], qd[:, j], qdd[:, j] = 0.3, 0.0, 0.0
    tau = Oracle.of(robot).evaluate("inverse_dynamics", q, qd, qdd)
    sizes = noise * np.abs(tau).max(axis=0)
    tau = tau + np.random.default_rng(seed + 100).normal(size=tau.shape) * sizes
    named = {"q": q, "qd": qd, "qdd": qdd, "tau": tau}
    columns = {f"{name}{j + 1}": values[:, j] for name, values in named.items() for j in range(robot.n)}
    return {"time": t} | columns, sizes


PUMA = load("puma560-corke", remarks_on_bodies=False)
REAL = otherwise(PUMA)
