"""The part of the handout with the inverse kinematics: it reads as a teacher writes it, and its formulas hold."""

import math
import random
from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np
import pytest
import sympy

from derive.handouts.assemble import context_of, document, section_of
from derive.handouts.exercise import exercise
from derive.handouts.parts.inverse import inverse
from derive.handouts.sheet.context import Context
from derive.handouts.sheet.document import (
    Blank,
    Document,
    Figure,
    Paragraph,
    Rows,
    Section,
    SheetFormula,
    Steps,
    Table,
    blocks_of,
)
from derive.handouts.sheet.language import ENGLISH, languages
from derive.handouts.sheet.latex_writer import latex
from derive.inverse.closed.solve import usual_task
from derive.lecture.sympy_conversion import expression_to_sympy
from derive.model.model import Model
from derive.robot.evaluate import parameter_values
from derive.robot.load import catalogue_names
from derive.robot.names import free_symbols
from derive.robot.options.inverse import InverseOptions
from derive.robot.robot import Robot
from derive.verification.oracle.frames import forward_kinematics, numeric_arm
from tests.handouts.latex_runner import overfull, run_latex
from tests.inverse.arms import PUBLISHED, ArmCase
from tests.random_robots import robot_text

KINDS = ("planar-2r-perugia", "planar-3r", "scara-perugia", "spherical-arm", "spherical-wrist", "thumb")
LARGE = ("puma560-corke", "stanford-laschi", "kuka-lwr4", "anthropomorphic-wrist")
UR5 = """
name: ur-like
convention: standard
joints:
  - {type: revolute, d: 0.089, alpha: pi/2}
  - {type: revolute, a: -0.425}
  - {type: revolute, a: -0.392}
  - {type: revolute, d: 0.109, alpha: pi/2}
  - {type: revolute, d: 0.095, alpha: -pi/2}
  - {type: revolute, d: 0.082}
"""


def part(robot: Robot, language: str = ENGLISH) -> Section:
    found = section_of(context_of(robot, replace(robot.handout, language=language)), "inverse")
    assert found is not None
    return found


def words(section: Section) -> str:
    return " ".join(block.text for block in blocks_of(section) if isinstance(block, Paragraph))


def printed(section: Section) -> list[str]:
    return [
        line
        for block in blocks_of(section)
        for rows in (block.rows if isinstance(block, SheetFormula) else (block,) if isinstance(block, Rows) else ())
        for line in rows.lines
    ]


def solved(robot: Robot) -> Robot:
    return replace(robot, inverse=InverseOptions(usual_task(robot)))


def copied(section: Section) -> list[str]:
    """What the buttons of the page copy: definitions and formulas as assignments, in their order."""
    found = [block for block in section.blocks if isinstance(block, SheetFormula) and block.entries]
    return [entry.python for block in found if block.function != "inverse_kinematics" for entry in block.entries]


@pytest.mark.parametrize(
    "name", [*KINDS, *(pytest.param(name, marks=pytest.mark.sweep) for name in (*LARGE, "ur-like"))]
)
def test_its_formulas_give_back_the_pose_with_every_choice_of_signs(name: str) -> None:
    """In numbers, by the oracle: the original is among them, and all reach the pose unless the part says otherwise."""
    robot = Robot.from_text(UR5) if name == "ur-like" else Robot.load(name)
    found = Model(solved(robot)).inverse
    lines = copied(part(robot))
    rng = random.Random(3)
    values = {symbol: rng.uniform(0.3, 0.9) for symbol in free_symbols(robot)}
    arm = numeric_arm(robot, values)
    numbers = {name: float(x) for name, x in parameter_values(robot, values).items()}
    q = np.array([rng.uniform(0.2, 1.2) for _ in robot.joints])
    pose = forward_kinematics(arm, q[None])[0]
    given = {str(symbol): pose[i, j] for i in range(3) for j in range(4) for symbol in [found.pose[i, j]]}
    given |= {robot.joints[k].variable: q[k] for k in found.graph.given}
    signs = [str(sign) for line in found.lines for sign in line.signs]
    reached = []
    for choice in product((1.0, -1.0), repeat=len(signs)):
        own = evaluated(lines, {**numbers, **given, **dict(zip(signs, choice, strict=True))})
        if own is None:
            continue
        other = np.array([own[joint.variable] for joint in robot.joints])
        error = np.abs(forward_kinematics(arm, other[None])[0] - pose)
        if max(error[i, j] for i, j in found.graph.places) < 1e-9:
            reached.append(other)
        else:
            assert found.graph.leaves > found.count
    assert any(np.abs(np.sin((other - q) / 2)).max() < 1e-9 for other in reached)


def evaluated(lines: list[str], known: dict[str, float]) -> dict[str, float] | None:
    """The numbers of all assignments; None where a root is not real."""
    functions = {"atan2": math.atan2, "sqrt": math.sqrt, "cos": math.cos, "sin": math.sin, "pi": math.pi}
    scope = {"__builtins__": {}, **functions, **known}
    try:
        exec("\n".join(lines), scope)
    except ValueError:
        return None
    return scope


def test_a_teacher_says_which_entries_are_squared_and_added_and_names_the_law_of_cosines() -> None:
    section = part(Robot.load("planar-2r-perugia"))
    assert "entries $(1,4)$, $(2,4)$ and $(3,4)$ of $\\mathbf{T}$, squared and added: the law of cosines." in words(
        section
    )
    assert "A reachable pose has 2 solutions, real or complex" in words(section)
    assert "This happens at a singularity of the arm: $s_{2} = 0$" in words(section)
    rows = next(block for block in section.blocks if isinstance(block, Table)).rows
    assert rows == (("1", "elbow down", "$+$"), ("2", "elbow up", "$-$"))


def test_an_arm_solved_for_its_position_says_what_a_whole_pose_must_satisfy() -> None:
    lines = printed(part(Robot.load("planar-2r-perugia")))
    assert any("r_{13} = 0" in line and "(p_{x} - a_{2}r_{11})^{2}" in line for line in lines)


def test_a_wrist_decouples_and_its_degenerate_poses_are_zeros_of_the_determinant() -> None:
    section = part(Robot.load("anthropomorphic-wrist"))
    assert "So the problem decouples" in words(section)
    assert "The arm is singular there: $s_{5} = 0$ (wrist)." in words(section)
    assert "$a_{2}c_{2} + d_{4}s_{23} = 0$ (shoulder)" in words(section)


def test_an_offset_axis_is_never_reached_and_so_no_joint_is_free_there() -> None:
    """With d3 the PUMA's q1 has no value at px = py = 0, where an arm without it has infinitely many."""
    assert "Where $p_{x} = 0$" not in words(part(Robot.load("puma560-corke")))


def test_a_redundant_arm_says_what_is_given_and_a_long_one_how_it_is_solved() -> None:
    assert "redundant of degree $R = N - M = 1$" in words(part(Robot.load("kuka-lwr4")))
    section = part(Robot.load("human-body"))
    assert "Of an arm with 21 joints no closed form is derived" in words(section)
    assert not any(isinstance(block, SheetFormula) for block in section.blocks)


def test_conditions_of_few_joints_are_printed() -> None:
    lines = printed(part(Robot.load("scara-perugia")))
    assert any(line.startswith("r_{13} = 0 \\qquad r_{23} = 0 \\qquad r_{33} = -1") for line in lines)


@pytest.mark.parametrize("name", ["planar-3r", "scara-perugia", "spherical-arm"])
def test_the_example_draws_its_configurations_over_each_other(name: str) -> None:
    section = part(Robot.load(name))
    (figure,) = (block for block in section.blocks if isinstance(block, Figure))
    assert figure.drawing.width <= 380
    table = next(b for b in section.blocks if isinstance(b, SheetFormula) and b.function == "inverse_kinematics")
    configurations = np.array(eval(table.entries[0].python, {"__builtins__": {}}))
    assert len(configurations) >= 2
    robot = Robot.load(name)
    poses = context_of(robot).poses
    assert poses is not None
    ends = np.array([poses.frames(tuple(q))[-1] for q in configurations])
    places = Model(solved(robot)).inverse.graph.places
    assert max(np.ptp(ends[:, i, j]) for i, j in places) < 1e-9


def test_a_single_joint_has_no_example() -> None:
    blocks = list(inverse(context_of(Robot.load("dh-general-laschi"))))
    assert any(isinstance(block, SheetFormula) and block.entries for block in blocks)
    assert not any(isinstance(block, Table | Figure) for block in blocks)


@pytest.mark.parametrize("language", languages())
def test_all_languages_say_the_same_things(language: str) -> None:
    robot = Robot.load("scara-perugia")
    english, other = part(robot), part(robot, language)
    assert [type(block) for block in english.blocks] == [type(block) for block in other.blocks]
    if language != ENGLISH:
        paragraphs = [b.text for b in english.blocks if isinstance(b, Paragraph)]
        assert not {b.text for b in other.blocks if isinstance(b, Paragraph)} & set(paragraphs)


def test_an_exercise_asks_for_each_unknown_and_shows_no_answer() -> None:
    robot = Robot.load("scara-perugia")
    context = context_of(robot, replace(robot.handout, language=ENGLISH))
    whole = part(robot)
    sheet = exercise(replace(document_with(context), sections=(whole,)), context.text)
    (section,) = sheet.sections
    tasks = [block.task for block in section.blocks if isinstance(block, Blank)]
    assert "Solve the inverse kinematics for $q_{2}$." in tasks
    assert "Which conditions must a pose satisfy so that the arm can reach it?" in tasks
    assert not any(isinstance(block, Table | Figure | Steps | SheetFormula) for block in section.blocks)
    shown = words(section) + "".join(printed(section))
    assert "D" not in "".join(printed(section))
    assert not any(word in shown for word in ("elbow", "entries (", "solutions, real", "configuration"))
    assert "In numbers, with $a_{1} = 1\\,\\mathrm{m}$" in shown


def document_with(context: Context) -> Document:
    """An empty document of a robot."""
    return replace(document(replace(context, options=replace(context.options, parts=("table",)))), sections=())


@pytest.mark.sweep
@pytest.mark.parametrize("name", catalogue_names())
def test_every_robot_of_the_catalogue_has_the_part(name: str) -> None:
    assert part(Robot.load(name)).blocks


@pytest.mark.parametrize("name", KINDS)
def test_the_equations_that_it_prints_hold_identically(name: str) -> None:
    """The pose put in by the joint variables, in exact rational numbers: c and s of every angle from a tangent."""
    robot = Robot.load(name)
    found = Model(solved(robot)).inverse
    rng = random.Random(8)
    tangents = {sympy.Symbol(j.variable): sympy.Rational(rng.randint(1, 20), 7) for j in robot.joints}
    exact = {sympy.Symbol(n): sympy.Rational(rng.randint(20, 90), 97) for n in free_symbols(robot)}
    exact |= {sympy.Symbol(n): expression_to_sympy(e) for n, e in robot.parameters}

    def rational(e: sympy.Expr) -> sympy.Expr:
        plain = sympy.expand_trig(e.xreplace(exact))
        calls = {}
        for q, t in tangents.items():
            calls[sympy.cos(q)], calls[sympy.sin(q)] = (1 - t**2) / (1 + t**2), 2 * t / (1 + t**2)
        slides = {
            sympy.Symbol(j.variable): t
            for j, t in zip(robot.joints, tangents.values(), strict=True)
            if not j.is_revolute
        }
        return sympy.expand(plain.xreplace(calls).xreplace(slides))

    totals = {name: total for total, name in found.sums.items()}
    end = Model(robot).T
    pose = {found.pose[i, j]: rational(end[i, j]) for i in range(3) for j in range(4)}
    for line in found.definitions:
        pose[line.symbol] = rational(line.value.xreplace(pose))
    for step in found.steps:
        for equation in step.equations:
            difference = (equation.left - equation.right).xreplace(totals).xreplace(pose)
            assert rational(difference) == 0


LONG = 7013
"""A seed of an arm of seven joints whose axes are parallel to no other."""


@pytest.mark.sweep
def test_an_arm_whose_formulas_nobody_reads_has_a_sentence_instead() -> None:
    section = part(Robot.from_text(robot_text(random.Random(LONG), 7)))
    assert "are too long to print" in words(section)
    assert len(section.blocks) == 1


@pytest.mark.sweep
@pytest.mark.parametrize("seed", [2, 3, 5, 8, 9, 10, 11, 16, 18, 22, 25, 26])
def test_long_conditions_and_equations_stay_within_the_margins(seed: int, tmp_path: Path) -> None:
    robot = Robot.from_text(robot_text(random.Random(7000 + seed), 1 + seed % 7))
    language = languages()[seed % len(languages())]
    context = context_of(robot, replace(robot.handout, language=language, parts=("inverse",)))
    log = run_latex(latex(document(context), context.text), tmp_path)
    assert not log.errors
    assert overfull(log) <= 1.0


@pytest.mark.parametrize("case", [c for c in PUBLISHED if c.name in ("scara-wrist", "crx-10ia")], ids=lambda c: c.name)
def test_arms_of_books_have_the_part(case: ArmCase) -> None:
    """With three parallel axes first; with an offset wrist, whose joints are those of an eigenvalue problem."""
    said = words(part(case.robot()))
    parallel = "are parallel; $q_{123} = q_{1} + q_{2} + q_{3}$"
    assert parallel in said or "of a matrix with 16 rows: its eigenvalues give $q_{4}$" in said
