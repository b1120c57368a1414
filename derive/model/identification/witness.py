"""Why no physically consistent bodies have some torques: a certificate (witness) that anybody can check.

For each link a quadratic function f_i of place, nowhere negative: then the sum of the integrals of f_i over the masses
of the links is not negative, whatever the bodies. Where f_i and f_{i-1} agree on the axis of joint i, and no torque
depends on their rest either, this sum is one of base parameters: it is the same for all bodies with these torques.
If it comes out negative from the given numbers, these contradict mechanics, and no choice of bodies helps.

The functions come from the dual of the search for bodies (`possible`), rounded to rational numbers,
with some kinetic energy added (which is such a sum, and positive) so that they stay above zero. Where a point of a link
never moves, no torque depends on what is there: f_i is zero, and rounding must keep it so, as beside it f_i would be
negative. The same goes for a direction along which it slides alone, or that never turns. These are the vectors (x, y,
z, 1) and (x, y, z, 0) that the screws of all joints up to i send to zero; elsewhere kinetic energy is positive, so that
a little of it makes up for rounding. All three claims are then checked again in the scalars of
`derive.model.identification.exact_scalars`: exactly where the geometry is rational, in balls of 256 bits otherwise.
"""

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import chain as joined
from math import ceil, log10

import numpy as np
from flint import fmpq

from derive.arrays import Array
from derive.errors import DeriveError
from derive.mechanics.chain import Body, Chain, build_chain
from derive.mechanics.floats import FloatDomain
from derive.mechanics.joint_motion import body_to_parent, origin, to_child
from derive.mechanics.regressor import with_unit_rotors
from derive.mechanics.vectors import Symmetric, add, scale
from derive.model.identification.base_parameters import base_set, parameters_of
from derive.model.identification.exact_scalars import Exact, ExactDomain, as_fraction, is_zero, null_space
from derive.model.identification.semidefinite import Cone, Limit, least, packed
from derive.model.identification.unit_dynamics import UnitDynamics
from derive.robot.inertial_parameters import LINK_PARTS, Parameter
from derive.robot.robot import Robot

ADDED = (0.0, *(10.0**-k for k in range(10, 0, -1)))  # parts of kinetic energy that are tried
DIGITS = (6, 12)  # of the largest coefficient of a function, in the units of the links; few are easier to read
SHOWN = 100  # coefficients smaller by this factor are left out of messages
STILL = 1e-9  # part of a link's kinetic energy that is rounding
STATES = 12  # of which kinetic energies are added up
# Terms of a function of place, and where their coefficients stand in its symmetric matrix.
MONOMIALS = {"x^2": (0, 0), "y^2": (1, 1), "z^2": (2, 2), "x y": (0, 1), "x z": (0, 2), "y z": (1, 2)}
MONOMIALS |= {"x": (0, 3), "y": (1, 3), "z": (2, 3), "": (3, 3)}

# -- the null space of the regressor: changes of the links' inertial parameters that leave every torque the same
#
# Torques depend on the base parameters alone (`derive.model.identification.base_parameters`), so bodies may change
# along the directions in which no base parameter does. They are of two kinds:
#
# - what of a link looks the same however its joint moves may as well be on the link before: of a revolute joint's link
#   its mass, its first moment along the axis, and the second moment along the axis, diag(1, 1, 0); of a prismatic
#   joint's link its inertia tensor without the mass. From link 1 it goes to the ground;
# - for each parameter of a link that others replace: one of it more, and of the others less by its coefficients.
#
# A vector of parameters has ten numbers a link in the order of `LINK_PARTS`, in joint frames: on the axis of joint i,
# which is DH frame i in the modified convention, and DH frame i before its a and alpha in the standard one.

WIDTH = len(LINK_PARTS)  # parameters of a link
Direction = list[Exact]  # a change of all links' parameters


def bare_chain(robot: Robot, domain: ExactDomain) -> Chain[Exact]:
    """The links of an arm without the rotors that they carry."""
    return build_chain(replace(robot, links=tuple(replace(link, motor=None) for link in robot.links)), domain)


def body_of(parameters: Sequence[Exact]) -> Body[Exact]:
    """The body of ten parameters."""
    mass, x, y, z, *tensor = parameters
    return Body(mass, (x, y, z), Symmetric(*tensor))


def directions(robot: Robot, chain: Chain[Exact], domain: ExactDomain) -> list[Direction]:
    """A basis of the changes of bodies that change no torque."""
    found, zero = [], [chain.zero] * WIDTH
    for i, joint in enumerate(chain.joints):
        # Mass, m z and the second moment along z look the same from link i-1 however joint i turns.
        units = [("m",), ("mz",), ("Ixx", "Iyy")] if joint.revolute else [(part,) for part in LINK_PARTS[4:]]
        for unit in units:
            own = [chain.one if part in unit else chain.zero for part in LINK_PARTS]
            links = [list(zero) for _ in range(chain.n)]
            links[i] = [-value for value in own]
            if i:
                links[i - 1] = parameters_of(body_to_parent(joint, body_of(own)))
            found.append(list(joined.from_iterable(links)))
    base = base_set(robot)
    for relation in base.relations:
        if not relation.parameter.of_link:
            continue
        direction = zero * chain.n
        direction[_place(relation.parameter)] = domain.number(1)
        for parameter, factor in relation.terms:
            numerator, denominator = map(domain.constant, base.fraction(factor))
            direction[_place(parameter)] = -numerator / denominator
        found.append(direction)
    return found


def _place(parameter: Parameter) -> int:
    return WIDTH * (parameter.joint - 1) + LINK_PARTS.index(parameter.part)


def fixing(basis: Sequence[Direction], places: Sequence[int]) -> list[Direction]:
    """Those changes that leave some parameters as they are."""
    rows = [[direction[place] for direction in basis] for place in places]
    return [combined(basis, weights) for weights in null_space(rows, len(basis)).values()]


def combined(basis: Sequence[Direction], weights: Sequence[Exact]) -> Direction:
    """A sum of changes."""
    total: Direction = [fmpq(0)] * len(basis[0])
    for weight, direction in zip(weights, basis, strict=True):
        if not is_zero(weight):
            total = [old + weight * x if not is_zero(x) else old for old, x in zip(total, direction, strict=True)]
    return total


# -- the witness


@dataclass(frozen=True, slots=True)
class Witness:
    """A sum that no bodies can have."""

    # By link, from 1, the symmetric 4x4 matrix of its function of (x, y, z, 1) in the joint frame; links whose
    # function is zero are left out.
    functions: tuple[tuple[int, tuple[tuple[Fraction, ...], ...]], ...]
    value: Fraction  # the sum of their integrals for the given numbers; negative
    exact: bool  # whether all is rational; else it is true within balls of 256 bits

    def __str__(self) -> str:
        sizes = {link: _largest(matrix) for link, matrix in self.functions}
        main = [pair for pair in self.functions if sizes[pair[0]] > max(sizes.values()) / SHOWN]
        terms = "; ".join(f"link {link}: f = {_polynomial(matrix)}" for link, matrix in main)
        more = "; smaller elsewhere" if len(main) < len(self.functions) else ""
        unit = "kg m^2" if any(any(map(any, matrix[:3])) for _, matrix in main) else "kg"
        return (
            f"torques fix the integral of f dm over all links at {float(self.value):.3g} {unit}, though f is nowhere "
            f"negative ({terms}{more}; in joint frames, rounded)"
        )


class NoSuchBodies(DeriveError):
    """No physically consistent bodies have these torques."""

    witness: Witness | None = None  # why; None where only the search says so


def _largest(matrix: Sequence[Sequence[Fraction]]) -> Fraction:
    return max(abs(entry) for row in matrix for entry in row)


def _polynomial(matrix: Sequence[Sequence[Fraction]]) -> str:
    """A function of place to three digits, without what is small."""
    text = ""
    for name, (i, j) in MONOMIALS.items():
        value = float(matrix[i][j] * (1 if i == j else 2))
        if abs(value) > _largest(matrix) / SHOWN:
            factor = "" if name and abs(value) == 1 else f"{abs(value):.3g}"
            term = f"{factor} {name}".strip()
            text += f" {'-' if value < 0 else '+'} {term}" if text else f"{'-' * (value < 0)}{term}"
    return text


def refusal(robot: Robot, chain: Chain[Exact], basis: Sequence[Direction], prices: Array, units: Array) -> NoSuchBodies:
    """The error that says why there are no bodies."""
    witness = find_witness(robot, chain, basis, prices, units) if base_set(robot).proven else None
    unsure = "no bodies with these torques were found, but no proof either that there are none"
    found = f"no bodies have these torques: {witness}" if witness else unsure
    error = NoSuchBodies(f"{robot.name}: {found}", remedy="correct masses and inertias")
    error.witness = witness
    return error


def find_witness(
    robot: Robot, chain: Chain[Exact], basis: Sequence[Direction], prices: Array, units: Array
) -> Witness | None:
    """A witness from approximate functions; None where rounding these does not give one.

    Prices, (n, 4, 4), are matrices of functions that nearly are one, in the units of the links; units, (n, 4, 4), take
    pseudo-inertias in joint frames to these units, from both sides.
    """
    parameters = [value for body in chain.bodies for value in parameters_of(body)]
    # Functions that torques depend on: orthogonal to all changes of bodies, zero where links never move.
    seen = list(null_space([*basis, *_still(chain)], len(parameters)).values())
    columns = np.array([_in_units([float(entry) for entry in vector], units) for vector in seen]).T
    lengths = np.linalg.norm(columns, axis=0)
    values = [float(sum((e * p for e, p in zip(vector, parameters, strict=True)), fmpq(0))) for vector in seen]
    energy = _in_units(list(_kinetic_energy(robot)), units)
    starts = _starts(columns / lengths, np.array(values) / lengths, prices, energy)
    for start, digits in ((each, few) for each in starts for few in DIGITS):
        nearest = start / lengths
        most = np.abs(nearest).max()
        places = [digits + max(0, ceil(log10(length * most))) for length in lengths]
        # Rounded to few decimals in units of each function, then everything is checked exactly.
        weights = [fmpq(round(float(x / most) * 10**p)) / fmpq(10) ** p for x, p in zip(nearest, places, strict=True)]
        total = combined(seen, weights)
        value = sum((c * p for c, p in zip(total, parameters, strict=True)), fmpq(0))
        matrices = [function_matrix(total[WIDTH * i : WIDTH * (i + 1)]) for i in range(robot.n)]
        if not value < 0 or not all(map(is_semidefinite, matrices)):
            continue
        unit = max(abs(as_fraction(entry)) for matrix in matrices for row in matrix for entry in row)
        functions = tuple(
            (i, tuple(tuple(as_fraction(entry) / unit for entry in row) for row in matrix))
            for i, matrix in enumerate(matrices, 1)
            if not all(is_zero(entry) for row in matrix for entry in row)
        )
        exact = all(isinstance(entry, fmpq) for entries in (total, parameters, *basis) for entry in entries)
        return Witness(functions, as_fraction(value) / unit, exact)
    return None


def _starts(columns: Array, values: Array, prices: Array, energy: Array) -> Iterator[Array]:
    """What may be a witness but for rounding: the dual with some energy in it; else the one that is wanted itself."""
    scaled = np.array([prices.ravel() / np.linalg.norm(prices), energy / np.linalg.norm(energy)]).T
    dual, among = np.linalg.lstsq(columns, scaled, rcond=None)[0].T
    yield from ((1 - part) * dual + part * among for part in ADDED)
    with suppress(DeriveError):
        found = _least_function(columns, values, energy)
        yield from ((1 - part) * found + part * among for part in ADDED)


def _least_function(columns: Array, values: Array, energy: Array) -> Array:
    """Of the functions seen, of trace 1 and nowhere negative where energy is positive, that of the least integral."""
    limits, total = [], np.zeros(len(values))
    for matrices, moving in zip(columns.reshape(-1, 4, 4, len(values)), energy.reshape(-1, 4, 4), strict=True):
        # A 4x4 quadratic form restricted to where it may be positive.
        sizes, axes = np.linalg.eigh(moving)
        axes = axes[:, sizes > STILL * sizes[-1]]
        slope = packed(np.einsum("ab,acv,cd->vbd", axes, matrices, axes)).T
        limits.append(Limit(Cone.SEMIDEFINITE, np.zeros(len(slope)), slope))
        total += np.einsum("aav->v", matrices)
    return least(values, [*limits, Limit(Cone.NOT_NEGATIVE, np.ones(1), -total[None])])[0]


def _in_units(factors: Sequence[float], units: Array) -> Array:
    """The matrices of functions, one a link after the other, in the units of the links."""
    inverses = np.linalg.inv(units)
    matrices = [function_matrix(factors[WIDTH * i : WIDTH * (i + 1)]) for i in range(len(units))]
    return np.asarray(np.einsum("nba,nbc,ncd->nad", inverses, np.array(matrices), inverses).ravel())


def _still(chain: Chain[Exact]) -> list[Direction]:
    """What is zero of functions that are nowhere negative and that torques depend on, where links never move."""
    units = [[fmpq(int(a == b)) for a in range(WIDTH)] for b in range(WIDTH)]
    matrices, zeros = [function_matrix(unit) for unit in units], [fmpq(0)] * (WIDTH * chain.n)
    rows = []
    still = [[fmpq(int(a == b)) for a in range(4)] for b in range(4)]
    for i, joint in enumerate(chain.joints):
        for vector in still:
            x, y, z, one = vector
            # Points (x, y, z, 1) and directions (x, y, z, 0) carried into the frame of the next joint.
            vector[:3] = to_child(joint, add((x, y, z), scale(-one, origin(joint))))
        # A turn about z leaves what has x = y = 0, a slide along z only directions.
        moved = [[vector[a] for vector in still] for a in ((0, 1) if joint.revolute else (3,))]
        still = [
            [sum((w * v[a] for w, v in zip(weights, still, strict=True)), fmpq(0)) for a in range(4)]
            for weights in null_space(moved, len(still)).values()
        ]
        for vector in still:
            for a in range(4):
                own = [sum((m * v for m, v in zip(matrix[a], vector, strict=True)), fmpq(0)) for matrix in matrices]
                rows.append([*zeros[: WIDTH * i], *own, *zeros[WIDTH * (i + 1) :]])
    return rows


def function_matrix(factors: Sequence[Exact]) -> list[list[Exact]]:
    """The function whose integral over a body is the sum of its parameters times some factors."""
    one, x, y, z, xx, yy, zz, xy, xz, yz = factors
    x, y, z, xy, xz, yz = x / 2, y / 2, z / 2, -xy / 2, -xz / 2, -yz / 2
    return [[yy + zz, xy, xz, x], [xy, xx + zz, yz, y], [xz, yz, xx + yy, z], [x, y, z, one]]


def is_semidefinite(matrix: Sequence[Sequence[Exact]]) -> bool:
    """Whether a symmetric matrix has no negative eigenvalue, by elimination."""
    if not matrix:
        return True
    # Cholesky without roots: a zero pivot needs a zero row, then the Schur complement.
    (pivot, *row), *rest = matrix
    if is_zero(pivot):
        return all(map(is_zero, row)) and is_semidefinite([line[1:] for line in rest])
    if not pivot > 0:
        return False
    return is_semidefinite([[e - line[0] * own / pivot for e, own in zip(line[1:], row, strict=True)] for line in rest])


def _kinetic_energy(robot: Robot) -> Array:
    """The factors of all parameters in a sum of kinetic energies."""
    random = np.random.default_rng(1)
    alone, total = with_unit_rotors(robot), np.zeros(WIDTH * robot.n)
    for _ in range(STATES):
        q, qd = random.uniform(-2, 2, (2, robot.n))
        units = UnitDynamics(build_chain(alone, FloatDomain(alone, [float(angle) for angle in q])), ends=False)
        for k in range(len(total)):
            entries = units.inertia(Parameter(k // WIDTH + 1, LINK_PARTS[k % WIDTH]))
            total[k] += sum((1 if a == b else 2) * value * qd[a] * qd[b] for (a, b), value in entries.items())
    return total
