"""What a model is put together from: matrices of frames and columns, symbols by their role, bodies one at a time."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import sympy

from derive.lecture.form import SymbolRoles
from derive.lecture.sympy_conversion import Matrix
from derive.mechanics.vectors import Frame, Vector
from derive.robot.description import Link, Motor
from derive.robot.expression import ZERO, Expression, names
from derive.robot.robot import Robot

Write = Callable[[Any], Any]  # turns an exact entry into a SymPy expression


def frame_matrix(frame: Frame[Any], write: Write = lambda value: value) -> Matrix:
    """A frame as a homogeneous matrix, 4x4."""
    rows = [[*map(write, frame.rotation[i]), write(frame.position[i])] for i in range(3)]
    return sympy.ImmutableMatrix([*rows, [0, 0, 0, 1]])


def columns_matrix(
    linear: Sequence[Vector[Any]], angular: Sequence[Vector[Any]] | None = None, write: Write = lambda value: value
) -> Matrix:
    """A Jacobian from its columns: 3xn, or 6xn with the linear rows first."""
    halves = [linear] if angular is None else [linear, angular]
    columns = [[write(x) for vector in parts for x in vector] for parts in zip(*halves, strict=True)]
    return sympy.ImmutableMatrix(columns).T


def symbol_roles(robot: Robot) -> SymbolRoles:
    """Symbols of masses, moments of inertia, gravity and offsets, by which expressions are grouped.

    Lengths in a moment of inertia are none of them: of ``m*l**2/12`` the mass alone leads.
    """
    masses: set[str] = set()
    moments: list[Expression] = []
    lengths = {name for joint in robot.joints for cell in (joint.a, joint.d) for name in names(cell)}
    for link in robot.links:
        t, motor = link.inertia, link.motor or Motor()
        lengths.update(name for cell in link.com for name in names(cell))
        masses.update(*(names(cell) for cell in (link.mass, motor.mass)))
        moments += (t.xx, t.yy, t.zz, t.xy, t.xz, t.yz, link.armature, motor.inertia)
    # a moment of inertia with a mass in it, m*l^2/12, is grouped by the mass alone
    plain = [set(names(cell)) for cell in moments if masses.isdisjoint(names(cell))]
    inertias, heavy = frozenset(set().union(*plain) - lengths), frozenset(masses - lengths)
    gravity = frozenset(name for cell in robot.gravity or () for name in names(cell))
    point_masses = robot.has_dynamics and all(cell == ZERO for cell in moments)
    links = {name for joint in robot.joints for name in names(joint.a)}
    offsets = frozenset(name for joint in robot.joints for name in names(joint.d)) - links
    return SymbolRoles(heavy | inertias, gravity, offsets, inertias, point_masses)


def only_body(robot: Robot, i: int, of_rotor: bool) -> Robot:
    """The robot with one body alone, a link or a rotor: every other link massless, no armature."""
    own, bare = robot.links[i - 1], Link()
    body = Link(motor=own.motor) if of_rotor else replace(own, motor=None, armature=bare.armature)
    return replace(robot, links=tuple(body if k == i else bare for k in range(1, robot.n + 1)))


def aligned_latex(lines: Sequence[str]) -> str:
    """Equations below each other, aligned at their left, as a notebook shows them."""
    body = " \\\\ ".join(f"& {line}" for line in lines)
    return f"$\\displaystyle \\begin{{aligned}} {body} \\end{{aligned}}$"
