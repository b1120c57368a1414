"""What holds for every part of the handout, whatever it shows."""

from collections.abc import Callable, Iterable
from dataclasses import replace
from functools import cache

import pytest

from derive.handouts.assemble import context_of, section_of
from derive.handouts.parts.bodies import energies, inertia, link_jacobians
from derive.handouts.parts.conversion import conversion
from derive.handouts.parts.example import example
from derive.handouts.parts.figure import arm, convention
from derive.handouts.parts.jacobian import jacobian
from derive.handouts.parts.kinematics import end_effector, transforms
from derive.handouts.parts.motion import christoffel, coriolis, equations_of_motion, gravity, skew
from derive.handouts.parts.newton_euler import newton_euler
from derive.handouts.parts.orientation import orientation
from derive.handouts.parts.recursion import JointLetters, Recursion
from derive.handouts.parts.singularities import singularities
from derive.handouts.parts.table import dh_table, parameters
from derive.handouts.sheet.context import Context
from derive.handouts.sheet.document import Block, Paragraph, Rows, Section, SheetFormula, Steps, blocks_of
from derive.handouts.sheet.dynamics import DynamicsLayout
from derive.robot.options.handout import Derivation, HandoutOptions
from derive.robot.robot import Robot

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


def lines(found: Iterable[Block]) -> list[str]:
    rows = [row for block in found if isinstance(block, SheetFormula) for row in block.rows]
    rows += [block for block in found if isinstance(block, Rows)]
    return [line for row in rows for line in row.lines]


@pytest.mark.parametrize("robot", ROBOTS)
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
    for line in lines(blocks(part, robot, Derivation.STEPS)):
        plain = line.replace("\\{", "").replace("\\}", "")
        assert plain.count("{") == plain.count("}"), line
        for opening, closing in (("\\left", "\\right"), ("\\begin", "\\end")):
            words = [line.count(word + extra) for word in (opening, closing) for extra in ("arrow",)]
            assert line.count(opening) - words[0] == line.count(closing) - words[1], line


@pytest.mark.parametrize("part", PARTS)
def test_no_part_is_empty_for_a_robot_with_everything(part: str) -> None:
    assert blocks(part, "scara-perugia", Derivation.RESULT) or part == "convention"


@pytest.mark.parametrize("robot", WITH_LINKS)
def test_the_layout_of_the_dynamics_names_one_entry_for_both_sides(robot: str) -> None:
    """B is symmetric: b_ij is printed by the name above the diagonal."""
    layout = context_of(Robot.load(robot)).dynamics
    assert isinstance(layout, DynamicsLayout)
    assert layout.inertia_entry(2, 1) == layout.inertia_entry(1, 2)


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


def test_a_vector_that_is_too_long_for_a_step_says_where_it_is() -> None:
    text = sentences(Robot.load("thumb"), ("jacobian",))
    assert "For $\\mathbf{p}$ see the fourth column of $\\mathbf{T}$." in text
    long = sentences(Robot.load("human-body"), ("jacobian",))
    assert "$\\mathbf{z}_{12}$" in long
    assert "an axis $z$ is the third column of the transform from its frame to the world." in long
    assert "an origin is the fourth column" in long


def test_an_equation_of_motion_without_gravity_has_no_g() -> None:
    robot = Robot.from_text(ARM)
    for given in (robot, replace(robot, gravity=None)):
        printed = lines(tuple(equations_of_motion(context_of(given))))
        has_g = any("\\mathbf{g}(\\mathbf{q})" in line for line in printed)
        assert has_g == (given.gravity is not None)
