"""A robot is checked as a whole, whatever its cells say one by one."""

from dataclasses import replace

import pytest

from derive.errors import RobotFileError
from derive.robot.cells import Cells
from derive.robot.load import description_from_bytes
from derive.robot.reading.document import read_document
from derive.robot.validate import validate

TEXT = b"name: r\nconvention: standard\njoints: [{type: revolute, a: a1, limits: [-1, 1]}]\nfigure: {q: [1]}\n"


def test_parts_that_contradict_each_other_are_refused_and_their_place_is_named() -> None:
    document, robot = read_document(TEXT, "r.yaml"), description_from_bytes(TEXT, "r.yaml")
    cells = Cells(document, robot.units)
    cells.raw(("joints", 0, "a"))
    validate(document, cells, robot)
    with pytest.raises(RobotFileError, match=r"^r.yaml:.*unknown symbol 'a2'"):
        validate(document, cells, replace(robot, runtime=("a2",)))
    (joint,) = robot.joints
    assert joint.limits is not None
    turned = replace(joint, limits=joint.limits[::-1])
    with pytest.raises(RobotFileError, match="lower limit is not below the upper"):
        validate(document, cells, replace(robot, joints=(turned,)))
