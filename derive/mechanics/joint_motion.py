"""Vectors and bodies between neighbouring joint frames.

The constant part and the turn about z are applied one after the other: for a twist that is a multiple of pi/2 a vector
costs four multiplications and two additions this way, half of a full matrix product.
"""

from __future__ import annotations

from collections.abc import Sequence

from derive.mechanics.chain import Body, Chain, ChainJoint
from derive.mechanics.vectors import (
    Frame,
    Matrix,
    S,
    Symmetric,
    Vector,
    add,
    column,
    from_matrix,
    matmul,
    multiply,
    scale,
    transpose,
)


def rates(chain: Chain[S], values: Sequence[S]) -> list[S]:
    """Rates positive about +z from derivatives of the joint variables: sign_i * value_i."""
    return [value if joint.sign > 0 else -value for joint, value in zip(chain.joints, values, strict=True)]


def to_child(joint: ChainJoint[S], v: Vector[S]) -> Vector[S]:
    """A vector of joint frame i-1 in the axes of joint frame i."""
    x, y, z = multiply(transpose(joint.fixed.rotation), v)
    c, s = joint.cosine, joint.sine
    return (c * x + s * y, c * y - s * x, z)


def to_parent(joint: ChainJoint[S], v: Vector[S]) -> Vector[S]:
    """A vector of joint frame i in the axes of joint frame i-1."""
    x, y, z = v
    c, s = joint.cosine, joint.sine
    return multiply(joint.fixed.rotation, (c * x - s * y, s * x + c * y, z))


def angular_velocities(chain: Chain[S], speed: Sequence[S]) -> list[Vector[S]]:
    """Of the base and of links 1..n, in their joint frames."""
    omegas: list[Vector[S]] = [(chain.zero, chain.zero, chain.zero)]
    for joint, rate in zip(chain.joints, speed, strict=True):
        x, y, z = to_child(joint, omegas[-1])
        omegas.append((x, y, z + rate if joint.revolute else z))
    return omegas


def axis(joint: ChainJoint[S]) -> Vector[S]:
    """The joint's axis z_i in joint frame i-1; constant."""
    return column(joint.fixed.rotation, 2)


def origin(joint: ChainJoint[S]) -> Vector[S]:
    """The origin of joint frame i in joint frame i-1; constant for a revolute joint."""
    return add(joint.fixed.position, scale(joint.offset, axis(joint)))


def advance(pose: Frame[S], joint: ChainJoint[S]) -> Frame[S]:
    """The pose of joint frame i from that of joint frame i-1."""
    fixed = Frame(matmul(pose.rotation, joint.fixed.rotation), pose.position)
    moved = add(pose.position, multiply(pose.rotation, joint.fixed.position))
    moved = add(moved, scale(joint.offset, column(fixed.rotation, 2)))
    c, s = joint.cosine, joint.sine
    rows = [(c * x + s * y, c * y - s * x, z) for x, y, z in fixed.rotation]
    return Frame((rows[0], rows[1], rows[2]), moved)


def turn_about_z(c: S, s: S, tensor: Symmetric[S]) -> Symmetric[S]:
    """Rot(z) I Rot(z)^T in eight multiplications and eight additions, using s^2 + c^2 = 1."""
    w = s * (tensor.xx - tensor.yy) + c * (tensor.xy + tensor.xy)
    return Symmetric(
        tensor.xx - s * w,
        tensor.yy + s * w,
        tensor.zz,
        c * w - tensor.xy,
        c * tensor.xz - s * tensor.yz,
        s * tensor.xz + c * tensor.yz,
    )


def turn_matrix(c: S, s: S, m: Matrix[S]) -> Matrix[S]:
    """Rot(z) E Rot(z)^T, using s^2 + c^2 = 1."""
    w = s * (m[0][0] - m[1][1]) + c * (m[0][1] + m[1][0])
    right = (c * m[0][2] - s * m[1][2], s * m[0][2] + c * m[1][2])
    below = (c * m[2][0] - s * m[2][1], s * m[2][0] + c * m[2][1])
    return (
        (m[0][0] - s * w, c * w - m[1][0], right[0]),
        (c * w - m[0][1], m[1][1] + s * w, right[1]),
        (below[0], below[1], m[2][2]),
    )


def turn_tensor(rotation: Matrix[S], tensor: Symmetric[S]) -> Symmetric[S]:
    """R I R^T."""
    return from_matrix(matmul(matmul(rotation, tensor.matrix), transpose(rotation)))


def shift(mass: S, moment: Vector[S], tensor: Symmetric[S], p: Vector[S]) -> Symmetric[S]:
    """Inertia about a point from which the old one is seen at ``p``; ``moment`` is the first moment about the old one.

    The second moments grow by h p^T + p h^T + m p p^T; the terms of h and of m p go together, but for the products of
    h on the diagonal, which the moments of a force -h and the like need as well.
    """
    moved = add(moment, scale(mass, p))
    a, b, c = (moment[k] * p[k] + moved[k] * p[k] for k in range(3))
    return Symmetric(
        tensor.xx + (b + c),
        tensor.yy + (a + c),
        tensor.zz + (a + b),
        tensor.xy - (moved[0] * p[1] + moment[1] * p[0]),
        tensor.xz - (moved[0] * p[2] + moment[2] * p[0]),
        tensor.yz - (moved[1] * p[2] + moment[2] * p[1]),
    )


def body_to_parent(joint: ChainJoint[S], body: Body[S]) -> Body[S]:
    """A body of joint frame i by its parameters in joint frame i-1."""
    p = origin(joint)
    moment = to_parent(joint, body.first_moment)
    tensor = turn_tensor(joint.fixed.rotation, turn_about_z(joint.cosine, joint.sine, body.inertia))
    moved = shift(body.mass, moment, tensor, p)
    return Body(body.mass, add(moment, scale(body.mass, p)), moved)


def composite_bodies(chain: Chain[S]) -> list[Body[S]]:
    """For each joint, all that moves when it alone moves, in its joint frame."""
    bodies = list(chain.bodies)
    for i in range(chain.n - 1, 0, -1):
        bodies[i - 1] = bodies[i - 1] + body_to_parent(chain.joints[i], bodies[i])
    return bodies


def work(joint: ChainJoint[S], force: Vector[S], moment: Vector[S]) -> S:
    """The component of a wrench (at the joint frame's origin) along the joint's motion."""
    return moment[2] if joint.revolute else force[2]
