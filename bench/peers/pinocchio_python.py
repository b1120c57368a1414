"""Pinocchio from Python, one call per configuration: it has no functions of batches."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np

from bench.peers.passes import one_by_one
from bench.peers.peer import Peer, Row, Timed
from bench.plain_arm import PlainArm, plain_arm
from bench.quantities import BY_SYMBOL, arguments
from bench.robots import Array, Case

ONE, LOOP = "Pinocchio, Python", "Pinocchio, Python loop"
_LOOP = 2_000


def build(arm: PlainArm) -> tuple[Any, int]:
    """The model, and the index of the end effector's frame."""
    import pinocchio as pin

    model, joint = pin.Model(), 0
    model.gravity.linear = arm.gravity
    for i, entry in enumerate(arm.joints):
        axis = np.array([0.0, 0.0, entry.sign])
        aligned = pin.JointModelRZ() if entry.revolute else pin.JointModelPZ()
        turned = pin.JointModelRevoluteUnaligned(axis) if entry.revolute else pin.JointModelPrismaticUnaligned(axis)
        placement = pin.SE3(entry.placement)
        joint = model.addJoint(joint, aligned if entry.sign > 0 else turned, placement, f"q{i + 1}")
        model.appendBodyToJoint(joint, pin.Inertia(entry.mass, entry.com, entry.inertia), pin.SE3.Identity())
    frame = pin.Frame("end", joint, 0, pin.SE3(arm.end), pin.FrameType.OP_FRAME)
    return model, model.addFrame(frame)


def calls(case: Case) -> dict[str, tuple[Callable[..., Any], Callable[..., Array]]]:
    """By quantity: what is timed, and the same with its result as an array."""
    import pinocchio as pin

    model, end = build(plain_arm(case))
    data = model.createData()

    def pose(q: Array) -> Array:
        pin.framesForwardKinematics(model, data, q)
        return np.asarray(data.oMf[end].homogeneous)

    def full(q: Array) -> Array:
        upper = np.triu(pin.crba(model, data, q))
        return np.asarray(upper + np.triu(upper, 1).T)

    def jacobian(q: Array) -> Array:
        return np.asarray(pin.computeFrameJacobian(model, data, q, end, pin.LOCAL_WORLD_ALIGNED))

    def coriolis(q: Array, qd: Array) -> Array:
        return np.asarray(pin.computeCoriolisMatrix(model, data, q, qd))

    def torque(q: Array, qd: Array, qdd: Array) -> Array:
        return np.asarray(pin.rnea(model, data, q, qd, qdd))

    def gravity(q: Array) -> Array:
        return np.asarray(pin.computeGeneralizedGravity(model, data, q))

    return {
        "tau": (torque, torque),
        "B": (lambda q: pin.crba(model, data, q), full),
        "C": (coriolis, coriolis),
        "g": (gravity, gravity),
        "T": (lambda q: pin.framesForwardKinematics(model, data, q), pose),
        "J": (jacobian, jacobian),
    }


def _time(case: Case, motions: Sequence[Array]) -> Iterator[Row]:
    for symbol, pair in calls(case).items():
        for label, batch, count in ((ONE, False, 100), (LOOP, True, _LOOP)):
            yield Row(
                label,
                symbol,
                batch,
                lambda symbol=symbol, pair=pair, count=count: _timed(case, symbol, pair, motions, count),  # type: ignore[misc]
            )


def _timed(
    case: Case, symbol: str, pair: tuple[Callable[..., Any], Callable[..., Array]], motions: Sequence[Array], count: int
) -> Timed:
    quantity = BY_SYMBOL[symbol]
    inputs, shape = arguments(quantity, tuple(motions)), quantity.shape(case.robot.n)
    run = one_by_one(pair[0], inputs, shape, count)
    return Timed(run.run, run.count, one_by_one(pair[1], inputs, shape, count).values)


PEER = Peer("Pinocchio, Python", ("pinocchio",), time=_time)
