"""A polynomial read in other angles of its groups: q2 and q3 in place of q2 and q2 + q3.

The generators of a ring stay; only what they stand for changes: the sine and cosine of a group's i-th generator become
those of the i-th angle of a tree of sums (`derive.algebra.contraction`). Products stay products on the way there and
back, so that a factor found in one basis is a factor in all.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

from derive.algebra.contraction import Edge, Tree, paths, trees
from derive.algebra.domain import PolynomialDomain
from derive.algebra.generators import Kind
from derive.algebra.ring import Polynomial

Pair = tuple[Polynomial, Polynomial]
"""Cosine and sine."""

Bases = Mapping[int, Tree]
"""Group number -> the tree that its generators are read in; groups that are not named are left as they are."""


@dataclass(frozen=True)
class AngleBases:
    """Changes between the angle bases of one domain.

    Args:
        domain: The domain of the polynomials.
    """

    domain: PolynomialDomain

    @cached_property
    def _places(self) -> dict[tuple[Kind, int], int]:
        return {(g.kind, g.joint): i for i, g in enumerate(self.domain.generators) if g.joint >= 0}

    def sine(self, joint: int) -> int:
        """Index of the generator that is the sine of a joint's angle."""
        return self._places[Kind.SINE, joint]

    def cosine(self, joint: int) -> int:
        """Index of the generator that is the cosine of a joint's angle."""
        return self._places[Kind.COSINE, joint]

    def own(self, group: int) -> Tree:
        """The tree that the ring's own generators are: sums from the first joint of the group on, or single angles."""
        return self.trees(group)[0]

    def trees(self, group: int) -> tuple[Tree, ...]:
        """The bases of a group, its own first."""
        joints = self.domain.groups[group]
        return trees(len(joints), len(joints) > 1 and len(self.domain.angles[joints[1]]) > 1)

    def to(self, p: Polynomial, bases: Bases) -> Polynomial:
        """A polynomial in the own angles, read in others."""
        return self._composed(p, {g: _steps(tree, self.own(g)) for g, tree in bases.items()})

    def back(self, p: Polynomial, bases: Bases) -> Polynomial:
        """A polynomial read in other angles, in the own ones."""
        return self._composed(p, {g: _steps(self.own(g), tree) for g, tree in bases.items()})

    def _composed(self, p: Polynomial, steps: Mapping[int, list[dict[int, int]]]) -> Polynomial:
        images = list(self.domain.ring.context.gens())
        for group, paths_of in steps.items():
            joints = self.domain.groups[group]
            for joint, path in zip(joints, paths_of, strict=True):
                cosine, sine = self._sum(joints, path)
                images[self.cosine(joint)], images[self.sine(joint)] = cosine.raw, sine.raw
        return self.domain.ring.wrap(p.raw.compose(*images))

    def _sum(self, joints: tuple[int, ...], path: Mapping[int, int]) -> Pair:
        """Cosine and sine of a signed sum of generator angles."""
        ring = self.domain.ring
        cosine, sine = ring.one, ring.zero
        for place, sign in path.items():
            c, s = (self._generator(index(joints[place])) for index in (self.cosine, self.sine))
            s = sign * s
            cosine, sine = cosine * c - sine * s, sine * c + cosine * s
        return cosine, sine

    def _generator(self, index: int) -> Polynomial:
        return self.domain.ring.generator(self.domain.generators[index].name)


def _steps(basis: Tree, wanted: tuple[Edge, ...]) -> list[dict[int, int]]:
    """Every wanted sum of angles as a signed sum of the angles of a basis."""
    return [paths(basis, lo)[hi] for lo, hi in wanted]
