"""The loops of a robot file: which frames are joined, and which variables the passive joints follow."""

from collections.abc import Callable, Sequence
from dataclasses import replace

from derive.errors import quoted
from derive.robot.coupling import drives
from derive.robot.description import Description, Joining, Loop
from derive.robot.expression import Name
from derive.robot.reading.document import Document, KeyPath
from derive.robot.tree import around, joint_places

Label = Callable[[KeyPath], str]  # the label of the row that a cell names


def with_loops(document: Document, robot: Description, passive_rows: Sequence[int], label: Label) -> Description:
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
        loops.append(Loop((one, other), Joining(document.text(*path, "by")), branch, document.location(path)))
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
        active = {name for m in members - passive for name, _ in drives(joints[m])}
        order = (each.variable for each in robot.coupled if each.variable in active)
        follows = tuple((name, Name(f"G_{joints[k].variable}_{name}")) for name in order)
        if not follows:
            found, allowed = "all joints of its loops are passive", "allowed: loops that a variable moves"
            raise document.error((*places[k], "passive"), found, allowed, "leave passive out of one")
        joints[k] = replace(joints[k], follows=follows)
    return replace(robot, joints=tuple(joints), loops=tuple(loops))
