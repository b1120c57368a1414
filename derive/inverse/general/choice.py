"""Which elimination serves an arm best, and how many solutions the arm has.

Every regular elimination is listed, and they are tried at random poses. What one costs is the size of its eigenvalue
problem; what it is worth shows in how close its candidates are to solutions before Newton's method has had any luck
with them. The node of the arm takes the best one for each hidden joint, so that where one leaves a doubt the next is
asked.

The number of complex solutions of a generic pose comes from an elimination modulo a prime. The rank of M(t) drops at
the roots of a polynomial g, the common divisor of its largest minors. At such a root the null vector v(t) is a vector
of minors, thus again of polynomials. It belongs to a solution where it has the form of a vector of products, v(joint a)
x v(joint b) with cosine and sine on the unit circle: where polynomials in its entries vanish. Their greatest common
divisor with g has the solutions as its roots. Everything is counted at one random configuration of an arm whose free
parameters are random, modulo a prime: the number is the same for all generic poses.
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
from derive.inverse.general.elimination import HALF, POLICY, POWERS, EigenProblem, Elimination, Reduction, left_null
from derive.inverse.general.rigid_motion import Array, joint_motion, pose_features
from derive.inverse.general.search import FULL, GeneralFormula, GeneralSolution, free_loop, scaled
from derive.inverse.numeric.chain import POSE, Entries, NumericChain
from derive.mechanics.chain import build_chain
from derive.mechanics.vectors import Frame
from derive.robot.description import Joint
from derive.robot.names import free_symbols
from derive.robot.robot import Robot

# How many solutions an elimination found at the trials, and how it compares with others that found as many.
Result = tuple[int, tuple[bool, int, int, int], Elimination]
_SHARES = (0.97, 0.4)
# Errors of candidates above which others are better; far from usual ones, so that no processor's rounding decides.
_INEXACT = (1e-6, 1e-3)
_FOUND = 1e-3  # without units: so near is a configuration that was found, however close to a singular one


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
        return self.loop.settle(product_.transpose(4, 0, 1, 2, 5, 3).reshape(2 * count, 3, -1))

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
        points, values = range(1, 2 * size), list[int]()
        unit = nmod_mat(size, 1, [0] * (size - 1) + [1], prime)
        for t in points:
            at = _flint(self.loop.settle(matrix[0] + t * matrix[1] + t * t * matrix[2]), prime)
            # Cofactors of the last row are det M times the last column of its inverse.
            determinant = at.det()
            solved = at.solve(unit) if determinant != 0 else None
            values += [0] * size if solved is None else [int(solved[j, 0] * determinant) for j in range(size)]
        count = len(points)
        powers = nmod_mat(count, count, [pow(t, k, prime) for t in points for k in range(count)], prime)
        rows = powers.solve(nmod_mat(count, size, values, prime)).transpose().table()
        return [self._polynomial([int(x) for x in row]) for row in rows]

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
            ends = ((key[:axis], key[axis + 1 :]) for key in keys if not key[axis])
            lines = [[entries[(*head, k, *tail)] for k in range(self.shape[axis])] for head, tail in ends]
            # Rank 1: all lines along an axis are parallel, 2 x 2 minors vanish.
            for line, other in pairwise(lines):
                yield from (line[0] * other[j] - line[j] * other[0] for j in range(1, len(line)))
            for line in lines:
                if not self.loop.revolute[joint]:
                    yield from (a * d - b * c for (a, b), (c, d) in pairwise(pairwise(line)))
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


def eliminations(loop: Loop, pose: Array, start: int = 0) -> Iterator[Elimination]:
    """Every way to make a regular eigenvalue problem of a loop, at a generic pose, (1, 4, 4)."""
    groups: dict[tuple[int, ...], list[Closure]] = {}
    for way in closures(loop):
        groups.setdefault(way.unknowns, []).append(way)
    for unknowns, group in groups.items():
        # Of the ways around with the same unknowns the one from which the eliminated joints follow best.
        worth = [1.0 if loop.tip else np.linalg.svd(finish_forms(loop, way))[1].min() for way in group]
        rounded = [float(f"{value:.3g}") for value in worth]  # equal ones differ by rounding
        finish = group[rounded.index(max(rounded))]
        for hidden in unknowns:
            straight = tuple(joint for joint in unknowns if _is_straight(loop, pose, group, joint))
            reductions = [_reduction(loop, way, hidden, straight) for way in group]
            # Ways on which the hidden joint is next to the eliminated ones have rows of lower degree.
            reductions.sort(key=lambda each: each.closure.aligned != hidden)
            choices = [(each,) for each in reductions] + ([tuple(reductions)] if len(reductions) > 1 else [])
            for chosen, multiplied in product(choices, (None, *[joint for joint in unknowns if joint != hidden])):
                trial = Elimination(chosen, hidden, multiplied, (0, 0, 0), finish, start, straight)
                if (rows := _rows(loop, pose, trial)) is not None:
                    yield replace(trial, rows=rows)


def _rank(matrix: Array) -> int:
    sizes = np.linalg.svd(matrix, compute_uv=False)
    return int((sizes > POLICY.rank * sizes.max(initial=1e-3)).sum())


def _is_straight(loop: Loop, pose: Array, group: Sequence[Closure], joint: int) -> bool:
    """Whether a joint is a slide whose square occurs in no equation."""
    if loop.revolute[joint]:
        return False
    for way in group:
        part, forms = way.eliminated_part(loop), way.unknown_part(loop, pose_features(pose))
        left = left_null(part, part.shape[-2] - _rank(part.reshape(part.shape[-2:])))
        squares = forms.take(2, axis=2 + way.unknowns.index(joint)).reshape(*forms.shape[:2], -1)
        if np.abs(left @ squares).max(initial=0.0) > POLICY.rank:
            return False
    return True


def _reduction(loop: Loop, way: Closure, hidden: int, straight: tuple[int, ...]) -> Reduction:
    part = way.eliminated_part(loop)
    part = part[0] if part.ndim == 3 else part
    products = _rank(part)
    m = len(part) - products
    if way.aligned != hidden:
        return Reduction(way, m, 0, m if hidden in straight else 0)
    _, first, second = loop.joint_actions(loop.carried(way.dropped), hidden, way.direction)
    # Ranks of the parts tell how many combinations are free of the hidden joint, and of which z = exp(i q) is gone.
    constant = m + products - _rank(np.concatenate([part, first, second], axis=1))
    top = first - 1j * second if loop.revolute[hidden] else second
    linear = m + products - _rank(np.concatenate([part, top], axis=1)) - constant
    return Reduction(way, m, constant, linear)


def _rows(loop: Loop, pose: Array, elimination: Elimination) -> tuple[int, int, int] | None:
    """How many rows of each degree a square regular system takes; None where there is none."""
    hidden, factor = elimination.hidden, 1 if elimination.multiplied is None else 2
    zero, one, two = (factor * count for count in elimination.available(loop))
    trial = EigenProblem.of(loop, replace(elimination, rows=(zero, one, two)))
    turn = np.array([0.37 * loop.revolute[hidden]])
    columns = math.prod(trial.shape)
    kept: list[int] = []
    stacked = np.zeros((0, columns))
    for part in trial.matrices(trial.forms(pose), turn):
        # M at one place t: rows of low degree are preferred, for each adds fewer eigenvalues.
        values = (part[0] * 0.83 ** np.arange(part.shape[2])[:, None]).sum(axis=1)
        size = np.linalg.norm(values, axis=1, keepdims=True)
        stacked = np.concatenate([stacked, values / np.where(size > POLICY.rank, size, np.inf)])
        kept.append(_rank(stacked) - sum(kept) if len(stacked) else 0)
    return (kept[0], kept[1], kept[2]) if sum(kept) == columns and kept[0] < columns else None


def find_general(chain: NumericChain, given: Sequence[int] = (), entries: Entries = POSE) -> tuple[Elimination, ...]:
    """The eliminations that find all solutions of an arm, compared at random poses."""
    span = np.where(chain.revolute, math.pi, chain.reach)
    # Poses of random configurations, so that it is known which solutions there are.
    q = np.random.default_rng(7).uniform(-span, span, (POLICY.trials, chain.n))
    poses, values = chain.pose_and_jacobian(q)[0], q[:, list(given)] if given else None
    loop, free = free_loop(chain, given, None if values is None else values[:1], entries)
    pose, results = scaled(poses[:1], chain.reach), []
    if not 3 <= len(free) <= FULL[entries] or (entries == POSE and len(free) == 3):
        return ()
    for start in (0,) if loop.tip else range(0, loop.n, 3):
        turned, goal = loop.rotated(start, pose) if start else (loop, pose)
        for option in sorted(eliminations(turned, goal, start), key=lambda each: each.eigenvalues)[: POLICY.options]:
            with np.errstate(over="ignore", invalid="ignore"):  # joints that are nowhere near a solution
                found = GeneralSolution(tuple(given), entries, (option,)).attempt(0, chain, poses, values)
            # Certain: close before Newton's method; then few doubts, small eigenvalue problems, exact candidates.
            doubts = int(found.doubtful.sum()) > POLICY.trials // 10
            inexact = sum(found.error > bound for bound in _INEXACT)
            results.append((found.certain, (doubts, option.eigenvalues, len(option.reductions), inexact), option))
        ranked = _ranked(results)
        if ranked and not ranked[0][1][0]:
            break
    best: dict[tuple[int, int], Elimination] = {}
    for _, _, option in _ranked(results):
        best.setdefault((option.start, option.hidden), option)
    solution = GeneralSolution(tuple(given), entries, tuple(best.values()))
    if not best:
        return ()
    # The configurations that poses were made of have to be among their solutions.
    with np.errstate(all="ignore"):
        apart = np.abs(solution.solve(chain, poses, values) - q[:, None])
    apart = np.where(chain.revolute, np.abs((apart + math.pi) % (2.0 * math.pi) - math.pi), apart / chain.reach)
    found_all = (np.nan_to_num(apart.max(axis=-1), nan=np.inf).min(axis=1, initial=np.inf) < _FOUND).all()
    return solution.eliminations if found_all else ()


def _ranked(results: Sequence[Result]) -> list[Result]:
    """The best first: what finds nearly all solutions that any does, then what finds many; the rest is rounding."""
    most = max((certain for certain, _, _ in results), default=0)
    return sorted(results, key=lambda each: (sum(each[0] < share * most for share in _SHARES), each[1]))


def general_formula(
    robot: Robot, specimen: Robot, given: Sequence[int], generators: Sequence[tuple[str, ...]], entries: Entries = POSE
) -> GeneralFormula | None:
    """The general node of an arm; None where there is no elimination."""
    draw = random.Random(5)
    chain = NumericChain.of(robot, {name: draw.uniform(0.3, 1.1) for name in sorted(set(free_symbols(specimen)))})
    found = find_general(chain, given, entries)
    if not found:
        return None
    counts = (count_solutions(specimen, each, given, tip=entries != POSE) for each in found)
    count = next((number for number in counts if number), 0)
    return GeneralFormula(robot, GeneralSolution(tuple(given), entries, found, count), tuple(generators))
