"""The parts with the data of a robot: table, parameters, figures and the other convention."""

import math
from dataclasses import replace
from fractions import Fraction

import pytest

from derive.handouts.assemble import context_of, section_of
from derive.handouts.parts.table import dh_table
from derive.handouts.sheet.document import Figure, SheetFormula, Table
from derive.robot.description import Matrix
from derive.robot.expression import Number, names
from derive.robot.load import catalogue_names
from derive.robot.options.handout import FigureOptions
from derive.robot.robot import Robot
from derive.workspace.poses import RobotPoses
from tests.handouts.reading import lines, part, words


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
    printed = "\n".join(lines(blocks))
    assert "\\theta_{1} = " in printed
    assert "a_{1} = " in printed


def test_base_and_tool_are_stated_where_they_are_not_the_identity() -> None:
    robot = Robot.load("planar-3r")
    base: Matrix = (*robot.base[:2], (*robot.base[2][:3], Number(robot.base[0][0].value / 2)), robot.base[3])
    for arm, stated in ((robot, False), (replace(robot, base=base), True)):
        assert ("Constant transforms" in words(part(arm, "table"))) is stated


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
    sections = part(robot, "table"), part(robot, "parameters")
    printed = " ".join(word for section in sections for line in lines(section.blocks) for word in line.split())
    assert "12.5" in printed
    assert "(150,\\, 0,\\, 0)" in printed
    assert ("a_{1} = 300\\,\\mathrm{mm}" if in_file else "a_{1} = 0.3") in printed
    assert ("\\beta = 30^{\\circ}" if in_file else "\\pi") in printed
    said = "".join(map(words, sections))
    assert "ables are in millimetres" in said
    assert ("symbols and all else in SI units" in said) is not in_file
    assert "lengths in metres" not in said


def test_nothing_is_drawn_without_poses() -> None:
    assert section_of(replace(context_of(Robot.load("scara-perugia")), poses=None), "figure") is None


def test_configuration_of_the_figure_is_drawn_with_its_values() -> None:
    q = (Number(Fraction(1, 2)), Number(Fraction(1)), Number(Fraction(3, 10)), Number(Fraction(0)))
    robot = replace(Robot.load("scara-perugia"), figure=FigureOptions(q=q))
    made = part(robot, "figure")
    figures = [block for block in made.blocks if isinstance(block, Figure)]
    assert len(figures) == 2
    assert "$q_{1} = 0.5\\,\\mathrm{rad}$" in figures[1].caption
    assert "$q_{3} = 0.3\\,\\mathrm{m}$" in figures[1].caption


LIMITED = """
name: arm
convention: standard
units: {angle: deg}
joints:
  - {type: revolute, a: 0.4, limits: [-90, 90]}
  - {type: revolute, a: 0.3, limits: [20, 130]}
  - {type: prismatic, alpha: 180, limits: [0.1, 0.4]}
  - {type: revolute, limits: [low, high]}
"""


def test_a_joint_whose_limits_exclude_zero_is_drawn_in_their_middle() -> None:
    robot = Robot.from_text(LIMITED)
    assert RobotPoses(robot).zero == pytest.approx((0, math.radians(75), 0.25, 0))
    made = part(robot, "figure")
    (figure,) = (block for block in made.blocks if isinstance(block, Figure))
    assert figure.caption.endswith(
        "in the middle of their limits: $q_{2} = 75^{\\circ}$, $q_{3} = 0.25\\,\\mathrm{m}$."
    )


def test_the_zero_configuration_is_within_the_limits_of_the_catalogue() -> None:
    for name in catalogue_names():
        robot = Robot.load(name)
        poses = RobotPoses(robot)
        for joint, value, bounds in zip(robot.joints, poses.zero, poses.limits, strict=True):
            if bounds is not None and not any(symbol for cell in joint.limits or () for symbol in names(cell)):
                assert min(bounds) <= value <= max(bounds), (name, joint.variable)


def test_the_table_of_the_other_convention_has_a_neighbours_factors() -> None:
    blocks = part("puma560-corke", "conversion").blocks
    (table,) = [block for block in blocks if isinstance(block, Table)]
    assert table.header[2:4] == ("$\\alpha_{i-1}$", "$a_{i-1}$")
    assert [row[2:4] for row in table.rows[:3]] == [("$0$", "$0$"), ("$90^{\\circ}$", "$0$"), ("$0$", "$a_{2}$")]
    assert any(isinstance(block, SheetFormula) for block in blocks)
