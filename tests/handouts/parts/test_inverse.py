"""The part of the handout with the inverse kinematics: it reads as a teacher writes it, and its formulas hold."""

import math
import random
from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np
import pytest
import sympy

from derive.handouts.assemble import context_of, document
from derive.handouts.exercise import exercise
from derive.handouts.notation.derivation import derivation_lines
from derive.handouts.parts.inverse import inverse
from derive.handouts.parts.inverse_example import reached
from derive.handouts.parts.inverse_words import and_list, branch_name, formulas, sources, words_alone
from derive.handouts.sheet.document import Blank, Figure, Section, SheetFormula, Steps, Table
from derive.handouts.sheet.language import Text, languages, text_for
from derive.handouts.sheet.latex_writer import latex
from derive.inverse.closed.solve import usual_task
from derive.inverse.words.postures import Word
from derive.lecture.sympy_conversion import expression_to_sympy
from derive.model.model import Model
from derive.robot.evaluate import parameter_values
from derive.robot.names import free_symbols
from derive.robot.options.handout import FrameIndices, NotationOptions, PoseEntries
from derive.robot.options.inverse import InverseOptions
from derive.robot.robot import Robot
from derive.verification.oracle.frames import forward_kinematics, numeric_arm
from tests.handouts.latex_runner import run_clean
from tests.handouts.reading import lines, part, words
from tests.inverse.arms import PUBLISHED, ArmCase
from tests.random_robots import chains, robot_text
from tests.rows import robot_of_rows

KINDS = ("planar-2r-perugia", "planar-3r", "scara-perugia", "spherical-arm", "spherical-wrist", "thumb")
LARGE = ("puma560-corke", "stanford-laschi", "kuka-lwr4", "anthropomorphic-wrist")
UR5 = robot_of_rows(
    "R d: 0.089, alpha: pi/2 | R a: -0.425 | R a: -0.392 | R d: 0.109, alpha: pi/2 | R d: 0.095, alpha: -pi/2"
    "| R d: 0.082"
)


def solved(robot: Robot) -> Robot:
    return replace(robot, inverse=InverseOptions(usual_task(robot)))


def copied(section: Section) -> list[str]:
    """What the buttons of the page copy: definitions and formulas as assignments, in their order."""
    found = [block for block in section.blocks if isinstance(block, SheetFormula)]
    return [entry.python for block in found if block.function != "inverse_kinematics" for entry in block.entries()]


@pytest.mark.parametrize(
    "name", [*KINDS, *(pytest.param(name, marks=pytest.mark.sweep) for name in (*LARGE, "ur-like"))]
)
def test_its_formulas_give_back_the_pose_with_every_choice_of_signs(name: str) -> None:
    """In numbers, by the oracle: the original is among them, and all reach the pose unless the part says otherwise."""
    robot = UR5 if name == "ur-like" else Robot.load(name)
    found = Model(solved(robot)).inverse
    assignments = copied(part(robot, "inverse"))
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
        own = evaluated(assignments, {**numbers, **given, **dict(zip(signs, choice, strict=True))})
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


@pytest.mark.parametrize("name", ["planar-3r", "scara-perugia", "spherical-arm"])
def test_the_example_draws_its_configurations_over_each_other(name: str) -> None:
    section = part(name, "inverse")
    (figure,) = (block for block in section.blocks if isinstance(block, Figure))
    assert figure.drawing.width <= 380
    table = next(b for b in section.blocks if isinstance(b, SheetFormula) and b.function == "inverse_kinematics")
    configurations = np.array(eval(next(iter(table.entries())).python, {"__builtins__": {}}))
    assert len(configurations) >= 2
    robot = Robot.load(name)
    poses = context_of(robot).poses
    ends = np.array([poses.frames(tuple(q))[-1] for q in configurations])
    places = Model(solved(robot)).inverse.graph.places
    assert max(np.ptp(ends[:, i, j]) for i, j in places) < 1e-9


def test_a_single_joint_has_no_example() -> None:
    blocks = list(inverse(context_of(Robot.load("dh-general-laschi"))))
    assert any(isinstance(block, SheetFormula) and any(block.entries()) for block in blocks)
    assert not any(isinstance(block, Table | Figure) for block in blocks)


def test_an_exercise_asks_for_each_unknown_and_shows_no_answer() -> None:
    robot = Robot.load("scara-perugia")
    context = context_of(robot, replace(robot.handout, parts=("inverse",)))
    (section,) = exercise(document(context), context.text).sections
    tasks = [block.task for block in section.blocks if isinstance(block, Blank)]
    assert "Solve the inverse kinematics for $q_{2}$." in tasks
    assert "Which conditions must a pose satisfy so that the arm can reach it?" in tasks
    assert not any(isinstance(block, Table | Figure | Steps | SheetFormula) for block in section.blocks)
    shown = words(section) + "".join(lines(section.blocks))
    assert "D" not in "".join(lines(section.blocks))
    assert not any(word in shown for word in ("elbow", "entries (", "solutions, real", "configuration"))
    assert "In numbers, with $a_{1} = 1\\,\\mathrm{m}$" in shown


@pytest.mark.sweep
@pytest.mark.parametrize("name", chains())
def test_every_robot_of_the_catalogue_has_the_part(name: str) -> None:
    assert part(name, "inverse").blocks


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

    end = Model(robot).T
    pose = {found.pose[i, j]: rational(end[i, j]) for i in range(3) for j in range(4)}
    for line in found.definitions:
        pose[line.symbol] = rational(line.value.xreplace(pose))
    for step in found.steps:
        for equation in step.equations:
            difference = (
                (equation.left - equation.right)
                .xreplace({name: total for total, name in found.sums.items()})
                .xreplace(pose)
            )
            assert rational(difference) == 0


@pytest.mark.sweep
def test_an_arm_whose_formulas_nobody_reads_has_a_sentence_instead() -> None:
    section = part(Robot.from_text(robot_text(random.Random(7013), 7)), "inverse")  # axes parallel to no other
    assert "are too long to print" in words(section)
    assert len(section.blocks) == 1


@pytest.mark.sweep
@pytest.mark.parametrize("seed", [2, 3, 5, 8, 9, 10, 11, 16, 18, 22, 25, 26])
def test_long_conditions_and_equations_stay_within_the_margins(seed: int, tmp_path: Path) -> None:
    robot = Robot.from_text(robot_text(random.Random(7000 + seed), 1 + seed % 7))
    language = languages()[seed % len(languages())]
    context = context_of(robot, replace(robot.handout, language=language, parts=("inverse",)))
    run_clean(latex(document(context), context.text), tmp_path)


@pytest.mark.parametrize("case", [c for c in PUBLISHED if c.name in ("scara-wrist", "crx-10ia")], ids=lambda c: c.name)
@pytest.mark.first(1)
def test_arms_of_books_have_the_part(case: ArmCase) -> None:
    """With three parallel axes first; with an offset wrist, whose joints are those of an eigenvalue problem."""
    said = words(part(case.robot(), "inverse"))
    parallel = "are parallel; $q_{123} = q_{1} + q_{2} + q_{3}$"
    assert parallel in said or "of a matrix with 16 rows: its eigenvalues give $q_{4}$" in said


def test_the_branches_of_a_planar_arm_are_its_elbows() -> None:
    rows = next(block for block in part("planar-2r-perugia", "inverse").blocks if isinstance(block, Table)).rows
    assert rows == (("1", "elbow down", "$+$"), ("2", "elbow up", "$-$"))


@pytest.mark.parametrize(
    ("name", "count"), [("scara-perugia", 2), ("planar-3r", 2), ("stanford-laschi", 8), ("crx-10ia", 8)]
)
def test_every_configuration_reaches_the_pose_by_the_oracle(name: str, count: int) -> None:
    """The last one has no formulas: it is solved in floats."""
    robot = next((case.robot() for case in PUBLISHED if case.name == name), None) or Robot.load(name)
    values = dict.fromkeys(free_symbols(robot), 0.4)
    numbers = {sympy.Symbol(n): float(x) for n, x in parameter_values(robot, values).items()}
    q = [0.3 + 0.2 * k for k in range(robot.n)]
    found = reached(Model(robot).inverse, numbers, q)
    arm = numeric_arm(robot, values)
    poses = forward_kinematics(arm, np.array(list(found.values())))
    assert len(found) == count
    assert np.abs(poses - forward_kinematics(arm, np.array(q))).max() < 1e-12
    apart = (
        max(abs(math.remainder(a - b, 2 * math.pi)) for a, b in zip(own, q, strict=True)) for own in found.values()
    )
    assert min(apart) < 1e-9


def test_each_unknown_has_a_block_and_the_pose_within_the_arm_one_before_them() -> None:
    robot = Robot.load("planar-3r")
    blocks = list(formulas(context_of(robot, robot.handout)))
    texts = ["\n".join(lines([block])) for block in blocks]
    assert [text.split(" = ")[0].strip() for text in texts] == ["w_{x}", "q_{123}", "D", "q_{1}", "q_{3}"]
    assert r"\frac{w_{x}^{2} + w_{y}^{2} - a_{1}^{2} - a_{2}^{2}}{2a_{1}a_{2}}" in texts[2]
    assert r"\pm \sqrt{1 - D^{2}}" in texts[2]


SYMBOL_AX = robot_of_rows("R a: ax | R a: a2 | R a: a3")
BY_COLUMNS = NotationOptions(pose=PoseEntries.COLUMNS)


@pytest.mark.parametrize(
    ("robot", "notation", "shown", "not_shown"),
    [
        # of two values the second stands behind a word
        (Robot.load("spherical-wrist"), NotationOptions(), r"\text{or}", "n_{y}"),
        (Robot.load("scara-perugia"), BY_COLUMNS, r"\operatorname{atan2}(n_{y},\, n_{x})", "r_{21}"),
        # columns that look like symbols of the robot stay entries
        (SYMBOL_AX, BY_COLUMNS, "r_{21}", "n_{y}"),
    ],
)
def test_the_rotation_of_the_pose_may_be_written_by_its_columns(
    robot: Robot, notation: NotationOptions, shown: str, not_shown: str
) -> None:
    text = "\n".join(lines(formulas(context_of(robot, replace(robot.handout, notation=notation)))))
    assert shown in text
    assert not_shown not in text


@pytest.mark.parametrize("name", ["planar-3r", "scara-perugia", "spherical-wrist", "stanford-laschi"])
def test_derive_show_prints_the_same_formulas(name: str) -> None:
    context = context_of(Robot.load(name))
    shown = derivation_lines(context.entries.model.inverse, "latex", context.notation)
    known = {" ".join(line.replace("&=", "=").removesuffix("\\\\").split()) for line in shown}
    for block in formulas(context):
        for entry in block.entries():
            printed = " ".join(f"{entry.name} = {entry.latex}".split())
            assert "\\frac" in printed or printed in known


ARM = Robot.load("anthropomorphic-wrist")


@pytest.mark.parametrize(
    ("frames", "product"), [("right", r"(\mathbf{T}_{4}^{0})"), ("left", r"({}^{0}\mathbf{T}_{4})")]
)
def test_products_are_said_by_the_transforms_of_the_sheet(frames: str, product: str) -> None:
    context = context_of(ARM, replace(ARM.handout, notation=NotationOptions(frames=FrameIndices(frames))))
    step = next(step for step in context.entries.model.inverse.steps if str(step.unknown) == "q5")
    words = sources(context, step.equations)
    assert words.startswith(rf"entries $(1,3)$ and $(2,3)$ of ${product}^{{-1}}\mathbf{{T}}")
    assert words.endswith(r"= \mathbf{A}_{5}^{4}$") or frames == "left"


@pytest.mark.parametrize(("words", "text"), [(["a"], "a"), (["a", "b"], "a and b"), (["a", "b", "c"], "a, b and c")])
def test_a_list_ends_with_and(words: list[str], text: str) -> None:
    assert and_list(Text(), words) == text


@pytest.mark.parametrize("language", ["it", "pt"])
def test_every_word_of_a_branch_is_translated(language: str) -> None:
    notation = context_of(ARM).notation
    text = text_for(language)
    written = {branch_name(text, notation, word) for word in Word}
    assert len(written) == len(Word)
    assert written.isdisjoint(set(Word))


def test_sides_of_zero_are_mathematics_and_numbers_are_left_out_where_they_stand_beside() -> None:
    notation = context_of(ARM).notation
    assert branch_name(Text(), notation, "elbow up, q2 < 0") == "elbow up, $q_{2} < 0$"
    assert branch_name(Text(), notation, "elbow up, #3") == "elbow up, branch 3"
    assert words_alone("elbow up, #2") == "elbow up"
    assert words_alone("#2") == ""
    assert branch_name(Text(), notation, "q2 < 0", lambda symbol: f"<i>{symbol}</i>") == "<i>q_{2}</i> < 0"
