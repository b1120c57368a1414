"""The rows of a tree: which follows which, the way to an end, and the serial arm that leads there."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from math import inf
from typing import TypeVar

from derive.errors import Location, QuantityError, listed, near_miss
from derive.robot import description
from derive.robot.description import BASE, IDENTITY, Description, End, FixedRow, Joint, Link, Root, RootType, Stand
from derive.robot.expression import ONE, ZERO, Expression

Some = TypeVar("Some", bound=Description)
Place = tuple[str | int, ...]  # of a cell or block in the file, by keys and positions from 0
# Moves the axes on in a cycle, z to x: what slides along z behind it slides along x of the frame before.
_CYCLE = ((ZERO, ZERO, ONE, ZERO), (ONE, ZERO, ZERO, ZERO), (ZERO, ONE, ZERO, ZERO), IDENTITY[3])
_CYCLE_BACK = (*zip(*(row[:3] for row in _CYCLE[:3]), (ZERO,) * 3, strict=True), IDENTITY[3])
ROOT_VARIABLES: Mapping[RootType, tuple[str, ...]] = {
    RootType.PLANAR: ("x", "y", "phi"),
    RootType.FLOATING: ("x", "y", "z", "yaw", "pitch", "roll"),
}
_SLIDE, _TURN = (description.JointType.PRISMATIC, _CYCLE), description.JointType.REVOLUTE
# Slides along x, y and z in axes moved on in a cycle, three of which are none, then turns about z, y and x; and what
# turns the axes back.
_ROOT_MOUNTS = {
    RootType.PLANAR: (_SLIDE, _SLIDE, (_TURN, _CYCLE), (_TURN, IDENTITY)),
    RootType.FLOATING: (_SLIDE, _SLIDE, _SLIDE, (_TURN, IDENTITY), *[(_TURN, _CYCLE_BACK)] * 3),
}


@dataclass(frozen=True, slots=True)
class Way:
    """From the frame of a joint, or from frame 0, outwards."""

    joint: int  # index of the joint where it starts, from 0; -1 for frame 0
    rows: tuple[FixedRow, ...]  # the rows without motion on it, outwards


def table(robot: Description) -> tuple[Joint | FixedRow, ...]:
    """The rows in the order of the file; a root that moves has none."""
    rows: list[Joint | FixedRow] = list(robot.joints[len(robot.root.variables) if robot.root else 0 :])
    fixed = ((inf if row.row is None else row.row, row) for row in robot.fixed if row.name != BASE)
    for place, row in sorted(fixed, key=lambda pair: pair[0]):
        rows.insert(int(min(place, len(rows))), row)  # at the end what has no place, as it was not read
    return tuple(rows)


def joint_places(robot: Description) -> tuple[Place, ...]:
    """The place of each joint in the file."""
    roots: list[Place] = [("root",)] * len(robot.root.variables if robot.root else ())
    return (*roots, *(("joints", place) for place, row in enumerate(table(robot)) if isinstance(row, Joint)))


def located_links(robot: Description) -> Iterator[tuple[Place, Link]]:
    """The bodies of a robot with dynamics and their places in the file: of a root that moves, then by rows."""
    if not robot.links:
        return
    moving = iter(robot.links[len(robot.root.variables) if robot.root else 0 :])
    if robot.root and robot.root.link:
        yield ("root", "link"), robot.root.link
    for place, row in enumerate(table(robot)):
        link = row.link if isinstance(row, FixedRow) else next(moving)
        if link is not None:
            yield ("links", place), link


def _stands(robot: Description) -> Iterator[tuple[Joint, Stand]]:
    """Each joint with what its stand is where it has none: right behind the joint above."""
    return zip(robot.joints, map(Stand, (BASE, *(joint.label for joint in robot.joints))), strict=False)


def explicit(robot: Some) -> Some:
    """The same with a stand for every row."""
    return replace(robot, joints=tuple(replace(joint, stand=joint.stand or usual) for joint, usual in _stands(robot)))


def plain(robot: Some) -> Some:
    """The same without what goes without saying: the stand right behind the joint above, the end behind the last."""
    pairs = ((joint, None if joint.stand == usual else joint.stand) for joint, usual in _stands(robot))
    last = End("", robot.joints[-1].label, robot.tool)
    joints = tuple(replace(joint, stand=stand) for joint, stand in pairs)
    return replace(robot, joints=joints, ends=() if robot.ends == (last,) else robot.ends)


def way_to(robot: Description, label: str) -> Way:
    """From the last joint before a row, or that row itself, to the row."""
    joints = {joint.label: i for i, joint in enumerate(robot.joints)}
    fixed = {row.name: row for row in robot.fixed}
    rows: list[FixedRow] = []
    while label in fixed:
        rows.append(fixed[label])
        label = fixed[label].stand.after
    return Way(joints.get(label, -1), tuple(reversed(rows)))


def ways(robot: Description) -> Iterator[Way]:
    """For each joint the way from the joint that it follows."""
    for i, joint in enumerate(robot.joints):
        yield way_to(robot, joint.stand.after) if joint.stand else Way(i - 1, ())


def parents(robot: Description) -> tuple[int, ...]:
    """For each joint the index of the joint that it follows, -1 on the base."""
    return tuple(way.joint for way in ways(robot))


def antecedents(robot: Description) -> dict[str, str]:
    """For each row its label and that of the row that it follows, empty for frame 0; a root that moves is one row."""
    found = {joint.label: (joint.stand or usual).after for joint, usual in _stands(robot)}
    found |= {row.name: row.stand.after for row in robot.fixed}
    moving = robot.root.variables if robot.root else ()
    found = {label: after for label, after in found.items() if label not in moving}
    return {label: after if after in found else "" for label, after in found.items()}


def labels(robot: Description) -> tuple[str, ...]:
    """The rows as frames are numbered: frame 0, the joints, the rows without motion."""
    return ("", *(joint.label for joint in robot.joints), *(row.name for row in robot.fixed))


def is_row_by_row(robot: Description) -> bool:
    """Whether frames are numbered as the rows stand: one chain, and what does not move is behind the last joint."""
    return len(robot.ends) < 2 and rows_to(robot, ends(robot)[0].after) == labels(robot)[1:]


def rows_to(robot: Description, label: str) -> tuple[str, ...]:
    """The labels of the rows from frame 0, which is none, to a row, that row included."""
    before, found = antecedents(robot), []
    while label in before:
        found.append(label)
        label = before[label]
    return tuple(reversed(found))


def path(robot: Description, last: int) -> tuple[int, ...]:
    """The joints that move a joint's link, from the base outwards, that joint included; of -1 none."""
    before, found = parents(robot), []
    while last >= 0:
        found.append(last)
        last = before[last]
    return tuple(reversed(found))


def around(robot: Description, loop: description.Loop) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """The joints of a loop from the row at which its branches meet outwards, those of either branch."""
    one, other = (path(robot, way_to(robot, label).joint) for label in loop.join)
    meeting = sum(a == b for a, b in zip(one, other, strict=False))
    return one[meeting:], other[meeting:]


def ends(robot: Description) -> tuple[End, ...]:
    """The ends, a chain's one end without a name."""
    return robot.ends or (End("", robot.joints[-1].label, robot.tool),)


def end_named(robot: Description, name: str) -> End:
    """An end by its name."""
    if found := next((end for end in ends(robot) if end.name == name), None):
        return found
    names = [end.name for end in robot.ends]
    allowed = f"allowed: {listed(names)}" if names else "allowed: none, it has one end without a name"
    raise QuantityError(f"end '{name}' of {robot.name}", allowed=allowed, remedy=near_miss(name, names))


def arm(robot: Some, name: str) -> tuple[Some, tuple[int, ...]]:
    """The serial arm that leads to an end, with that tool and without bodies, and the indices of its joints."""
    end, before = end_named(robot, name), tuple(ways(robot))
    last = way_to(robot, end.after)
    places = path(robot, last.joint)
    on_way = (*((before[place], robot.joints[place].label) for place in places), (last, ""))
    fixed = [row for way, _ in on_way for row in way.rows]
    labels = [label for way, joint in on_way for label in (*(row.name for row in way.rows), joint)]
    own = labels[len(robot.root.variables) + 1 if robot.root else 0 :]  # rows of the arm's own table
    q = robot.figure.q
    drawn = tuple(q[place] for place in places) if q and not robot.coupled else q
    serial = replace(
        robot,
        joints=tuple(robot.joints[place] for place in places),
        fixed=tuple(replace(row, link=None, row=None if row.name == BASE else own.index(row.name)) for row in fixed),
        ends=(replace(end, name=""),),
        tool=end.tool,
        links=(),
        loops=(),
        root=robot.root and replace(robot.root, link=None),
        figure=replace(robot.figure, q=drawn),
    )
    return plain(serial), places


def mapped_stand(stand: Stand, put: Callable[[Expression], Expression]) -> Stand:
    """Where a row stands, with other cells."""
    mount = tuple(tuple(put(cell) for cell in cells) for cells in stand.mount)
    return replace(stand, mount=mount, gamma=put(stand.gamma), b=put(stand.b))


def mapped(robot: Some, put: Callable[[Expression], Expression]) -> Some:
    """The robot with other cells between the rows, on rows without motion and on ends."""
    joints = (replace(j, stand=mapped_stand(j.stand, put)) if j.stand else j for j in robot.joints)
    ends = (replace(end, tool=tuple(tuple(map(put, row)) for row in end.tool)) for end in robot.ends)
    fixed = []
    for row in robot.fixed:
        theta, d, a, alpha = map(put, (row.theta, row.d, row.a, row.alpha))
        fixed.append(replace(row, stand=mapped_stand(row.stand, put), theta=theta, d=d, a=a, alpha=alpha))
    return replace(robot, joints=tuple(joints), fixed=tuple(fixed), ends=tuple(ends))


def stands(robot: Description) -> list[Stand]:
    """Where rows of the table stand that do not simply follow the one above."""
    return [joint.stand for joint in robot.joints if joint.stand] + [row.stand for row in robot.fixed]


def lengths(robot: Description) -> list[Expression]:
    """The lengths between the rows of a tree, on its rows without motion and on its ends."""
    places = [*(stand.mount for stand in stands(robot)), *(end.tool for end in robot.ends)]
    cells = [row[3] for matrix in places for row in matrix[:3]] + [stand.b for stand in stands(robot)]
    return cells + [cell for row in robot.fixed for cell in (row.a, row.d)]


def constant_cells(robot: Description) -> tuple[list[Expression], list[Expression]]:
    """What stands between the rows of a tree, on its rows without motion and on its ends: values, and angles [rad]."""
    between = stands(robot)
    matrices = [*(stand.mount for stand in between), *(end.tool for end in robot.ends)]
    values = [cell for matrix in matrices for row in matrix for cell in row]
    values += [cell for row in robot.fixed for cell in (row.a, row.d)] + [stand.b for stand in between]
    for link in (row.link for row in robot.fixed if row.link):
        values += (link.mass, *link.com, *(getattr(link.inertia, key) for key in description.INERTIA))
    return values, [stand.gamma for stand in between] + [a for row in robot.fixed for a in (row.theta, row.alpha)]


def bodies(robot: Description) -> tuple[Link, ...]:
    """The links of the joints, behind link n those of rows without motion; of a robot without dynamics none."""
    return (*robot.links, *(row.link or Link() for row in robot.fixed if robot.links))


def massless(rows: tuple[FixedRow, ...]) -> tuple[FixedRow, ...]:
    """Rows without motion, without their bodies."""
    return tuple(replace(row, link=None) for row in rows)


def bare(robot: Some) -> Some:
    """Its table alone, equal for robots of equal tables and names."""
    table = replace(robot, links=(), gravity=None, fixed=massless(robot.fixed), ends=())
    return replace(table, title="", digest="", source="", remarks=())


def is_arm(robot: Description) -> bool:
    """Whether its joints follow each other to one end without a name, whatever is constant between them."""
    is_alone = not (robot.root or robot.coupled or (robot.ends and robot.ends[0].name))
    return is_alone and parents(robot) == tuple(range(-1, robot.n - 1))


def require_arm(robot: Description, what: str) -> None:
    """Refuse a root that moves, rows that branch and coupled joints, for what is made of one arm."""
    require_own_variables(robot, what)
    if not is_arm(robot):
        found = f"{what} of {robot.name}, {'whose root moves' if robot.root else 'whose table branches'}"
        raise QuantityError(found, allowed="allowed: arms that stand, and their ends by name")


def require_own_variables(robot: Description, what: str, location: Location | None = None) -> None:
    """Refuse coupled joints for what is made of joints each with its own variable."""
    if not robot.coupled:
        return
    kind, how = "coupled joints", "whose joints are coupled"
    if robot.passive:
        kind, how = "closed loops", "which has closed loops"
    found, allowed = f"{what} of {robot.name}, {how}", "allowed: robots of which each joint has its own variable"
    remedy = f"derive show and derive build take {kind}; for the rest write a table without them"
    raise QuantityError(found, allowed=allowed, remedy=remedy, location=location)


def require_chain(robot: Description, what: str, location: Location | None = None) -> None:
    """Refuse a tree for what is made of one chain alone: ``what`` as in "the handout"."""
    require_own_variables(robot, what, location)
    if not robot.is_tree:
        return
    names = [end.name for end in robot.ends if end.name]
    to = f"to one of {listed(names)}" if len(names) > 1 else "to its end"
    found, allowed = f"{what} of {robot.name}, whose table is a tree", "allowed: robots of one chain"
    remedy = f"derive show and derive build take trees; for the rest write a robot file of the serial arm {to}"
    raise QuantityError(found, allowed=allowed, remedy=remedy, location=location)


def root_rows(root: Root) -> tuple[tuple[Joint, ...], FixedRow]:
    """The rows of a root that moves, in either convention, and the row `BASE` that stands on it."""
    *steps, back = _ROOT_MOUNTS[root.type]
    befores = ("", *root.variables)  # the first row stands on frame 0, which no label means any more
    placed = zip(steps, root.variables, befores, strict=False)
    rows = tuple(Joint(kind, q, 1, ZERO, ZERO, ZERO, ZERO, stand=Stand(at, mount)) for (kind, mount), q, at in placed)
    return rows, FixedRow(BASE, Stand(befores[-1], back[1]), link=root.link)
