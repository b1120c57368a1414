"""The parts of the handout: what holds for all of them, and the parts with the data of a robot."""

import math
import random
from collections.abc import Callable, Iterable
from dataclasses import replace
from fractions import Fraction
from functools import cache

import pytest

from derive.handouts.assemble import context_of, section_of
from derive.handouts.parts.conversion import conversion
from derive.handouts.parts.dynamics import (
    christoffel,
    coriolis,
    energies,
    equations_of_motion,
    gravity,
    inertia,
    link_jacobians,
    skew,
)
from derive.handouts.parts.example import example
from derive.handouts.parts.figure import arm, convention
from derive.handouts.parts.jacobian import jacobian
from derive.handouts.parts.kinematics import end_effector, orientation, transforms
from derive.handouts.parts.newton_euler import JointLetters, Recursion, newton_euler
from derive.handouts.parts.singularities import singularities
from derive.handouts.parts.table import dh_table, parameters
from derive.handouts.sheet.context import Context
from derive.handouts.sheet.document import Block, Figure, Paragraph, Section, SheetFormula, Steps, Table, blocks_of
from derive.handouts.sheet.language import ENGLISH, languages
from derive.robot.description import Matrix
from derive.robot.expression import Number, names
from derive.robot.options.handout import Derivation, FigureOptions, HandoutOptions
from derive.robot.robot import Robot
from derive.workspace.poses import RobotPoses
from tests.handouts.reading import REACHED, changed, lines, part, words
from tests.random_robots import chains, random_robot, sampled
from tests.rows import robot_of_rows

KINEMATICS = {
    part.__name__: part
    for part in (arm, dh_table, convention, parameters, transforms, end_effector, orientation, jacobian, singularities)
} | {"conversion": conversion}
DYNAMICS = {
    part.__name__: part
    for part in (
        *(link_jacobians, energies, inertia, christoffel, coriolis, skew, gravity, equations_of_motion),
        *(newton_euler, example),
    )
}
PARTS: dict[str, Callable[[Context], Iterable[Block]]] = KINEMATICS | DYNAMICS
WITH_LINKS = ("planar-2r-perugia", "scara-perugia")
ROBOTS = (*WITH_LINKS, "anthropomorphic-arm", "skeleton-modified")


@cache
def blocks(part: str, robot: str, derivation: Derivation) -> tuple[Block, ...]:
    context = context_of(Robot.load(robot), HandoutOptions(derivation=derivation))
    if part in DYNAMICS and not context.has_closed_dynamics:
        return ()
    return tuple(blocks_of(Section(part, part, tuple(PARTS[part](context)))))


@pytest.mark.first(12)
@pytest.mark.parametrize("robot", sampled(ROBOTS, ("planar-2r-perugia", "anthropomorphic-arm")))
@pytest.mark.parametrize("part", PARTS)
def test_steps_add_to_the_result_and_take_nothing_away(part: str, robot: str) -> None:
    result, stepwise = (blocks(part, robot, derivation) for derivation in (Derivation.RESULT, Derivation.STEPS))
    assert not [block for block in result if isinstance(block, Steps)]
    shown = [block.rows for block in stepwise if isinstance(block, SheetFormula)]
    assert all(block.rows in shown for block in result if isinstance(block, SheetFormula))
    assert len(stepwise) >= len(result)


@pytest.mark.parametrize("robot", ROBOTS)
@pytest.mark.parametrize("part", PARTS)
def test_brackets_of_every_line_are_closed(part: str, robot: str) -> None:
    assert_closed(lines(blocks(part, robot, Derivation.STEPS)))


def assert_closed(rows: list[str]) -> None:
    for line in rows:
        plain = line.replace("\\{", "").replace("\\}", "")
        assert plain.count("{") == plain.count("}"), line
        for opening, closing in (("\\left", "\\right"), ("\\begin", "\\end")):
            arrows = [line.count(f"{word}arrow") for word in (opening, closing)]
            assert line.count(opening) - arrows[0] == line.count(closing) - arrows[1], line


@pytest.mark.parametrize("revolute", [True, False])
@pytest.mark.parametrize("standard", [True, False])
def test_the_recursion_goes_outward_over_motion_and_inward_over_forces(standard: bool, revolute: bool) -> None:
    context = context_of(Robot.load("scara-perugia"))
    recursion, joint = Recursion(standard, context.symbols), JointLetters.any_joint(revolute)
    outward, inward = (" ".join(map(str, way(joint))) for way in (recursion.outward, recursion.inward))
    assert "omega" in outward
    assert "tau" in inward
    assert "tau" not in outward


def sentences(robot: Robot, parts: Iterable[str]) -> str:
    context = context_of(robot, HandoutOptions(derivation=Derivation.STEPS))
    found = [section for part in parts if (section := section_of(context, part)) is not None]
    texts = [block.text for section in found for block in blocks_of(section) if isinstance(block, Paragraph)]
    return " ".join([*(section.title for section in found), *texts])


ARM = "name: arm\nconvention: standard\njoints: [{type: revolute, a: 1}]\nlinks: [{mass: 2, inertia: {zz: 1}}]\n"


@pytest.mark.parametrize("links", ["{mass: 2}", "{mass: 2, armature: 3}", "{mass: 2, motor: {ratio: 5, inertia: 1}}"])
def test_motors_are_spoken_of_only_where_there_are_some(links: str) -> None:
    robot = Robot.from_text(ARM.replace("{mass: 2, inertia: {zz: 1}}", links))
    text = sentences(robot, ("link-jacobians", "energies", "inertia"))
    assert any(word in text for word in ("motors", "rotor", "armature")) == (links != "{mass: 2}")
    assert ("rotor" in text) == ("motor" in links or "armature" in links)


def test_an_equation_of_motion_without_gravity_has_no_g() -> None:
    robot = Robot.from_text(ARM)
    for given in (robot, replace(robot, gravity=None)):
        printed = lines(tuple(equations_of_motion(context_of(given))))
        has_g = any("\\mathbf{g}(\\mathbf{q})" in line for line in printed)
        assert has_g == (given.gravity is not None)


# pi/6 exceeds the limit of the first joint, which is then in the middle of them
IN_NUMBERS = (r"q_{1} = (0.15 - \tfrac{\pi}{2})\,\mathrm{rad}", r"d_{3} = 0.1\,\mathrm{m}", r"\mathrm{N\,m}")
WITHOUT_MASS, WITHOUT_LENGTH = REACHED.replace(", m2: 2", ""), REACHED.replace("a2: 0.5, ", "")
SQUARED = r"entries $(1,4)$, $(2,4)$ and $(3,4)$ of $\mathbf{T}$, squared and added: the law of cosines."
PRODUCTS = (
    r"\mathbf{T} = (\mathbf{Z}_{1}\mathbf{X}_{1})\,(\mathbf{Z}_{2}\mathbf{X}_{2})\,\mathbf{T}_{\mathrm{tool}}",
    r"\mathbf{T} = (\mathbf{X}_{0}\mathbf{Z}_{1})\,(\mathbf{X}_{1}\mathbf{Z}_{2})\,\mathbf{T}'_{\mathrm{tool}}",
    r"\mathbf{T}'_{\mathrm{tool}} = \mathbf{X}_{2}\mathbf{T}_{\mathrm{tool}}",
)
FACTORED = r"a_{2}s_{5}(d_{4}c_{3} + a_{3}s_{3})(a_{2}c_{2} + a_{3}c_{23} - d_{4}s_{23})"
NO_AXIS = r"an axis $z$ is the third column of the transform from its frame to the world."
# Robot, part, what it says as often as it stands here, and what it does not say.
SAID: list[tuple[str, str, tuple[str, ...], tuple[str, ...]]] = [
    (
        "planar-2r-perugia",
        "parameters",
        (r"\text{mass}", r"\text{gear ratio}", "Link 2:"),
        (r"\text{armature}", "Link 3:"),
    ),
    ("scara-perugia", "figure", ("frames at the zero configuration", r"$a_{1} = 1\,\mathrm{m}$"), ()),
    ("puma560-corke", "figure", (), ("assumed",)),
    ("planar-2r-perugia", "conversion", (*PRODUCTS, "Jacobian", "torques"), ("base}",)),
    ("planar-3r", "conversion", ("Jacobian",), ("torques",)),
    ("puma560-corke", "conversion", tuple(f"Link {i}:" for i in range(1, 6)), ("Link 6:", "rotor", "friction")),
    (
        "skeleton-modified",
        "conversion",
        (r"\mathbf{T}'_{\mathrm{base}} = \mathbf{T}_{\mathrm{base}}\mathbf{X}_{0}",),
        (),
    ),
    ("skeleton-modified", "conversion", (r"'_{\mathrm{tool}} = \mathbf{X}_{2}^{-1}\mathbf{T}_{\mathrm{tool}}",), ()),
    ("scara-perugia", "orientation", ("never singular", "in every configuration"), ()),
    ("spherical-wrist", "orientation", ("They are singular where",) * 2, ()),
    (REACHED, "jacobian", ("opposite sign", r"& -\mathbf{z}_{2} \\"), ()),
    ("thumb", "jacobian", (r"For $\mathbf{p}$ see the fourth column of $\mathbf{T}$.",), ()),
    ("human-body", "jacobian", (r"$\mathbf{z}_{12}$", NO_AXIS, "an origin is the fourth column"), ()),
    ("planar-2r-perugia", "skew", ("cancel",), ()),
    ("scara-perugia", "singularities", ("\n\\det\\mathbf{J}' = a_{1}a_{2}s_{2}\ns_{2} = 0 \\iff q_{2} = 0",), ()),
    ("puma560-corke", "singularities", (r"\det\mathbf{J}_{22}", FACTORED, "(shoulder)", "(elbow)", "(wrist)"), ()),
    ("kuka-lwr4", "singularities", (r"\det(\mathbf{J}\,\mathbf{J}^T) = 0", "Nowhere else is rank lost."), ()),
    ("kuka-lwr4", "singularities", ("\ns_{2} = 0 \\iff q_{2} = 0\\ \\text{or}\\ 180^{\\circ},\\quad c_{3} = 0 ",), ()),
    ("planar-2r-perugia", "inverse", (SQUARED, "A reachable pose has 2 solutions, real or complex"), ()),
    ("planar-2r-perugia", "inverse", ("This happens at a singularity of the arm: $s_{2} = 0$",), ()),
    # solved for its position, it says what a whole pose must satisfy
    ("planar-2r-perugia", "inverse", ("r_{13} = 0", "(p_{x} - a_{2}r_{11})^{2}"), ()),
    ("anthropomorphic-wrist", "inverse", ("So the problem decouples", "$a_{2}c_{2} + d_{4}s_{23} = 0$ (shoulder)"), ()),
    ("anthropomorphic-wrist", "inverse", ("The arm is singular there: $s_{5} = 0$ (wrist).",), ()),
    # with d3 the PUMA's q1 has no value at px = py = 0, where an arm without it has infinitely many
    ("puma560-corke", "inverse", (), ("Where $p_{x} = 0$",)),
    ("kuka-lwr4", "inverse", ("redundant of degree $R = N - M = 1$",), ()),
    ("human-body", "inverse", ("Of an arm with 21 joints no closed form is derived",), ("atan2",)),
    ("scara-perugia", "inverse", (r"r_{13} = 0 \qquad r_{23} = 0 \qquad r_{33} = -1",), ()),
    (REACHED, "example", IN_NUMBERS, ()),
    (WITHOUT_LENGTH, "example", ("assumed", r"\mathbf{B} = "), ()),
    (WITHOUT_MASS, "example", ("$m_{2}$", "\n\\mathbf{T} = ", "\n\\mathbf{J} = "), (r"\mathbf{B} = ", r"g_{1} = ")),
]


@pytest.mark.parametrize(("robot", "name", "said", "unsaid"), SAID)
@pytest.mark.first(8)
def test_what_a_reader_must_know_is_said(robot: str, name: str, said: tuple[str, ...], unsaid: tuple[str, ...]) -> None:
    found = part(robot, name, steps=True)
    text = "\n".join((words(found), *lines(blocks_of(found)), ""))
    assert all(text.count(sentence) >= said.count(sentence) for sentence in said)
    assert not [sentence for sentence in unsaid if sentence in text]


def test_the_steps_show_the_blocks_and_results_can_be_left_blank() -> None:
    robot = "stanford-deluca"
    assert not any(isinstance(block, Steps) for block in part(robot, "singularities").blocks)
    steps = next(block for block in part(robot, "singularities", steps=True).blocks if isinstance(block, Steps))
    assert sum(isinstance(block, SheetFormula) for block in steps.blocks) == 2
    formulas = [block for block in part("planar-2r-perugia", "singularities").blocks if isinstance(block, SheetFormula)]
    assert formulas
    assert all(formula.blanks for formula in formulas)


def test_the_texts_are_translated() -> None:
    found = part("stanford-deluca", "singularities", language="it")
    assert found.title == "Singolarità"
    assert "\\text{o}" in "".join(lines(found.blocks))
    assert "\\text{(polso)}" in "".join(lines(found.blocks))


@pytest.mark.parametrize("key", [*chains(), *range(20)])
@pytest.mark.first(8)
def test_every_robot_has_the_part(key: str | int) -> None:
    robot = key if isinstance(key, str) else random_robot(random.Random(key), dynamics=False).text
    for block in blocks_of(part(robot, "singularities", steps=True)):
        if isinstance(block, SheetFormula):
            assert block.rows or block.omitted
            assert_closed(lines([block]))


@pytest.mark.parametrize("language", [language for language in languages() if language != ENGLISH])
@pytest.mark.parametrize("name", ["inverse", "conversion"])
def test_all_languages_say_the_same_things(name: str, language: str) -> None:
    english, other = part("scara-perugia", name), part("scara-perugia", name, language=language)
    assert english.title != other.title
    assert [type(block) for block in english.blocks] == [type(block) for block in other.blocks]
    ours, theirs = ({b.text for b in found.blocks if isinstance(b, Paragraph)} for found in (english, other))
    assert ours & theirs <= {"Standard:"}


def table(robot: Robot) -> Table:
    (found,) = (block for block in dh_table(context_of(robot)) if isinstance(block, Table))
    return found


def test_columns_have_the_order_of_the_convention_and_every_joint_a_row_with_its_variable() -> None:
    standard, modified = table(Robot.load("scara-perugia")), table(Robot.load("dh-modified-deluca"))
    assert standard.header[2:6] == ("$\\theta_i$", "$d_i$", "$a_i$", "$\\alpha_i$")
    assert modified.header[2:6] == ("$\\alpha_{i-1}$", "$a_{i-1}$", "$\\theta_i$", "$d_i$")
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
    for own, stated in ((robot, False), (replace(robot, base=base), True)):
        assert ("Constant transforms" in words(part(own, "table"))) is stated


MIXED = """\
name: arm
convention: standard
units: {angle: deg, length: mm}
joints: [{type: revolute, d: 400, a: a1 + 20, alpha: beta - 90}, {type: prismatic, d: q2 - 10, limits: [0, 180]}]
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


def test_the_figure_is_drawn_with_its_values_and_nothing_without_poses() -> None:
    assert section_of(changed(context_of(Robot.load("scara-perugia")), poses=None), "figure") is None
    q = (Number(Fraction(1, 2)), Number(Fraction(1)), Number(Fraction(3, 10)), Number(Fraction(0)))
    robot = replace(Robot.load("scara-perugia"), figure=FigureOptions(q=q))
    made = part(robot, "figure")
    figures = [block for block in made.blocks if isinstance(block, Figure)]
    assert len(figures) == 2
    assert "$q_{1} = 0.5\\,\\mathrm{rad}$" in figures[1].caption
    assert "$q_{3} = 0.3\\,\\mathrm{m}$" in figures[1].caption


def test_a_joint_whose_limits_exclude_zero_is_drawn_in_their_middle() -> None:
    rows = "R a: 0.4, limits: [-90, 90] | R a: 0.3, limits: [20, 130] | P alpha: 180, limits: [0.1, 0.4]"
    robot = robot_of_rows(f"{rows} | R limits: [low, high]", "units: {angle: deg}")
    assert RobotPoses(robot).zero == pytest.approx((0, math.radians(75), 0.25, 0))
    made = part(robot, "figure")
    (figure,) = (block for block in made.blocks if isinstance(block, Figure))
    assert figure.caption.endswith(
        "in the middle of their limits: $q_{2} = 75^{\\circ}$, $q_{3} = 0.25\\,\\mathrm{m}$."
    )


def test_the_zero_configuration_is_within_the_limits_of_the_catalogue() -> None:
    for name in chains():
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
