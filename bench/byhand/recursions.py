"""Newton-Euler, composite bodies and kinematics on joint-axis frames, written once for any arithmetic."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from bench.byhand.axis_arm import AxisArm, Body, Rows, Vector, added
from bench.byhand.symbols import Arithmetic
from bench.byhand.vectors import Step, cross, dot, plus, step_of, times


def steps_of(arm: AxisArm, q: Sequence[Any], system: Arithmetic) -> list[Step]:
    """The steps from axis to axis at a configuration."""
    sin, cos = system.functions["sin"], system.functions["cos"]
    steps = []
    for axis, variable in zip(arm.axes, q, strict=True):
        angle, offset = axis.theta, axis.d
        if axis.revolute:
            angle = angle + axis.sign * variable
        else:
            offset = offset + axis.sign * variable
        steps.append(step_of(axis, cos(angle), sin(angle), offset))
    return steps


def newton_euler(arm: AxisArm, steps: list[Step], qd: Sequence[Any], qdd: Sequence[Any], zero: Any) -> list[Any]:
    """Joint torques (Craig, ch. 6; bodies by first moments and inertia about the frames' origins)."""
    still = (zero, zero, zero)
    w, dw, a = still, still, times(-1, arm.gravity)
    states: list[tuple[Vector, Vector]] = []
    for axis, step, rate, acceleration in zip(arm.axes, steps, qd, qdd, strict=True):
        rate, acceleration = axis.sign * rate, axis.sign * acceleration
        a = step.outwards(plus(a, turning(w, dw, step.place)))
        w, dw = step.outwards(w), step.outwards(dw)
        across = (w[1] * rate, -w[0] * rate, zero)
        if axis.revolute:
            w, dw = plus(w, (zero, zero, rate)), plus(plus(dw, across), (zero, zero, acceleration))
        else:
            a = plus(plus(a, times(2, across)), (zero, zero, acceleration))
        states.append(wrench(axis.body, w, dw, a))
    return inwards(arm, steps, states)


def turning(w: Vector, dw: Vector, r: Vector) -> Vector:
    """(dw^ + w^ w^) r as one matrix, whose entries are shared by all vectors r of a body."""
    xy, xz, yz = w[0] * w[1], w[0] * w[2], w[1] * w[2]
    xx, yy, zz = w[0] * w[0], w[1] * w[1], w[2] * w[2]
    return (
        -(yy + zz) * r[0] + (xy - dw[2]) * r[1] + (xz + dw[1]) * r[2],
        (xy + dw[2]) * r[0] - (xx + zz) * r[1] + (yz - dw[0]) * r[2],
        (xz - dw[1]) * r[0] + (yz + dw[0]) * r[1] - (xx + yy) * r[2],
    )


def wrench(body: Body, w: Vector, dw: Vector, a: Vector) -> tuple[Vector, Vector]:
    """Force and moment that move a body."""
    force = plus(times(body.mass, a), turning(w, dw, body.moment))
    spin, rise = ((dot(body.inertia[0], v), dot(body.inertia[1], v), dot(body.inertia[2], v)) for v in (w, dw))
    return force, plus(plus(rise, cross(w, spin)), cross(body.moment, a))


def inwards(arm: AxisArm, steps: list[Step], wrenches: list[tuple[Vector, Vector]]) -> list[Any]:
    """Torques from the wrenches on the bodies."""
    torques: list[Any] = []
    carried: tuple[Vector, Vector] | None = None
    for i in reversed(range(len(steps))):
        force, moment = wrenches[i]
        if carried is not None:
            force, moment = plus(force, carried[0]), plus(moment, carried[1])
        torques.append(arm.axes[i].sign * (moment if arm.axes[i].revolute else force)[2])
        carried = moved(steps[i], force, moment)
    return torques[::-1]


def moved(step: Step, force: Vector, moment: Vector) -> tuple[Vector, Vector]:
    """A wrench about the origin before."""
    force = step.inwards(force)
    return force, plus(step.inwards(moment), cross(step.place, force))


def gravity_torques(arm: AxisArm, steps: list[Step]) -> list[Any]:
    """Torques that hold the arm at rest."""
    a, states = times(-1, arm.gravity), []
    for axis, step in zip(arm.axes, steps, strict=True):
        a = step.outwards(a)
        states.append((times(axis.body.mass, a), cross(axis.body.moment, a)))
    return inwards(arm, steps, states)


def inertia_matrix(arm: AxisArm, steps: list[Step], zero: Any) -> list[list[Any]]:
    """B by composite bodies (Walker and Orin 1982; Featherstone, ch. 6)."""
    n = len(steps)
    matrix = [[zero] * n for _ in range(n)]
    composite: Body | None = None
    for j in reversed(range(n)):
        own = arm.axes[j].body
        composite = own if composite is None else joined(own, carried(steps[j + 1], composite))
        force, moment = unit_wrench(composite, arm.axes[j].revolute, zero)
        for i in range(j, -1, -1):
            entry = (moment if arm.axes[i].revolute else force)[2]
            matrix[i][j] = matrix[j][i] = arm.axes[i].sign * arm.axes[j].sign * entry
            force, moment = moved(steps[i], force, moment)
    return matrix


def unit_wrench(body: Body, revolute: bool, zero: Any) -> tuple[Vector, Vector]:
    """What accelerates a body at rest by one unit about or along z."""
    x, y, _ = body.moment
    if revolute:
        return (-y, x, zero), (body.inertia[0][2], body.inertia[1][2], body.inertia[2][2])
    return (zero, zero, body.mass), (y, -x, zero)


def carried(step: Step, body: Body) -> Body:
    """A body's parameters in the frame before."""
    moment, p = step.inwards(body.moment), step.place
    shifted = plus(moment, times(body.mass, p))
    columns = [step.inwards(row) for row in body.inertia]
    rows = [step.inwards(column) for column in zip(*columns, strict=True)]
    trace = dot(p, plus(moment, shifted))
    out = [[(trace if i == j else 0) - p[i] * moment[j] - shifted[i] * p[j] for j in range(3)] for i in range(3)]
    return Body(body.mass, shifted, symmetric(added((rows[0], rows[1], rows[2]), (*map(tuple, out),))))


def symmetric(rows: Rows) -> Rows:
    """The upper half of a symmetric tensor, mirrored."""
    return rows[0], (rows[0][1], *rows[1][1:]), (rows[0][2], rows[1][2], rows[2][2])


def joined(x: Body, y: Body) -> Body:
    """Two bodies as one."""
    return Body(x.mass + y.mass, plus(x.moment, y.moment), added(x.inertia, y.inertia))


def poses(arm: AxisArm, steps: list[Step], system: Arithmetic) -> list[tuple[Vector, Vector, Vector, Vector]]:
    """Axes x, y, z and origin of every frame in the base, the end effector last."""
    zero, one = system.number(0.0), system.number(1.0)
    end = Step(arm.end[0], arm.end[1], one, zero, (arm.end[2], zero, zero))
    x, y, z, p = (one, zero, zero), (zero, one, zero), (zero, zero, one), (zero, zero, zero)
    found = []
    for step in (*steps, end):
        a, b, c = step.place
        p = plus(p, plus(times(a, x), plus(times(b, y), times(c, z))))
        y, z = (
            plus(times(step.cos_alpha, y), times(step.sin_alpha, z)),
            plus(times(step.cos_alpha, z), times(-step.sin_alpha, y)),
        )
        x, y = plus(times(step.cos, x), times(step.sin, y)), plus(times(step.cos, y), times(-step.sin, x))
        found.append((x, y, z, p))
    return found


def transform(found: list[tuple[Vector, Vector, Vector, Vector]], system: Arithmetic) -> list[list[Any]]:
    """T of the end effector."""
    zero, one = system.number(0.0), system.number(1.0)
    x, y, z, p = found[-1]
    return [[x[i], y[i], z[i], p[i]] for i in range(3)] + [[zero, zero, zero, one]]


def jacobian(arm: AxisArm, found: list[tuple[Vector, Vector, Vector, Vector]], zero: Any) -> list[list[Any]]:
    """The geometric Jacobian, linear rows first."""
    columns = []
    end = found[-1][3]
    for axis, (_, _, z, p) in zip(arm.axes, found[:-1], strict=True):
        z = times(axis.sign, z)
        arm_of_force = plus(end, times(-1, p))
        columns.append((*cross(z, arm_of_force), *z) if axis.revolute else (*z, zero, zero, zero))
    return [list(row) for row in zip(*columns, strict=True)]
