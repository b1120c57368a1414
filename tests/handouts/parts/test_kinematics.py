"""The parts of the handout about kinematics, and its example in numbers."""

import json
import random
import re
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from derive.handouts import assemble
from derive.handouts.assemble import section_of
from derive.handouts.layout.quantity import POLICY, SheetPolicy
from derive.handouts.parts.example import ANGLES, configuration, numbers_of
from derive.handouts.sheet.context import Context
from derive.handouts.sheet.document import Document, Paragraph, Rows, Section, SheetFormula, blocks_of
from derive.handouts.sheet.language import Text
from derive.handouts.sheet.latex_writer import latex
from derive.mechanics.floats import value_at
from derive.model.dynamic_entries import ModelEntries
from derive.model.model import Model
from derive.robot.expression import Number, Pi, Product
from derive.robot.load import catalogue_names
from derive.robot.names import robot_symbols
from derive.robot.options.handout import Derivation, FrameIndices, HandoutOptions, NotationOptions
from derive.robot.robot import Robot
from derive.verification.oracle.functions import Oracle
from derive.workspace.poses import RobotPoses
from tests.evaluate import evaluate
from tests.handouts.latex_runner import overfull, run_latex
from tests.random_robots import random_robot, robot_text

TENTH = Fraction(1, 10)

PARTS = ("transforms", "kinematics", "orientation", "jacobian", "example")

ARM = """
name: arm
convention: standard
joints:
  - {type: revolute, d: 0.4, a: 0.3, alpha: pi/2, limits: [-pi, 0.3]}
  - {type: revolute, a: a2}
  - {type: prismatic, q: d3, d: -d3, alpha: -pi/2}
links:
  - {mass: 3, com: [-0.1, 0, 0], inertia: {zz: 0.2}}
  - {mass: m2, com: [-0.1, 0, 0], inertia: {zz: 0.2}}
  - {mass: 1, com: [0, 0.1, 0], inertia: {zz: 0.1}}
gravity: [0, 0, -9.81]
parameters: {a2: 0.5, m2: 2}
"""


def context_of(robot: Robot, *, steps: bool = False, policy: SheetPolicy = POLICY, **notation: FrameIndices) -> Context:
    derivation = Derivation.STEPS if steps else Derivation.RESULT
    options = HandoutOptions(derivation=derivation, notation=NotationOptions(**notation))  # type: ignore[arg-type]
    return Context(ModelEntries(Model(robot)), options, Text(), "0.0.0", policy=policy)


def part_of(context: Context, name: str) -> Section:
    section = section_of(context, name)
    assert section is not None
    return section


def mathematics(section: Section) -> str:
    lines: list[str] = []
    for block in blocks_of(section):
        rows = block.rows if isinstance(block, SheetFormula) else (block,) if isinstance(block, Rows) else ()
        lines += [line for part in rows for line in part.lines]
    return "\n".join(lines)


def words(section: Section) -> str:
    return "\n".join(block.text for block in blocks_of(section) if isinstance(block, Paragraph))


def numbered(robot: Robot) -> Robot:
    """The robot with a number for every symbol."""
    given = {name for name, _ in robot.parameters}
    missing = [name for name in robot_symbols(robot) if name not in given]
    further = tuple((name, numbered_value(k)) for k, name in enumerate(missing))
    return replace(robot, figure=replace(robot.figure, values=further))


def numbered_value(k: int) -> Number:
    return Number(TENTH * (k + 3))


def assert_compiles(robot: Robot, folder: Path, **options: object) -> None:
    context = context_of(robot, **options)  # type: ignore[arg-type]
    found = [section_of(context, part) for part in PARTS]
    sections = tuple(section for section in found if section is not None)
    document = Document("Arm", "", robot.name, "en", "0" * 64, "0.0.0", "", sections)
    log = run_latex(latex(document, context.text), folder)
    assert not log.errors
    assert overfull(log) <= 1.0


# -- on paper


@pytest.mark.slow
@pytest.mark.parametrize("name", catalogue_names())
def test_the_kinematics_of_the_catalogue_compiles(name: str, tmp_path: Path) -> None:
    assert_compiles(numbered(Robot.load(name)), tmp_path, steps=True)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(10))
def test_the_kinematics_of_random_robots_compiles(seed: int, tmp_path: Path) -> None:
    robot = Robot.from_text(robot_text(random.Random(seed), 1 + seed % 7))
    frames = FrameIndices.LEFT if seed % 2 else FrameIndices.RIGHT
    assert_compiles(numbered(robot), tmp_path, steps=True, frames=frames)


@pytest.mark.sweep
def test_a_long_arm_compiles(tmp_path: Path) -> None:
    rows = "".join(
        f"  - {{type: {'prismatic' if i % 5 == 0 else 'revolute'}, a: 0.{i}, alpha: pi/2}}\n" for i in range(1, 31)
    )
    robot = Robot.from_text(f"name: arm\nconvention: modified\njoints:\n{rows}")
    assert_compiles(robot, tmp_path, steps=True)


# -- steps


@pytest.mark.parametrize("name", ["scara-perugia", "puma560-corke", "dh-modified-deluca", "kuka-lwr4"])
def test_the_steps_have_every_transform_and_every_column(name: str) -> None:
    robot = Robot.load(name)
    stepwise, result = context_of(robot, steps=True), context_of(robot)
    products, columns = (mathematics(part_of(stepwise, name)) for name in ("kinematics", "jacobian"))
    offset = 1 if robot.convention == "standard" else 0
    for i in range(1, robot.n + 1):
        assert f"\\mathbf{{T}}_{{{i}}}^{{0}} = " in products
        axis = f"\\mathbf{{z}}_{{{i - offset}}}"
        assert f"{axis} = " in columns or f"({axis})_{{" in columns
        assert f"\\mathbf{{J}}_{{{i}}} = " in columns
        assert f"\\mathbf{{J}}_{{{i}}} = " not in mathematics(part_of(result, "jacobian"))
    assert "\\mathbf{T}_{1}^{0} = \\mathbf{A}_{1}^{0}" not in mathematics(part_of(result, "kinematics"))


def test_frames_can_stand_on_the_left() -> None:
    context = context_of(Robot.load("scara-perugia"), steps=True, frames=FrameIndices.LEFT)
    assert "{}^{0}\\mathbf{T}_{2} = {}^{0}\\mathbf{T}_{1}{}^{1}\\mathbf{A}_{2}" in mathematics(
        part_of(context, "kinematics")
    )


def test_without_room_the_steps_are_products(tmp_path: Path) -> None:
    robot = Robot.load("puma560-corke")
    policy = SheetPolicy(matrix_terms=0, flat_terms=3)
    assert_compiles(robot, tmp_path, steps=True, policy=policy)
    section = part_of(context_of(robot, steps=True, policy=policy), "kinematics")
    assert "too long for a step" in words(section)
    for i in range(2, 7):
        assert f"\\mathbf{{T}}_{{{i}}}^{{0}} = \\mathbf{{T}}_{{{i - 1}}}^{{0}}" in mathematics(section)


def test_columns_of_the_jacobian_carry_the_sign_of_their_variable() -> None:
    context = context_of(Robot.from_text(ARM), steps=True)
    assert "& -\\mathbf{z}_{2} \\\\" in mathematics(part_of(context, "jacobian"))
    assert "opposite sign" in words(part_of(context, "jacobian"))


# -- orientation


@pytest.mark.parametrize("seed", range(6))
def test_printed_angles_give_back_the_orientation(seed: int) -> None:
    """R = Rot(z, yaw) Rot(y, pitch) Rot(x, roll) = Rot(z, phi) Rot(y, theta) Rot(z, psi)."""
    drawn = random_robot(random.Random(seed), 1 + seed % 3)
    robot = Robot.from_text(drawn.text)
    q = [0.3, -0.7, 1.1][: robot.n]
    values = {**numbers_of(robot), **drawn.values, **{j.variable: x for j, x in zip(robot.joints, q, strict=True)}}
    entries = ModelEntries(Model(robot))
    wanted = Oracle.of(robot, drawn.values).evaluate("forward_kinematics", q)[:3, :3]
    roll, pitch, yaw = (evaluate(entries.rpy.entry(i, 1), values) for i in (1, 2, 3))
    phi, theta, psi = (evaluate(entries.euler_zyz.entry(i, 1), values) for i in (1, 2, 3))
    np.testing.assert_allclose(turn("z", yaw) @ turn("y", pitch) @ turn("x", roll), wanted, atol=1e-9)
    np.testing.assert_allclose(turn("z", phi) @ turn("y", theta) @ turn("z", psi), wanted, atol=1e-9)


def turn(axis: str, angle: float) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    rows = {
        "x": [[1, 0, 0], [0, c, -s], [0, s, c]],
        "y": [[c, 0, s], [0, 1, 0], [-s, 0, c]],
        "z": [[c, -s, 0], [s, c, 0], [0, 0, 1]],
    }
    return np.array(rows[axis])


def test_singular_orientations_are_told_apart() -> None:
    """Angles ZYZ of a SCARA are singular everywhere, its roll, pitch and yaw nowhere, those of a wrist somewhere."""
    scara = words(part_of(context_of(Robot.load("scara-perugia")), "orientation"))
    assert "never singular" in scara
    assert "in every configuration" in scara
    wrist = words(part_of(context_of(Robot.load("spherical-wrist")), "orientation"))
    assert wrist.count("They are singular where") == 2


# -- example


@pytest.mark.parametrize("seed", range(8))
def test_the_numbers_equal_those_of_the_independent_recursion(seed: int) -> None:
    drawn = random_robot(random.Random(seed))
    robot = numbered(Robot.from_text(drawn.text))
    chosen = {name: float(value.value) for name, value in robot.figure.values if isinstance(value, Number)}
    oracle = Oracle.of(robot, chosen)
    q = configuration(robot).q
    functions = {"T": "forward_kinematics", "J": "jacobian"}
    functions |= {"B": "inertia_matrix", "g": "gravity_vector"} if robot.has_dynamics else {}
    for name, function in functions.items():
        value = np.array(value_at(robot, name, q))
        wanted = oracle.evaluate(function, q)
        np.testing.assert_allclose(value[:, 0] if name == "g" else value, wanted, rtol=1e-9, atol=1e-9)


def test_what_is_copied_is_what_is_computed() -> None:
    robot = Robot.from_text(ARM)
    formulas = [b for b in blocks_of(section_of_example(robot)) if isinstance(b, SheetFormula)]
    q = configuration(robot).q
    for formula, name in zip(formulas, "TJB", strict=False):
        np.testing.assert_allclose(json.loads(formula.entries[0].python), value_at(robot, name, q), atol=1e-11)
    assert len(formulas) == 4


def section_of_example(robot: Robot) -> Section:
    return part_of(context_of(robot), "example")


def test_the_example_keeps_the_limits_and_states_units() -> None:
    """pi/6 exceeds the limit of the first joint, which is then in the middle of them."""
    section = section_of_example(Robot.from_text(ARM))
    first = next(block for block in section.blocks if isinstance(block, Rows)).lines[0]
    assert "q_{1} = (0.15 - \\tfrac{\\pi}{2})\\,\\mathrm{rad}" in first
    assert "d_{3} = 0.1\\,\\mathrm{m}" in first
    assert "\\mathrm{N\\,m}" in mathematics(section)


def test_the_example_is_at_the_configuration_of_the_figure() -> None:
    robot = Robot.from_text(ARM)
    cells = (Product((Pi(), Number(TENTH))), Number(TENTH), Number(TENTH))
    stated = replace(robot, figure=replace(robot.figure, q=cells))
    assert configuration(stated).q == pytest.approx((0.1 * np.pi, 0.1, 0.1))
    assert "configuration of the figure" in words(section_of_example(stated))
    assert configuration(robot).q[1] == pytest.approx(ANGLES[1] * np.pi / 6)


def test_lengths_without_numbers_are_those_of_the_drawing() -> None:
    robot = Robot.from_text(ARM.replace("parameters: {a2: 0.5, m2: 2}", ""))
    section, stated = part_of(assemble.context_of(robot), "example"), RobotPoses(robot).assumed
    assert "assumed" in words(section)
    assert all(f"= {value:g}\\,\\mathrm{{m}}" in mathematics(section) for _name, value, _unit in stated)
    numbers = replace(robot, parameters=tuple((name, Number(Fraction(str(value)))) for name, value, _unit in stated))
    end = next(block for block in section.blocks if isinstance(block, SheetFormula))
    given = next(block for block in section_of_example(numbers).blocks if isinstance(block, SheetFormula))
    assert end.rows == given.rows


def test_lengths_of_the_drawing_serve_the_dynamics_too() -> None:
    robot = Robot.from_text(ARM.replace("a2: 0.5, m2: 2", "m2: 2"))
    assert "\\mathbf{B} = " in mathematics(part_of(assemble.context_of(robot), "example"))


def test_symbols_of_the_dynamics_without_numbers_are_named() -> None:
    """Instead of its inertia matrix and gravity."""
    kinematic = Robot.from_text(ARM.replace("a2: 0.5, m2: 2", "a2: 0.5"))
    assert "$m_{2}$" in words(section_of_example(kinematic))
    assert re.findall(r"^\\mathbf\{(\w)\} = ", mathematics(section_of_example(kinematic)), re.MULTILINE) == ["T", "J"]


def test_the_closed_form_at_the_example_is_the_example() -> None:
    robot = Robot.from_text(ARM)
    q = configuration(robot).q
    values = {**numbers_of(robot), **{j.variable: x for j, x in zip(robot.joints, q, strict=True)}}
    np.testing.assert_allclose(evaluate(Model(robot).T, values), value_at(robot, "T", q), atol=1e-12)
