"""Random trees: YAML text of the robot file beside the plain numbers for which it stands; without symbols."""

import random
from collections.abc import Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from typing import Any

import numpy as np

from derive.robot.description import BASE, JointType, RootType, Variable
from derive.robot.expression import number
from derive.robot.robot import Robot
from tests.random_robots import Array, JointNumbers, LinkNumbers, RandomRobot, _Writer, _yaml

ENDS = ("left", "right", "head", "tail", "tip", "hand")
_BODY = ("mass", "com", "inertia")
Block = dict[str, Any]  # a part of a robot file


@dataclass(frozen=True)
class TreeRow(JointNumbers):
    """One row of the table, and where it stands; sign and type of a fixed one mean nothing."""

    label: str
    after: int  # place of the row that it follows, -1 for the base
    fixed: bool
    mount: Array
    gamma: float
    b: float
    link: LinkNumbers


@dataclass(frozen=True)
class RandomTree:
    """A robot file and what it means."""

    table: RandomRobot  # text, convention, base, gravity, and the rows that move with their links
    rows: tuple[TreeRow, ...]
    ends: Mapping[str, tuple[int, Array]]  # of each the place of its row and its tool; a chain's has no name
    root: RootType | None
    body: LinkNumbers  # of the root

    @cached_property
    def robot(self) -> Robot:
        return Robot.from_text(self.table.text)

    def __repr__(self) -> str:
        return repr(self.table)


def random_tree(rng: random.Random, joints: int | None = None) -> RandomTree:
    """A tree with so many joints in its table, 1 to 14 unless given, and perhaps those of a root."""
    return _TreeWriter(rng, joints or rng.choice([*range(1, 10), 12, 14])).tree()


class _TreeWriter(_Writer):
    def __init__(self, rng: random.Random, joints: int) -> None:
        super().__init__(rng, joints, None, True, False)
        self.degrees = self.millimetres = self.plain_names = False
        self.root = rng.choice([None, None, *RootType])
        self.straight = rng.choice([0.4, 0.6, 0.8, 1.0])  # chance of a row to follow the one above
        self.rows: list[TreeRow] = []

    def tree(self) -> RandomTree:
        cells = []
        while sum(not row.fixed for row in self.rows) < self.n or self.rng.random() < 0.2:
            cells.append(self.row(len(self.rows)))
        (base_cells, base), (gravity_cells, gravity), (root_link, body) = self.transform(), self.gravity(), self.body(0)
        end_cells, ends = self.ends()
        block: Block = {
            "name": "random-tree",
            "convention": "standard" if self.standard else "modified",
            "root": {"type": str(self.root), "link": root_link} if self.root else {},
            "joints": [row for row, _ in cells],
            "base": base_cells,
            "gravity": gravity_cells,
            "links": [link for _, link in cells],
            **({"tool": end_cells[""]} if "" in end_cells else {"ends": end_cells}),
        }
        text = _yaml({key: value for key, value in block.items() if value})
        joints = tuple(row for row in self.rows if not row.fixed)
        links = tuple(row.link for row in joints)
        table = RandomRobot(text, self.standard, joints, base, gravity=gravity, links=links)
        return RandomTree(table, tuple(self.rows), ends, self.root, body)

    def row(self, k: int) -> tuple[Block, Block]:
        """Row k and its link."""
        rng = self.rng
        after = k - 1 if rng.random() < self.straight else rng.randrange(-1, k)
        (cells, joint), (link, numbers), fixed = self.joint(k + 1), self.link(k + 1), rng.random() < 0.2
        if fixed:
            theta, d, (link, numbers) = self.angle("", k), self.length("", k), self.body(k)
            joint = replace(joint, theta=theta[1], d=d[1])
            cells = {"a": cells.get("a", "0"), "alpha": cells.get("alpha", "0"), "theta": theta[0], "d": d[0]}
            cells["type"] = "fixed"
        name = f"row{k}" if fixed or rng.random() < 0.3 else ""
        mount_cells, mount = self.transform() if rng.random() < 0.4 else ([], np.eye(4))
        moved = not self.standard and rng.random() < 0.4
        gamma, b = (self.angle("", k), self.length("", k)) if moved else (("0", 0.0), ("0", 0.0))
        names_row = after < k - 1 or rng.random() < 0.2
        before = (self.rows[after].label if after >= 0 else BASE) if names_row else ""
        cells |= {"name": name, "after": before, "mount": mount_cells, "gamma": gamma[0], "b": b[0]}
        own: Block = {"label": name or cells["q"], "after": after, "fixed": fixed, "mount": mount, "link": numbers}
        self.rows.append(TreeRow(**vars(joint), **own, gamma=gamma[1], b=b[1]))
        return {key: cell for key, cell in cells.items() if cell not in ("", [], "0")}, link

    def body(self, k: int) -> tuple[Block, LinkNumbers]:
        """A link that no joint drives."""
        cells, numbers = self.link(k)
        return {key: cells[key] for key in _BODY}, LinkNumbers(*(getattr(numbers, key) for key in _BODY))

    def ends(self) -> tuple[Block, dict[str, tuple[int, Array]]]:
        """Ends that move, as cells and numbers; where no row branches off, there may be one without a name."""
        rng, moved = self.rng, list[int]()
        for k, row in enumerate(self.rows):
            moved += [k] * (self.root is not None or not row.fixed or row.after in moved)
        is_chain = all(row.after == k - 1 for k, row in enumerate(self.rows)) and len(self.rows) - 1 in moved
        if is_chain and rng.random() < 0.7:
            cells, tool = self.transform()
            return {"": cells}, {"": (len(self.rows) - 1, tool)}
        texts, numbers = {}, {}
        for name, k in zip(ENDS, rng.sample(moved, min(len(moved), rng.randint(1, len(ENDS)))), strict=False):
            cells, tool = self.transform()
            texts[name] = {"after": self.rows[k].label, **({"tool": cells} if cells else {})}
            numbers[name] = (k, tool)
        return texts, numbers


def coupled(rng: random.Random, robot: Robot) -> tuple[Robot, Array]:
    """A robot with coupled joints in the place of those with their own variables, and S."""
    shape = robot.n, rng.randint(max(1, robot.n - 3), robot.n)
    factors = [Fraction(text) for text in ("0", "0", "1", "-1", "2", "-1/2", "3/2")]
    while True:
        drawn = np.array([rng.choices(factors, k=shape[1]) for _ in range(shape[0])])
        matrix = drawn.astype(float)
        if matrix.any(axis=1).all() and np.linalg.matrix_rank(matrix) == shape[1]:
            break
    names = [f"v{k}" for k in range(shape[1])]
    drives = [tuple((name, number(factor)) for name, factor in zip(names, row, strict=True) if factor) for row in drawn]
    joints = [replace(joint, sign=1, drive=drive) for joint, drive in zip(robot.joints, drives, strict=True)]
    kinds = rng.choices([*JointType], k=len(names))
    variables = tuple(map(Variable, names, kinds))
    return replace(robot, joints=tuple(joints), coupled=variables), matrix
