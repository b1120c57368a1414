"""The table of a robot file: which row follows which, rows without motion, a root that moves, ends, and all bodies."""

import re
from collections.abc import Callable, Sequence
from dataclasses import replace

from derive.errors import RobotFileError, listed, near_miss, quoted
from derive.robot import description
from derive.robot.cells import Cells, check_symbol, inert_text
from derive.robot.description import BASE, FIXED, Description, End, FixedRow, Joint, JointType, Link, Loop, Root, Stand
from derive.robot.expression import Name, names
from derive.robot.reading.document import Document, KeyPath, YamlMapping
from derive.robot.reading.size_limits import FILE_LIMITS
from derive.robot.table import MovingRow, read_bound, read_frame, read_gravity, read_limits, read_link
from derive.robot.tree import ROOT_VARIABLES, around, joint_places, plain, root_rows

# What stands behind a function's name to name another one, as in jacobian_dot: names of ends stand there, too.
SUFFIXES = re.compile(r"(?:(?:end|dq|dqd|dot|hessian|rpy|zyz|position|orientation|nearest|step)_)*")


def read_table(document: Document, cells: Cells) -> Description:
    """The rows, frames and bodies of a file, without a name yet."""
    root = _read_root(document)
    reader = _Table(document, cells, root)
    rows = reader.read()
    base, tool = (read_frame(document, cells, (key,)) for key in ("base", "tool"))
    ends, links = reader.ends(rows, tool), _read_links(document, cells, rows)
    bodies, has_dynamics = dict(enumerate(links)), document.find(("links",)) is not None
    joints, coupled = tuple(row for row in rows if isinstance(row, Joint)), reader.coupled(rows)
    fixed = tuple(replace(row, link=bodies.get(at)) for at, row in enumerate(rows) if isinstance(row, FixedRow))
    moved = tuple(link for row, link in zip(rows, links, strict=False) if isinstance(row, Joint))
    if root is not None:
        root = replace(root, link=read_link(document, cells, ("root", "link")) if has_dynamics else None)
        moving, standing = root_rows(root)
        joints, fixed = (*moving, *joints), (standing, *fixed)
        moved = (*(Link() for _ in moving if has_dynamics), *moved)
    convention, gravity = description.Convention(document.text("convention")), read_gravity(document, cells)
    whole = Description("", "", convention, joints, base, tool, gravity, moved, fixed=fixed, ends=ends, root=root)
    return plain(with_loops(document, cells, replace(whole, coupled=coupled), reader.passive, reader.label))


def _read_root(document: Document) -> Root | None:
    """How the root moves, its body still to be read."""
    if document.find(("root",)) is None:
        return None
    kind, path = description.RootType(document.text("root", "type")), ("root", "q")
    usual = names = ROOT_VARIABLES[kind]
    if document.find(path) is not None:
        names = tuple(document.text(*path, at) for at in range(document.length(path)))
    if len(names) != len(usual):
        found = f"{len(names)} name{'s' * (len(names) != 1)} for a {kind.value} root"
        remedy = f"write q: [{listed(usual)}], or leave q out"
        raise document.error(path, found, f"allowed: exactly {len(usual)}", remedy)
    for at, name in enumerate(names):
        check_symbol(document, (*path, at), name)
        if name in names[:at]:
            raise document.error((*path, at), f"'{name}' twice", remedy="give every variable a name of its own")
    if document.find(("root", "link")) is not None and document.find(("links",)) is None:
        remedy = "write links: with one entry for each row of joints, or leave the link of the root out"
        raise document.error(("root", "link"), "a body of the root alone", "allowed: all links or none", remedy)
    return Root(kind, names)


def _read_links(document: Document, cells: Cells, rows: Sequence[Joint | FixedRow]) -> tuple[Link, ...]:
    """The body of each row; none where the file has no dynamics."""
    if document.find(("links",)) is None:
        return ()
    count = document.length(("links",))
    if count != len(rows):
        what = "joints" if all(isinstance(row, Joint) for row in rows) else "rows of joints"
        found = f"{count} {'row' if count == 1 else 'rows'} for {len(rows)} {what}"
        remedy = f"write one row per {'joint' if what == 'joints' else 'row'}; a massless link is {{mass: 0}}"
        raise document.error(("links",), found, f"allowed: exactly {len(rows)}", remedy)
    for at, row in enumerate(rows):
        for key in ("motor", "armature", "friction") if isinstance(row, FixedRow) else ():
            if document.find(path := ("links", at, key)) is not None:
                allowed = "allowed: mass, com, inertia"
                raise document.error(path, f"'{row.name}' is fixed, and no motor drives it", allowed, "remove it")
    return tuple(read_link(document, cells, ("links", at)) for at in range(count))


class _Table:
    """The rows by the names under which others follow them."""

    def __init__(self, document: Document, cells: Cells, root: Root | None) -> None:
        self._document, self._cells = document, cells
        self._root_joints = root_rows(root)[0] if root else ()
        self._roots = tuple(joint.variable for joint in self._root_joints)
        block = document.find(("variables",))
        self._declared = tuple(block.entries) if isinstance(block, YamlMapping) else ()
        self._variables = self._read_variables()  # by row; nothing where it is fixed
        self._own = [name if self._is_own(row, name) else "" for row, name in enumerate(self._variables)]
        usual = [own or (f"row {row + 1}" if self._variables[row] else "") for row, own in enumerate(self._own)]
        self._labels = [document.text("joints", row, "name") or label for row, label in enumerate(usual)]
        self.passive = [row for row in range(len(self._variables)) if document.text("joints", row, "passive") == "true"]

    def _read_variables(self) -> list[str]:
        most, rows = FILE_LIMITS.joints, range(self._document.length(("joints",)))
        are_fixed = [self._document.text("joints", row, "type") == FIXED for row in rows]
        fixed = sum(are_fixed)
        joints = len(rows) - fixed + len(self._roots)
        if not 1 <= joints <= most or fixed > most:
            found = f"{len(rows)} rows" if joints == len(rows) else f"{joints} joints and {fixed} fixed rows"
            raise self._document.error(("joints",), found, f"allowed: 1 to {most}", "one row per joint")
        found_at = dict.fromkeys(self._roots, "the root")
        variables: list[str] = []
        for row, is_fixed in enumerate(are_fixed):
            path: KeyPath = ("joints", row, "q")
            given = self._document.scalar(path)
            name = given.text if given else f"q{sum(map(bool, variables)) + 1}"
            variables.append("" if is_fixed else name)
            if is_fixed:
                continue
            if not given and not self._has_name(row, name):
                continue
            check_symbol(self._document, path, name)
            if name in found_at and (given or not self._declared):
                said = f"variable '{name}' belongs to {found_at[name]} already"
                remedy = "give every joint its own variable: q: ..."
                raise self._document.error(path if given else path[:-1], said, remedy=remedy)
            found_at[name] = f"row {row + 1}"
        return variables

    def read(self) -> tuple[Joint | FixedRow, ...]:
        variables = frozenset((*self._roots, *filter(None, self._own), *self._declared))
        variables -= {self._own[row] for row in self.passive}
        rows = tuple(
            replace(self._joint(at, variables), stand=self._stand(at)) if self._variables[at] else self._fixed_row(at)
            for at in range(len(self._labels))
        )
        for at, row in enumerate(rows):
            if row.label == BASE:  # which means something in a file that says what only those of trees say
                keys = (("joints", k, key) for k in range(len(rows)) for key in ("after", "mount", "gamma", "b"))
                is_tree = any(self._document.find(key) is not None for key in (("root",), ("ends",), *keys))
                if is_tree or "" in self._variables or self.coupled(rows):
                    raise self._named_base(("joints", at, "name" if row.name else "q"))
            if (first := self._labels.index(row.label)) < at or row.label in self._roots:
                what = "joint" if self._variables[at] else "row"
                whose = f"row {first + 1}" if first < at else "the root"
                said = f"{what} name {quoted(row.label)} belongs to {whose} already"
                place: KeyPath = ("joints", at if row.name else first, "name")
                raise self._document.error(place, said, remedy=f"give every {what} a name of its own")
        return rows

    def _joint(self, row: int, variables: frozenset[str]) -> Joint:
        name, path = self._own[row], ("joints", row)
        if row not in self.passive:
            return MovingRow(self._document, self._cells, row, name or f"row {row + 1}", variables).read()
        joint = MovingRow(self._document, self._cells, row, name, variables | {name}).read() if name else None
        if joint is None or joint.drive:
            remedy = "leave the cell that moves out, or write passive: false"
            raise self._document.error((*path, "passive"), "a passive joint that variables move", "", remedy)
        return joint

    def _is_own(self, row: int, name: str) -> bool:
        """Whether a row has a variable of its own: q, or that of its number where its cell has that or none."""
        if not name or self._document.find(("joints", row, "q")) or self._has_name(row, name):
            return bool(name)
        return frozenset(self._moving(row)).isdisjoint((*self._roots, *self._variables, *self._declared))

    def _has_name(self, row: int, name: str) -> bool:
        """Whether the cell of a row that moves holds a name, or is left out."""
        return name in (self._moving(row) or (name,))

    def _moving(self, row: int) -> tuple[str, ...]:
        path: KeyPath = ("joints", row, "theta" if self._document.text("joints", row, "type") == "revolute" else "d")
        return tuple(names(self._cells.raw(path))) if self._document.find(path) is not None else ()

    def coupled(self, rows: Sequence[Joint | FixedRow]) -> tuple[description.Variable, ...]:
        """The variables in their order, where a row is coupled or the file names them; else none."""
        joints = [row for row in rows if isinstance(row, Joint)]
        if not (self._declared or self.passive or any(joint.drive for joint in joints)):
            return ()
        own = (name for row, name in enumerate(self._own) if row not in self.passive)
        used = dict.fromkeys((*self._roots, *filter(None, own)))
        order = self._declared if used.keys() <= {*self._declared} else tuple({**used, **dict.fromkeys(self._declared)})
        variables = tuple(self._variable(name, [*self._root_joints, *joints]) for name in order)
        kinds = {variable.variable: variable.type for variable in variables}
        has_units = self._cells.units.degrees or self._cells.units.millimetres
        for at, joint in enumerate(rows):
            # Of factors between an angle and a length nobody could say whether they are per degree.
            drive = joint.drive if has_units and isinstance(joint, Joint) else ()
            if isinstance(joint, Joint) and any(kinds[name] is not joint.type for name, _ in drive):
                path: KeyPath = ("joints", at, "theta" if joint.is_revolute else "d")
                said = "a length moves an angle" if joint.is_revolute else "an angle moves a length"
                allowed = "allowed in files with units: factors between angles, or between lengths"
                raise self._document.error(path, said, allowed, "write the file in rad and m, without units:")
        return variables

    def _variable(self, name: str, joints: Sequence[Joint]) -> description.Variable:
        path: KeyPath = ("variables", name)
        check_symbol(self._document, path, name)
        alone = next((j for j in joints if j.variable == name and name in dict(description.drives(j))), None)
        driven = next((joint for joint in joints if name in dict(joint.drive)), None)
        if alone is None and driven is None:
            found, allowed = f"variable '{name}' moves no joint", "allowed: variables that the cell of a joint has"
            place = path if name in self._declared else ("joints", self._own.index(name), "q")
            raise self._document.error(place, found, allowed, "remove it, or write it into a cell")
        kind = next(joint.type for joint in (alone, driven) if joint)
        own = alone or description.Variable(name, kind)
        angle = self._cells.angle if kind is JointType.REVOLUTE else self._cells.length
        limits = read_limits(self._document, self._cells, path, angle)
        speed = read_bound(self._document, self._cells, path, "speed", angle)
        torque = read_bound(self._document, self._cells, path, "torque", self._cells.plain)
        return description.Variable(name, kind, limits or own.limits, speed or own.speed, torque or own.torque)

    def _fixed_row(self, row: int) -> FixedRow:
        path: KeyPath = ("joints", row)
        for key in ("q", "limits", "speed", "torque", *(["passive"] if row in self.passive else [])):
            if self._document.find((*path, key)) is not None:
                allowed = "allowed in a fixed row: name, after, mount and constant cells"
                remedy = "remove it, or write type: revolute or type: prismatic"
                raise self._document.error((*path, key), "a fixed row has no motion", allowed, remedy)
        name = inert_text(self._document, (*path, "name"))
        if not name:
            remedy = "write name: and by what other rows and ends follow it"
            raise self._document.error(path, "a fixed row without a name", "allowed: a text of its own", remedy)
        angle, length = self._cells.angle, self._cells.length
        stand, theta, d = self._stand(row), angle((*path, "theta")), length((*path, "d"))
        return FixedRow(name, stand, theta, d, length((*path, "a")), angle((*path, "alpha")), row=row)

    def _stand(self, row: int) -> Stand:
        path: KeyPath = ("joints", row)
        for key, else_write in (("gamma", "mount: a constant transform"), ("b", "d, the offset along z")):
            at, convention = (*path, key), self._document.text("convention")
            if convention == description.Convention.STANDARD and self._document.find(at) is not None:
                found, allowed = f"{key} in the {convention} convention", "allowed: gamma and b in convention: modified"
                raise self._document.error(at, found, allowed, f"write {else_write}")
        given = self._document.find((*path, "after")) is not None
        after = self.label((*path, "after"), row) if given else (BASE, *self._labels)[row]
        mount = read_frame(self._document, self._cells, (*path, "mount"))
        return Stand(after, mount, self._cells.angle((*path, "gamma")), self._cells.length((*path, "b")))

    def label(self, path: KeyPath, before: int | None = None) -> str:
        """The label of the row that is named, which must be one of the first if there is a bound, or the base."""
        name, rows = self._document.text(*path), len(self._labels) if before is None else before
        if name == BASE:
            return BASE
        at, known = self._at(name), (BASE, *self._labels[:rows])
        if at is not None and at < rows:
            return self._labels[at]
        found, remedy = f"no row {quoted(name)}", near_miss(name, (*known, *filter(None, self._own[:rows])))
        if at == rows:
            found, remedy = "the row itself", "name the row that it follows"
        elif at is not None:
            found, remedy = f"{quoted(name)} is row {at + 1}, below this one", "move that row up, above this one"
            if self._follows(at, rows):
                found = f"row {at + 1}, {quoted(name)}, follows this one: a circle"
                remedy = "let one of the two follow a row above both"
        raise self._document.error(path, found, f"allowed: {listed(known)}", remedy)

    def _at(self, name: str) -> int | None:
        """The row with a label, else that with a variable."""
        return next((words.index(name) for words in (self._labels, self._own) if name and name in words), None)

    def _follows(self, row: int | None, other: int) -> bool:
        """Whether a row below another one follows it, perhaps by way of more rows."""
        for _ in self._labels:
            if row is None or row <= other:
                return row == other
            after = self._document.scalar(("joints", row, "after"))
            row = self._at(after.text) if after else row - 1
        return False

    def ends(self, rows: Sequence[Joint | FixedRow], tool: description.Matrix) -> tuple[End, ...]:
        """The ends by name, or the one behind the last row."""
        block = self._document.find(("ends",))
        if not isinstance(block, YamlMapping):
            self._refuse_branches(rows)
            return (End("", (BASE, *self._labels)[-1], tool),)
        if self._document.find(("tool",)) is not None:
            remedy = "write it into the ends: {after: ..., tool: ...}"
            raise self._document.error(("tool",), "a tool beside ends", "allowed: a tool for each end", remedy)
        if not block.entries:
            remedy = "name one, or leave ends out where no row branches off"
            raise self._document.error(("ends",), "no ends", "allowed: one or more", remedy)
        return tuple(self._end(name, tuple(block.entries), rows) for name in block.entries)

    def _refuse_branches(self, rows: Sequence[Joint | FixedRow]) -> None:
        followed = [row.stand.after for row in rows if row.stand]
        for at, (after, above) in enumerate(zip(followed, (BASE, *self._labels), strict=False)):
            if after != above:
                found = f"row {at + 1} branches off, and the file names no ends"
                allowed = "allowed without ends: rows one behind the other"
                tips = listed(label for label in self._labels if label not in followed)
                remedy = f"write ends: {{left: NAME, right: NAME}} with the rows on which they are, such as {tips}"
                raise self._document.error(("joints", at, "after"), found, allowed, remedy)

    def _end(self, name: str, names: Sequence[str], rows: Sequence[Joint | FixedRow]) -> End:
        path: KeyPath = ("ends", name)
        check_symbol(self._document, path, name)
        if name == BASE:
            raise self._named_base(path)
        folded = name.casefold()
        others = (other.casefold() for other in names if other != name)
        rests = (folded.removesuffix(other) for other in others if folded.endswith(other))
        if any(map(SUFFIXES.fullmatch, (f"{folded}_", *rests))):
            found = f"a function such as jacobian_{name} could be another one, or another end's"
            raise self._document.error(path, found, remedy="use another name")
        place = (*path, "after") if isinstance(self._document.find(path), YamlMapping) else path
        after = label = self.label(place)
        followed = {row.name: row.stand.after for row in rows if isinstance(row, FixedRow)}
        while label in followed:
            label = followed[label]
        if label == BASE and not self._roots:
            allowed = "allowed: rows that move or follow one that does"
            raise self._document.error(place, f"no joint moves {quoted(after)}", allowed, "leave the end out")
        return End(name, after, read_frame(self._document, self._cells, (*path, "tool")))

    def _named_base(self, path: KeyPath) -> RobotFileError:
        found = f"'{BASE}' is what rows follow that stand on the base, or on a root that moves"
        return self._document.error(path, found, remedy="use another name")


# -- closed loops: which frames are joined, and which variables the passive joints follow

Label = Callable[[KeyPath], str]  # the label of the row that a cell names


def with_loops(
    document: Document, cells: Cells, robot: Description, passive_rows: Sequence[int], label: Label
) -> Description:
    """The robot with its loops, whose passive joints follow the variables of theirs."""
    loops: list[Loop] = []
    for k in range(document.length(("loops",)) if document.find(("loops",)) is not None else 0):
        path: KeyPath = ("loops", k)
        one, other = (label((*path, "join", side)) for side in (0, 1))
        if one == other:
            found, remedy = f"{quoted(one)} joined with itself", "name the two rows whose frames coincide"
            raise document.error((*path, "join"), found, "allowed: two rows", remedy)
        branch = document.text(*path, "branch")
        if set(branch) - {"+", "-"}:
            remedy = "derive show ROBOT closure lists the branches"
            raise document.error((*path, "branch"), f"branch {quoted(branch)}", "allowed: signs + and -", remedy)
        by, is_long = description.Joining(document.text(*path, "by")), document.find((*path, "length")) is not None
        if is_long != (by is description.Joining.DISTANCE):
            found = f"by: {by.value} {'with a' if is_long else 'without a'} length"
            remedy = "write by: distance, or leave the length out" if is_long else "write length: that of the rod"
            raise document.error(path, found, "allowed: a length with by: distance alone", remedy)
        loops.append(Loop((one, other), by, branch, cells.length((*path, "length")), document.location(path)))
    places = joint_places(robot)
    passive = {k for k, place in enumerate(places) if place[0] == "joints" and place[1] in passive_rows}
    groups = [{k for branch in around(robot, loop) for k in branch} for loop in loops]
    for k, own in enumerate(groups):
        if not own & passive:
            found, remedy = "no joint of the loop is passive", "write passive: true on the joints that it moves"
            raise document.error(("loops", k), found, "allowed: loops that move joints", remedy)
    joints = list(robot.joints)
    for k in sorted(passive):
        members, before = {k}, set[int]()
        while members != before:  # the loops that move it, and those that move passive joints of these
            before = members
            members = members.union(*(own for own in groups if own & members & passive))
        if members == {k}:
            found, remedy = "no loop moves the joint", "write the loop that does under loops:, or passive: false"
            raise document.error((*places[k], "passive"), found, remedy=remedy)
        active = {name for m in members - passive for name, _ in description.drives(joints[m])}
        order = (each.variable for each in robot.coupled if each.variable in active)
        follows = tuple((name, Name(f"G_{joints[k].variable}_{name}")) for name in order)
        if not follows:
            found, allowed = "all joints of its loops are passive", "allowed: loops that a variable moves"
            raise document.error((*places[k], "passive"), found, allowed, "leave passive out of one")
        joints[k] = replace(joints[k], follows=follows)
    return replace(robot, joints=tuple(joints), loops=tuple(loops))
