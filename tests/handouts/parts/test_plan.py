"""The part about a motion plan: its tables, and the derivation of the profiles."""

import numpy as np
import pytest
from sympy import Expr, Float, Integer, Rational, pi

from derive.handouts.assemble import context_of
from derive.handouts.figure.drawing import Label
from derive.handouts.parts.plan import plan_section, plan_sheet
from derive.handouts.sheet.context import Context
from derive.handouts.sheet.document import Figure, Paragraph, Rows, Section, Steps, Table
from derive.handouts.sheet.latex_writer import latex
from derive.plans.hermite import TIME, Piece
from derive.plans.profile import AnyPiece, Curve
from derive.plans.segments import Load, Peak, Segment, SegmentPeaks
from derive.robot.robot import Robot

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
def context() -> Context:
    return context_of(Robot.load("planar-2r-perugia"))


def part(context: Context, *profiles: str) -> Section:
    segments = (
        segment("a -> b", 2, (MOVING, STILL), 17.975),
        segment("b -> $c`", 1, (STILL, MANY), 0.0),
        segment("c -> c", 1, (STILL, STILL), 0.0),
    )
    return plan_section(context, segments, profiles)


def test_a_row_for_each_joint_that_moves(context: Context) -> None:
    speeds, torques, _ = (block for block in part(context).blocks if isinstance(block, Table))
    assert [row[0] for row in speeds.rows] == ["a → b", "b → c", "c → c"]
    assert "\\pi" in speeds.rows[0][3]
    assert "= 0.981748" in speeds.rows[0][3]
    assert speeds.rows[0][4] == "$1.00766$"
    assert speeds.rows[2][3] == "none moves"
    assert torques.rows[0][1:] == ("$376.839$", "$-3$", "$17.975$")


def test_the_derivation_ends_with_the_polynomial(context: Context) -> None:
    steps = [block for block in part(context, "quintic").blocks if isinstance(block, Steps)]
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
def test_other_profiles_have_their_formulas(context: Context, profile: str, letters: str) -> None:
    steps = [block for block in part(context, profile).blocks if isinstance(block, Steps)]
    assert any(letters in line for block in steps[0].blocks if isinstance(block, Rows) for line in block.lines)


def test_what_is_too_long_is_counted(context: Context) -> None:
    last = part(context).blocks[-1]
    assert isinstance(last, Steps)
    said = [block.text for block in last.blocks if isinstance(block, Paragraph)]
    assert "The other joints: 128 polynomials each, between places on the way." in said


def test_the_sheet_can_be_printed(context: Context) -> None:
    sheet = plan_sheet(context, "A plan", "ab" * 32, (part(context, "quintic", "spline"),))
    tex = latex(sheet, context.text)
    assert "10 u^{3} - 15 u^{4}" in tex
    assert "abababab" in tex


def test_curves_are_drawn_in_panels_by_unit_and_each_joint_has_its_power(context: Context) -> None:
    times = np.linspace(0, 4, 9)
    values = tuple(np.stack([np.sin(k * times), times], axis=1) for k in (1, 2, 3, 4))
    still: Joint = ((), Integer(0), Integer(0), -3.0)
    section = plan_section(context, (segment("a -> b", 4, (still, still), 0.5),), (), (times, *values))
    (figure,) = (block for block in section.blocks if isinstance(block, Figure))
    labels = [item.latex for item in figure.drawing.items if isinstance(item, Label)]
    assert sum("mathrm{rad" in label for label in labels) == 3
    assert sum("N\\,m" in label for label in labels) == 1
    powers = [block for block in section.blocks if isinstance(block, Table)][-1]
    assert powers.rows[0] == ("a \N{RIGHTWARDS ARROW} b", "$\\tau_{1}$", "$1.5$", "$-2.5$", "$0.25$")
