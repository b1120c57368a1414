"""Robots of short tables, ``R d: d1, alpha: pi/2 | R a: a2 | P``: rows of cells, ``P`` before those that slide."""

from derive.robot.robot import Robot

TWO_BARS = """
gravity: [0, -g, 0]
links: [{mass: m1, com: [-l1, 0, 0], inertia: {zz: I1}}, {mass: m2, com: [-l2, 0, 0], inertia: {zz: I2}}]
"""
"""The bodies of a planar arm as in textbooks."""


def text_of_rows(rows: str, more: str = "", *, name: str = "arm", convention: str = "standard") -> str:
    """A robot file, with more lines behind its table."""
    joints = ""
    for row in rows.split("|"):
        kind, _, cells = row.strip().partition(" ")
        joints += f"  - {{type: {'prismatic' if kind == 'P' else 'revolute'}{', ' if cells else ''}{cells}}}\n"
    return f"name: {name}\nconvention: {convention}\njoints:\n{joints}{more}\n"


def robot_of_rows(rows: str, more: str = "", *, name: str = "arm", convention: str = "standard") -> Robot:
    return Robot.from_text(text_of_rows(rows, more, name=name, convention=convention))
