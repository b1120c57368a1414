"""Symbols with assumptions are the same model: only what SymPy knows of them differs."""

from __future__ import annotations

import pytest
import sympy

import derive
from derive.model.assumptions import Assumptions, plain
from derive.model.quantities import DESCRIBED, REGISTRY
from derive.robot.options.style import Style
from derive.robot.robot import Robot

ARM = """\
name: two-bars
convention: standard
joints:
  - {type: revolute, a: a1, alpha: pi/2}
  - {type: prismatic, a: a2, d: q2 + d2}
gravity: [0, 0, -g]
links:
  - {mass: m1, com: [l1, 0, 0], inertia: {yy: I1}, motor: {mass: mm1, inertia: 1e-4, ratio: k}}
  - {mass: m2 + m3, com: [l2, 0, 0], motor: {mass: mm2}, friction: {viscous: b, coulomb: f}}
parameters: {mm2: 0}
runtime: [mm2]
inverse: {task: [x, y]}
"""


@pytest.fixture(scope="module")
def models() -> tuple[derive.Model, derive.Model]:
    """With plain symbols, and with assumptions."""
    robot = Robot.from_text(ARM)
    return derive.Model(robot), derive.Model(robot, assumptions=True)


def test_every_quantity_is_the_same_in_real_symbols_and_masses_are_positive(
    models: tuple[derive.Model, derive.Model],
) -> None:
    """A mass that is a sum of symbols, or may be zero, says nothing of the sign of any."""
    usual, assumed = models
    seen: set[sympy.Symbol] = set()
    for row in REGISTRY.values():
        if not row.is_of(usual.robot) or row.name in ("detJ_rows", "inverse", "J_zyz"):
            continue
        indices = f"[{','.join('1' * row.indices[0])}]" if row.indices[0] else ""
        ours, theirs = (model.quantity(row.name + indices) for model in models)
        assert sympy.srepr(plain(theirs)) == sympy.srepr(ours), row.name
        assert str(theirs) == str(ours), row.name  # brackets and order too
        seen |= theirs.free_symbols
    assert all(symbol.is_real for symbol in seen)
    assert {str(symbol) for symbol in seen if symbol.is_positive} == {"m1", "mm1"}
    assert all(symbol.is_positive is None for symbol in usual.B.free_symbols)
    assert all(q.is_real for q in (*assumed.q, *assumed.qd, *assumed.qdd))


def test_sympy_simplifies_with_them(models: tuple[derive.Model, derive.Model]) -> None:
    usual, assumed = models
    assert sympy.sqrt(assumed.p[0] ** 2) == sympy.Abs(assumed.p[0])
    assert sympy.sqrt(usual.p[0] ** 2) != sympy.Abs(usual.p[0])
    mass = next(symbol for symbol in assumed.B.free_symbols if symbol.name == "m1")
    assert sympy.sqrt(mass**2) == mass


def test_whatever_the_model_has_or_does_speaks_of_these_symbols(models: tuple[derive.Model, derive.Model]) -> None:
    usual, assumed = models
    assert isinstance(assumed, derive.Model)
    assert assumed.robot == usual.robot
    assert assumed.M == assumed.B == assumed.with_style(Style.of("expanded")).with_style(Style()).B
    assert assumed.christoffel(1, 1, 2).diff(assumed.q[1]) == Assumptions(usual.robot)(
        usual.christoffel(1, 1, 2).diff(usual.q[1])
    )
    assert assumed.equal("T[1,4]", assumed.T[0, 3])
    assert assumed.equal("T[1,4]", str(usual.T[0, 3]))
    assert all(symbol.is_real for symbol in assumed.at("T", [0.3, 0.5]).free_symbols)
    (definition,) = {name for _, names in [assumed.abbreviated("C")] for name in names}
    assert definition.is_real
    assert all(symbol.is_real for line in assumed.inverse.lines for symbol in line.value.free_symbols)
    assert all(q.is_real for q in assumed.inverse.solutions[0].joints)
    assert all(symbol.is_real for symbol in assumed.inverse[0, 0].free_symbols)
    assert all(name in dir(assumed) for name in ("B", "inverse"))
    assert all(getattr(assumed, name) is not None for name in DESCRIBED)
