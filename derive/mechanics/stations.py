"""The ways in which vectors of an arm come to the world frame.

*Station* r is where run r of parallel axes begins: its frame has the run's z axis and turns with the run before; the
first one stands still, and the last one is the end effector. A vector known at station r comes to the world by turning
it about one z axis after another (four multiplications and two additions each, half of that for a vector in a
coordinate plane), or at once by the rotation of a station on the way, built from the base outwards. Which costs less
depends on what else is needed, so all ways are offered.
"""

from __future__ import annotations

from functools import cached_property

from derive.algebra.tape_value import Value
from derive.mechanics.chain import Chain
from derive.mechanics.parallel_axes import Placement, Run, about_z
from derive.mechanics.vectors import Matrix, Vector, add, matmul, multiply, transpose

_MOST_STATIONS, _MOST_JOINTS = 7, 12
"""Of longer arms only the ways over near stations are tried; the number of all grows with the cube."""


class Stations:
    """Stations 0 to ``last`` of one arm whose base and tool are exact rotations.

    Args:
        chain: The arm, one joint at least.
        runs: Its runs of parallel axes.

    Attributes:
        few: Whether all ways over them can be tried.
    """

    def __init__(self, chain: Chain[Value], runs: tuple[Run, ...]) -> None:
        self.chain = chain
        self.runs = runs
        self.last = len(runs)
        self.few = self.last <= _MOST_STATIONS and chain.n <= _MOST_JOINTS
        self._fixed = [*(run.fixed for run in runs), chain.tool]

    @cached_property
    def rotations(self) -> list[Matrix[Value]]:
        """The axes of each station in the world, built outwards."""
        found = [matmul(self.chain.base.rotation, self._fixed[0].rotation)]
        for r, run in enumerate(self.runs):
            found.append(matmul(_about_z(found[r], run.last), self._constants[r + 1]))
        return found

    def turned(self, r: int, place: Placement) -> Matrix[Value]:
        """The axes of station r in the world, turned about z as far as a joint of run r is."""
        return _about_z(self.rotations[r], place)

    @cached_property
    def _constants(self) -> list[Matrix[Value]]:
        """Between what the run before turns and the axes of each station; constant."""
        befores = [run.last.constant for run in self.runs]
        later = (matmul(constant, fixed.rotation) for constant, fixed in zip(befores, self._fixed[1:], strict=True))
        return [self._fixed[0].rotation, *later]

    @cached_property
    def entries(self) -> list[Vector[Value]]:
        """From the last joint of the run before (or frame 0) to each station, in the station's axes; constant."""
        return [multiply(transpose(fixed.rotation), fixed.position) for fixed in self._fixed]

    def world(self, r: int, v: Vector[Value], meeting: int) -> Vector[Value]:
        """A vector of station r in the world, turned inward as far as station ``meeting``, at most to r."""
        while r > meeting:
            v, r = self.inward(r, v), r - 1
        return multiply(self.rotations[r], v)

    def inward(self, r: int, v: Vector[Value]) -> Vector[Value]:
        """A vector of station r in the axes of station r-1."""
        last = self.runs[r - 1].last
        return about_z(last.cosine, last.sine, multiply(self._constants[r], v))

    def axis_beyond(self, r: int) -> Vector[Value]:
        """The axis of run r in the axes of station r+1; constant."""
        return self._constants[r + 1][2]

    def part(self, r: int, joint: int = -1) -> Vector[Value]:
        """From a joint of run r (counted in the run; -1: from its station) to the run's last joint, in station axes."""
        return self._with_steps(r, joint, (self.chain.zero,) * 3)

    def whole(self, r: int, joint: int = -1) -> Vector[Value]:
        """The same, to the end effector, summed from there inwards."""
        return self._with_steps(r, joint, self._beyond[r])

    def _with_steps(self, r: int, joint: int, total: Vector[Value]) -> Vector[Value]:
        for place in reversed(self.runs[r].placements[joint + 1 :] if r < self.last else ()):
            total = add(place.step, total)
        return total

    @cached_property
    def _beyond(self) -> list[Vector[Value]]:
        """From the last joint of each run to the end effector, in station axes."""
        found: list[Vector[Value]] = [(self.chain.zero,) * 3]
        for r in range(self.last, 0, -1):
            there = self._with_steps(r, -1, found[-1])
            found.append(self.inward(r, add(self.entries[r], there)))
        return found[::-1]


def _about_z(rotation: Matrix[Value], place: Placement) -> Matrix[Value]:
    c, s = place.cosine, place.sine
    x, y, z = ((c * x + s * y, c * y - s * x, z) for x, y, z in rotation)
    return (x, y, z)
