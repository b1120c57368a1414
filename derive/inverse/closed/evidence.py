"""What the equations of the pool say about an arm, found at random reachable poses modulo a prime.

The entries of a pose are no independent numbers, so that ranks mean nothing as polynomials: where an arm reaches, whole
equations vanish. So joint values are drawn, W is what they lead to, and then one thing is changed while all others
stand: the angle between two sets of links of a group of parallel joints, or a slide. An equation in which its value
does not change with it does not determine it; else the value is a polynomial in cosine and sine of the change, whose
coefficients are found by interpolation. All is done at once, for all equations, as arrays of residues.
"""

import random
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from derive.algebra.residues import Array, Residue, ResidueDomain, echelon, residue
from derive.algebra.ring import Polynomial
from derive.inverse.closed.pool import ENTRIES, HIGHER, Atoms, Cut, Links, Pool, frame_atoms, frame_of
from derive.inverse.closed.unknowns import InverseDomain, turned
from derive.mechanics.vectors import Frame
from derive.robot.expression import Expression

POSES = 3  # random poses; what vanishes at all of them vanishes everywhere, but for a chance of 1 in 10^18
_SPECIAL_POSES = 32  # poses at which formulas may fail: most joints are at zero or at right angles
# Values of a change: five (three) determine a polynomial of degree 2, one more checks it.
_ANGLE_NODES, _LENGTH_NODES = 6, 4
_RIGHT = ((1, 0), (0, 1), (-1, 0), (0, -1))  # cosines and sines of right angles
_PLACE = re.compile(r"W\[(\d),(\d)\]")


@dataclass(frozen=True, slots=True)
class Change:
    """What is changed: a slide, or the links of a group on one side of an angle."""

    group: int  # number of the group, -1 for a slide
    links: int  # the links that turn, phi_k as bit k without bit 0; or the joint that slides


@dataclass(frozen=True)
class Effect:
    """How the equations depend on one change."""

    depends: Array  # for each equation whether what is changed occurs in it
    degrees: Array  # for each equation its degree in the change at poses that are reached; 3 stands for all above 2
    coefficients: Array  # for each equation and pose the coefficients of (1, c, s, c^2, c s), or of (1, r, r^2)


class Evidence:
    """The equations of an arm in numbers: cut and entry of each, the effect of each change on them.

    `other` is W with other numbers for entries of T that are not told; `allowed` are equations that do not need these.
    """

    def __init__(
        self,
        domain: InverseDomain,
        cuts: Sequence[Cut],
        allowed: frozenset[tuple[int, int]],
        *,
        keep_tool: bool = False,
        keep_base: bool = False,
        deep: bool = False,
        special: bool = False,
    ) -> None:
        self.poses, self._special = (_SPECIAL_POSES if special else POSES), special
        self.domain, self.robot = domain, domain.robot
        self.residues = ResidueDomain(domain, 1, seed=1)
        self.prime = self.residues.prime
        self._random = random.Random(1)
        self._nodes = [self._circle_point() for _ in range(_ANGLE_NODES - 1)]
        self._steps = [self._random.randrange(1, self.prime) for _ in range(_LENGTH_NODES - 1)]
        self.equations = [(cut, entry) for cut in cuts for entry in (*ENTRIES, *(HIGHER if deep else ()))]
        self._layout()
        links = Links(self.robot, self.residues, self._motion, keep_tool, keep_base)
        whole = Pool(links, frame_atoms(links.unit, links.zero, deep=deep)).sides(Cut(0, self.robot.n - 1))[0]
        samples, shape = (1, self._samples), (self.poses, self._width)  # at the poses themselves nothing is changed
        self.pose = whole.mapped(
            lambda x: Residue(self.prime, np.broadcast_to(x.values, samples).reshape(shape)[None, :, 0])
        )
        self.end = links.base @ Frame(self.pose.rotation, self.pose.position) @ links.tool
        reached = self._table(links, cuts, self.pose)
        anywhere = reached if special else self._table(links, cuts, self._elsewhere())
        self.effects = {change: self._effect(reached, anywhere, k) for k, change in enumerate(self.changes)}
        self.other, self.allowed = self.pose, np.ones(len(self.equations), dtype=bool)
        if untold := self.untold(allowed):
            entries = self._entries()
            for place in untold:
                entries[place] = Residue(self.prime, [[self._random.randrange(self.prime) for _ in range(self.poses)]])
            self.other = frame_atoms(links.base.inverse @ frame_of(entries) @ links.tool.inverse, links.zero, deep=deep)
            same = self._table(links, cuts, self.pose) == self._table(links, cuts, self.other)
            self.allowed = np.all(same.reshape(len(same), self.poses, self._width)[:, :, 0], axis=1)
        self._numbers: dict[str, Array] = {}

    def _layout(self) -> None:
        """The angles of the links of every group and the slides, for every sample: poses x (base + changes x nodes)."""
        robot, groups = self.robot, self.domain.groups
        self.changes = [Change(g, mask) for g, group in enumerate(groups) for mask in range(2, 2 << len(group), 2)]
        self.changes += [Change(-1, i) for i, joint in enumerate(robot.joints) if not joint.is_revolute]
        sizes = [len(self._nodes) if change.group >= 0 else len(self._steps) for change in self.changes]
        self._starts = np.cumsum([1, *sizes])
        self._width = int(self._starts[-1])
        self._samples = self.poses * self._width
        self.turns: list[list[tuple[Array, Array]]] = []
        for g, group in enumerate(groups):
            base = [(1, 0)] * self.poses
            links = [self._turned(g, 0, base)]
            for k in range(1, len(group) + 1):
                # phi_k of link k is the sum of the joint angles before it, by the addition theorems.
                is_right = (self._special and self._random.random() < 0.6 for _ in base)
                angles = (self._random.choice(_RIGHT) if right else self._circle_point() for right in is_right)
                added = (turned(pair, angle) for pair, angle in zip(base, angles, strict=True))
                base = [(c % self.prime, s % self.prime) for c, s in added]
                links.append(self._turned(g, k, base))
            self.turns.append(links)
        self.slides: dict[int, Array] = {}
        for i, joint in enumerate(robot.joints):
            if not joint.is_revolute:
                zeros = (self._special and self._random.random() < 0.4 for _ in range(self.poses))
                drawn = [[0 if is_zero else self._random.randrange(self.prime)] for is_zero in zeros]
                values = np.repeat(np.array(drawn, dtype=np.int64), self._width, axis=1)
                place = self.changes.index(Change(-1, i))
                values[:, self._starts[place] : self._starts[place + 1]] += np.array(self._steps)
                self.slides[i] = values.reshape(-1) % self.prime

    def _turned(self, group: int, link: int, base: Sequence[tuple[int, int]]) -> tuple[Array, Array]:
        p = self.prime
        c, s = (np.repeat([[pair[k]] for pair in base], self._width, axis=1).astype(np.int64) for k in (0, 1))
        for place, change in enumerate(self.changes):
            if change.group == group and change.links >> link & 1:
                span = slice(self._starts[place], self._starts[place + 1])
                # The links of the change turn by one more angle at every node, the others stand.
                d, e = (np.array([node[k] for node in self._nodes], dtype=np.int64) for k in (0, 1))
                x, y = turned((c[:, span], s[:, span]), (d, e))
                c[:, span], s[:, span] = x % p, y % p
        return c.reshape(-1), s.reshape(-1)

    def _circle_point(self) -> tuple[int, int]:
        p, t = self.prime, self._random.randrange(2, self.prime - 1)
        scale = pow(1 + t * t, -1, p)
        return (1 - t * t) * scale % p, 2 * t * scale % p

    def _motion(self, joint: int, start: int) -> tuple[Residue, ...]:
        row, sign = self.robot.joints[joint], self.robot.joints[joint].sign
        if not row.is_revolute:
            return (Residue(self.prime, sign * self.slides[joint][None, :]),)
        cosine, sine = self.turn(joint)
        return Residue(self.prime, cosine[None, :]), Residue(self.prime, sign * sine[None, :])

    def turn(self, joint: int) -> tuple[Array, Array]:
        """Cosine and sine of a joint's variable in every sample."""
        return self._difference(*self.domain.ends(self.domain.unknown(joint)))

    def _difference(self, g: int, u: int, v: int) -> tuple[Array, Array]:
        """Cosine and sine of phi_v - phi_u of a group, counted as the joint behind link u is."""
        (c, s), (d, e) = self.turns[g][u], self.turns[g][v]
        p, direction = self.prime, self.domain.directions[self.domain.groups[g][u]]
        return (c * d + s * e) % p, direction * ((c * e - s * d) % p)

    def _table(self, links: Links[Residue], cuts: Sequence[Cut], pose: Atoms[Residue]) -> Array:
        """The difference of both sides of every equation in every sample, with W as given at each of the poses."""
        pool = Pool(links, pose.mapped(lambda value: Residue(self.prime, np.repeat(value.values, self._width, axis=1))))
        sides = {cut: pool.sides(cut) for cut in cuts}
        differences = [sides[cut][0].entry(entry) - sides[cut][1].entry(entry) for cut, entry in self.equations]
        return np.stack([np.broadcast_to(d.values, (1, self._samples))[0] for d in differences])

    def _elsewhere(self) -> Atoms[Residue]:
        """Random numbers in place of W, zero, one or equal where those of W always are."""
        # W leaves the reachable poses: entries that were equal or opposite stay so, all others become independent.
        known: dict[tuple[int, ...], Residue] = {}

        def _drawn(power: int, value: Residue) -> Residue:
            key = tuple(int(x) for x in self._plain(value))
            if len(set(key)) == 1 and key[0] in (0, 1, self.prime - 1):
                return value
            if (power, *key) not in known:
                drawn = Residue(self.prime, [[self._random.randrange(self.prime) for _ in range(self.poses)]])
                known[(power, *((self.prime - x) % self.prime for x in key))] = -drawn
                known[(power, *key)] = drawn
            return known[(power, *key)]

        ratios, lengths, areas = (self.pose.mapped(partial(_drawn, power)) for power in (0, 1, 2))
        return Atoms(ratios.rotation, lengths.position, lengths.back, areas.square, lengths.moment, areas.reflection)

    def _effect(self, reached: Array, anywhere: Array, place: int) -> Effect:
        change, p = self.changes[place], self.prime
        rows, others = (table.reshape(len(table), self.poses, self._width) for table in (reached, anywhere))
        span = slice(self._starts[place], self._starts[place + 1])
        # A polynomial of second degree on the circle: interpolated in 1, c, s, c^2, c s, checked at one more place.
        values = np.concatenate([rows[:, :, :1], rows[:, :, span]], axis=2)
        basis, degree_of = [[1, r, r * r % p] for r in (0, *self._steps)], np.array([0, 1, 2])
        if change.group >= 0:
            basis = [[1, c, s, c * c % p, c * s % p] for c, s in [(1, 0), *self._nodes]]
            degree_of = np.array([0, 1, 1, 2, 2])
        size = len(degree_of)
        joined = np.hstack([np.array([r[:size] for r in basis[:size]], dtype=np.int64), np.eye(size, dtype=np.int64)])
        inverse = echelon(joined, p)[1][:, size:].T  # of the values at the nodes, by Gauss and Jordan modulo the prime
        fitted = _product(values[:, :, :size], inverse, p)
        # What the last node contradicts is of a higher degree, and no elementary equation.
        check = _product(fitted, np.array(basis[size], dtype=np.int64)[:, None], p)[:, :, 0]
        degrees = np.where(np.any(fitted != 0, axis=1), degree_of, 0).max(axis=1)
        # Dependence is judged away from the reachable poses, on which equations may vanish identically.
        depends = np.any(others[:, :, span] != others[:, :, :1], axis=(1, 2))
        return Effect(depends, np.where(np.all(check == values[:, :, size], axis=1), degrees, 3), fitted)

    def is_told(self, name: str) -> bool:
        """Whether an entry of W or an invariant needs nothing of the pose but what is given."""
        if (place := _PLACE.fullmatch(name)) is not None:
            name = f"p[{place[1]}]" if place[2] == "4" else f"R[{place[1]},{place[2]}]"
        return bool(np.all(self._plain(self.pose.entry(name)) == self._plain(self.other.entry(name))))

    def _entries(self) -> dict[tuple[int, int], Residue]:
        entries = {(i, j): self.end.rotation[i][j] for i in range(3) for j in range(3)}
        return entries | {(i, 3): self.end.position[i] for i in range(3)}

    def untold(self, given: frozenset[tuple[int, int]]) -> list[tuple[int, int]]:
        """Entries of T that are neither given, nor equal to one that is, nor always 0, 1 or -1."""
        # Equal residues at all poses stand for equal polynomials: such an entry is told with the other.
        keys = {place: tuple(map(int, self._plain(value))) for place, value in self._entries().items()}
        told = {key for (i, j), key in keys.items() if (i + 1, j + 1) in given}
        told |= {tuple((self.prime - x) % self.prime for x in key) for key in told}
        told |= {(number,) * self.poses for number in (0, 1, self.prime - 1)}
        return [place for place, key in keys.items() if key not in told]

    def value(self, p: Polynomial, constants: Mapping[str, Expression]) -> Array:
        """A polynomial of the arm's ring at the poses."""
        return residue(p, lambda i: self.number(p.ring.names[i], constants), self.prime)

    def number(self, name: str, constants: Mapping[str, Expression]) -> Array:
        """A generator at the poses."""
        if name in self._numbers:
            return self._numbers[name]
        if name == "p.p" or name[:2] in ("u[", "m[", "k["):
            found = self._plain(self.pose.entry(name))
        elif name[:2] in ("T[", "W["):
            frame = self.end if name[0] == "T" else Frame(self.pose.rotation, self.pose.position)
            i, j = int(name[2]) - 1, int(name[4]) - 1
            found = self._plain(frame.position[i] if j == 3 else frame.rotation[i][j])
        elif name in constants:
            found = np.broadcast_to(self.residues.constant(constants[name]).values.reshape(-1)[0], (self.poses,))
        elif unknown := self.domain.owner(name):
            is_angle, (joint, *_) = unknown.is_angle, unknown.joints
            samples = self._difference(*self.domain.ends(unknown)) if is_angle else (self.slides[joint],)
            found = samples[unknown.generators.index(name)].reshape(self.poses, self._width)[:, 0]
        else:
            raise KeyError(name)
        self._numbers[name] = found % self.prime
        return self._numbers[name]

    def _plain(self, value: Residue) -> Array:
        return np.asarray(np.broadcast_to(value.values, (1, self.poses))[0])


def _product(a: Array, b: Array, p: int) -> Array:
    total: Array = np.zeros((*a.shape[:-1], b.shape[1]), dtype=np.int64)
    for k in range(b.shape[0]):
        total = (total + a[..., k : k + 1] * b[k]) % p
    return total
