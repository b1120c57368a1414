"""Vectors, tensors and bodies between neighbouring joint frames.

The constant part and the turn about z are applied one after the other: for a twist that is a multiple of pi/2 a vector
costs four multiplications and two additions this way, half of a full matrix product.
"""

from collections.abc import Sequence

from derive.mechanics import vectors
from derive.mechanics.chain import Body, Chain, ChainJoint
from derive.mechanics.vectors import Frame, Matrix, S, Symmetric, Vector, add, column, conjugate, multiply, scale


def along_axes(chain: Chain[S], values: Sequence[S]) -> list[S]:
    """Derivatives of the joint variables counted positive about (along) +z of the joints: sign_i * value_i."""
    return [value if joint.sign > 0 else -value for joint, value in zip(chain.joints, values, strict=True)]


def to_child(joint: ChainJoint[S], v: Vector[S]) -> Vector[S]:
    """A vector of joint frame i-1 in the axes of joint frame i."""
    x, y, z = multiply(vectors.transpose(joint.fixed.rotation), v)
    c, s = joint.cosine, joint.sine
    return (c * x + s * y, c * y - s * x, z)


def to_parent(joint: ChainJoint[S], v: Vector[S]) -> Vector[S]:
    """A vector of joint frame i in the axes of joint frame i-1."""
    return multiply(joint.fixed.rotation, turn_vector(joint.cosine, joint.sine, v))


def axis(joint: ChainJoint[S]) -> Vector[S]:
    """The joint's axis z_i in joint frame i-1; constant."""
    return column(joint.fixed.rotation, 2)


def origin(joint: ChainJoint[S]) -> Vector[S]:
    """The origin of joint frame i in joint frame i-1; constant for a revolute joint."""
    return add(joint.fixed.position, scale(joint.offset, axis(joint)))


def advance(pose: Frame[S], joint: ChainJoint[S]) -> Frame[S]:
    """The pose of joint frame i from that of joint frame i-1."""
    fixed = Frame(vectors.matmul(pose.rotation, joint.fixed.rotation), pose.position)
    moved = add(pose.position, multiply(pose.rotation, joint.fixed.position))
    moved = add(moved, scale(joint.offset, column(fixed.rotation, 2)))
    c, s = joint.cosine, joint.sine
    rows = [(c * x + s * y, c * y - s * x, z) for x, y, z in fixed.rotation]
    return Frame((rows[0], rows[1], rows[2]), moved)


def turn_vector(c: S, s: S, v: Vector[S]) -> Vector[S]:
    """Rot(z) v."""
    return (c * v[0] - s * v[1], s * v[0] + c * v[1], v[2])


def turn_about_z(c: S, s: S, tensor: Symmetric[S]) -> Symmetric[S]:
    """Rot(z) I Rot(z)^T in eight multiplications and eight additions, using s^2 + c^2 = 1."""
    w = s * (tensor.xx - tensor.yy) + c * (tensor.xy + tensor.xy)
    diagonal = (tensor.xx - s * w, tensor.yy + s * w, tensor.zz)
    return Symmetric(*diagonal, c * w - tensor.xy, c * tensor.xz - s * tensor.yz, s * tensor.xz + c * tensor.yz)


def turn_matrix(c: S, s: S, m: Matrix[S]) -> Matrix[S]:
    """Rot(z) M Rot(z)^T, using s^2 + c^2 = 1."""
    w = s * (m[0][0] - m[1][1]) + c * (m[0][1] + m[1][0])
    right = (c * m[0][2] - s * m[1][2], s * m[0][2] + c * m[1][2])
    below = (c * m[2][0] - s * m[2][1], s * m[2][0] + c * m[2][1])
    first = (m[0][0] - s * w, c * w - m[1][0], right[0])
    return first, (c * w - m[0][1], m[1][1] + s * w, right[1]), (below[0], below[1], m[2][2])


def turn_tensor(rotation: Matrix[S], tensor: Symmetric[S]) -> Symmetric[S]:
    """R I R^T."""
    return vectors.from_matrix(conjugate(rotation, tensor.matrix))


def tensor_to_parent(joint: ChainJoint[S], tensor: Symmetric[S]) -> Symmetric[S]:
    """A symmetric tensor of joint frame i in the axes of joint frame i-1."""
    return turn_tensor(joint.fixed.rotation, turn_about_z(joint.cosine, joint.sine, tensor))


def matrix_to_parent(joint: ChainJoint[S], m: Matrix[S]) -> Matrix[S]:
    """A matrix of joint frame i in the axes of joint frame i-1."""
    return conjugate(joint.fixed.rotation, turn_matrix(joint.cosine, joint.sine, m))


def shift(mass: S, moment: Vector[S], tensor: Symmetric[S], p: Vector[S]) -> Symmetric[S]:
    """The inertia tensor of a body about another point.

    The second moments grow by h p^T + p h^T + m p p^T; the terms of h and of m p go together, but for the products of
    h on the diagonal, which the moments of a force -h and the like need as well.
    """
    moved = add(moment, scale(mass, p))
    a, b, c = (moment[k] * p[k] + moved[k] * p[k] for k in range(3))
    diagonal = (tensor.xx + (b + c), tensor.yy + (a + c), tensor.zz + (a + b))
    xy, xz = tensor.xy - (moved[0] * p[1] + moment[1] * p[0]), tensor.xz - (moved[0] * p[2] + moment[2] * p[0])
    return Symmetric(*diagonal, xy, xz, tensor.yz - (moved[1] * p[2] + moment[2] * p[1]))


def body_to_parent(joint: ChainJoint[S], body: Body[S]) -> Body[S]:
    """A body of joint frame i by its parameters in joint frame i-1."""
    p = origin(joint)
    moment = to_parent(joint, body.first_moment)
    moved = shift(body.mass, moment, tensor_to_parent(joint, body.inertia), p)
    return Body(body.mass, add(moment, scale(body.mass, p)), moved)


def generalized_force(joint: ChainJoint[S], force: Vector[S], moment: Vector[S]) -> S:
    """Torque of a revolute joint, force of a prismatic one: the component of a wrench along the joint's motion."""
    return moment[2] if joint.revolute else force[2]
