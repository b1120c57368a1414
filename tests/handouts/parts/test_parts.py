"""What holds for every part of the handout, whatever it shows."""

import random
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
from derive.handouts.parts.newton_euler import JointLetters, Recursion, newton_euler
from derive.handouts.parts.orientation import orientation
from derive.handouts.parts.singularities import singularities
from derive.handouts.parts.table import dh_table, parameters
from derive.handouts.sheet.context import Context
from derive.handouts.sheet.document import Block, Paragraph, Section, SheetFormula, Steps, blocks_of
from derive.handouts.sheet.dynamics import DynamicsLayout
from derive.handouts.sheet.language import ENGLISH, languages
from derive.robot.load import catalogue_names
from derive.robot.options.handout import Derivation, HandoutOptions
from derive.robot.robot import Robot
from tests.handouts.reading import REACHED, lines, part, words
from tests.random_robots import random_robot

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
            arrows = [line.count(f"{word}arrow") for word in (opening, closing)]
            assert line.count(opening) - arrows[0] == line.count(closing) - arrows[1], line


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
def test_what_a_reader_must_know_is_said(robot: str, name: str, said: tuple[str, ...], unsaid: tuple[str, ...]) -> None:
    found = part(robot, name, steps=True)
    text = "\n".join((words(found), *lines(blocks_of(found)), ""))
    assert all(text.count(sentence) >= said.count(sentence) for sentence in said)
    assert not [sentence for sentence in unsaid if sentence in text]


def test_the_steps_show_the_blocks() -> None:
    robot = "stanford-deluca"
    assert not any(isinstance(block, Steps) for block in part(robot, "singularities").blocks)
    steps = next(block for block in part(robot, "singularities", steps=True).blocks if isinstance(block, Steps))
    assert sum(isinstance(block, SheetFormula) for block in steps.blocks) == 2


def test_the_results_can_be_left_blank() -> None:
    formulas = [block for block in part("planar-2r-perugia", "singularities").blocks if isinstance(block, SheetFormula)]
    assert formulas
    assert all(formula.blanks for formula in formulas)


def test_the_texts_are_translated() -> None:
    found = part("stanford-deluca", "singularities", language="it")
    assert found.title == "Singolarità"
    assert "\\text{o}" in "".join(lines(found.blocks))
    assert "\\text{(polso)}" in "".join(lines(found.blocks))


@pytest.mark.parametrize("key", [*catalogue_names(), *range(20)])
def test_every_robot_has_the_part(key: str | int) -> None:
    robot = key if isinstance(key, str) else random_robot(random.Random(key), dynamics=False).text
    for block in blocks_of(part(robot, "singularities", steps=True)):
        if isinstance(block, SheetFormula):
            assert block.rows or block.omitted
            printed = (line.replace("\\{", "").replace("\\}", "") for rows in block.rows for line in rows.lines)
            assert all(line.count("{") == line.count("}") for line in printed)


@pytest.mark.parametrize("language", [language for language in languages() if language != ENGLISH])
@pytest.mark.parametrize("name", ["inverse", "conversion"])
def test_all_languages_say_the_same_things(name: str, language: str) -> None:
    english, other = part("scara-perugia", name), part("scara-perugia", name, language=language)
    assert english.title != other.title
    assert [type(block) for block in english.blocks] == [type(block) for block in other.blocks]
    ours, theirs = ({b.text for b in found.blocks if isinstance(b, Paragraph)} for found in (english, other))
    assert ours & theirs <= {"Standard:"}
