"""The number of complex solutions of a generic pose, from an elimination modulo a prime.

The rank of M(t) drops at the roots of a polynomial g, the common divisor of its largest minors. At such a root the null
vector v(t) is a vector of minors, thus again of polynomials. It belongs to a solution where it has the form of a vector
of products, v(joint a) x v(joint b) with cosine and sine on the unit circle: where polynomials in its entries vanish.
Their greatest common divisor with g has the solutions as its roots. Everything is counted at one random configuration
of an arm whose free parameters are random, modulo a prime: the number is the same for all generic poses.
"""

import math
import random
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import pairwise, product
from typing import Any

import numpy as np
from flint import nmod_mat, nmod_poly

from derive.algebra.domain import PolynomialDomain
from derive.algebra.residues import ResidueDomain
from derive.inverse.general.closure import Closure, Loop, closures, middle_part
from derive.inverse.general.elimination import HALF, POWERS, EigenProblem, Elimination
from derive.inverse.general.rigid_motion import Array, joint_motion, pose_features
from derive.mechanics.chain import build_chain
from derive.mechanics.vectors import Frame
from derive.robot.description import Joint
from derive.robot.robot import Robot


class _AtRest(ResidueDomain):
    """Residues of an arm whose joint variables are zero."""

    def joint_cosine_sine(self, index: int, joint: Joint) -> Any:
        return self.cosine_sine(joint.theta)

    def joint_offset(self, index: int, joint: Joint) -> Any:
        return self.constant(joint.d)


def _integers(frame: Frame[Any]) -> Array:
    zero = frame.rotation[0][0] * 0
    return np.array([[int(entry.values.item()) for entry in row] for row in frame.rows(zero, zero + 1)], dtype=object)


def count_solutions(
    robot: Robot, elimination: Elimination, given: Sequence[int] = (), seed: int = 0, *, tip: bool = False
) -> int:
    """How many complex solutions a generic pose has."""
    # The arm modulo a prime, with random numbers for its symbols.
    plain = replace(robot, links=(), gravity=None)
    domain = _AtRest(PolynomialDomain(plain, rates=False), 1, seed)
    chain = build_chain(plain, domain)
    first, *others = (_integers(joint.fixed @ joint.motion(chain.zero, chain.one)) for joint in chain.joints)
    loop = Loop(tuple(joint.revolute for joint in chain.joints), (first, *others, _integers(chain.tool)), domain.prime)
    loop = replace(loop, gaps=(loop.product(_integers(chain.base), first), *loop.gaps[1:]))
    motions, draw = [], random.Random(seed + 1)
    for turns in loop.revolute:
        # A rational point of the circle: cosine and sine of the angle whose half has the tangent t.
        t = draw.randrange(2, loop.prime - 1)
        scale = pow(1 + t * t, -1, loop.prime)
        pair = [np.array(x % loop.prime, dtype=object) for x in ((1 - t * t) * scale, 2 * t * scale)]
        motions.append(loop.settle(joint_motion(turns, *pair) if turns else joint_motion(turns, pair[0])))
    pose = loop.pose(motions)[None]
    loop = loop.locked([motion if i in given else None for i, motion in enumerate(motions)])
    loop = loop.with_tip if tip else loop
    if elimination.start:
        loop, pose = loop.rotated(elimination.start, pose)
    if _flint(finish_forms(loop, elimination.finish), loop.prime).rank() < 2:
        return 0
    return _System(loop, pose, elimination, random.Random(seed)).count()


def finish_forms(loop: Loop, way: Closure) -> Array:
    """Coefficients of cosine and sine of the (middle one of the) eliminated joints, (rows, k)."""
    if loop.tip:
        return way.eliminated_part(loop).reshape(-1, 3)[:, 1:]
    first = min(way.order[:3])
    three = Loop(loop.revolute[first : first + 3], loop.gaps[first : first + 4], loop.prime)
    carried = three.carried(way.alone.dropped)
    kept = list(carried.heights if three.revolute[way.alone.order[2]] else carried.along)
    parts: Array = three.settle(middle_part(three, way.alone)[0])
    return parts.reshape(3, 15)[1:, kept]


def _flint(matrix: Array, prime: int) -> Any:
    return nmod_mat(*matrix.shape, [int(x) for x in matrix.ravel()], prime)


class _System:
    """M(t) modulo a prime, with all equations between the unknown joints."""

    def __init__(self, loop: Loop, pose: Array, elimination: Elimination, draw: random.Random) -> None:
        self.loop, self.prime, self.draw = loop, loop.prime, draw
        self.hidden, self.multiplied = elimination.hidden, elimination.multiplied
        problem = EigenProblem(loop, elimination, (), ())
        self.others, self.shape, self.powers = problem.others, problem.shape, problem.powers
        place = elimination.unknowns.index(self.hidden)
        stacked = []
        for way in closures(loop):
            if way.unknowns == elimination.unknowns:
                # All ways around the loop with the same unknowns, not only those that the elimination takes.
                part = way.eliminated_part(loop)
                basis, nullity = _flint(part.reshape(*part.shape[-2:]).T, self.prime).nullspace()
                left = np.array([[int(x) for x in row] for row in basis.table()], dtype=object)[:, : int(nullity)].T
                forms = way.unknown_part(loop, pose_features(pose))[0]
                rows = loop.settle(left @ forms.reshape(len(forms), -1)).reshape(-1, *forms.shape[1:])
                for joint in elimination.straight:
                    if joint != self.hidden:
                        rows = rows.take([0, 1], axis=1 + elimination.unknowns.index(joint))
                stacked.append(self._multiplied(np.moveaxis(rows, 1 + place, 1)))
        fixed, one, two = np.moveaxis(np.concatenate(stacked), 1, 0)
        if loop.revolute[self.hidden]:
            # (1 + t^2) (1, c, s) = (1 + t^2, 1 - t^2, 2 t).
            fixed, one, two = fixed + one, 2 * two, fixed - one
        # (3, rows, columns): of powers of the half-angle tangent, or of the length.
        self.coefficients = loop.settle(np.stack([fixed, one, two]))

    def _multiplied(self, rows: Array) -> Array:
        """(rows, 3, columns): equations times cosine and sine of the half angle, or times 1 and the length."""
        count = len(rows)
        if self.multiplied is None:
            return rows.reshape(count, 3, -1)
        own = self.powers(self.multiplied)
        factors = HALF if self.loop.revolute[self.multiplied] else POWERS[:, :own, : own + 1]
        # Twice the factors, for those of half angles are halves.
        whole = np.vectorize(int, otypes=[object])(2 * factors)
        before = math.prod(self.powers(other) for other in self.others[: self.others.index(self.multiplied)])
        split = rows.reshape(count, 3, before, own, rows.size // (3 * own * count * before))
        product_ = np.tensordot(split, whole, axes=([3], [1]))  # rows, 3, before, after, factor, ext
        moved = product_.transpose(4, 0, 1, 2, 5, 3).reshape(2 * count, 3, -1)
        return self.loop.settle(moved)

    def count(self) -> int:
        columns, prime = self.coefficients.shape[2], self.prime
        # Random combinations of all rows: one more than there are columns.
        mixer = [[self.draw.randrange(prime) for _ in range(self.coefficients.shape[1])] for _ in range(columns + 1)]
        mixed = self.loop.settle(np.array(mixer, dtype=object) @ self.coefficients)
        # n - 1 of them and a random row: the last minors of these are a null vector v(t) of the n - 1.
        bordered = np.concatenate([mixed[:, : columns - 1], np.zeros((3, 1, columns), dtype=object)], axis=1)
        bordered[0, -1] = [self.draw.randrange(prime) for _ in range(columns)]
        vector = self._last_minors(bordered)
        rows = [self._polynomial([int(x) for x in row]) for row in mixed.transpose(1, 2, 0).reshape(-1, 3)]
        rest = [
            sum((rows[k * columns + j] * vector[j] for j in range(columns)), nmod_poly([], prime))
            for k in (columns - 1, columns)
        ]
        common = rest[0].gcd(rest[1])
        circle = self._polynomial([1, 0, 1])  # 1 + t^2, which stands for no angle
        while common != 0 and self.loop.revolute[self.hidden] and common % circle == 0:
            common = common // circle
        return self._solutions(common, vector) if common != 0 else 0

    def _polynomial(self, values: Sequence[int]) -> Any:
        return nmod_poly([x % self.prime for x in values], self.prime)

    def _last_minors(self, matrix: Array) -> list[Any]:
        """Minors of all rows but the last, with signs: polynomials from their values at enough points."""
        size, prime = matrix.shape[1], self.prime
        # Minors of n - 1 rows of degree 2 have degree 2 n - 2 at most: so many values determine them.
        points = list(range(1, 2 * size))
        values: list[list[int]] = [[] for _ in range(size)]
        unit = nmod_mat(size, 1, [0] * (size - 1) + [1], prime)
        for t in points:
            at = _flint(self.loop.settle(matrix[0] + t * matrix[1] + t * t * matrix[2]), prime)
            # Cofactors of the last row are det M times the last column of its inverse.
            determinant = at.det()
            solved = at.solve(unit) if determinant != 0 else None
            for j in range(size):
                values[j].append(0 if solved is None else int(solved[j, 0] * determinant))
        # Newton's divided differences.
        results = []
        for table in values:
            for level in range(1, len(points)):
                for k in range(len(points) - 1, level - 1, -1):
                    table[k] = (table[k] - table[k - 1]) * pow(points[k] - points[k - level], -1, prime) % prime
            total = nmod_poly([table[-1]], prime)
            for k in range(len(points) - 2, -1, -1):
                total = total * nmod_poly([-points[k] % prime, 1], prime) + table[k]
            results.append(total)
        return results

    def _solutions(self, g: Any, vector: list[Any]) -> int:
        """The number of roots of g at which the null vector is a vector of products."""
        # Each root once; where the whole vector vanishes at one the null space is larger, and nothing is decided.
        g = g // g.gcd(g.derivative())
        zero = g
        for entry in vector:
            zero = zero.gcd(entry)
        if zero.degree() > 0:
            return 0
        entries = dict(zip(product(*map(range, self.shape)), (entry % g for entry in vector), strict=True))
        for relation in self._relations(entries):
            g = g.gcd(relation % g)
        # Roots at which another joint is at infinity, or the vector zero, are no solutions: there this is zero.
        size = entries[(0,) * len(self.others)]
        if self.multiplied is not None and self.loop.revolute[self.multiplied]:
            axis = self.others.index(self.multiplied)
            pair = [entries[tuple(k if i == axis else 0 for i in range(len(self.others)))] for k in (2, 3)]
            size = pair[0] * pair[0] + pair[1] * pair[1]
        infinite = g.gcd(size % g)
        while infinite.degree() > 0:
            g = g // infinite
            infinite = g.gcd(size % g)
        return int(g.degree())

    def _relations(self, entries: dict[tuple[int, ...], Any]) -> Iterator[Any]:
        """What vanishes where the vector is one of products."""
        keys = list(entries)
        for axis, joint in enumerate(self.others):
            lines = [
                [entries[(*key[:axis], k, *key[axis + 1 :])] for k in range(self.shape[axis])]
                for key in keys
                if not key[axis]
            ]
            # Rank 1: all lines along an axis are parallel, 2 x 2 minors vanish.
            for line, other in pairwise(lines):
                for j in range(1, len(line)):
                    yield line[0] * other[j] - line[j] * other[0]
            for line in lines:
                if not self.loop.revolute[joint]:
                    for (a, b), (c, d) in pairwise(pairwise(line)):
                        yield a * d - b * c
                    if len(line) > 3:
                        yield line[0] * line[3] - line[1] * line[2]
                elif len(line) > 3:  # cosine and sine of 3/2 and of 1/2 of the angle
                    a, b, c, d = line
                    yield a * c + b * d - c * c + d * d
                    yield b * c - a * d - 2 * c * d
                    yield a * a + b * b - c * c - d * d
                else:
                    a, b, c = line
                    yield b * b + c * c - a * a
