"""The parts of the handout about kinematics and about a motion plan, and its example in numbers."""

import json
import random
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from sympy import Expr, Float, Integer, Rational, pi

from derive.handouts.assemble import context_of
from derive.handouts.figure.drawing import Label
from derive.handouts.layout.quantity import SheetPolicy
from derive.handouts.parts.example import ANGLES, configuration
from derive.handouts.parts.plan import plan_section, plan_sheet
from derive.handouts.sheet.context import Context
from derive.handouts.sheet.document import Figure, Paragraph, Rows, Section, SheetFormula, Steps, Table, blocks_of
from derive.handouts.sheet.language import Text
from derive.handouts.sheet.latex_writer import latex
from derive.mechanics.floats import value_at
from derive.model.entries import ModelEntries
from derive.model.model import Model
from derive.plans.profile import TIME, AnyPiece, Curve, Piece
from derive.plans.segments import Load, Peak, Segment, SegmentPeaks
from derive.robot.evaluate import parameter_values
from derive.robot.expression import Number, Pi, Product
from derive.robot.names import robot_symbols
from derive.robot.options.handout import FrameIndices, NotationOptions
from derive.robot.robot import Robot
from derive.verification.oracle.functions import Oracle
from derive.workspace.poses import RobotPoses
from tests.evaluate import evaluate
from tests.handouts.latex_runner import run_clean
from tests.handouts.reading import REACHED, bare_context, document_of, lines, part, words
from tests.random_robots import random_robot
from tests.rows import robot_of_rows

TENTH = Fraction(1, 10)

PARTS = ("transforms", "kinematics", "orientation", "jacobian", "example")


def numbered(robot: Robot) -> Robot:
    """The robot with a number for every symbol."""
    given = {name for name, _ in robot.parameters}
    missing = [name for name in robot_symbols(robot) if name not in given]
    further = tuple((name, Number(TENTH * (k + 3))) for k, name in enumerate(missing))
    return replace(robot, figure=replace(robot.figure, values=further))


def assert_compiles(robot: Robot, folder: Path, **options: Any) -> None:
    run_clean(latex(document_of(bare_context(robot, **options), PARTS), Text()), folder)


# -- on paper


@pytest.mark.sweep
def test_a_long_arm_compiles(tmp_path: Path) -> None:
    rows = "|".join(f"{'P' if i % 5 == 0 else 'R'} a: 0.{i}, alpha: pi/2" for i in range(1, 31))
    assert_compiles(robot_of_rows(rows, convention="modified"), tmp_path)


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
    (section,) = document_of(bare_context(robot, policy=policy), ["kinematics"]).sections
    assert "too long for a step" in words(section)
    for i in range(2, 7):
        assert f"\\mathbf{{T}}_{{{i}}}^{{0}} = \\mathbf{{T}}_{{{i - 1}}}^{{0}}" in "\n".join(lines(blocks_of(section)))
    assert_compiles(robot, tmp_path, policy=policy)


# -- orientation


@pytest.mark.parametrize("seed", range(6))
def test_printed_angles_give_back_the_orientation(seed: int) -> None:
    """R = Rot(z, yaw) Rot(y, pitch) Rot(x, roll) = Rot(z, phi) Rot(y, theta) Rot(z, psi)."""
    drawn = random_robot(random.Random(seed), 1 + seed % 3)
    robot = Robot.from_text(drawn.text)
    q = [0.3, -0.7, 1.1][: robot.n]
    values = {j.variable: x for j, x in zip(robot.joints, q, strict=True)}
    values |= {name: float(x) for name, x in parameter_values(robot, drawn.values).items()}
    entries = ModelEntries(Model(robot))
    wanted = Oracle.of(robot, drawn.values).evaluate("forward_kinematics", q)[:3, :3]
    for axes, angles in (("xyz", entries.rpy), ("ZYZ", entries.euler_zyz)):  # capital letters: moving axes
        found = Rotation.from_euler(axes, [evaluate(angles.entry(i, 1), values) for i in (1, 2, 3)])
        np.testing.assert_allclose(found.as_matrix(), wanted, atol=1e-9)


# -- example


@pytest.mark.parametrize("seed", range(8))
def test_the_numbers_equal_those_of_the_independent_recursion(seed: int) -> None:
    drawn = random_robot(random.Random(seed))
    robot = numbered(Robot.from_text(drawn.text))
    chosen = {name: float(value.value) for name, value in robot.figure.values if isinstance(value, Number)}
    oracle = Oracle.of(robot, chosen)
    q = configuration(robot)[1]
    functions = {"T": "forward_kinematics", "J": "jacobian"}
    functions |= {"B": "inertia_matrix", "g": "gravity_vector"} if robot.has_dynamics else {}
    for name, function in functions.items():
        value = np.array(value_at(robot, name, q))
        wanted = oracle.evaluate(function, q)
        np.testing.assert_allclose(value[:, 0] if name == "g" else value, wanted, rtol=1e-9, atol=1e-9)


def test_what_is_copied_is_what_is_computed() -> None:
    robot = Robot.from_text(REACHED)
    formulas = [b for b in blocks_of(part(robot, "example")) if isinstance(b, SheetFormula)]
    q = configuration(robot)[1]
    for formula, name in zip(formulas, "TJB", strict=False):
        (entry,) = formula.entries()
        np.testing.assert_allclose(json.loads(entry.python), value_at(robot, name, q), atol=1e-11)
    assert len(formulas) == 4


def test_the_example_is_at_the_configuration_of_the_figure() -> None:
    robot = Robot.from_text(REACHED)
    cells = (Product((Pi(), Number(TENTH))), Number(TENTH), Number(TENTH))
    stated = replace(robot, figure=replace(robot.figure, q=cells))
    assert configuration(stated)[1] == pytest.approx((0.1 * np.pi, 0.1, 0.1))
    assert "configuration of the figure" in words(part(stated, "example"))
    assert configuration(robot)[1][1] == pytest.approx(ANGLES[1] * np.pi / 6)


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


Joint = tuple[tuple[AnyPiece, ...], Expr, Expr, float]  # pieces, largest velocity, acceleration and torque
ONE, PLACE = Integer(1), (Float(0.25), Integer(0))
FORMULA = pi * TIME**2 - Rational(1, 3) * TIME
STILL: Joint = ((Piece(Integer(0), Integer(2), (PLACE, PLACE)),), Integer(0), Integer(0), -3.0)
MOVING: Joint = (
    (Curve(Integer(0), Integer(2), (FORMULA, FORMULA.diff(TIME), 2 * pi)),),
    5 * pi / 16,
    Float(1.00766),
    376.8394,
)
MANY: Joint = (tuple(Piece(Integer(k), ONE, (PLACE, PLACE)) for k in range(128)), Float(0.5), Float(0.5), 1.0)


def segment(name: str, duration: int, joints: tuple[Joint, Joint], work: float) -> SegmentPeaks:
    speeds, accelerations = ([Peak(joint[k], Integer(0), True) for joint in joints] for k in (1, 2))
    loads = tuple(Load(joint[3], 0.0, 1.5, -2.5, work / 2) for joint in joints)
    way = Segment(name, Integer(0), Integer(duration), tuple(joint[0] for joint in joints))
    return SegmentPeaks(way, tuple(speeds), tuple(accelerations), loads)


@pytest.fixture(scope="module")
def plan_context() -> Context:
    return context_of(Robot.load("planar-2r-perugia"))


def plan_part(plan_context: Context, *profiles: str) -> Section:
    segments = (
        segment("a -> b", 2, (MOVING, STILL), 17.975),
        segment("b -> $c`", 1, (STILL, MANY), 0.0),
        segment("c -> c", 1, (STILL, STILL), 0.0),
    )
    return plan_section(plan_context, segments, profiles)


def test_a_row_for_each_joint_that_moves(plan_context: Context) -> None:
    speeds, torques, _ = (block for block in plan_part(plan_context).blocks if isinstance(block, Table))
    assert [row[0] for row in speeds.rows] == ["a → b", "b → c", "c → c"]
    assert "\\pi" in speeds.rows[0][3]
    assert "= 0.981748" in speeds.rows[0][3]
    assert speeds.rows[0][4] == "$1.00766$"
    assert speeds.rows[2][3] == "none moves"
    assert torques.rows[0][1:] == ("$376.839$", "$-3$", "$17.975$")


def test_the_derivation_ends_with_the_polynomial(plan_context: Context) -> None:
    steps = [block for block in plan_part(plan_context, "quintic").blocks if isinstance(block, Steps)]
    rows = [block for block in steps[0].blocks if isinstance(block, Rows)]
    assert steps[0].title == "How the polynomial of degree 5 is found"
    assert rows[-1].lines == (
        "s = 10 u^{3} - 15 u^{4} + 6 u^{5}",
        "s' = 30 u^{2} - 60 u^{3} + 30 u^{4}",
        "s'' = 60 u - 180 u^{2} + 120 u^{3}",
    )
    assert "1 & 1 & 1\\\\3 & 4 & 5\\\\6 & 12 & 20" in rows[1].lines[1]


@pytest.mark.parametrize(
    ("profile", "letters"), [("trapezoidal", "t_b"), ("harmonic", "\\cos"), ("spline", "\\sigma_j")]
)
def test_other_profiles_have_their_formulas(plan_context: Context, profile: str, letters: str) -> None:
    steps = [block for block in plan_part(plan_context, profile).blocks if isinstance(block, Steps)]
    assert any(letters in line for block in steps[0].blocks if isinstance(block, Rows) for line in block.lines)


def test_the_sheet_can_be_printed_and_what_is_too_long_is_counted(plan_context: Context) -> None:
    last = plan_part(plan_context).blocks[-1]
    assert isinstance(last, Steps)
    said = [block.text for block in last.blocks if isinstance(block, Paragraph)]
    assert "The other joints: 128 polynomials each, between places on the way." in said
    sheet = plan_sheet(plan_context, "A plan", "ab" * 32, (plan_part(plan_context, "quintic", "spline"),))
    tex = latex(sheet, plan_context.text)
    assert "10 u^{3} - 15 u^{4}" in tex
    assert "abababab" in tex


def test_curves_are_drawn_in_panels_by_unit_and_each_joint_has_its_power(plan_context: Context) -> None:
    times = np.linspace(0, 4, 9)
    values = tuple(np.stack([np.sin(k * times), times], axis=1) for k in (1, 2, 3, 4))
    still: Joint = ((), Integer(0), Integer(0), -3.0)
    section = plan_section(plan_context, (segment("a -> b", 4, (still, still), 0.5),), (), (times, *values))
    (figure,) = (block for block in section.blocks if isinstance(block, Figure))
    labels = [item.latex for item in figure.drawing.items if isinstance(item, Label)]
    assert sum("mathrm{rad" in label for label in labels) == 3
    assert sum("N\\,m" in label for label in labels) == 1
    powers = [block for block in section.blocks if isinstance(block, Table)][-1]
    assert powers.rows[0] == ("a \N{RIGHTWARDS ARROW} b", "$\\tau_{1}$", "$1.5$", "$-2.5$", "$0.25$")
