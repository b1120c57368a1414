"""Styles, abbreviations, and entries of printed matrices."""

import random

import pytest

from derive.lecture.shorthand import read_formula
from derive.lecture.sympy_conversion import expression_from_sympy
from derive.model import model as abbreviations
from derive.model.dynamic_form import DynamicForm
from derive.model.dynamic_model import DynamicModel
from derive.model.equality import Verdict, same_form, verdict
from derive.model.model import Model
from derive.robot.options.style import NAMED_STYLES, STYLE_OPTIONS, Style
from derive.robot.robot import Robot
from tests.rows import robot_of_rows

BODIES = """
links:
  - {mass: m1, inertia: {zz: Iz1, yy: Iz1}}
  - {mass: m2, com: [r2 - a2, 0, 0], inertia: {xx: Ix2, yy: Iy2, zz: Iz2}}
  - {mass: m3, com: [r3 - a3, 0, 0], inertia: {xx: Ix3, yy: Iy3, zz: Iz3}}
"""
ELBOW = robot_of_rows("R alpha: pi/2, d: d1 | R a: a2 | R a: a3", BODIES, name="elbow")
WRIST = robot_of_rows("R alpha: -pi/2|R alpha: pi/2, d: d2|P|R alpha: -pi/2|R alpha: pi/2|R d: d6", name="wrist")
PLANAR = robot_of_rows("R a: a1 | R a: a2", "gravity: [0, -g, 0]\nlinks: [{mass: m1}, {mass: m2}]", name="planar")
SCARA = robot_of_rows("R a: a1 | R a: a2, alpha: pi | P | R", name="scara")
QUANTITIES = {
    "elbow": ("T[][1,4]", "B[1,1]", "B[2,3]", "C[1,2]", "g[2]", "tau[2]", "kinetic", "potential", "J[1,2]"),
    "wrist": ("T[][1,1]", "T[][1,4]", "J[2,5]", "T[][3,4]"),
    "planar": ("B[1,1]", "tau[1]", "tau[2]", "kinetic", "potential", "N[1,2]", "Bdot[1,1]", "christoffel[1,1,2]"),
    "scara": ("T[][1,1]", "T[][1,4]"),
}


def random_style(seed: int) -> Style:
    rng = random.Random(seed)
    return Style().changed({name: rng.choice(list(kind)) for name, kind in STYLE_OPTIONS.items()})


def assert_all_equal(robot: Robot, style: Style) -> None:
    """Exactly: the difference of the polynomials is zero."""
    plain, styled = Model(robot), Model(robot, style)
    for quantity in QUANTITIES[robot.name]:
        assert verdict(plain, quantity, styled.quantity(quantity)) == Verdict(True, True), f"{quantity} in {style}"


def values(model: Model) -> list[float]:
    """All quantities at one configuration, with numbers for all symbols."""
    rng = random.Random(model.robot.name)
    written = [model.quantity(quantity) for quantity in QUANTITIES[model.robot.name]]
    symbols = sorted(set().union(*(e.free_symbols for e in written)), key=str)
    point = {symbol: rng.uniform(0.3, 2.5) for symbol in symbols}
    return [float(e.subs(point)) for e in written]


@pytest.mark.parametrize("robot", [ELBOW, WRIST, PLANAR, SCARA], ids=lambda robot: robot.name)
def test_a_random_style_changes_no_value(robot: Robot) -> None:
    plain = Model(robot)
    for seed in range(3):
        assert values(plain.with_style(random_style(seed))) == pytest.approx(values(plain), rel=1e-9), seed


@pytest.mark.sweep
@pytest.mark.parametrize("robot", [ELBOW, WRIST, PLANAR, SCARA], ids=lambda robot: robot.name)
def test_no_single_option_and_no_random_style_changes_a_value(robot: Robot) -> None:
    for start in NAMED_STYLES.values():
        for name, kind in STYLE_OPTIONS.items():
            for value in kind:
                assert_all_equal(robot, start.changed({name: value}))
    for seed in (*range(6), *range(100, 160)):
        assert_all_equal(robot, random_style(seed))


FORMS = [
    "compact | wrist | T[][1,4] | d6*(c1*(c2*c4*s5 + s2*c5) - s1*s4*s5) + c1*s2*q3 - s1*d2",
    "positions: base | wrist | T[][1,4] | c1*(d6*(c2*c4*s5 + s2*c5) + s2*q3) - s1*(d6*s4*s5 + d2)",
    "positions: length-expanded | wrist | T[][1,4] | d6*(c1*c2*c4*s5 + c1*s2*c5 - s1*s4*s5) + c1*s2*q3 - s1*d2",
    "positions: length-tool | wrist | T[][1,4] | d6*((c1*c2*c4 - s1*s4)*s5 + c1*s2*c5) + c1*s2*q3 - s1*d2",
    "positions: expanded | elbow | T[][1,4] | a2*c1*c2 + a3*c1*c23",
    "short: positions | elbow | T[][1,4] | a2*c1*c2 + a3*c1*c23",
    "short: short-arms | elbow | T[][1,4] | a2*c1*c2 + a3*c1*c23",
    "short: short-arms | wrist | T[][3,1] | -s2*(c4*c5*c6 - s4*s6) - c2*s5*c6",
    "rotations: tool | wrist | T[][3,1] | c6*(-s2*c4*c5 - c2*s5) + s2*s4*s6",
    "rotations: expanded | wrist | T[][3,1] | -s2*c4*c5*c6 - c2*s5*c6 + s2*s4*s6",
    "rotations: base-expanded | wrist | T[][1,1] | c1*(c2*c4*c5*c6 - c2*s4*s6 - s2*s5*c6) - s1*(s4*c5*c6 + c4*s6)",
    "rotations: tool-expanded | wrist | T[][1,1] | c6*(c1*c2*c4*c5 - s1*s4*c5 - c1*s2*s5) - s6*(c1*c2*s4 + s1*c4)",
    "contraction: opposed | scara | T[][1,1] | cos(q1 + q2 - q4)",
    "compact | planar | B[1,1] | (m1 + m2)*a1**2 + m2*a2**2 + 2*m2*a1*a2*c2",
    "inertia: body | planar | B[1,1] | m1*a1**2 + m2*(a1**2 + a2**2 + 2*a1*a2*c2)",
    "inertia: body, brackets: long | planar | B[1,2] | m2*a2**2 + m2*a1*a2*c2",
    "inertia: geometry, factors: all | planar | B[1,2] | m2*a2*(a2 + a1*c2)",
    "inertia: function-body | planar | B[1,1] | m1*a1**2 + m2*(a1**2 + a2**2) + 2*m2*a1*a2*c2",
    "kinetic: body | planar | kinetic | "
    "m1*a1**2*qd1**2/2 + m2*(a1**2*qd1**2 + a2**2*(qd1 + qd2)**2 + 2*a1*a2*c2*qd1*(qd1 + qd2))/2",
    "velocities: factored | planar | Cqd[1] | -m2*a1*a2*s2*qd2*(2*qd1 + qd2)",
    "coriolis: product | planar | C[1,2] | -m2*a1*a2*s2*qd1 - m2*a1*a2*s2*qd2",
    "accelerations: term | planar | B_qdd[1] | "
    "m2*a2**2*(qdd1 + qdd2) + m2*a1*a2*c2*(2*qdd1 + qdd2) + (m1 + m2)*a1**2*qdd1",
    "accelerations: geometry | planar | B_qdd[1] | "
    "a2**2*(m2*qdd1 + m2*qdd2) + a1*a2*c2*(2*m2*qdd1 + m2*qdd2) + (m1 + m2)*a1**2*qdd1",
    "gravity: body, g: outside | planar | g[1] | g*(m1*a1*c1 + m2*(a1*c1 + a2*c12))",
    "compact | elbow | christoffel[1,1,2] | "
    "(Ix2 - Iy2 - m2*r2**2)*c2*s2 + (Ix3 - Iy3)*c23*s23 - m3*(a2*c2 + r3*c23)*(a2*s2 + r3*s23)",
    "christoffel: function | elbow | christoffel[1,1,2] | "
    "(Ix2 - Iy2 - m2*r2**2)*c2*s2 + (Ix3 - Iy3)*c23*s23 - m3*(a2*c2 + r3*c23)*(a2*s2 + r3*s23)",
    "christoffel: function, factors: all | elbow | christoffel[1,1,3] | "
    "(Ix3 - Iy3)*c23*s23 - m3*r3*s23*(a2*c2 + r3*c23)",
]


@pytest.mark.parametrize("form", FORMS, ids=lambda form: ", ".join(form.split(" | ")[:3]))
def test_an_option_writes_the_form_that_its_words_say(form: str) -> None:
    style, name, quantity, text = form.split(" | ")
    robot = next(robot for robot in (ELBOW, WRIST, PLANAR, SCARA) if robot.name == name)
    ours = expression_from_sympy(Model(robot, style=style).quantity(quantity))
    assert same_form(ours, read_formula(text, robot)), ours


def test_a_model_in_another_style_is_that_model_written_anew() -> None:
    model = Model(ELBOW)
    assert model.B[0, 0] != 0
    for style in map(random_style, range(3)):
        assert model.with_style(style).tau == Model(ELBOW, style).tau
        assert model.with_style(style).T == Model(ELBOW, style).T


ROBOTS = ["planar-2r-perugia", "scara-perugia"]


@pytest.mark.parametrize("name", ROBOTS)
@pytest.mark.parametrize(
    ("quantity", "by"),
    [*((q, "christoffel") for q in abbreviations.BY_RATES), *((q, "coefficients") for q in abbreviations.BY_CONSTANTS)],
)
def test_definitions_put_back_give_the_quantity(name: str, quantity: str, by: str) -> None:
    model = Model(Robot.load(name))
    written, names = model.abbreviated(quantity, by)
    difference = written.subs(dict(names)) - getattr(model, quantity)
    assert all(entry.expand(trig=True).equals(0) for entry in difference)


@pytest.mark.parametrize("name", ROBOTS)
def test_every_name_is_used_and_defined_before_it_is(name: str) -> None:
    model = Model(Robot.load(name))
    written, names = model.abbreviated("B", "coefficients")
    assert set(names) <= written.free_symbols


def test_long_entries_are_not_expanded() -> None:
    """The budget of `DynamicForm` is what decides."""
    model = DynamicModel(Robot.load("planar-2r-perugia"))
    form = DynamicForm(model.dynamics, model.form)
    entry = model.dynamics.inertia_matrix[0][0]
    long, short = form.entry(entry, 10**6), form.entry(entry, 0)
    assert short != long
    assert len(short.free_symbols) <= len(long.free_symbols)
