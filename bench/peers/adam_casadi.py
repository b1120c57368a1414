"""adam: CasADi functions from a numeric URDF, of a floating base that is held still here."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any

import casadi
import numpy as np

from bench.peers import casadi_times
from bench.peers.casadi_programs import Programs, counted, of_motion
from bench.peers.peer import Counted, Peer, Row
from bench.plain_arm import plain_arm
from bench.robots import Array, Case
from bench.urdf import END, urdf


def programs(case: Case) -> Programs:
    """The quantities that it has; tau = M qdd + h."""
    if case.numbers:
        return
    arm, n = plain_arm(case), case.robot.n
    whole = _computations(urdf(arm), n, np.array([*arm.gravity, 0.0, 0.0, 0.0]))
    still, none = casadi.SX.eye(4), casadi.SX.zeros(6)

    def torque(q: Any, qd: Any, qdd: Any) -> Any:
        bias = whole.bias_force_fun()(still, q, none, qd)
        return casadi.mtimes(whole.mass_matrix_fun()(still, q)[6:, 6:], qdd) + bias[6:]

    makers: dict[str, Callable[..., Any]] = {
        "tau": torque,
        "B": lambda q: whole.mass_matrix_fun()(still, q)[6:, 6:],
        "g": lambda q: whole.gravity_term_fun()(still, q)[6:],
        "T": lambda q: whole.forward_kinematics_fun(END)(still, q),
        "J": lambda q: whole.jacobian_fun(END)(still, q)[:, 6:],
    }
    for symbol, make in makers.items():
        yield symbol, lambda symbol=symbol, make=make: of_motion(symbol, n, make)  # type: ignore[misc]


def _computations(text: str, joints: int, gravity: Any) -> Any:
    from adam import Representations
    from adam.casadi import KinDynComputations

    whole = KinDynComputations(text, [f"q{i + 1}" for i in range(joints)], gravity=gravity)
    whole.set_frame_velocity_representation(Representations.MIXED_REPRESENTATION)
    return whole


def _count(case: Case) -> Iterator[tuple[str, Callable[[], Counted]]]:
    return counted(case, programs(case))


def _time(case: Case, motions: Sequence[Array]) -> Iterator[Row]:
    return casadi_times.rows("adam", case, programs(case), motions)


PEER = Peer("adam", ("adam", "liecasadi"), _count, _time)
