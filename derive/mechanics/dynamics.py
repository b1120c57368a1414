"""Closed-form dynamics by Lagrange: B, the Christoffel symbols, C, N and Bdot as exact polynomials.

The kinetic energy is collected in composite bodies: seen from joint frame j, everything outboard moves as one rigid body
when only joint j moves (Featherstone, Rigid Body Dynamics Algorithms, ch. 6). In link frames the polynomials stay short.
"""

from __future__ import annotations

from fractions import Fraction
from functools import cached_property

from derive.algebra.domain import PolynomialDomain
from derive.algebra.ring import Polynomial
from derive.mechanics.chain import Body, Chain, build_chain
from derive.mechanics.vectors import (
    Frame,
    Symmetric,
    Vector,
    add,
    cross,
    dot,
    from_matrix,
    matmul,
    multiply,
    scale,
    transpose,
)
from derive.robot.robot import Robot

PolynomialVector = Vector[Polynomial]


class Dynamics:
    """B and what follows from it.

    Args:
        robot: A robot with links.
        domain: The ring to work in.
    """

    def __init__(self, robot: Robot, domain: PolynomialDomain) -> None:
        self.robot = robot
        self.domain = domain
        self.chain: Chain[Polynomial] = build_chain(robot, domain)
        self._steps = [j.fixed @ j.motion(self.chain.zero, self.chain.one) for j in self.chain.joints]
        self._derivatives: dict[tuple[int, int, int], Polynomial] = {}
        self._christoffel: dict[tuple[int, int, int], Polynomial] = {}

    @cached_property
    def inertia_matrix(self) -> list[list[Polynomial]]:
        """B(q), n x n, links and rotors."""
        n = self.chain.n
        b = [[self.chain.zero] * n for _ in range(n)]
        composite: Body[Polynomial] | None = None
        for j in reversed(range(n)):
            body = self.chain.bodies[j]
            composite = body if composite is None else body + moved(composite, self._steps[j + 1])
            for i, value in self._column(j, composite):
                b[i][j] = b[j][i] = value
        return b

    def _column(self, j: int, composite: Body[Polynomial]) -> list[tuple[int, Polynomial]]:
        """B[i, j] for i <= j: the generalised forces of a unit acceleration of joint j."""
        joint = self.chain.joints[j]
        zero, one = self.chain.zero, self.chain.one
        z = (zero, zero, one)
        if joint.revolute:
            force = cross(z, composite.first_moment)
            moment = (composite.inertia.xz, composite.inertia.yz, composite.inertia.zz)
        else:
            force = (zero, zero, composite.mass)
            moment = cross(composite.first_moment, z)
        column = [(j, (moment[2] if joint.revolute else force[2]) + joint.reflected)]
        for i in reversed(range(j)):
            force, moment = carried(force, moment, self._steps[i + 1])
            if i == j - 1:
                moment = add(moment, scale(joint.coupling, _axis(joint.fixed)))
            here = self.chain.joints[i]
            value = moment[2] if here.revolute else force[2]
            column.append((i, value if here.sign == joint.sign else -value))
        return column

    def derivative(self, i: int, j: int, k: int) -> Polynomial:
        """dB_ij/dq_k; zero unless k > min(i, j), for turning an inboard joint turns everything."""
        key = (min(i, j), max(i, j), k)
        if key not in self._derivatives:
            value = self.inertia_matrix[i][j]
            self._derivatives[key] = self.domain.derivative(value, k) if value else value
        return self._derivatives[key]

    def christoffel(self, i: int, j: int, k: int) -> Polynomial:
        """c_ijk = 1/2 (dB_ij/dq_k + dB_ik/dq_j - dB_jk/dq_i); indices from 0."""
        key = (i, min(j, k), max(j, k))
        if key not in self._christoffel:
            d = self.derivative
            twice = d(i, j, k) + d(i, k, j) - d(j, k, i)
            self._christoffel[key] = Fraction(1, 2) * twice
        return self._christoffel[key]


def _axis(frame: Frame[Polynomial]) -> PolynomialVector:
    r = frame.rotation
    return (r[0][2], r[1][2], r[2][2])


def carried(
    force: PolynomialVector, moment: PolynomialVector, step: Frame[Polynomial]
) -> tuple[PolynomialVector, PolynomialVector]:
    """A force and a moment about the origin of a frame, seen from the frame before it."""
    turned = multiply(step.rotation, force)
    return turned, add(multiply(step.rotation, moment), cross(step.position, turned))


def moved(body: Body[Polynomial], step: Frame[Polynomial]) -> Body[Polynomial]:
    """A body given in a frame, by its parameters in the frame before it.

    I' = R I R^T + 2 (p.h) 1 - p h^T - h p^T + m (p.p 1 - p p^T) with h = R (m r), the parallel-axis theorem.
    """
    r, p = step.rotation, step.position
    h = multiply(r, body.first_moment)
    turned = matmul(matmul(r, body.inertia.matrix), transpose(r))
    mp = scale(body.mass, p)
    return Body(body.mass, add(h, mp), from_matrix(turned) + _parallel_axis(p, h, mp))


def _parallel_axis(p: PolynomialVector, h: PolynomialVector, mp: PolynomialVector) -> Symmetric[Polynomial]:
    w = add(scale(2, h), mp)
    total = dot(p, w)

    def outer(i: int, j: int) -> Polynomial:
        return p[i] * (h[j] + mp[j]) + h[i] * p[j]

    return Symmetric(
        total - outer(0, 0), total - outer(1, 1), total - outer(2, 2), -outer(0, 1), -outer(0, 2), -outer(1, 2)
    )


