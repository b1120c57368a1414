"""A whole tree of links as one robot file: a row for each joint, mounted where the file has it, its axis turned to z.

No common normals are needed: the frame of a row is that of the link which it moves, turned so that z is along the axis.
"""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from derive.errors import DeriveError, RobotFileError, near_miss, quoted, require_known
from derive.exchange.arm import Arm, Axis, Mass, carrying_joints, changes_of, check_kind, direction_of, frame_at, some
from derive.exchange.convert import convention_named
from derive.exchange.file_tree import Agreement, FileTree, agreement
from derive.exchange.from_urdf import AS_USUAL, ImportOptions, notes_on, plain_text, read_back, robot_name, snap_of
from derive.exchange.reading.elements import MOVING, ZEROS, Origin, Urdf, UrdfJoint, free_name
from derive.exchange.robot_of_arm import GRAVITY, label_of, link_of, matrix_of, rounded, row_of
from derive.exchange.ties import closed, joins, turn_to, variable_of
from derive.mechanics.space import WORLD, Line, exactly
from derive.robot import description
from derive.robot.description import BASE, Description, End, FixedRow, Joint, Link, Root, RootType, Stand
from derive.robot.expression import ZERO, Name, add, multiply, number
from derive.robot.parser import NOT_SYMBOLS, RESERVED_NAMES
from derive.robot.reading.size_limits import FILE_LIMITS
from derive.robot.reading.table import SUFFIXES
from derive.robot.robot import Robot
from derive.robot.tree import ROOT_VARIABLES, plain, root_rows
from derive.robot.writer import robot_text

MOST_ENDS = 12  # that are chosen where nobody names them
MOST_MOVED = 0.01  # of the farthest end from the root: a tree whose ends would be farther from the file's is refused
REMEDY = "import single chains of it by --tip or --chain"


@dataclass(frozen=True, slots=True)
class ImportedTree:
    """A robot file of a tree and what is known about its making."""

    text: str  # the robot file
    robot: Robot  # what it says
    agreement: Agreement  # how far it is from the file
    ends: Mapping[str, str]  # the link at each end
    joints: tuple[str, ...]  # names of the joints in the file, in the order of the rows
    notes: tuple[str, ...]  # what a reader should know, as sentences

    @property
    def report(self) -> tuple[str, ...]:
        """What was made, in lines."""
        root = self.robot.root
        fixed, moved = len(self.robot.fixed) - bool(root), f", {root.type.value} root" if root else ""
        driven = sum(bool(joint.drive) for joint in self.robot.joints)
        coupled = f" ({driven} driven by others)" if driven else ""
        counts = f"{len(self.joints)} joint{'s' * (len(self.joints) != 1)}{coupled}, {fixed} fixed{moved}"
        ends = ", ".join(name or link for name, link in self.ends.items())
        return (f"tree: {counts}; ends: {ends}", str(self.agreement), *self.notes)

    def as_dict(self) -> dict[str, object]:
        """The report as plain data."""
        names = ("position", "rotation", "inertia", "torques")
        errors = {f"{name}_error": getattr(self.agreement, name) for name in names}
        who = {"robot": self.robot.name, "joints": list(self.joints), "ends": dict(self.ends)}
        return who | {"convention": self.robot.convention.value} | errors | {"notes": list(self.notes)}


def import_tree(
    urdf: Urdf, root: str = "", ends: Sequence[str] = (), options: ImportOptions = AS_USUAL, head: str = ""
) -> ImportedTree:
    """The robot of all joints of a file, whose root stands, or moves as ``root`` says."""
    if root:
        require_known(root, list(RootType), f"--root {quoted(root)}")
    if options.inertia != "given" or options.symbols:
        word = "--symbols" if options.symbols else f"--inertia {options.inertia}"
        raise DeriveError(f"{word} with --tree", allowed="allowed: of one chain alone", remedy="leave one out")
    urdf = _without_world(urdf)
    with exactly(len(urdf.joints)):
        tree = _Tree(urdf, RootType(root or urdf.root) if root or urdf.root else None, options)
        robot, chosen = tree.described(ends)
    made = read_back(robot_text(robot), robot.name, urdf.source)
    found = agreement(FileTree.of(urdf, tree.joints, tree.root), made, list(chosen.values()))
    if found.position > MOST_MOVED * found.reach + 1e-9:
        moved = f"--snap {float(tree.snap):g} would move an end by {found.position:.2g} m"
        raise RobotFileError(f"{urdf.source}: {moved}", remedy="write a smaller --snap")
    notes = tuple(plain_text(note) for note in tree.notes)
    if tree.joins:
        robot, note = closed(made, urdf, tree.joins, {joint.name: row.label for row, joint in tree.moved})
        notes = (*notes, *filter(None, [note]))
    text = robot_text(robot, [*([head] if head else []), str(found), *notes])
    names = tuple(plain_text(joint.name) for joint in tree.joints if joint.type in MOVING)
    return ImportedTree(text, read_back(text, robot.name, urdf.source), found, chosen, names, notes)


def _without_world(urdf: Urdf) -> Urdf:
    """The file without a link that carries one floating joint and nothing else: the root floats."""
    carrying = carrying_joints(urdf)
    match [joint for joint in urdf.joints if joint.parent not in carrying]:
        case [UrdfJoint(type="floating", parent=world, origin=at) as free] if at == Origin() and not urdf.bodies[world]:
            bodies = {link: body for link, body in urdf.bodies.items() if link != world}
            return replace(urdf, bodies=bodies, joints=tuple(j for j in urdf.joints if j != free), root="floating")
    return urdf


def in_order(urdf: Urdf) -> tuple[str, list[UrdfJoint]]:
    """The link on which all hang, and the joints from it outwards, limb by limb."""
    carrying = carrying_joints(urdf)
    roots = [link for link in urdf.bodies if link not in carrying]
    if len(roots) != 1:
        loop = "every link hangs on a joint: a loop"
        found = f"{len(roots)} links hang on no joint: {some(roots)}" if roots else loop
        raise RobotFileError(f"{urdf.source}: {found}", allowed="allowed: exactly one", remedy=REMEDY)
    behind: dict[str, list[UrdfJoint]] = {}
    for joint in reversed(urdf.joints):
        check_kind(joint, REMEDY, may_follow=True) if joint.type != "fixed" else None
        behind.setdefault(joint.parent, []).append(joint)
    found_joints: list[UrdfJoint] = []
    waiting = list(behind.get(roots[0], ()))
    while waiting:
        found_joints.append(waiting.pop())
        waiting += behind.get(found_joints[-1].child, ())
    if len(found_joints) < len(urdf.joints):
        lost = next(joint for joint in urdf.joints if joint not in found_joints)
        found = f"joint {quoted(lost.name)} is part of a loop"
        raise RobotFileError(found, remedy="give a tree, without loops", location=lost.location)
    return roots[0], found_joints


class _Tree:
    def __init__(self, urdf: Urdf, root: RootType | None, options: ImportOptions) -> None:
        self.urdf, self.root, self.snap, self._options = urdf, root, snap_of(options.snap), options
        self._base, self.joints = in_order(urdf)
        self.joins = tuple(joins(urdf, self.joints, self.snap))
        self.notes: list[str] = []
        self._has_bodies = any(urdf.bodies.values())
        # The frame of each row in that of the link which it moves, and the link with which each one moves as a body.
        self._turns, self._carriers = {self._base: WORLD}, {self._base: self._base}
        self._steps = {self._base: 0}  # how many fixed joints lead to a link from the one with which it moves
        for joint in self.joints:
            moves, link = joint.type in MOVING, joint.child
            self._turns[link] = turn_to(direction_of(joint, self.snap)) if moves else WORLD
            self._carriers[link] = link if moves else self._carriers[joint.parent]
            self._steps[link] = 0 if moves else self._steps[joint.parent] + 1

    def described(self, wanted: Sequence[str]) -> tuple[Description, dict[str, str]]:
        """The robot, and the links of its ends by their names."""
        chosen, variables = _named(self._ends(wanted)), ROOT_VARIABLES[self.root] if self.root else ()
        kept = self._kept({*chosen.values(), *(link for join in self.joins for link in join.links)})
        labels = {self._base: BASE}
        for joint in kept:
            labels[joint.child] = free_name(label_of(joint.name), (*labels.values(), *variables))
        rows = [self._row(joint, labels) for joint in kept]
        self.moved = [(row, joint) for joint, (row, _) in zip(kept, rows, strict=True) if isinstance(row, Joint)]
        names = {joint.name: f"q{k}" for k, (_, joint) in enumerate(self.moved, 1)}
        joints = [_driven(row, joint, followed(joint, self.joints), names) for row, joint in self.moved]
        links = [link for row, link in rows if isinstance(row, Joint)] if self._has_bodies else []
        fixed = [replace(row, row=place) for place, (row, _) in enumerate(rows) if isinstance(row, FixedRow)]
        fixed += self._closing(labels, len(rows))
        root = None
        if self.root:
            root = Root(self.root, variables, self._body(self._base))
            moving, standing = root_rows(root)
            joints, fixed = [*moving, *joints], [standing, *fixed]
            links = [*(Link() for _ in moving if self._has_bodies), *links]
        tools = [matrix_of(WORLD.seen_from(self._turns[link]), self.snap) for link in chosen.values()]
        ends = [End(name, labels[link], at) for (name, link), at in zip(chosen.items(), tools, strict=True)]
        above = (BASE, *(labels[joint.child] for joint in kept))
        is_chain = all(labels[joint.parent] == before for joint, before in zip(kept, above, strict=False))
        if is_chain and not self.joins and len(ends) == 1 and ends[0].after == above[-1] and not self.root:
            ends, chosen = [replace(ends[0], name="")], {"": chosen[ends[0].name]}
        axes = tuple(self._axis(joint) for _, joint in self.moved)
        self.notes += notes_on(self.urdf, Arm(self._base, "", axes, WORLD, WORLD.z, (), ()), proven=False)
        if changes := [change for joint in kept for change in changes_of(joint, self.snap)]:
            n = len(changes)
            self.notes.insert(0, f"{n} angle{'s' * (n > 1)} rounded, largest change {max(changes):.2g} rad")
        coupled = [variable_of(row) for row in joints if not row.drive]
        given = self.urdf.gravity and [number(rounded(component)) for component in self.urdf.gravity]
        x, y, z = given or (ZERO, ZERO, multiply(number(-1), Name("g")))
        robot = Description(
            name=robot_name(self._options.name or self.urdf.name or "tree"),
            title=plain_text(" ".join(self.urdf.name.split()))[: FILE_LIMITS.title_length],
            convention=convention_named(self._options.convention or "modified"),
            gravity=(x, y, z) if self._has_bodies else None,
            parameters=(("g", number(GRAVITY)),) if self._has_bodies and not given else (),
            joints=tuple(joints),
            links=tuple(links),
            fixed=tuple(fixed),
            ends=tuple(ends),
            tool=description.IDENTITY if ends[0].name else ends[0].tool,
            coupled=tuple(coupled) if len(coupled) < len(joints) else (),
            root=root,
        )
        return plain(robot), chosen

    def _closing(self, labels: Mapping[str, str], first: int) -> Iterator[FixedRow]:
        """The frames that close loops, as rows behind all others."""
        body = Link() if self._has_bodies else None
        sides = (side for join in self.joins for side in zip(join.links, join.frames, strict=True))
        for k, (link, frame) in enumerate(sides):
            name = free_name(f"loop{k // 2 + 1}_{('first', 'second')[k % 2]}", labels.values())
            mount = matrix_of(frame.seen_from(self._turns[link]), self.snap)
            yield FixedRow(name, Stand(labels[link], mount), link=body, row=first + k)

    def _row(self, joint: UrdfJoint, labels: Mapping[str, str]) -> tuple[Joint | FixedRow, Link]:
        """The row of a joint without its variable or place yet, and its link."""
        turn, label = self._turns[joint.child], labels[joint.child]
        mount = frame_at(joint.origin, self.snap).then(turn).seen_from(self._turns[joint.parent])
        stand = Stand(labels[joint.parent], matrix_of(mount, self.snap))
        if joint.type not in MOVING:
            return FixedRow(label, stand, link=self._body(joint.child)), Link()
        axis = self._axis(joint)
        return replace(row_of(axis, ""), name=label, stand=stand), link_of(axis, turn, self.snap)

    def _axis(self, joint: UrdfJoint) -> Axis:
        body = self.urdf.bodies[joint.child]
        masses = (Mass(body.mass, frame_at(body.origin, self.snap), body.inertia, joint.child),) if body else ()
        return Axis(Line(WORLD.origin, WORLD.z), joint, masses)

    def _body(self, link: str) -> Link | None:
        """The body of a link that no joint drives."""
        if not self._has_bodies:
            return None
        if (body := self.urdf.bodies[link]) is None:
            return Link()
        still = UrdfJoint(link, "fixed", "", link, Origin(), ZEROS, body.location)
        return link_of(self._axis(still), WORLD, self.snap)

    def _moved(self, link: str) -> bool:
        return bool(self.root) or self._carriers[link] != self._base

    def _ends(self, wanted: Sequence[str]) -> list[str]:
        """The links that are named, or those which carry no other, behind the last joints of limbs."""
        for link in wanted:
            if link not in self.urdf.bodies:
                hint = near_miss(link, self.urdf.bodies)
                raise RobotFileError(f"{self.urdf.source}: no link {quoted(link)}", remedy=hint)
            if not self._moved(link):
                found = f"{self.urdf.source}: no joint moves {quoted(link)}"
                raise RobotFileError(found, remedy="leave it out of --ends")
        if wanted:
            return list(dict.fromkeys(wanted))
        inner = {self._carriers[joint.parent] for joint in self.joints if joint.type in MOVING}
        carrying = {joint.parent for joint in self.joints}
        homes = self._carriers.items()
        tips = [link for link, at in homes if link not in carrying and at not in inner and self._moved(link)]
        joined = {link for join in self.joins for link in join.links}
        tips = [link for link in tips if link not in joined] or tips
        if not tips:
            raise RobotFileError(f"{self.urdf.source}: no joint moves", remedy="give a robot with a joint that moves")
        if len(tips) > MOST_ENDS:  # of several on one joint the one at the end of the longest way
            carriers = dict.fromkeys(self._carriers[link] for link in tips)
            tips = [max((t for t in tips if self._carriers[t] == at), key=self._steps.__getitem__) for at in carriers]
        if len(tips) > MOST_ENDS:
            self.notes.append(f"{len(tips)} ends, of which these are left out: {some(tips[MOST_ENDS:])}")
        return tips[:MOST_ENDS]

    def _kept(self, ends: set[str]) -> list[UrdfJoint]:
        """The joints that become rows: those which move, and the fixed ones on the way to one, to a body or an end."""
        needed, kept = set(ends), []
        for joint in reversed(self.joints):
            body = self.urdf.bodies[joint.child]
            has_body = body is not None and self._moved(joint.child) and bool(body.mass or any(body.inertia))
            if joint.type in MOVING or has_body or joint.child in needed:
                needed.add(joint.parent)
                kept.append(joint)
        if gone := [joint.child for joint in self.joints if joint not in kept and self._moved(joint.child)]:
            self.notes.append(f"links without a body that are left out, as long as --ends names none: {some(gone)}")
        return kept[::-1]


def followed(joint: UrdfJoint, joints: Sequence[UrdfJoint]) -> tuple[str, Fraction, Fraction]:
    """The joint at the end of those which a joint follows, with factor and offset to it: f q + c; often itself."""
    known, factor, offset, seen = {other.name: other for other in joints}, Fraction(1), Fraction(0), [joint.name]
    while joint.mimics is not None:
        if (before := known.get(joint.mimics)) is None or before.type not in MOVING or before.name in seen:
            what = "which is none that moves" if before is None or before.type not in MOVING else "in a circle"
            found = f"joint {quoted(joint.name)} follows {quoted(joint.mimics)}, {what}"
            remedy = near_miss(joint.mimics, known.keys() - {joint.mimics})
            raise RobotFileError(found, remedy=remedy, location=joint.location)
        # f (m q' + o) + c, q' being the position of the joint that is followed
        factor, offset, joint = factor * joint.multiplier, offset + factor * joint.offset, before
        seen.append(joint.name)
    if not factor:
        remedy = "write a multiplier, or type fixed"
        raise RobotFileError(f"joint {quoted(seen[0])} follows by 0", remedy=remedy, location=joint.location)
    return joint.name, factor, offset


def _driven(row: Joint, joint: UrdfJoint, way: tuple[str, Fraction, Fraction], names: Mapping[str, str]) -> Joint:
    """The row of a joint with its variable, or driven by that of another row."""
    name, factor, offset = way
    if joint.mimics is None:
        return replace(row, variable=names[name])
    drive, added = ((names[name], number(factor * row.sign)),), number(offset * row.sign)
    driven = replace(row, variable=f"of {row.name}", sign=1, drive=drive)
    return replace(driven, theta=add(row.theta, added)) if row.is_revolute else replace(driven, d=add(row.d, added))


def _named(links: Sequence[str]) -> dict[str, str]:
    """Links by names that ends may have."""
    found: dict[str, str] = {}
    for link in links:
        name = re.sub(r"[^A-Za-z0-9]+", "_", link).strip("_")[: FILE_LIMITS.name_length - 8]
        folded = name.casefold()
        is_taken = name in RESERVED_NAMES or folded in (*NOT_SYMBOLS, BASE) or SUFFIXES.fullmatch(f"{folded}_")
        name = name if name[:1].isalpha() and not is_taken else f"link_{name}"
        found[free_name(name, found)] = link
    return found
