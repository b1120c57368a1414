"""Polynomial equations between a few joints as an eigenvalue problem.

Equations between some joints of the loop (`derive.inverse.general.closure`) are polynomials in the half-angle tangent t
of one of them, the *hidden* joint, and in products of (1, c, s) of the others. Where there are fewer equations than
products, each is multiplied by cosine and sine of half the angle of one more joint, whose (1, c, s) become the cosines
and sines of 3/2 and 1/2 of the angle. A square system M(t) v = 0 is left, v the vector of products: t is an eigenvalue,
v an eigenvector, and the other joints are ratios of entries of v (Raghavan and Roth 1993; Manocha and Canny, Efficient
inverse kinematics for general 6R manipulators, IEEE T-RA 10(5), 1994).

With z = exp(i theta) of the hidden joint the equations are A + z P + conj(P)/z. The coefficients P of z have a small
rank, because a rotation moves few combinations of the fifteen numbers by z: rows w with w P = 0 are of the first degree
after multiplication with 1 + i t, and the factors 1 + t^2 of the determinant, which are no solutions, are gone before
the eigenvalues are computed: sixteen of them for a general arm, not twenty-four.

Angles are counted from a turn of the hidden joint at which M is far from singular, so that t = infinity is no solution;
likewise the lengths of a slide, of which M is singular at infinity in some arms.
An elimination is used only where M is regular at generic poses: then every solution is among the eigenvalues.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from derive.inverse.general.closure import Closure, Loop
from derive.inverse.general.rigid_motion import FEATURES, Array, pose_features

HALF = np.zeros((2, 3, 4))  # (cos, sin)(x/2) times (1, c, s)(x) in terms of (cos 3x/2, sin 3x/2, cos x/2, sin x/2)
HALF[0, 0, 2] = HALF[1, 0, 3] = 1.0
HALF[0, 1, (0, 2)] = HALF[0, 2, (1, 3)] = HALF[1, 1, 1] = HALF[1, 2, 2] = 0.5
HALF[1, 1, 3] = HALF[1, 2, 0] = -0.5

POWERS = np.zeros((2, 3, 4))  # (1, d) times (1, d, d^2) in terms of (1, d, d^2, d^3)
POWERS[(0, 0, 0, 1, 1, 1), (0, 1, 2, 0, 1, 2), (0, 1, 2, 1, 2, 3)] = 1.0


@dataclass(frozen=True, slots=True)
class EliminationPolicy:
    """Every threshold of general nodes."""

    rank: float = 1e-9  # singular values, relative to the largest, that count as zero
    real: float = 1e-3  # imaginary part of tan(theta/2), relative to 1 + |t|^2, up to which a candidate is tried
    residual: float = 1e-10  # largest error of an entry of a solution's pose, lengths relative to the reach
    apart: float = 1e-6  # solutions closer than this are one
    turns: int = 4  # places of the hidden joint that are tried as that of t = infinity
    steps: int = 12  # most Newton steps of a candidate
    trials: int = 24  # poses at which eliminations are compared
    options: int = 24  # eliminations that are compared, those with the fewest eigenvalues
    # Angles tan^-1 t closer than this are one eigenvalue, as where solutions share the hidden joint.
    shared: float = 1e-5
    regular: float = 1e3  # entries of that inverse up to which the lengths of a slide are taken as they are
    singular: float = 1e8  # entries of the inverse of the leading rows from which on M is singular for every t
    far: float = 1e3  # slides beyond this many reaches are no solutions but rounding of infinite ones
    approach: int = 60  # most steps from poor candidates at poses with infinitely many solutions
    near: float = 1e-4  # error of a pose before refinement below which a candidate should have become a solution
    rough: float = 1e-6  # error before refinement above which a candidate that became a solution was a lucky start
    alone: float = 1e-5  # smallest singular value of the derivatives at a solution that is none of a continuum


POLICY = EliminationPolicy()


@dataclass(frozen=True)
class Reduction:
    """How the equations of one way around the loop split by their degree in the hidden joint."""

    closure: Closure  # the way around the loop
    equations: int  # number of equations, after elimination
    constant: int = 0  # how many combinations do not hold the hidden joint
    linear: int = 0  # how many further complex (for a slide real) combinations are of the first degree


@dataclass(frozen=True)
class Elimination:
    """One way to find all solutions of an arm."""

    reductions: tuple[Reduction, ...]  # the equations that are used
    hidden: int  # index of the joint whose tan(theta/2), or length, is the eigenvalue
    multiplied: int | None  # index of the joint with whose half angle the equations are multiplied; None for none
    rows: tuple[int, int, int]  # how many rows of M are of degree 0, 1 and 2
    finish: Closure  # along which way around the loop the eliminated joints follow
    start: int = 0  # the joint of the arm at which the loop begins; all other indices are counted from there
    straight: tuple[int, ...] = ()  # slides of which no squares occur

    @property
    def eigenvalues(self) -> int:
        """The size of the eigenvalue problem, a bound of the number of solutions."""
        return self.rows[1] + 2 * self.rows[2]

    @property
    def unknowns(self) -> tuple[int, ...]:
        """The joints between which the equations hold."""
        return self.finish.unknowns

    def available(self, loop: Loop) -> tuple[int, int, int]:
        """How many equations are of degree 0, 1 and 2, before they are multiplied."""
        constant = sum(each.constant for each in self.reductions)
        linear = sum(each.linear for each in self.reductions) * (2 if loop.revolute[self.hidden] else 1)
        return constant, linear, sum(each.equations for each in self.reductions) - constant - linear


@dataclass(frozen=True, eq=False)
class Equations:
    """The equations of one way around the loop in numbers, split by degree."""

    reduction: Reduction  # their structure
    # (..., equations, numbers) combinations of what is carried around, without the eliminated joints.
    combinations: Array
    constant: Array  # (..., constant, equations) rows of degree 0
    linear: Array  # (..., linear, equations) complex rows of degree 1
    rest: Array  # (..., rest, equations) the others

    @classmethod
    def of(cls, loop: Loop, reduction: Reduction, hidden: int) -> Equations:
        """The numbers of an arm."""
        m = reduction.equations
        # Combinations in which the products of the eliminated joints cancel (Raghavan and Roth 1993).
        left = left_null(reduction.closure.eliminated_part(loop), m)
        none = np.zeros((*left.shape[:-2], 0, m))
        unit = np.broadcast_to(np.eye(m), (*left.shape[:-2], m, m))
        if not reduction.constant + reduction.linear:
            return cls(reduction, left, none, none, unit)
        if reduction.closure.aligned != hidden:
            return cls(reduction, left, none, unit, none)
        closure = reduction.closure
        # The equations are A + c P + s Q in the hidden joint: w P = w Q = 0 leaves rows of degree 0 in t.
        _, first, second = loop.joint_actions(loop.carried(closure.dropped), hidden, closure.direction)
        moved, moved_twice = left @ first, left @ second
        turns = loop.revolute[hidden]
        constant = left_null(np.concatenate([moved, moved_twice], axis=-1), reduction.constant)
        # c P + s Q = z (P - iQ)/2 + conj: rows w with w (P - iQ) = 0 are of the first degree after times 1 + i t;
        # orthogonal to those of degree 0, so that none counts twice.
        top = moved - 1j * moved_twice if turns else moved_twice
        free = left_null(np.concatenate([top, _adjoint(constant)], axis=-1), reduction.linear)
        taken = np.concatenate([constant, free.real, free.imag] if turns else [constant, free], axis=-2)
        # What is orthogonal to both is of degree 2 and fills up to as many rows as there are equations.
        rest = left_null(_adjoint(taken), m - taken.shape[-2])
        return cls(reduction, left, constant, free, rest)

    def rows(self, forms: Array, turn: Array, turns: bool) -> tuple[Array, Array, Array]:
        """Coefficients of t^0, t^1 and t^2 of the rows of degree 0, 1 and 2.

        (poses, rows of the degree, degree + 1, products) for each degree, of forms (poses, equations, 3, products), the
        second last axis for the hidden joint; turn (poses,) is where that is counted from (`EigenProblem.position`).
        """
        fixed, one, two = forms[:, :, 0], forms[:, :, 1], forms[:, :, 2]
        # A slide is substituted projectively, so that its infinity is turned away from t = infinity:
        if not turns:  # d = (s + c t)/(c - s t)
            c, s = np.cos(0.5 * turn)[:, None, None], np.sin(0.5 * turn)[:, None, None]
            first = np.stack([self.linear @ part for part in (c * fixed + s * one, c * one - s * fixed)], axis=2)
            middle = 2.0 * c * s * (two - fixed) + (c * c - s * s) * one
            ends = c * c * fixed + c * s * one + s * s * two, s * s * fixed - c * s * one + c * c * two
            second = np.stack([self.rest @ part for part in (ends[0], middle, ends[1])], axis=2)
            return (self.constant @ fixed)[:, :, None], first, second
        # cos and sin of the angle less the turn, then (1 + t^2) (c, s) = (1 - t^2, 2 t).
        c, s = np.cos(turn)[:, None, None], np.sin(turn)[:, None, None]
        one, two = one * c + two * s, two * c - one * s
        still, turned = self.linear @ fixed, self.linear @ one
        pair = np.stack([still + turned, 1j * (still - turned)], axis=2)  # still (1 + i t) + turned (1 - i t)
        zero, fixed, one, two = self.constant @ fixed, self.rest @ fixed, self.rest @ one, self.rest @ two
        second = np.stack([fixed + one, 2.0 * two, fixed - one], axis=2)
        return zero[:, :, None], np.concatenate([pair.real, pair.imag], axis=1), second


@dataclass(frozen=True, eq=False)
class EigenProblem:
    """The eigenvalue problem M(t) v = 0 of a numeric arm."""

    loop: Loop  # the arm, in a unit of length that makes its numbers alike
    elimination: Elimination  # how M is made
    equations: tuple[Equations, ...]  # the numbers of each way around the loop that is used
    mixers: tuple[Array, ...]  # for each degree the fixed combinations of rows that are kept
    # For each way around the loop (35, equations, 3, products): the coefficients are linear in the features of the
    # pose (`derive.inverse.general.rigid_motion.pose_features`). None where the arm differs from pose to pose.
    tables: tuple[Array, ...] = ()

    @classmethod
    def of(cls, loop: Loop, elimination: Elimination) -> EigenProblem:
        """The eigenvalue problem of an arm."""
        equations = tuple(Equations.of(loop, each, elimination.hidden) for each in elimination.reductions)
        factor = 1 if elimination.multiplied is None else 2
        counts = zip(elimination.rows, elimination.available(loop), strict=True)
        mixers = tuple(_mixer(kept, factor * count) for kept, count in counts)
        # The coefficients are linear in the 35 features of a pose: one table for all poses of an arm.
        problem = cls(loop, elimination, equations, mixers)
        if any(gap.ndim > 2 for gap in loop.gaps):
            return problem
        unit = np.eye(FEATURES)
        return replace(problem, tables=tuple(problem._of_features(each, unit) for each in equations))

    def matrices(self, forms: Sequence[Array], turn: Array) -> tuple[Array, Array, Array]:
        """The rows of M by degree, each as coefficients of powers of t.

        (poses, rows of the degree, degree + 1, columns) for each degree, the hidden joint counted from turn (poses,).
        """
        turns = self.loop.revolute[self.elimination.hidden]
        parts = [each.rows(form, turn, turns) for each, form in zip(self.equations, forms, strict=True)]
        joined = [np.concatenate([part[degree] for part in parts], axis=1) for degree in range(3)]
        return tuple(
            np.einsum("kr,nrpx->nkpx", mixer, self.multiplied(rows))
            for mixer, rows in zip(self.mixers, joined, strict=True)
        )

    def forms(self, pose: Array) -> list[Array]:
        """The coefficients of the equations, for each way around the loop (poses, equations, 3, products)."""
        features = pose_features(pose)
        if self.tables:
            return [np.tensordot(features, table, axes=1) for table in self.tables]
        return [self._of_features(each, features) for each in self.equations]

    def _of_features(self, equations: Equations, features: Array) -> Array:
        elimination = self.elimination
        part = equations.reduction.closure.unknown_part(self.loop, features)
        # Eliminate, then leave out squares of slides that occur in no equation: no column of M for them.
        part = (equations.combinations @ part.reshape(*part.shape[:2], -1)).reshape(len(part), -1, *part.shape[2:])
        for joint in elimination.straight:
            if joint != elimination.hidden:
                part = part.take([0, 1], axis=2 + elimination.unknowns.index(joint))
        # The hidden joint first; the products of the others become the columns of M.
        part = np.moveaxis(part, 2 + elimination.unknowns.index(elimination.hidden), 2)
        return part.reshape(*part.shape[:3], -1)

    @property
    def others(self) -> tuple[int, ...]:
        """The unknown joints but the hidden one."""
        return tuple(joint for joint in self.elimination.unknowns if joint != self.elimination.hidden)

    @property
    def shape(self) -> tuple[int, ...]:
        """How many entries of v belong to each of the other joints."""
        return tuple(self.powers(joint) + (joint == self.elimination.multiplied) for joint in self.others)

    def position(self, turn: Array, t: Array) -> Array:
        """The hidden joint: its angle is turn + 2 atan t, its length tan(turn/2 + atan t), so that none is at infinity.

        Shapes of `turn` and `t` broadcast.
        """
        half = 0.5 * turn + np.arctan(t)
        return 2.0 * half if self.loop.revolute[self.elimination.hidden] else np.tan(half)

    def powers(self, joint: int) -> int:
        """How many of 1, c, s or 1, d, d^2 occur in the equations."""
        return 2 if joint in self.elimination.straight else 3

    def multiplied(self, rows: Array) -> Array:
        """The rows times what the multiplied joint contributes.

        (poses, 2 * rows, powers, columns); the rows themselves where nothing is multiplied.
        """
        joint, (n, count, powers) = self.elimination.multiplied, rows.shape[:3]
        if joint is None:
            return rows
        own = self.powers(joint)
        before = math.prod(self.powers(other) for other in self.others[: self.others.index(joint)])
        # Axes: pose, row, power of t, joints before, the multiplied joint, joints after.
        split = rows.reshape(n, count, powers, before, own, rows.shape[3] // (own * before))
        factors = HALF if self.loop.revolute[joint] else POWERS[:, :own, : own + 1]
        product: Array = np.einsum("nrpxay,kae->nrkpxey", split, factors)
        return product.reshape(n, 2 * count, powers, rows.shape[3] // own * (own + 1))

    def eigen(self, pose: Array) -> tuple[Array, Array, Array, Array]:
        """Eigenvalues and vectors.

        t (poses, k), v (poses, columns, k), both complex, the turn that t is counted from (poses,), and where M is
        singular for every t (poses,): where solutions are infinitely many.
        """
        forms, count = self.forms(pose), len(pose)
        turns = self.loop.revolute[self.elimination.hidden]
        best: list[Array] = []
        for k in range(POLICY.turns):
            if k and not turns and (best[0] < POLICY.regular).all():
                break
            turn = np.full(count, 0.3 * turns + 2.0 * math.pi * k / POLICY.turns)
            rows = self.matrices(forms, turn)
            rows = tuple(part / _norm(part) for part in rows)  # type: ignore[assignment]
            # M is inverted at t = infinity: of several turns the one is kept at which it is farthest from singular.
            leading = np.concatenate([part[:, :, -1] for part in rows], axis=1)
            inverse, size = _inverse(leading)
            if not best:
                best = [size, turn, inverse, *rows]
                continue
            better = size < best[0]
            for old, new in zip(best, (size, turn, inverse, *rows), strict=True):
                old[better] = new[better]
        size, turn, inverse, _, first, second = best
        # A polynomial eigenvalue problem made linear (Manocha and Canny 1994, section V); v follows from H v = x.
        values, vectors = np.linalg.eig(_companion(first, second, inverse))
        n1, n2 = first.shape[1], second.shape[1]
        shift = inverse.shape[-1] - n1 - n2
        return values, inverse[:, :, shift:] @ vectors[:, : n1 + n2], turn, size > POLICY.singular


def _companion(first: Array, second: Array, inverse: Array) -> Array:
    """The matrix whose eigenvalues are t, x = H v with the leading rows H: (x1, x2, t x2), by degree of rows."""
    n1, n2 = first.shape[1], second.shape[1]
    # Rows of degree 0 hold at every t: x has no component along them, and their columns are left out.
    columns = inverse[:, :, inverse.shape[-1] - n1 - n2 :]
    low, lowest, middle = first[:, :, 0] @ columns, second[:, :, 0] @ columns, second[:, :, 1] @ columns
    result = np.zeros((len(first), n1 + 2 * n2, n1 + 2 * n2))
    # t x1 = -L0 x,  t x2 = (t x2),  t (t x2) = -Q0 x - Q1 (t x2) with t x1 put in.
    result[:, :n1, : n1 + n2] = -low
    result[:, n1 : n1 + n2, n1 + n2 :] = np.eye(n2)
    result[:, n1 + n2 :, : n1 + n2] = middle[:, :, :n1] @ low - lowest
    result[:, n1 + n2 :, n1 + n2 :] = -middle[:, :, n1:]
    return result


def _inverse(matrices: Array) -> tuple[Array, Array]:
    """The inverses, and the size of their entries: infinite for a pseudoinverse, where a matrix has no inverse."""
    try:
        inverse: Array = np.linalg.inv(matrices)
    except np.linalg.LinAlgError:
        regular: Array = np.linalg.slogdet(matrices)[0] != 0.0
        inverse = np.linalg.pinv(matrices)
        inverse[regular] = np.linalg.inv(matrices[regular])
        return inverse, np.where(regular, np.abs(inverse).max(axis=(1, 2)), np.inf)
    return inverse, np.abs(inverse).max(axis=(1, 2))


def _norm(rows: Array) -> Array:
    size = np.sqrt((rows**2).sum(axis=(2, 3), keepdims=True))
    return np.where(size > 0, size, 1.0)


def _adjoint(matrix: Array) -> Array:
    return np.swapaxes(matrix, -1, -2).conj()


def left_null(matrix: Array, count: int) -> Array:
    """Orthonormal rows w with w M = 0."""
    left = np.linalg.svd(matrix, full_matrices=True)[0]
    return _adjoint(left[..., left.shape[-1] - count :])


def _mixer(kept: int, available: int) -> Array:
    """Fixed combinations of rows, (kept, available); the rows themselves where all are kept."""
    if kept == available:
        return np.eye(kept)
    return np.linalg.qr(np.random.default_rng(kept).normal(size=(available, available)))[0][:kept]
