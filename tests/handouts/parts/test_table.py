"""The part with the DH table and the data of the links."""

from dataclasses import replace

import pytest

from derive.handouts.assemble import context_of, section_of
from derive.handouts.parts.table import dh_table
from derive.handouts.sheet.document import Paragraph, Rows, Section, Table
from derive.robot.description import Matrix
from derive.robot.expression import Number
from derive.robot.robot import Robot


def section(robot: Robot, name: str) -> Section:
    found = section_of(context_of(robot), name)
    assert found is not None
    return found


def table(robot: Robot) -> Table:
    (found,) = (block for block in dh_table(context_of(robot)) if isinstance(block, Table))
    return found


def test_columns_have_the_order_of_the_convention() -> None:
    standard, modified = table(Robot.load("scara-perugia")), table(Robot.load("dh-modified-deluca"))
    assert standard.header[2:6] == ("$\\theta_i$", "$d_i$", "$a_i$", "$\\alpha_i$")
    assert modified.header[2:6] == ("$\\alpha_{i-1}$", "$a_{i-1}$", "$\\theta_i$", "$d_i$")


def test_every_joint_has_a_row_with_its_variable() -> None:
    robot = Robot.load("scara-perugia")
    rows = table(robot).rows
    assert [row[1] for row in rows] == ["revolute" if joint.is_revolute else "prismatic" for joint in robot.joints]
    cells = (row[2] if joint.is_revolute else row[3] for joint, row in zip(robot.joints, rows, strict=True))
    assert [cell.strip("$") for cell in cells] == [f"q_{{{i}}}" for i in range(1, 5)]


def test_a_table_too_wide_for_the_page_is_given_cell_by_cell() -> None:
    name = "a".ljust(60, "x")
    text = f"name: arm\nconvention: standard\njoints:\n  - {{type: revolute, a: {name}1, d: {name}2}}\n"
    blocks = list(dh_table(context_of(Robot.from_text(text))))
    assert not any(isinstance(block, Table) for block in blocks)
    lines = "\n".join(line for block in blocks if isinstance(block, Rows) for line in block.lines)
    assert "\\theta_{1} = " in lines
    assert "a_{1} = " in lines


def test_base_and_tool_are_stated_where_they_are_not_the_identity() -> None:
    robot = Robot.load("planar-3r")
    base: Matrix = (*robot.base[:2], (*robot.base[2][:3], Number(robot.base[0][0].value / 2)), robot.base[3])
    for arm, stated in ((robot, False), (replace(robot, base=base), True)):
        words = [block.text for block in section(arm, "table").blocks if isinstance(block, Paragraph)]
        assert any(text.startswith("Constant transforms") for text in words) is stated


def test_links_state_what_is_not_zero() -> None:
    blocks = section(Robot.load("planar-2r-perugia"), "parameters").blocks
    links = [block for block in blocks if isinstance(block, Paragraph) and block.text.startswith("Link ")]
    data = "\n".join(line for block in blocks if isinstance(block, Rows) for line in block.lines)
    assert len(links) == 2
    assert "\\text{mass}" in data
    assert "\\text{gear ratio}" in data
    assert "\\text{armature}" not in data


MIXED = """\
name: arm
convention: standard
units: {angle: deg, length: mm}
joints:
  - {type: revolute, d: 400, a: a1 + 20, alpha: beta - 90}
  - {type: prismatic, d: q2 - 10, limits: [0, 180]}
tool: [[1, 0, 0, 12.5], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
links: [{mass: 2, com: [150, 0, 0]}, {mass: m}]
parameters: {a1: 0.3, beta: pi/6, m: 3}
"""


@pytest.mark.parametrize("in_file", [False, True])
def test_tables_have_the_units_of_the_file(in_file: bool) -> None:
    text = MIXED
    if in_file:
        text = text.replace("mm}", "mm, parameters: file}").replace("a1: 0.3, beta: pi/6", "a1: 300, beta: 30")
    robot = Robot.from_text(text)
    first, second = ([" ".join(cell.split()) for cell in row] for row in table(robot).rows)
    assert first[2:] == ["$q_{1}$", "$400$", "$20 + a_{1}$", "$\\beta - 90^{\\circ}$", "$\\text{--}$"]
    assert second[3] == "$-10 + q_{2}$"
    assert second[6] == "$[0,\\, 180]\\,\\mathrm{mm}$"
    blocks = [*section(robot, "table").blocks, *section(robot, "parameters").blocks]
    lines = " ".join(
        word for block in blocks if isinstance(block, Rows) for line in block.lines for word in line.split()
    )
    assert "12.5" in lines
    assert "(150,\\, 0,\\, 0)" in lines
    assert ("a_{1} = 300\\,\\mathrm{mm}" if in_file else "a_{1} = 0.3") in lines
    assert ("\\beta = 30^{\\circ}" if in_file else "\\pi") in lines
    words = " ".join(block.text for block in blocks if isinstance(block, Paragraph))
    assert "ables are in millimetres" in words
    assert ("symbols and all else in SI units" in words) is not in_file
    assert "lengths in metres" not in words
