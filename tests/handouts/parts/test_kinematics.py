"""The parts of the handout about kinematics, and its example in numbers."""

import json
import random
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from derive.handouts.assemble import section_of
from derive.handouts.layout.quantity import POLICY, SheetPolicy
from derive.handouts.parts.example import ANGLES, configuration, numbers_of
from derive.handouts.sheet.context import Context
from derive.handouts.sheet.document import Document, SheetFormula, blocks_of
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
from tests.handouts.latex_runner import run_clean
from tests.handouts.reading import REACHED, lines, part, words
from tests.random_robots import random_robot, robot_text, sampled, seeds

TENTH = Fraction(1, 10)

PARTS = ("transforms", "kinematics", "orientation", "jacobian", "example")


def context_of(robot: Robot, *, steps: bool = False, policy: SheetPolicy = POLICY, **notation: FrameIndices) -> Context:
    derivation = Derivation.STEPS if steps else Derivation.RESULT
    options = HandoutOptions(derivation=derivation, notation=NotationOptions(**notation))  # type: ignore[arg-type]
    return Context(ModelEntries(Model(robot)), options, Text(), "0.0.0", policy=policy)


def numbered(robot: Robot) -> Robot:
    """The robot with a number for every symbol."""
    given = {name for name, _ in robot.parameters}
    missing = [name for name in robot_symbols(robot) if name not in given]
    further = tuple((name, Number(TENTH * (k + 3))) for k, name in enumerate(missing))
    return replace(robot, figure=replace(robot.figure, values=further))


def assert_compiles(robot: Robot, folder: Path, **options: object) -> None:
    context = context_of(robot, **options)  # type: ignore[arg-type]
    found = [section_of(context, part) for part in PARTS]
    sections = tuple(section for section in found if section is not None)
    document = Document("Arm", "", robot.name, "en", "0" * 64, "0.0.0", "", sections)
    run_clean(latex(document, context.text), folder)


# -- on paper


@pytest.mark.slow
@pytest.mark.parametrize("name", sampled(catalogue_names(), catalogue_names()[1::4]))
def test_the_kinematics_of_the_catalogue_compiles(name: str, tmp_path: Path) -> None:
    assert_compiles(numbered(Robot.load(name)), tmp_path, steps=True)


@pytest.mark.slow
@pytest.mark.parametrize("seed", seeds(10, usual=3))
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
    products, columns, *results = (
        "\n".join(lines(blocks_of(part(robot, name, steps=steps))))
        for steps in (True, False)
        for name in ("kinematics", "jacobian")
    )
    offset = 1 if robot.convention == "standard" else 0
    for i in range(1, robot.n + 1):
        assert f"\\mathbf{{T}}_{{{i}}}^{{0}} = " in products
        axis = f"\\mathbf{{z}}_{{{i - offset}}}"
        assert f"{axis} = " in columns or f"({axis})_{{" in columns
        assert f"\\mathbf{{J}}_{{{i}}} = " in columns
        assert f"\\mathbf{{J}}_{{{i}}} = " not in results[1]
    assert "\\mathbf{T}_{1}^{0} = \\mathbf{A}_{1}^{0}" not in results[0]


def test_frames_can_stand_on_the_left() -> None:
    section = part("scara-perugia", "kinematics", steps=True, notation=NotationOptions(frames=FrameIndices.LEFT))
    assert "{}^{0}\\mathbf{T}_{2} = {}^{0}\\mathbf{T}_{1}{}^{1}\\mathbf{A}_{2}" in "\n".join(lines(blocks_of(section)))


def test_without_room_the_steps_are_products(tmp_path: Path) -> None:
    robot = Robot.load("puma560-corke")
    policy = SheetPolicy(matrix_terms=0, flat_terms=3)
    assert_compiles(robot, tmp_path, steps=True, policy=policy)
    section = section_of(context_of(robot, steps=True, policy=policy), "kinematics")
    assert section is not None
    assert "too long for a step" in words(section)
    for i in range(2, 7):
        assert f"\\mathbf{{T}}_{{{i}}}^{{0}} = \\mathbf{{T}}_{{{i - 1}}}^{{0}}" in "\n".join(lines(blocks_of(section)))


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
    robot = Robot.from_text(REACHED)
    formulas = [b for b in blocks_of(part(robot, "example")) if isinstance(b, SheetFormula)]
    q = configuration(robot).q
    for formula, name in zip(formulas, "TJB", strict=False):
        np.testing.assert_allclose(json.loads(formula.entries[0].python), value_at(robot, name, q), atol=1e-11)
    assert len(formulas) == 4


def test_the_example_is_at_the_configuration_of_the_figure() -> None:
    robot = Robot.from_text(REACHED)
    cells = (Product((Pi(), Number(TENTH))), Number(TENTH), Number(TENTH))
    stated = replace(robot, figure=replace(robot.figure, q=cells))
    assert configuration(stated).q == pytest.approx((0.1 * np.pi, 0.1, 0.1))
    assert "configuration of the figure" in words(part(stated, "example"))
    assert configuration(robot).q[1] == pytest.approx(ANGLES[1] * np.pi / 6)


def test_lengths_without_numbers_are_those_of_the_drawing() -> None:
    robot = Robot.from_text(REACHED.replace("parameters: {a2: 0.5, m2: 2}", ""))
    section, stated = part(robot, "example"), RobotPoses(robot).assumed
    assert all(f"= {value:g}\\,\\mathrm{{m}}" in "\n".join(lines(section.blocks)) for _name, value, _unit in stated)
    numbers = replace(robot, parameters=tuple((name, Number(Fraction(str(value)))) for name, value, _unit in stated))
    end, given = (
        next(block for block in found.blocks if isinstance(block, SheetFormula))
        for found in (section, part(numbers, "example"))
    )
    assert end.rows == given.rows
