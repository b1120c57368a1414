"""Random arms with bodies of all kinds, some of which exist, with motors, armatures and slides."""

from __future__ import annotations

import numpy as np

from derive.robot.robot import Robot


def random_arm(seed: int, *, motors: bool = False) -> Robot:
    """An arm of 2 to 7 joints; the bodies are clouds of points, flat ones, rods and points, and published ones.

    Args:
        seed: Of the random numbers.
        motors: Whether rotors turn in the links.
    """
    random = np.random.default_rng(seed)
    n = int(random.integers(2, 8))
    rows, links = [], []
    for i in range(1, n + 1):
        slides = random.random() < 0.2
        alpha = random.choice(["0", "pi/2", "-pi/2", "0.7", "-1.1"])
        cells = f"d: {random.integers(0, 4) / 10}" if not slides else f"theta: {random.choice(['0', 'pi/2', '0.4'])}"
        sign = random.choice(["", "-"])
        moving = f"d: {sign}q{i}" if slides else f"theta: {sign}q{i}"
        kind = "prismatic" if slides else "revolute"
        rows.append(f"  - {{type: {kind}, {moving}, {cells}, a: {random.integers(0, 4) / 10}, alpha: {alpha}}}")
        links.append(_link(random, motors))
    convention = random.choice(["standard", "modified"])
    head = [f"name: random-{seed}", f"convention: {convention}", "joints:", *rows, "gravity: [0, 0, -9.81]", "links:"]
    return Robot.from_text("\n".join([*head, *links]) + "\n")


def _link(random: np.random.Generator, motors: bool) -> str:
    """A cloud of four to one points, so a body, a plate, a rod or a point; some tensors are off as published ones."""
    count = int(random.choice([4, 4, 4, 4, 3, 2, 1]))
    mass = round(float(random.uniform(0.2, 4)), 3)
    points = random.normal(size=(count, 3)) * 0.1
    away = points - points.mean(axis=0)
    second = mass * away.T @ away / count
    tensor = np.trace(second) * np.eye(3) - second
    if random.random() < 0.35:  # what a torque does not notice, mostly
        tensor = np.diag(np.diag(tensor)) + np.diag([*random.uniform(-0.4, 0.4, 1), *[0.0] * 2]) * tensor.max()
    entries = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
    digits = int(random.choice([4, 6, 9, 17]))
    cells = ", ".join(f"{'xyz'[i]}{'xyz'[j]}: {tensor[i, j]:.{digits}g}" for i, j in entries)
    com = ", ".join(f"{c:.4f}" for c in points.mean(axis=0))
    rotor = (
        f"{random.uniform(0, 0.3):.3f}, inertia: {random.uniform(1, 20) * 1e-5:.3g}, ratio: {random.integers(-90, 91)}"
    )
    more = f", motor: {{mass: {rotor}}}" if motors else f", armature: {random.uniform(0, 0.2):.3f}"
    return f"  - {{mass: {mass}, com: [{com}], inertia: {{{cells}}}{more}}}"
