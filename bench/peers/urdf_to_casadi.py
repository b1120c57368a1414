"""urdf2casadi: CasADi functions from a numeric URDF."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any

from bench.peers import casadi_times
from bench.peers.casadi_programs import Programs, counted, of_motion
from bench.peers.peer import Counted, Peer, Row
from bench.plain_arm import plain_arm
from bench.robots import Array, Case
from bench.urdf import BASE, END, urdf


def programs(case: Case) -> Programs:
    """The quantities that it has."""
    if case.numbers:
        return
    arm = plain_arm(case)
    gravity = [float(v) for v in arm.gravity]
    whole = _parser(urdf(arm))
    makers: dict[str, Callable[[], Any]] = {
        "tau": lambda: whole.get_inverse_dynamics_rnea(BASE, END, gravity=gravity),
        "B": lambda: whole.get_inertia_matrix_crba(BASE, END),
        "g": lambda: whole.get_gravity_rnea(BASE, END, gravity),
        "T": lambda: whole.get_forward_kinematics(BASE, END)["T_fk"],
    }
    for symbol, make in makers.items():
        yield symbol, lambda symbol=symbol, make=make: of_motion(symbol, case.robot.n, make())  # type: ignore[misc]


def _parser(text: str) -> Any:
    from urdf2casadi.urdfparser import URDFparser

    parser = URDFparser()
    parser.from_string(text)
    return parser


def _count(case: Case) -> Iterator[tuple[str, Callable[[], Counted]]]:
    return counted(case, programs(case))


def _time(case: Case, motions: Sequence[Array]) -> Iterator[Row]:
    return casadi_times.rows("urdf2casadi", case, programs(case), motions)


PEER = Peer("urdf2casadi", ("urdf2casadi",), _count, _time)
