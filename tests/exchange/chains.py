"""Random chains whose axes are parallel, meet, coincide or slide, as URDFs."""

from __future__ import annotations

import random

from tests.exchange.urdfs import HALF, PI, J, body, urdf

ANGLES = ("0", "0", HALF, f"-{HALF}", PI, "0.7853981633974483", "1.57", "1.5707", "-2.1", "0.003", "1.570796")
LENGTHS = ("0", "0", "0", "0.3", "-0.25", "0.4318", "1e-10", "0.001")
AXES = ("0 0 1", "0 0 1", "0 0 -1", "0 1 0", "-1 0 0", "1 1 0", "0.1 0.2 -2")
TYPES = ("revolute", "revolute", "revolute", "prismatic", "continuous")


def random_chain(seed: int) -> tuple[str, list[str]]:
    """A URDF of one to seven joints that move, and their names in the order of the chain."""
    source = random.Random(seed)

    def triple(words: tuple[str, ...], most: float) -> str:
        if source.random() < 0.15:
            return " ".join(repr(round(source.uniform(-most, most), 6)) for _ in range(3))
        return " ".join(source.choice(words) for _ in range(3))

    joints = []
    for _ in range(source.randint(1, 7)):
        if source.random() < 0.3:
            joints.append(J(triple(LENGTHS, 0.5), triple(ANGLES, 3.0), type="fixed", inertial=_body(source)))
        kind, axis = source.choice(TYPES), source.choice(AXES)
        limit = 'lower="-0.5" upper="0.8" effort="10" velocity="1"' if kind != "continuous" else ""
        joints.append(J(triple(LENGTHS, 0.5), triple(ANGLES, 3.0), axis, kind, limit, _body(source)))
    joints.append(J(triple(LENGTHS, 0.5), triple(ANGLES, 3.0), type="fixed"))
    return urdf(joints), [f"j{k}" for k, joint in enumerate(joints, 1) if joint.type != "fixed"]


def _body(source: random.Random) -> tuple[str, str, str, str] | None:
    """A body, or none; its principal moments are those of some box."""
    if source.random() < 0.3:
        return None
    a, b, c = (source.uniform(0.01, 0.3) ** 2 for _ in range(3))
    centre = " ".join(f"{source.uniform(-0.2, 0.2):.4f}" for _ in range(3))
    return body(f"{source.uniform(0.1, 5):.3f}", centre, "0.3 0 -1", f"{b + c!r} {a + c!r} {a + b!r} 0 0 0")
