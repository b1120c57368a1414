"""Options of a style decide the form, never the value; each writes the form that its words say."""

from __future__ import annotations

import random

import pytest

from derive.checking.formulas.findings import same_form
from derive.lecture.shorthand import read_formula
from derive.lecture.sympy_conversion import expression_from_sympy
from derive.model.equality import compare
from derive.model.model import Model
from derive.robot.options.style import NAMED_STYLES, STYLE_OPTIONS, Style
from derive.robot.robot import Robot

ELBOW = Robot.from_text("""
name: elbow
convention: standard
joints: [{type: revolute, alpha: pi/2, d: d1}, {type: revolute, a: a2}, {type: revolute, a: a3}]
links:
  - {mass: m1, inertia: {zz: Iz1, yy: Iz1}}
  - {mass: m2, com: [r2 - a2, 0, 0], inertia: {xx: Ix2, yy: Iy2, zz: Iz2}}
  - {mass: m3, com: [r3 - a3, 0, 0], inertia: {xx: Ix3, yy: Iy3, zz: Iz3}}
""")
WRIST = Robot.from_text("""
name: wrist
convention: standard
joints:
  - {type: revolute, alpha: -pi/2}
  - {type: revolute, alpha: pi/2, d: d2}
  - {type: prismatic}
  - {type: revolute, alpha: -pi/2}
  - {type: revolute, alpha: pi/2}
  - {type: revolute, d: d6}
""")
PLANAR = Robot.from_text("""
name: planar
convention: standard
joints: [{type: revolute, a: a1}, {type: revolute, a: a2}]
gravity: [0, -g, 0]
links: [{mass: m1}, {mass: m2}]
""")
SCARA = Robot.from_text("""
name: scara
convention: standard
joints: [{type: revolute, a: a1}, {type: revolute, a: a2, alpha: pi}, {type: prismatic}, {type: revolute}]
""")
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
        ours, theirs = (expression_from_sympy(model.quantity(quantity)) for model in (plain, styled))
        verdict = compare(robot, ours, theirs)
        assert verdict.equal, f"{quantity} in {style}"
        assert verdict.exact, f"{quantity} in {style}"


def values(model: Model) -> list[float]:
    """All quantities at one configuration, with numbers for all symbols."""
    rng, found = random.Random(model.robot.name), []
    written = [model.quantity(quantity) for quantity in QUANTITIES[model.robot.name]]
    symbols = sorted(set().union(*(e.free_symbols for e in written)), key=str)
    point = {symbol: rng.uniform(0.3, 2.5) for symbol in symbols}
    for e in written:
        found.append(float(e.subs(point)))
    return found


@pytest.mark.parametrize("robot", [ELBOW, WRIST, PLANAR, SCARA], ids=lambda robot: robot.name)
def test_a_random_style_changes_no_value(robot: Robot) -> None:
    plain = Model(robot)
    for seed in range(6):
        assert values(plain.with_style(random_style(seed))) == pytest.approx(values(plain), rel=1e-9), seed


@pytest.mark.sweep
@pytest.mark.parametrize("robot", [ELBOW, WRIST, PLANAR, SCARA], ids=lambda robot: robot.name)
def test_no_single_option_and_no_random_style_changes_a_value(robot: Robot) -> None:
    for start in NAMED_STYLES.values():
        for name, kind in STYLE_OPTIONS.items():
            for value in kind:
                assert_all_equal(robot, start.changed({name: value}))
    for seed in range(100, 160):
        assert_all_equal(robot, random_style(seed))


FORMS = [
    ("compact", WRIST, "T[][1,4]", "d6*(c1*(c2*c4*s5 + s2*c5) - s1*s4*s5) + c1*s2*q3 - s1*d2"),
    ("positions: base", WRIST, "T[][1,4]", "c1*(d6*(c2*c4*s5 + s2*c5) + s2*q3) - s1*(d6*s4*s5 + d2)"),
    ("positions: length-expanded", WRIST, "T[][1,4]", "d6*(c1*c2*c4*s5 + c1*s2*c5 - s1*s4*s5) + c1*s2*q3 - s1*d2"),
    ("positions: length-tool", WRIST, "T[][1,4]", "d6*((c1*c2*c4 - s1*s4)*s5 + c1*s2*c5) + c1*s2*q3 - s1*d2"),
    ("positions: expanded", ELBOW, "T[][1,4]", "a2*c1*c2 + a3*c1*c23"),
    ("short: positions", ELBOW, "T[][1,4]", "a2*c1*c2 + a3*c1*c23"),
    ("short: short-arms", ELBOW, "T[][1,4]", "a2*c1*c2 + a3*c1*c23"),
    ("short: short-arms", WRIST, "T[][3,1]", "-s2*(c4*c5*c6 - s4*s6) - c2*s5*c6"),
    ("rotations: tool", WRIST, "T[][3,1]", "c6*(-s2*c4*c5 - c2*s5) + s2*s4*s6"),
    ("rotations: expanded", WRIST, "T[][3,1]", "-s2*c4*c5*c6 - c2*s5*c6 + s2*s4*s6"),
    (
        "rotations: base-expanded",
        WRIST,
        "T[][1,1]",
        "c1*(c2*c4*c5*c6 - c2*s4*s6 - s2*s5*c6) - s1*(s4*c5*c6 + c4*s6)",
    ),
    (
        "rotations: tool-expanded",
        WRIST,
        "T[][1,1]",
        "c6*(c1*c2*c4*c5 - s1*s4*c5 - c1*s2*s5) - s6*(c1*c2*s4 + s1*c4)",
    ),
    ("contraction: opposed", SCARA, "T[][1,1]", "cos(q1 + q2 - q4)"),
    ("compact", PLANAR, "B[1,1]", "(m1 + m2)*a1**2 + m2*a2**2 + 2*m2*a1*a2*c2"),
    ("inertia: body", PLANAR, "B[1,1]", "m1*a1**2 + m2*(a1**2 + a2**2 + 2*a1*a2*c2)"),
    ("inertia: body, brackets: long", PLANAR, "B[1,2]", "m2*a2**2 + m2*a1*a2*c2"),
    ("inertia: geometry, factors: all", PLANAR, "B[1,2]", "m2*a2*(a2 + a1*c2)"),
    ("inertia: function-body", PLANAR, "B[1,1]", "m1*a1**2 + m2*(a1**2 + a2**2) + 2*m2*a1*a2*c2"),
    (
        "kinetic: body",
        PLANAR,
        "kinetic",
        "m1*a1**2*qd1**2/2 + m2*(a1**2*qd1**2 + a2**2*(qd1 + qd2)**2 + 2*a1*a2*c2*qd1*(qd1 + qd2))/2",
    ),
    ("velocities: factored", PLANAR, "Cqd[1]", "-m2*a1*a2*s2*qd2*(2*qd1 + qd2)"),
    ("coriolis: product", PLANAR, "C[1,2]", "-m2*a1*a2*s2*qd1 - m2*a1*a2*s2*qd2"),
    (
        "accelerations: term",
        PLANAR,
        "B_qdd[1]",
        "m2*a2**2*(qdd1 + qdd2) + m2*a1*a2*c2*(2*qdd1 + qdd2) + (m1 + m2)*a1**2*qdd1",
    ),
    (
        "accelerations: geometry",
        PLANAR,
        "B_qdd[1]",
        "a2**2*(m2*qdd1 + m2*qdd2) + a1*a2*c2*(2*m2*qdd1 + m2*qdd2) + (m1 + m2)*a1**2*qdd1",
    ),
    ("gravity: body, g: outside", PLANAR, "g[1]", "g*(m1*a1*c1 + m2*(a1*c1 + a2*c12))"),
    (
        "compact",
        ELBOW,
        "christoffel[1,1,2]",
        "(Ix2 - Iy2 - m2*r2**2)*c2*s2 + (Ix3 - Iy3)*c23*s23 - m3*(a2*c2 + r3*c23)*(a2*s2 + r3*s23)",
    ),
    (
        "christoffel: function",
        ELBOW,
        "christoffel[1,1,2]",
        "(Ix2 - Iy2 - m2*r2**2)*c2*s2 + (Ix3 - Iy3)*c23*s23 - m3*(a2*c2 + r3*c23)*(a2*s2 + r3*s23)",
    ),
    (
        "christoffel: function, factors: all",
        ELBOW,
        "christoffel[1,1,3]",
        "(Ix3 - Iy3)*c23*s23 - m3*r3*s23*(a2*c2 + r3*c23)",
    ),
]


@pytest.mark.parametrize(("style", "robot", "quantity", "text"), FORMS, ids=[f"{row[0]}, {row[2]}" for row in FORMS])
def test_an_option_writes_the_form_that_its_words_say(style: str, robot: Robot, quantity: str, text: str) -> None:
    ours = expression_from_sympy(Model(robot, style=style).quantity(quantity))
    assert same_form(ours, read_formula(text, robot)), ours


def test_a_model_in_another_style_is_that_model_written_anew() -> None:
    model = Model(ELBOW)
    assert model.B[0, 0] != 0
    for style in map(random_style, range(3)):
        assert model.with_style(style).tau == Model(ELBOW, style).tau
        assert model.with_style(style).T == Model(ELBOW, style).T
