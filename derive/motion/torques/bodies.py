"""Bodies that an arm carries: their ten numbers, alone and as one body with the last link."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from derive.arrays import Array
from derive.plans.segments import Payload
from derive.robot.description import Inertia
from derive.robot.evaluate import evaluate
from derive.robot.expression import Name
from derive.robot.names import robot_symbols
from derive.robot.robot import Robot

_ENTRIES = {"xx": (0, 0), "yy": (1, 1), "zz": (2, 2), "xy": (0, 1), "xz": (0, 2), "yz": (1, 2)}


@dataclass(frozen=True)
class CarriedBody:
    """A rigid body in the frame of the last link."""

    mass: float  # [kg]
    com: Array  # centre of mass, (3,) [m]
    inertia: Array  # about it, (3, 3) [kg m^2]

    @classmethod
    def payload(cls, robot: Robot, payload: Payload, values: Mapping[str, float]) -> CarriedBody:
        """What the tool carries."""
        tool = np.array([[evaluate(cell, values) for cell in row] for row in robot.tool])
        rotation, place = tool[:3, :3], tool[:3, 3]
        # From the frame of the end effector to that of the last link: r = R r_e + p, I = R I_e R^T.
        com = rotation @ [evaluate(cell, values) for cell in payload.com] + place
        own = np.diag([evaluate(cell, values) for cell in payload.inertia])
        return cls(evaluate(payload.mass, values), com, rotation @ own @ rotation.T)

    @classmethod
    def last_link(cls, robot: Robot, values: Mapping[str, float]) -> CarriedBody:
        """The last link without its motor."""
        link, inertia = robot.links[-1], np.zeros((3, 3))
        for entry, (i, j) in _ENTRIES.items():
            inertia[i, j] = inertia[j, i] = evaluate(getattr(link.inertia, entry), values)
        return cls(evaluate(link.mass, values), np.array([evaluate(cell, values) for cell in link.com]), inertia)

    def about(self, point: Array) -> Array:
        """The inertia about a point in the frame of the last link [m] (Steiner), (3, 3) [kg m^2]."""
        # I_point = I_com + m (r.r 1 - r r^T).
        r = self.com - point
        return self.inertia + self.mass * (r @ r * np.eye(3) - np.outer(r, r))

    def __add__(self, other: CarriedBody) -> CarriedBody:
        """Both as one body."""
        mass = self.mass + other.mass
        com = (self.mass * self.com + other.mass * other.com) / mass if mass else self.com
        return CarriedBody(mass, com, self.about(com) + other.about(com))

    def columns(self, n: int) -> dict[str, float]:
        """Its parameters as the columns of the regressor are named, the inertia about the origin of the frame."""
        # Dynamics are linear in m, m r and the inertia about the origin of the frame (Siciliano et al., 7.2.2).
        parts = {"m": self.mass, **dict(zip(("mx", "my", "mz"), self.mass * self.com, strict=True))}
        inertia = self.about(np.zeros(3))
        parts |= {f"I{entry}": inertia[place] for entry, place in _ENTRIES.items()}
        return {f"{part}{n}": float(value) for part, value in parts.items()}


@dataclass(frozen=True)
class OpenLink:
    """A robot whose last link has symbols instead of numbers, so that what it carries may change."""

    robot: Robot  # with these symbols
    names: tuple[str, ...]  # of mass, centre of mass and inertia about it

    @classmethod
    def of(cls, robot: Robot) -> OpenLink:
        """Open the last link."""
        taken, stem = set(robot_symbols(robot)), "carried"
        while any(name.startswith(stem) for name in taken):
            stem += "_"
        names = [f"{stem}{part}" for part in ("m", "x", "y", "z", *_ENTRIES)]
        mass, x, y, z, *inertia = map(Name, names)
        link = replace(robot.links[-1], mass=mass, com=(x, y, z), inertia=Inertia(*inertia))
        return cls(replace(robot, links=(*robot.links[:-1], link)), tuple(names))

    def carrying(
        self, robot: Robot, values: Mapping[str, float], payloads: Iterable[Payload | None] = ()
    ) -> dict[str, float]:
        """The numbers of a robot, and those of the symbols for its last link with what the tool carries."""
        body = CarriedBody.last_link(robot, values)
        for payload in filter(None, payloads):
            body += CarriedBody.payload(robot, payload, values)
        entries = [body.inertia[place] for place in _ENTRIES.values()]
        return {**values} | {
            name: float(v) for name, v in zip(self.names, (body.mass, *body.com, *entries), strict=True)
        }
