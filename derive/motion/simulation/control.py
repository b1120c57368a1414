"""Control laws: from where an arm is and should be to the torques of its motors.

Siciliano et al., Robotics, 2009: 8.5.1 (PD with gravity), 8.5.2 (computed torque, there inverse dynamics).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from derive.arrays import Array
from derive.motion.torques.functions import Functions

# Position, velocity and acceleration that are wanted at a time.
Reference = Callable[[float], tuple[Array, Array, Array]]


def looked_up(reference: Callable[[Array], tuple[Array, Array, Array]], period: float, duration: float) -> Reference:
    """What is wanted at the looks of a sampled controller, computed for all of them at once.

    Args:
        period: Time between two looks [s].
        duration: How long the motion lasts [s].
    """
    q, qd, qdd = reference(period * np.arange(np.ceil(duration / period) + 1))

    def _at(t: float) -> tuple[Array, Array, Array]:
        k = round(t / period)
        return q[k], qd[k], qdd[k]

    return _at


# Generated functions of each law.
NEEDS: dict[str, frozenset[str]] = {
    "none": frozenset(),
    "pd": frozenset(),
    "pd-gravity": frozenset({"gravity_vector"}),
    "computed-torque": frozenset({"inverse_dynamics"}),
}


@dataclass(frozen=True)
class Controller:
    """A control law with its gains."""

    law: str  # one of `NEEDS`
    kp: Array  # gains of the position, (n,)
    kd: Array  # gains of the velocity, (n,)
    reference: Reference  # what is wanted
    # The model that the controller knows, without dry friction; None where the law needs none.
    functions: Functions | None
    # What that model says that a base that moves adds; None where it stands.
    inertial: Callable[[float, Array, Array], Array] | None = None

    def __call__(self, t: float, q: Array, qd: Array) -> Array:
        """Torques of the motors.

            pd               tau = Kp e + Kd de/dt
            pd-gravity       tau = Kp e + Kd de/dt + g(q)
            computed-torque  tau = B(q) (qdd_d + Kd de/dt + Kp e) + C(q, qd) qd + g(q)

        Returns:
            tau, (n,) [N m or N].
        """
        if self.law == "none":
            return np.zeros(q.size)
        wanted, velocity, acceleration = self.reference(t)
        tau: Array = self.kp * (wanted - q) + self.kd * (velocity - qd)
        if self.functions is None:
            return tau
        inertial = 0.0 if self.inertial is None else self.inertial(t, q, qd)
        if self.law == "pd-gravity":
            return tau + self.functions("gravity_vector", q) + inertial
        return self.functions("inverse_dynamics", q, qd, acceleration + tau) + inertial
