"""Closed forms as exact polynomials: frames, Jacobians of end effector, links and rotors, B and Christoffel symbols."""

from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache, cached_property

from derive.algebra.domain import PolynomialDomain
from derive.algebra.ring import Polynomial
from derive.mechanics.chain import Body, Chain, build_chain, constant_vector, way_frame
from derive.mechanics.energy import inertia_matrix, potential_energy
from derive.mechanics.vectors import Frame, Symmetric, Vector, add, column, cross, multiply, scale, subtract
from derive.robot import tree
from derive.robot.description import Convention, Inertia, Motor, projected
from derive.robot.expression import ZERO, Name
from derive.robot.robot import Robot

PolynomialFrame = Frame[Polynomial]
PolynomialVector = Vector[Polynomial]
JacobianColumn = tuple[Polynomial, ...]  # linear velocity, then angular velocity, per unit of one rate


class Kinematics:
    """Frames and Jacobians of one robot."""

    def __init__(self, robot: Robot, domain: PolynomialDomain) -> None:
        self.robot = robot
        self.domain = domain
        self.chain: Chain[Polynomial] = build_chain(robot, domain)
        self.transform, self.joint_frame = cache(self._transform), cache(self._joint_frame)

    def _transform(self, i: int, j: int) -> PolynomialFrame:
        """DH frame j in DH frame i, without base and tool."""
        if i >= j:
            return self.transform(j, i).inverse if i > j else self.chain.unit
        return self.transform(i, self.chain.joints[j - 1].parent + 1) @ self.chain.row(j, self.robot.convention)

    def row(self, i: int) -> PolynomialFrame:
        """A_i, from the frame that row i follows."""
        return self.transform(self.chain.joints[i - 1].parent + 1, i)

    def between(self, one: str, other: str) -> PolynomialFrame:
        """The frame of a row of a tree in that of another one, both by their labels."""
        (i, start), (j, end) = (way_frame(self.robot, label, self.domain) for label in (one, other))
        frame = self.transform(i + 1, j + 1)
        return (frame if start is None else start.inverse @ frame) @ (self.chain.unit if end is None else end)

    def placed(self, label: str) -> PolynomialFrame:
        """The frame of a row of a tree in the world."""
        return self.chain.base @ self.between("", label)

    def frame(self, i: int) -> PolynomialFrame:
        """DH frame i in the world: base A_1 ... A_i."""
        return self.chain.base @ self.transform(0, i)

    @cached_property
    def end(self) -> PolynomialFrame:
        """The end effector in the world: base A_1 ... A_n tool."""
        return self.joint_frame(self.robot.n) @ self.chain.tool

    def _joint_frame(self, i: int) -> PolynomialFrame:
        """Joint frame i in the world; its z axis is the axis of joint i."""
        if i == 0:
            return self.chain.base
        joint = self.chain.joints[i - 1]
        return self.joint_frame(joint.parent + 1) @ (joint.fixed @ joint.motion(self.chain.zero, self.chain.one))

    def axis(self, i: int) -> PolynomialVector:
        """Axis of joint i in the world, in the sense of a positive rate of its variable."""
        z = column(self.joint_frame(i).rotation, 2)
        return z if self.robot.joints[i - 1].sign > 0 else scale(-1, z)

    def linear_columns(self, point: PolynomialVector) -> list[PolynomialVector]:
        """The derivatives of a point with respect to every joint variable: n columns of J_v."""
        d = self.domain.derivative
        return [(d(point[0], k), d(point[1], k), d(point[2], k)) for k in range(self.robot.dof)]

    def angular_columns(self, last: int) -> list[PolynomialVector]:
        """Angular velocity of a link per unit of every rate, in the world: n columns of J_w."""
        return self._by_variables(self._spins(last))

    def _spins(self, last: int) -> list[PolynomialVector]:
        """The same per unit of every joint's rate."""
        movers, joints = tree.path(self.robot, last - 1), enumerate(self.robot.joints)
        return [self.axis(k + 1) if k in movers and joint.is_revolute else self.chain.null for k, joint in joints]

    def _by_variables(self, columns: list[PolynomialVector]) -> list[PolynomialVector]:
        """Columns for the variables from those for the joints."""
        if not self.robot.coupled:
            return columns
        matrix, zero = self.domain.coupling, self.chain.zero
        rows = (projected(entries, matrix, zero) for entries in zip(*columns, strict=True))
        return [(x, y, z) for x, y, z in zip(*rows, strict=True)]

    def com(self, i: int) -> PolynomialVector:
        """Centre of mass of link i in the world; bodies of rows without motion count behind link n."""
        frame = self.frame(i) if i <= self.robot.n else self.chain.base @ self.between("", tree.labels(self.robot)[i])
        com = tree.bodies(self.robot)[i - 1].com
        return add(frame.position, multiply(frame.rotation, constant_vector(com, self.domain)))

    def motor_place(self, i: int) -> PolynomialVector:
        """Where the rotor of joint i sits, in the world."""
        joint = self.chain.joints[i - 1]
        carrier = self.joint_frame(joint.parent + 1)
        return add(carrier.position, multiply(carrier.rotation, joint.rotor))

    def motor_angular_columns(self, i: int) -> list[PolynomialVector]:
        """Angular velocity of rotor i per unit of every rate: that of link i-1, and ratio*z for joint i."""
        joint = self.chain.joints[i - 1]
        columns = self._spins(joint.parent + 1)
        motor = self.robot.links[i - 1].motor or Motor()
        z = column((self.joint_frame(joint.parent + 1) @ joint.fixed).rotation, 2)
        columns[i - 1] = scale(self.domain.constant(motor.ratio), z)
        return self._by_variables(columns)

    @cached_property
    def potential(self) -> Polynomial:
        """U = -sum m g0.p over links and rotors, g0 in the world."""
        return potential_energy(self.chain) if self.chain.bodies else self.chain.zero

    @cached_property
    def gravity_vector(self) -> list[Polynomial]:
        """g = dU/dq, n entries."""
        return [self.domain.derivative(self.potential, k) for k in range(self.robot.dof)]


@dataclass(frozen=True, slots=True)
class Reference:
    """Where a Jacobian is taken.

    Moving the point adds multiples of the angular rows to the linear ones, and turning the axes turns both: neither
    changes the rank of J, nor the determinant of all six rows. In the middle of the arm the entries are shortest
    (Siciliano et al., Robotics, sec. 3.3).
    """

    frame: int | None = None  # DH frame in whose axes it is, None for the world
    point: int | None = None  # DH frame whose origin is the point of the last link, None for the end effector


def jacobian_columns(kinematics: Kinematics, reference: Reference) -> list[JacobianColumn]:
    """The columns of the Jacobian of another point of the last link, in the axes of another frame."""
    robot, seen_from = kinematics.robot, reference.frame

    def _frame(i: int) -> PolynomialFrame:
        return kinematics.frame(i) if seen_from is None else kinematics.transform(seen_from, i)

    if reference.point is not None:
        point = _frame(reference.point).position
    elif seen_from is None:
        point = kinematics.end.position
    else:
        last = _frame(robot.n)
        point = add(last.position, multiply(last.rotation, kinematics.chain.tip.position))
    columns: list[JacobianColumn] = []
    for index, joint in enumerate(robot.joints):
        moved = kinematics.chain.joints[index]
        at = _frame(index + 1 if robot.convention is Convention.MODIFIED else moved.parent + 1)
        if robot.convention is Convention.STANDARD and moved.mount is not None:
            at = at @ moved.mount
        axis: PolynomialVector = scale(joint.sign, column(at.rotation, 2))
        linear = cross(axis, subtract(point, at.position)) if joint.is_revolute else axis
        columns.append((*linear, *(axis if joint.is_revolute else kinematics.chain.null)))
    return columns


# -- dynamics by Lagrange: B and the Christoffel symbols
#
# B comes from composite bodies in joint frames, where polynomials stay short, and is linear in the ten parameters of
# each body. So it is derived in those *lumped* parameters (mass, first moments, inertia about the joint frame's origin,
# rotors included), each a symbol of its own, and the user's symbols are put in afterwards, entry by entry, where they
# are wanted.

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
        self.expand, d = cache(self._expand), self.derivative
        self._slope = cache(lambda i, j, k: self.lumped.derivative(self.inertia_matrix[i][j], k))
        self._symbol = cache(lambda i, j, k: Fraction(1, 2) * (d(i, j, k) + d(i, k, j) - d(j, k, i)))

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
        return self._slope(min(i, j), max(i, j), k)

    def christoffel(self, i: int, j: int, k: int) -> Polynomial:
        """c_ijk = 1/2 (dB_ij/dq_k + dB_ik/dq_j - dB_jk/dq_i) (Siciliano et al., Robotics, section 7.2.1)."""
        return self._symbol(i, min(j, k), max(j, k))

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

    def _expand(self, p: Polynomial) -> Polynomial:
        """A polynomial in the ring of the user's symbols."""
        ring, (parts, rest) = self.domain.ring, self.split(p)
        return sum((ring.project(coefficient) * lump.value for lump, coefficient in parts), ring.project(rest))
