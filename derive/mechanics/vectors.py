"""Three-vectors and frames over any scalar type: exact polynomials, tape nodes or floats."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Generic, Protocol, Self, TypeVar


class Scalar(Protocol):
    """What a scalar must be able to do; ints mix in on either side."""

    def __add__(self, other: Any, /) -> Self: ...
    def __radd__(self, other: Any, /) -> Self: ...
    def __sub__(self, other: Any, /) -> Self: ...
    def __rsub__(self, other: Any, /) -> Self: ...
    def __mul__(self, other: Any, /) -> Self: ...
    def __rmul__(self, other: Any, /) -> Self: ...
    def __neg__(self) -> Self: ...


S = TypeVar("S", bound=Scalar)

Vector = tuple[S, S, S]
Matrix = tuple[Vector[S], Vector[S], Vector[S]]
UPPER = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))  # places of the entries of a symmetric tensor


def add(a: Vector[S], b: Vector[S]) -> Vector[S]:
    """a + b."""
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


def subtract(a: Vector[S], b: Vector[S]) -> Vector[S]:
    """a - b."""
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def scale(factor: Any, a: Vector[S]) -> Vector[S]:
    """factor * a."""
    return (factor * a[0], factor * a[1], factor * a[2])


def dot(a: Vector[S], b: Vector[S]) -> S:
    """a . b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Vector[S], b: Vector[S]) -> Vector[S]:
    """a x b."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def multiply(m: Matrix[S], v: Vector[S]) -> Vector[S]:
    """m v."""
    return (dot(m[0], v), dot(m[1], v), dot(m[2], v))


def transpose(m: Matrix[S]) -> Matrix[S]:
    """The transpose of m."""
    return (column(m, 0), column(m, 1), column(m, 2))


def column(m: Matrix[S], j: int) -> Vector[S]:
    """Column j of m."""
    return (m[0][j], m[1][j], m[2][j])


def identity(zero: S, one: S) -> Matrix[S]:
    """The unit matrix."""
    return ((one, zero, zero), (zero, one, zero), (zero, zero, one))


def about_axis(axis: int, c: S, s: S, zero: S, one: S) -> Matrix[S]:
    """The rotation about the x, y or z axis, 0 to 2, by an angle with a cosine and a sine."""
    return (
        ((one, zero, zero), (zero, c, -s), (zero, s, c)),
        ((c, zero, s), (zero, one, zero), (-s, zero, c)),
        ((c, -s, zero), (s, c, zero), (zero, zero, one)),
    )[axis]


def matmul(a: Matrix[S], b: Matrix[S]) -> Matrix[S]:
    """a b."""
    x, y, z = (multiply(a, column(b, j)) for j in range(3))
    return transpose((x, y, z))


def add_matrices(a: Matrix[S], b: Matrix[S]) -> Matrix[S]:
    """a + b."""
    return (add(a[0], b[0]), add(a[1], b[1]), add(a[2], b[2]))


def conjugate(rotation: Matrix[S], m: Matrix[S]) -> Matrix[S]:
    """R m R^T: what m is in axes that are turned by R."""
    return matmul(matmul(rotation, m), transpose(rotation))


def outer(a: Vector[S], b: Vector[S]) -> Matrix[S]:
    """a b^T."""
    return (scale(a[0], b), scale(a[1], b), scale(a[2], b))


def hat(u: Vector[S], zero: S) -> Matrix[S]:
    """The skew-symmetric matrix u^ of the product u x."""
    return ((zero, -u[2], u[1]), (u[2], zero, -u[0]), (-u[1], u[0], zero))


@dataclass(frozen=True, slots=True)
class Symmetric(Generic[S]):
    """A symmetric 3x3 tensor by its six entries."""

    xx: S
    yy: S
    zz: S
    xy: S
    xz: S
    yz: S

    @property
    def matrix(self) -> Matrix[S]:
        """All nine entries."""
        return ((self.xx, self.xy, self.xz), (self.xy, self.yy, self.yz), (self.xz, self.yz, self.zz))

    def __add__(self, other: Symmetric[S]) -> Symmetric[S]:
        a, b = self.matrix, other.matrix
        return Symmetric(*(a[i][j] + b[i][j] for i, j in UPPER))


def from_matrix(m: Matrix[S]) -> Symmetric[S]:
    """A symmetric tensor from the upper triangle of its matrix."""
    return Symmetric(*(m[i][j] for i, j in UPPER))


def axial_tensor(inertia: S, u: Vector[S]) -> Symmetric[S]:
    """Inertia u u^T of what resists turning about one axis alone."""
    v = scale(inertia, u)
    return Symmetric(v[0] * u[0], v[1] * u[1], v[2] * u[2], v[0] * u[1], v[0] * u[2], v[1] * u[2])


def steiner(mass: S, r: Vector[S]) -> Symmetric[S]:
    """Inertia of a point mass about the origin: mass * (r.r 1 - r r^T), the term of Steiner."""
    x, y, z = r
    mx, my, mz = mass * x, mass * y, mass * z
    xx, yy, zz = mx * x, my * y, mz * z
    return Symmetric(yy + zz, xx + zz, xx + yy, -(mx * y), -(mx * z), -(my * z))


@dataclass(frozen=True, slots=True)
class Frame(Generic[S]):
    """A rigid transform."""

    rotation: Matrix[S]  # its axes as columns, in the parent frame
    position: Vector[S]  # its origin in the parent frame

    @property
    def inverse(self) -> Frame[S]:
        """The transform backwards: (R^T, -R^T p)."""
        turned = transpose(self.rotation)
        return Frame(turned, scale(-1, multiply(turned, self.position)))

    def rows(self, zero: S, one: S) -> list[list[S]]:
        """The homogeneous matrix, 4x4."""
        return [*[[*self.rotation[k], self.position[k]] for k in range(3)], [zero, zero, zero, one]]

    def __matmul__(self, other: Frame[S]) -> Frame[S]:
        moved = add(self.position, multiply(self.rotation, other.position))
        return Frame(matmul(self.rotation, other.rotation), moved)
