"""Closed-form dynamics by Lagrange: B and the Christoffel symbols as exact polynomials.

B comes from composite bodies in joint frames, where polynomials stay short, and is linear in the ten parameters of
each body. So it is derived in those *lumped* parameters (mass, first moments, inertia about the joint frame's origin,
rotors included), each a symbol of its own, and the user's symbols are put in afterwards, entry by entry, where they
are wanted.
"""

from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property

from derive.algebra.domain import PolynomialDomain
from derive.algebra.ring import Polynomial
from derive.mechanics.chain import Body, build_chain
from derive.mechanics.inertia_matrix import inertia_matrix
from derive.mechanics.vectors import Symmetric
from derive.robot import tree
from derive.robot.coupling import projected
from derive.robot.description import Inertia
from derive.robot.expression import ZERO, Name
from derive.robot.robot import Robot

# The ten parameters of a body: mass, first moments, inertia about the origin of its joint frame.
PARTS = ("m", "hx", "hy", "hz", "xx", "yy", "zz", "xy", "xz", "yz")


@dataclass(frozen=True, slots=True)
class Lump:
    """A lumped parameter as a generator of the ring of `Dynamics`."""

    generator: int  # its index in that ring
    value: Polynomial  # what it is, in the ring of the user's symbols


class Dynamics:
    """B and what follows from it, in lumped parameters; joints count from 0."""

    def __init__(self, robot: Robot, domain: PolynomialDomain, max_terms: int = 10**9) -> None:
        self.robot = robot
        self.domain = domain
        massless = (replace(link, mass=ZERO, com=(ZERO, ZERO, ZERO), inertia=Inertia()) for link in robot.links)
        bare = replace(robot, links=tuple(massless), fixed=tree.massless(robot.fixed))
        names = [Name(f"{part} of {i}") for i in range(robot.n) for part in PARTS]
        kind, offsets = domain.contraction, domain.with_offsets
        self.lumped = PolynomialDomain(bare, names, contraction=kind, rates=False, offsets=offsets, max_terms=max_terms)
        self.lumps: list[Lump] = []
        # a generator for each of the ten parameters of a body, or its number
        bodies, ring = [], self.lumped.ring
        for i, body in enumerate(build_chain(robot, domain).bodies):
            t, p = body.inertia, list[Polynomial]()
            values = (body.mass, *body.first_moment, t.xx, t.yy, t.zz, t.xy, t.xz, t.yz)
            for part, value in zip(PARTS, values, strict=True):
                name = f"{part} of {i}"
                if not value.is_constant:
                    self.lumps.append(Lump(ring.index[name], value))
                p.append(self.lumped.number(value.constant_term) if value.is_constant else ring.generator(name))
            bodies.append(Body(p[0], (p[1], p[2], p[3]), Symmetric(*p[4:])))
        self.chain = replace(build_chain(bare, self.lumped), bodies=tuple(bodies))
        self._derivatives: dict[tuple[int, int, int], Polynomial] = {}
        self._expanded: dict[str, Polynomial] = {}
        self._christoffel: dict[tuple[int, int, int], Polynomial] = {}

    @cached_property
    def inertia_matrix(self) -> list[list[Polynomial]]:
        """B(q), nxn, links and rotors."""
        matrix = inertia_matrix(self.chain)
        if not self.robot.coupled:
            return matrix
        # S^T B S: kinetic energy is that of the joints.
        half = [projected(row, self.lumped.coupling, self.chain.zero) for row in matrix]
        columns = [projected(column, self.lumped.coupling, self.chain.zero) for column in zip(*half, strict=True)]
        return [list(row) for row in zip(*columns, strict=True)]

    def derivative(self, i: int, j: int, k: int) -> Polynomial:
        """dB_ij/dq_k."""
        key = (min(i, j), max(i, j), k)
        if key not in self._derivatives:
            value = self.inertia_matrix[i][j]
            self._derivatives[key] = self.lumped.derivative(value, k) if value else value
        return self._derivatives[key]

    def christoffel(self, i: int, j: int, k: int) -> Polynomial:
        """c_ijk = 1/2 (dB_ij/dq_k + dB_ik/dq_j - dB_jk/dq_i) (Siciliano et al., Robotics, section 7.2.1)."""
        key = (i, min(j, k), max(j, k))
        if key not in self._christoffel:
            d = self.derivative
            twice = d(i, j, k) + d(i, k, j) - d(j, k, i)
            self._christoffel[key] = Fraction(1, 2) * twice
        return self._christoffel[key]

    def skew(self, i: int, j: int, k: int) -> Polynomial:
        """The coefficient of qd_k in N_ij, N = Bdot - 2C: dB_jk/dq_i - dB_ik/dq_j."""
        return self.derivative(j, k, i) - self.derivative(i, k, j)

    def split(self, p: Polynomial) -> tuple[list[tuple[Lump, Polynomial]], Polynomial]:
        """A polynomial as sum of lump * coefficient, and the rest that has no lump in it."""
        parts = self._coefficients(p)
        ring = self.lumped.ring
        if sum(len(coefficient) for _, coefficient in parts) == len(p):
            return parts, ring.zero
        names = {ring.names[lump.generator]: 0 for lump, _ in parts}
        return parts, ring.wrap(p.raw.subs(names)) if names else p

    def _coefficients(self, p: Polynomial) -> list[tuple[Lump, Polynomial]]:
        """What every lump that occurs is multiplied by."""
        degrees = p.degrees()
        return [(lump, p.partial(lump.generator)) for lump in self.lumps if degrees[lump.generator]]

    def expanded_size(self, p: Polynomial) -> int:
        """Number of terms once the user's symbols are put in (before terms meet)."""
        return len(p) + sum((len(lump.value) - 1) * len(c) for lump, c in self._coefficients(p))

    def expand(self, p: Polynomial) -> Polynomial:
        """A polynomial in the ring of the user's symbols."""
        key = p.key()
        if key not in self._expanded:
            parts, rest = self.split(p)
            ring = self.domain.ring
            total = ring.project(rest)
            for lump, coefficient in parts:
                total = total + ring.project(coefficient) * lump.value
            self._expanded[key] = total
        return self._expanded[key]
