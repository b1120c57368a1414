"""Kinematics straight from the recursion, nested from the base outwards.

For arms whose expanded polynomials are too long. Everything is computed from the end effector inwards, so that an
expression is ``c1*(...) + s1*(...)`` with inner parts shared between entries; a chain of n joints costs O(n^2)
operations where its polynomials have a number of terms exponential in n.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Generic

from derive.mechanics.chain import Chain
from derive.mechanics.vectors import Frame, Matrix, S, Vector, multiply, scale


@dataclass(frozen=True)
class NestedKinematics(Generic[S]):
    """T and J of a chain, nested from the base outwards.

    Attributes:
        end: The end effector in the world.
        linear: Columns of the linear part of J, world frame.
        angular: Columns of the angular part of J, world frame.
    """

    end: Frame[S]
    linear: tuple[Vector[S], ...]
    angular: tuple[Vector[S], ...]


def nested_kinematics(chain: Chain[S]) -> NestedKinematics[S]:
    """T and J of ``chain`` from the end effector inwards."""
    end = chain.tool
    columns: list[tuple[Vector[S], Vector[S]]] = []
    for joint in reversed(chain.joints):
        rotation = joint.motion(chain.zero, chain.one)
        columns = [*(_turned(c, rotation.rotation) for c in columns)]
        end = rotation @ end
        columns.insert(0, _column(chain, joint.revolute, joint.sign, end.position))
        columns = [_turned(c, joint.fixed.rotation) for c in columns]
        end = joint.fixed @ end
    columns = [_turned(c, chain.base.rotation) for c in columns]
    return NestedKinematics(
        end=chain.base @ end,
        linear=tuple(v for v, _ in columns),
        angular=tuple(w for _, w in columns),
    )


def _column(chain: Chain[S], revolute: bool, sign: int, p: Vector[S]) -> tuple[Vector[S], Vector[S]]:
    """Velocity of the end and of the link per unit rate about (along) z, in a frame on the axis of the joint."""
    zero = chain.zero
    z = (zero, zero, chain.one)
    v, w = ((-p[1], p[0], zero), z) if revolute else (z, (zero, zero, zero))
    return (v, w) if sign > 0 else (scale(-1, v), scale(-1, w))


def _turned(column: tuple[Vector[S], Vector[S]], rotation: Matrix[S]) -> tuple[Vector[S], Vector[S]]:
    return multiply(rotation, column[0]), multiply(rotation, column[1])


def product(frames: Sequence[Frame[S]]) -> Frame[S]:
    """The product of frames from the right, so that it nests outwards."""
    result = frames[-1]
    for frame in reversed(frames[:-1]):
        result = frame @ result
    return result
