"""Inertial parameters regrouped along the chain (Khalil and Dombre, section 9.4.2.2).

Whatever of a body a joint's motion leaves in place belongs to the body before as well: of a revolute joint the inertia
diag(Iyy, Iyy, 0), the first moment along z and the mass; of a prismatic joint the whole inertia tensor.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from bench.byhand.axis_arm import AxisArm, Body, Rows
from bench.byhand.recursions import carried, joined
from bench.byhand.symbols import Arithmetic
from bench.byhand.vectors import step_of


def regrouped(arm: AxisArm, system: Arithmetic) -> AxisArm:
    """The same dynamics with fewer parameters that are not zero."""
    zero, one = system.number(0.0), system.number(1.0)
    sin, cos = system.functions["sin"], system.functions["cos"]
    bodies = [axis.body for axis in arm.axes]
    for j in reversed(range(1, len(bodies))):
        axis = arm.axes[j]
        bodies[j], invariant = split(bodies[j], axis.revolute, zero)
        turn = (one, zero) if axis.revolute else (cos(axis.theta), sin(axis.theta))
        bodies[j - 1] = joined(bodies[j - 1], carried(step_of(axis, *turn, axis.d), invariant))
    bodies[0], _ = split(bodies[0], arm.axes[0].revolute, zero) if is_upright(arm, system) else (bodies[0], None)
    return arm.with_bodies(bodies)


def split(body: Body, revolute: bool, zero: Any) -> tuple[Body, Body]:
    """What a joint moves, and what it leaves in place."""
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = body.inertia
    none = ((zero, zero, zero),) * 3
    if not revolute:
        return Body(body.mass, body.moment, none), Body(zero, (zero, zero, zero), body.inertia)
    x, y, z = body.moment
    moving: Rows = ((xx - yy, xy, xz), (xy, zero, yz), (xz, yz, zz))
    still: Rows = ((yy, zero, zero), (zero, yy, zero), (zero, zero, zero))
    return Body(zero, (x, y, zero), moving), Body(body.mass, (zero, zero, z), still)


def is_upright(arm: AxisArm, system: Arithmetic) -> bool:
    """Whether gravity is along the first axis, so that nothing of body 1 but its inertia about z acts."""
    x, y, _ = arm.gravity
    first = arm.axes[0]
    straight = all(system.is_number(v) and float(v) == 0 for v in (x, y, first.sin_alpha))
    return straight and first.revolute


def named(arm: AxisArm, system: Arithmetic, record: Callable[[Any, Any], None]) -> AxisArm:
    """Every parameter that is not a number behind a symbol of its own: it is computed once, beforehand.

    Args:
        arm: The robot.
        system: The arithmetic.
        record: Told of each symbol and what it stands for.
    """
    known: dict[str, Any] = {}

    def name(value: Any, label: str) -> Any:
        if system.is_number(value):
            return value
        if str(value) not in known:
            known[str(value)] = system.symbol(label)
            record(known[str(value)], value)
        return known[str(value)]

    bodies = []
    for i, axis in enumerate(arm.axes):
        body = axis.body
        moment = [name(v, f"h{i}_{k}") for k, v in enumerate(body.moment)]
        entries = {(j, k): name(body.inertia[j][k], f"I{i}_{j}{k}") for j in range(3) for k in range(j, 3)}
        rows = [tuple(entries[min(j, k), max(j, k)] for k in range(3)) for j in range(3)]
        bodies.append(Body(name(body.mass, f"m{i}"), (*moment,), (rows[0], rows[1], rows[2])))
    return arm.with_bodies(bodies)
