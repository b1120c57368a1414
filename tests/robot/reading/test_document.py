"""A document knows the place of every text in it; a file with loops that is written again says the same."""

from collections.abc import Iterator

import pytest

from derive.robot.cells import Cells
from derive.robot.description import Joining
from derive.robot.load import catalogue_names, robot_file_bytes
from derive.robot.reading.document import KeyPath, Node, YamlMapping, YamlScalar, YamlSequence, read_document, read_tree
from derive.robot.reading.table import with_loops
from derive.robot.robot import Robot
from derive.robot.writer import robot_text


def scalars(node: Node, path: KeyPath = ()) -> Iterator[tuple[KeyPath, YamlScalar]]:
    match node:
        case YamlScalar():
            yield path, node
        case YamlSequence():
            for index, item in enumerate(node.items):
                yield from scalars(item, (*path, index))
        case YamlMapping():
            for key, (_, value) in node.entries.items():
                yield from scalars(value, (*path, key))


@pytest.mark.parametrize("name", catalogue_names())
def test_every_text_stands_where_it_is_said_to_stand(name: str) -> None:
    data = robot_file_bytes(name)
    document, lines = read_document(data, name), data.decode().splitlines()
    found = list(scalars(document.root))
    assert len(found) > 5
    for path, scalar in found:
        assert document.find(path) is scalar
        assert document.text(*path) == scalar.text
        assert document.location(path) == scalar.location
        if scalar.verbatim:
            place = scalar.inner
            assert lines[place.line - 1][place.column - 1 :].startswith(scalar.text)


def test_texts_keep_what_other_readers_of_yaml_change() -> None:
    root = read_tree(b"a: 0.10\nb: 1e3\nc: no\nd: 0o17\ne: 2001-01-01\nf: 'it''s'\n", "x")
    assert isinstance(root, YamlMapping)
    assert [scalar.text for _, scalar in scalars(root)] == ["0.10", "1e3", "no", "0o17", "2001-01-01", "it's"]


def test_of_a_corpus_file_only_the_robot_is_kept_at_its_places() -> None:
    document = read_document(b"notes: long\nrobot:\n  name: arm\nexpected: [x]\n", "notes.yaml")
    assert list(document.root.entries) == ["name"]
    assert (document.location(("name",)).line, document.location(("name",)).column) == (3, 9)


LINKAGES = ("delta", "five-bar", "four-bar", "slider-crank")


@pytest.mark.parametrize("name", LINKAGES)
def test_a_written_file_has_the_same_loops_and_passive_joints(name: str) -> None:
    robot = Robot.load(name)
    again = Robot.from_text(robot_text(robot))
    assert (again.loops, again.joints, again.coupled) == (robot.loops, robot.joints, robot.coupled)


def test_passive_joints_follow_the_variables_of_their_own_loops_alone() -> None:
    names = {joint.variable: [name for name, _ in joint.follows] for joint in Robot.load("delta").passive}
    assert set(map(tuple, names.values())) == {("x", "y", "z")}
    robot = Robot.load("slider-crank")
    assert (robot.dof, robot.n, [joint.variable for joint in robot.passive]) == (1, 3, ["q2", "s"])
    assert [loop.by for loop in robot.loops] == [Joining.REVOLUTE]


def test_a_file_without_loops_is_read_as_before() -> None:
    document, robot = read_document(robot_file_bytes("planar-3r"), "planar-3r"), Robot.load("planar-3r")
    assert (
        with_loops(
            document, Cells(document, robot.units), robot, (), lambda path: pytest.fail(f"nothing to read at {path}")
        )
        == robot
    )
