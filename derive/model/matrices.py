"""Frames and columns as SymPy matrices.

Parts of a robot: the symbols of its inertia, one link alone.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import sympy

from derive.mechanics.vectors import Frame, Vector
from derive.robot.description import Link
from derive.robot.expression import names
from derive.robot.robot import Robot

Matrix = Any
Write = Callable[[Any], Any]


def _as_is(value: Any) -> Any:
    return value


def frame_matrix(frame: Frame[Any], write: Write = _as_is) -> Matrix:
    """A frame as a 4x4 matrix, every entry written by ``write``."""
    rows = [[*map(write, frame.rotation[i]), write(frame.position[i])] for i in range(3)]
    return sympy.ImmutableMatrix([*rows, [0, 0, 0, 1]])


def columns_matrix(
    linear: Sequence[Vector[Any]], angular: Sequence[Vector[Any]] | None = None, write: Write = _as_is
) -> Matrix:
    """A Jacobian from its columns: 3xn, or 6xn with the linear rows first."""
    halves = [linear] if angular is None else [linear, angular]
    columns = [[write(x) for vector in parts for x in vector] for parts in zip(*halves, strict=True)]
    return sympy.ImmutableMatrix(columns).T


def symmetric_matrix(n: int, upper: Sequence[Any]) -> Matrix:
    """A symmetric nxn matrix from its upper triangle, row by row."""
    keys = [(i, j) for i in range(n) for j in range(i, n)]
    written = dict(zip(keys, upper, strict=True))
    return sympy.ImmutableMatrix([[written[min(i, j), max(i, j)] for j in range(n)] for i in range(n)])


def inertial_symbols(robot: Robot) -> frozenset[str]:
    """Symbols of masses and moments of inertia, by which dynamics is grouped."""
    found: set[str] = set()
    for link in robot.links:
        t = link.inertia
        cells = [link.mass, t.xx, t.yy, t.zz, t.xy, t.xz, t.yz, link.armature]
        if link.motor is not None:
            cells += [link.motor.mass, link.motor.inertia]
        for cell in cells:
            found.update(names(cell))
    return frozenset(found)


def gravity_symbols(robot: Robot) -> frozenset[str]:
    """Symbols of the acceleration of gravity."""
    return frozenset(name for cell in robot.gravity or () for name in names(cell))


def only_link(robot: Robot, i: int) -> Robot:
    """The robot with the body of link i (from 1) alone: every other link massless, no rotor at all."""
    link = replace(robot.links[i - 1], motor=None, armature=Link().armature)
    links = tuple(link if k == i else Link() for k in range(1, robot.n + 1))
    return replace(robot, links=links)


def only_rotor(robot: Robot, i: int) -> Robot:
    """The robot with the rotor of joint i (from 1) alone: every link massless, no armature."""
    rotor = Link(motor=robot.links[i - 1].motor)
    links = tuple(rotor if k == i else Link() for k in range(1, robot.n + 1))
    return replace(robot, links=links)


def aligned_latex(lines: Sequence[str]) -> str:
    """Equations below each other, aligned at their left, as a notebook shows them.

    Args:
        lines: LaTeX of each equation, without dollar signs.

    Returns:
        LaTeX of the whole, between dollar signs.
    """
    body = " \\\\ ".join(f"& {line}" for line in lines)
    return f"$\\displaystyle \\begin{{aligned}} {body} \\end{{aligned}}$"
