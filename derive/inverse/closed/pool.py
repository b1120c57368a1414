"""The equations of an arm: every cut of the chain into M = joints i..j and what lies around it.

With W the pose within the arm, from the first joint to the last, M = L^-1 W R^-1, where L are the joints before i and R
those after j. Besides the entries of both sides their invariants are compared, as Pieper and Raghavan and Roth do:

    p,  u = R^T p,  p.p,  x^2 + y^2 of p and of u,  m = [p]x R,  k = p.p R - 2 p u^T.

All of these but x^2 + y^2 are linear in those of W, whatever is multiplied to W from either side (they are a linear
representation of rigid motions), so that the right hand sides stay short. With a the translation and Q the rotation:

    W Trans(a):  p + R a,   u + a,      p.p + 2 u.a + a.a,  m + R [a],  k - 2 m [a] - 2 p a^T + a.a R - 2 R a a^T
    Trans(a) W:  p + a,     u + R^T a,  p.p + 2 p.a + a.a,  m + [a] R,  k - 2 [a] m - 2 a u^T + a.a R - 2 a a^T R
    W Q:         p,         Q^T u,      p.p,                m Q,        k Q
    Q W:         Q p,       u,          p.p,                Q m,        Q k

A cut may lie at either end of the offset d of its joint: the distance of a wrist's centre is that of one of the ends.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cache
from typing import Generic

from derive.mechanics import vectors
from derive.mechanics.chain import Domain, build_chain
from derive.mechanics.vectors import Frame, Matrix, S, Vector, add, add_matrices, matmul, multiply, scale, transpose
from derive.robot.robot import Robot

_PLACES = [f"[{row},{column}]" for row in (1, 2, 3) for column in (1, 2, 3)]
# Entries of the rotation and the position, and the invariants that lectures use.
ENTRIES = *(f"R{ij}" for ij in _PLACES), *(f"{v}[{k}]" for v in "pu" for k in (1, 2, 3)), "p.p", "p.xy", "u.xy"
HIGHER = tuple(f"{name}{place}" for name in "mk" for place in _PLACES)  # the invariants of Raghavan and Roth besides


@dataclass(frozen=True, slots=True)
class Atoms(Generic[S]):
    """A rigid transform and its invariants; see the head of the module."""

    rotation: Matrix[S]  # R
    position: Vector[S]  # p
    back: Vector[S]  # u = R^T p
    square: S  # p.p
    moment: Matrix[S] | None = None  # m, None where the higher invariants are not asked for
    reflection: Matrix[S] | None = None  # k, likewise

    def moved_after(self, a: Vector[S]) -> Atoms[S]:
        """The atoms of W Trans(a)."""
        r, p, u, m, k = self.rotation, self.position, self.back, self.moment, self.reflection
        length = vectors.dot(a, a)
        square = self.square + 2 * vectors.dot(u, a) + length
        ra = multiply(r, a)
        if m is None or k is None:
            return Atoms(r, add(p, ra), add(u, a), square)
        cross = vectors.hat(a, length - length)
        sums = add_matrices(matmul(m, cross), vectors.outer(add(p, ra), a))
        k = add_matrices(add_matrices(k, scaled(-2, sums)), scaled(length, r))
        return Atoms(r, add(p, ra), add(u, a), square, add_matrices(m, matmul(r, cross)), k)

    @property
    def inverse(self) -> Atoms[S]:
        """The atoms of W^-1: R^T, -u, -p, p.p, m^T and k^T."""
        m, k = (None if x is None else transpose(x) for x in (self.moment, self.reflection))
        return Atoms(transpose(self.rotation), scale(-1, self.back), scale(-1, self.position), self.square, m, k)

    def turned_after(self, q: Matrix[S]) -> Atoms[S]:
        """The atoms of W Q, with Q a rotation."""
        moment, reflection = (None if m is None else matmul(m, q) for m in (self.moment, self.reflection))
        back = multiply(transpose(q), self.back)
        return Atoms(matmul(self.rotation, q), self.position, back, self.square, moment, reflection)

    def after(self, frame: Frame[S]) -> Atoms[S]:
        """The atoms of W F, with F a frame."""
        return self.moved_after(frame.position).turned_after(frame.rotation)

    def without_after(self, frame: Frame[S]) -> Atoms[S]:
        """The atoms of W F^-1, with F a frame."""
        return self.turned_after(transpose(frame.rotation)).moved_after(scale(-1, frame.position))

    def before(self, frame: Frame[S]) -> Atoms[S]:
        """The atoms of F W = (W^-1 F^-1)^-1, with F a frame."""
        return self.inverse.without_after(frame).inverse

    def without_before(self, frame: Frame[S]) -> Atoms[S]:
        """The atoms of F^-1 W = (W^-1 F)^-1, with F a frame."""
        return self.inverse.after(frame).inverse

    def mapped(self, change: Callable[[S], S]) -> Atoms[S]:
        """The atoms with a function applied to every number."""

        def _vector(v: Vector[S]) -> Vector[S]:
            return (change(v[0]), change(v[1]), change(v[2]))

        def _matrix(m: Matrix[S]) -> Matrix[S]:
            return (_vector(m[0]), _vector(m[1]), _vector(m[2]))

        moment, reflection = (None if m is None else _matrix(m) for m in (self.moment, self.reflection))
        position, back = _vector(self.position), _vector(self.back)
        return Atoms(_matrix(self.rotation), position, back, change(self.square), moment, reflection)

    def entry(self, name: str) -> S:
        """One of the entries and invariants."""
        if name == "p.p":
            return self.square
        if name in ("p.xy", "u.xy"):
            x, y, _ = self.position if name == "p.xy" else self.back
            return x * x + y * y
        first, *second = [int(number) - 1 for number in name[2:-1].split(",")]
        if not second:
            return (self.position if name[0] == "p" else self.back)[first]
        matrix = {"R": self.rotation, "m": self.moment, "k": self.reflection}[name[0]]
        assert matrix is not None, "the higher invariants are asked for"
        return matrix[first][second[0]]


def dimension(entry: str) -> int:
    """The power of length that an entry has."""
    return 2 if "." in entry or entry[0] == "k" else 0 if entry[0] == "R" else 1


@dataclass(frozen=True, slots=True)
class Cut:
    """M = joints first..last."""

    first: int  # the first joint of M, from 0
    last: int  # its last joint
    outer_left: bool = False  # whether M begins after the offset of its first joint, which then lies around it
    outer_right: bool = False  # whether M ends before the offset of its last joint


class Links(Generic[S]):
    """The constant frames between the joint motions, and the motions.

    `base` lies before the first motion, `start` is the same where M begins with it, `tool` lies after the last one;
    `twists` lie before each joint's motion, after the offset of the joint before; `offsets` along or about its axis.
    """

    def __init__(
        self,
        robot: Robot,
        domain: Domain[S],
        motion: Callable[[int, int], tuple[S, ...]],
        keep_tool: bool = False,
        keep_base: bool = False,
    ) -> None:
        chain = build_chain(replace(robot, links=(), gravity=None), domain)
        self.zero, self.one, self.n, self.motion = chain.zero, chain.one, chain.n, motion
        unit = self.unit = chain.unit
        self.twists = [joint.fixed for joint in chain.joints]
        self.offsets = []
        for joint in robot.joints:  # the constant part of its motion, which commutes with the rest
            along = domain.constant(joint.d) if joint.is_revolute else self.zero
            turn = vectors.about_axis(2, *domain.cosine_sine(joint.theta), self.zero, self.one)
            self.offsets.append(Frame(turn, (self.zero, self.zero, along)))
        self.base = chain.base @ self.twists[0]
        self.tool = chain.tool
        if self.n > 1 or not keep_tool:
            self.base, self.offsets[0] = self.base @ self.offsets[0], unit
        last = self.offsets[-1] @ self.tool
        self.offsets[-1], self.tool = (last, unit) if keep_tool else (unit, last)
        self.start = self.base if keep_base else None
        self.base = unit if keep_base else self.base

    def cuts(self) -> Iterator[Cut]:
        """All cuts, those of short M first."""
        along = [bool(offset.position[2]) for offset in self.offsets]
        for size in range(self.n):
            for first in range(self.n - size):
                last = first + size
                left = [False, True] if size and along[first] else [False]
                right = [False, True] if size and along[last] and last < self.n - 1 else [False]
                yield from (Cut(first, last, a, b) for a in left for b in right)

    def moved(self, atoms: Atoms[S], joint: int, start: int, sign: int = 1) -> Atoms[S]:
        """W times the motion of a joint, or its inverse."""
        numbers = self.motion(joint, start)
        if len(numbers) == 1:
            return atoms.moved_after((self.zero, self.zero, sign * numbers[0]))
        return atoms.turned_after(vectors.about_axis(2, numbers[0], sign * numbers[1], self.zero, self.one))

    def before(self, atoms: Atoms[S], joint: int) -> Atoms[S]:
        """What is right of a joint and of its offset, (.. Z_joint D_joint K)^-1 W."""
        if joint == 0 and self.start is not None:
            atoms = atoms.without_before(self.start)
        atoms = self.moved(atoms.inverse, joint, 0).inverse
        return atoms.without_before(self.offsets[joint]).without_before(self.twists[joint + 1])

    def after(self, atoms: Atoms[S], joint: int) -> Atoms[S]:
        """What is left of a joint, W (K Z_joint D_joint ..)^-1."""
        return self.moved(atoms.without_after(self.offsets[joint]), joint, -1, -1).without_after(self.twists[joint])


class Pool(Generic[S]):
    """Both sides of every cut of one arm, computed when asked for."""

    def __init__(self, links: Links[S], pose: Atoms[S]) -> None:
        self.links = links
        self._unit = frame_atoms(links.unit, links.zero, deep=pose.moment is not None)
        self._pose = pose
        self.inside = cache(self._inside)
        self.around = cache(self._around)

    def sides(self, cut: Cut) -> tuple[Atoms[S], Atoms[S]]:
        """M, and L^-1 W R^-1."""
        links, first, last = self.links, cut.first, cut.last
        inside, around = self.inside(first, last), self.around(first, last)
        left, right, is_long = links.offsets[first], links.offsets[last], first != last
        if is_long and cut.outer_left:
            around = around.without_before(left)
        elif is_long:
            inside = inside.before(left)
        if not cut.outer_right if is_long else last == links.n - 1:
            return inside.after(right), around
        return inside, around.without_after(right)

    def _inside(self, first: int, last: int) -> Atoms[S]:
        links = self.links
        if first == last:
            begin = self._unit if first or links.start is None else self._unit.after(links.start)
            return links.moved(begin, first, first)
        before = self.inside(first, last - 1)
        step = links.twists[last] if last - 1 == first else links.offsets[last - 1] @ links.twists[last]
        return links.moved(before.after(step), last, first)

    def _around(self, first: int, last: int) -> Atoms[S]:
        if last < self.links.n - 1:
            return self.links.after(self.around(first, last + 1), last + 1)
        return self._pose if first == 0 else self.links.before(self.around(first - 1, last), first - 1)


def frame_atoms(frame: Frame[S], zero: S, *, deep: bool) -> Atoms[S]:
    """The atoms of a frame, by their definitions."""
    r, p = frame.rotation, frame.position
    back, square = multiply(transpose(r), p), vectors.dot(p, p)
    if not deep:
        return Atoms(r, p, back, square)
    reflection = add_matrices(scaled(square, r), scaled(-2, vectors.outer(p, back)))
    return Atoms(r, p, back, square, matmul(vectors.hat(p, zero), r), reflection)


def frame_of(entries: Mapping[tuple[int, int], S]) -> Frame[S]:
    """A frame from its entries by row and column, from 0."""
    x, y, z = ((entries[i, 0], entries[i, 1], entries[i, 2]) for i in range(3))
    return Frame((x, y, z), (entries[0, 3], entries[1, 3], entries[2, 3]))


def scaled(factor: S | int, m: Matrix[S]) -> Matrix[S]:
    """A matrix times a number."""
    return (scale(factor, m[0]), scale(factor, m[1]), scale(factor, m[2]))
