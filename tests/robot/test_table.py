"""The table and what stands around it: every expression of a robot has its place in the file."""

import random
import re
from dataclasses import replace

import pytest

from derive.errors import RobotFileError
from derive.robot.cells import Cells
from derive.robot.expression import ONE, ZERO
from derive.robot.load import description_from_bytes
from derive.robot.options.handout import HandoutOptions
from derive.robot.presentation import read_handout
from derive.robot.reading.document import read_document
from derive.robot.table import ROTATION_TOLERANCE
from derive.robot.units import located_expressions
from derive.robot.validate import validate
from tests.random_robots import random_robot
from tests.rows import robot_of_rows

HEAD = "name: arm\nconvention: standard\njoints: [{type: revolute}]\n"


@pytest.mark.parametrize("seed", range(12))
def test_what_is_no_default_stands_at_its_path_in_the_file(seed: int) -> None:
    data = random_robot(random.Random(seed)).text.encode()
    robot, document = description_from_bytes(data, "arm.yaml"), read_document(data, "arm.yaml")
    found = 0
    for path, expression in located_expressions(robot):
        if expression not in (ZERO, ONE) and path[0] not in ("base", "tool"):
            if document.find(path) is not None:
                found += 1
            else:
                assert path[-1] in ("theta", "d", "ratio", 0, 1, 2), path
    assert found >= robot.n


@pytest.mark.parametrize("factor", [0.4, 3.0])
def test_a_rotation_is_one_to_within_the_stated_tolerance(factor: float) -> None:
    entry = 1 + factor * ROTATION_TOLERANCE
    base = f"base: [[{entry:.12f}, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]\n"
    if factor < 1:
        assert description_from_bytes((HEAD + base).encode(), "arm.yaml").n == 1
    else:
        with pytest.raises(RobotFileError, match="row 1 of the rotation block"):
            description_from_bytes((HEAD + base).encode(), "arm.yaml")


def test_without_a_block_the_handout_has_its_defaults() -> None:
    assert read_handout(read_document(HEAD.encode(), "arm.yaml")) == HandoutOptions()


@pytest.mark.parametrize(
    ("names", "found"),
    [
        (('name: "a"', 'name: "a"'), "joints row 2, name: joint name 'a' belongs to row 1 already"),
        (("name: q2", ""), "joints row 1, name: joint name 'q2' belongs to row 1 already"),
        (('name: "a\\nb"', ""), "joints row 1, name: control character U+000A; allowed: text on one line"),
        (('name: "a\\u2028b"', ""), "joints row 1, name: control character U+2028"),
        ((f"name: {'x' * 501}", ""), "501 characters; allowed: at most 500"),
        (("name: [a]", ""), "allowed: a text"),
    ],
)
def test_a_name_of_a_joint_is_a_line_of_its_own(names: tuple[str, str], found: str) -> None:
    with pytest.raises(RobotFileError, match=re.escape(found)):
        robot_of_rows("|".join(f"R a: 1, {name}" for name in names))


TEXT = b"name: r\nconvention: standard\njoints: [{type: revolute, a: a1, limits: [-1, 1]}]\nfigure: {q: [1]}\n"


def test_parts_that_contradict_each_other_are_refused_and_their_place_is_named() -> None:
    document, robot = read_document(TEXT, "r.yaml"), description_from_bytes(TEXT, "r.yaml")
    cells = Cells(document, robot.units)
    cells.raw(("joints", 0, "a"))
    validate(document, cells, robot)
    with pytest.raises(RobotFileError, match=r"^r.yaml:.*unknown symbol 'a2'"):
        validate(document, cells, replace(robot, runtime=("a2",)))
    (joint,) = robot.joints
    turned = replace(joint, limits=joint.limits[::-1])
    with pytest.raises(RobotFileError, match="lower limit is not below the upper"):
        validate(document, cells, replace(robot, joints=(turned,)))
