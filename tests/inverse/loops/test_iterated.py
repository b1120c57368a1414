"""Loops without formulas: closed by Newton's method, as SciPy closes them, and in generated code from near there."""

import numpy as np
import pytest
from scipy.optimize import root

from derive.errors import QuantityError
from derive.handouts.notation.notation import Notation
from derive.handouts.parts.closure import closure_lines
from derive.inverse.loops.closing import Closing, IteratedLoops
from derive.inverse.loops.linkage import linkage, positions, rates
from derive.lecture.shorthand import read_formula
from derive.model.equality import compare
from derive.model.model import Model
from derive.programs.build import build_program
from derive.programs.optimise.search_policy import Effort
from derive.publish.modules import loaded
from derive.robot.robot import Robot
from derive.targets.target import Source
from tests.inverse.loops.test_linkage import Array

PLATE = """
name: plate
convention: standard
joints:
  - {type: revolute, name: crank, q: q1, a: r}
  - {type: revolute, name: rod, q: q2, a: 0.35, passive: true}
  - {type: revolute, name: plate, q: q3, a: 0.2, passive: true}
  - {type: fixed, name: corner, after: plate, theta: 2, a: 0.15}
  - {type: fixed, name: ground, after: base, a: 0.5}
  - {type: revolute, name: left, q: q4, a: 0.25, passive: true}
  - {type: fixed, name: post, after: base, theta: 1, a: 0.55}
  - {type: revolute, name: right, q: q5, a: 0.3, passive: true}
loops:
  - {join: [plate, left], by: revolute}
  - {join: [corner, right], by: revolute}
ends: {plate: plate}
parameters: {r: 0.1}
runtime: [r]
"""


def plate_gap(q: float, x: Array) -> Array:
    """Of the pins of the plate in complex numbers, by passive joints."""
    rod = 0.1 * np.exp(1j * q) + 0.35 * np.exp(1j * (q + x[0]))
    pin = rod + 0.2 * np.exp(1j * (q + x[0] + x[1]))
    corner = pin + 0.15 * np.exp(1j * (q + x[0] + x[1] + 2))
    left, right = 0.5 + 0.25 * np.exp(1j * x[2]), 0.55 * np.exp(1j) + 0.3 * np.exp(1j * (1 + x[3]))
    return np.array([(pin - left).real, (pin - left).imag, (corner - right).real, (corner - right).imag])


def solved() -> tuple[Robot, tuple[Closing, ...], Array, list[Array]]:
    robot, q = Robot.from_text(PLATE), np.random.default_rng(2).uniform(-3, 3, 12)
    full, exists = positions(robot, linkage(robot), [q])
    assert exists.all()
    return robot, linkage(robot), q, full


def test_what_closes_the_loops_is_what_scipy_finds_from_near_there() -> None:
    _, loops, q, full = solved()
    assert [type(one) for one in loops] == [IteratedLoops]
    for k, angle in enumerate(q):
        x = np.array([full[place][k] for place in loops[0].passive])
        assert np.abs(plate_gap(angle, x)).max() < 1e-12
        found = root(lambda x, angle=angle: plate_gap(angle, x), x + 0.02, tol=1e-14)
        assert np.abs(found.x - x).max() < 1e-9


def test_rates_are_differences_of_positions() -> None:
    robot, loops, q, full = solved()
    ahead, back = (positions(robot, loops, [q + step])[0] for step in (1e-6, -1e-6))
    slope, _ = rates(robot, loops, full, {"r": 0.1})
    assert np.abs((np.array(ahead) - np.array(back)) / 2e-6 - slope[:, 0]).max() < 1e-7


def test_limits_of_passive_joints_choose_the_assembly() -> None:
    seen = []
    for low, high in ((0, 3.2), (-3.2, 0)):
        text = PLATE.replace("name: plate, q: q3,", f"name: plate, q: q3, limits: [{low}, {high}],")
        robot = Robot.from_text(text)
        full, exists = positions(robot, linkage(robot), [np.array([0.5])])
        assert exists.all()
        seen.append(np.sin(full[2][0]))
    assert seen[0] * seen[1] < 0


def test_there_is_no_branch_to_choose_and_what_stays_loose_is_refused() -> None:
    with pytest.raises(QuantityError, match="branch of loops that are solved numerically"):
        linkage(Robot.from_text(PLATE.replace("left], by: revolute", "left], by: revolute, branch: '+'")))
    loose = PLATE.replace("  - {join: [corner, right], by: revolute}\n", "").replace("a: 0.3, passive: true", "a: 0.3")
    with pytest.raises(QuantityError, match="it does not determine"):
        linkage(Robot.from_text(loose))


def test_the_equations_that_remain_are_printed_and_hold_where_the_loops_close() -> None:
    robot, _, q, full = solved()
    model = Model(robot)
    (one,) = model.closure.loops
    values = dict(zip([joint.variable for joint in robot.joints], np.array(full)[:, 0], strict=True)) | {"r": 0.1}
    assert [abs(float(e.subs(values))) < 1e-9 for e in one.equations] == [True] * 4
    assert any("solved numerically" in line for line in closure_lines(model.closure, "text", Notation.of(robot)))
    found = np.array(model.at("closure", [q[0]]), dtype=float)[:, 0]
    assert np.abs(np.exp(1j * found) - np.exp(1j * np.array(full)[1:, 0])).max() < 1e-12


def test_generated_code_follows_from_the_last_configuration_and_says_where_the_loops_stay_open() -> None:
    robot, loops, q, full = solved()
    program = build_program(robot, Effort.QUICK, names={"passive_positions", "jacobian"})
    generated, _folder = loaded(Source(robot, program, "0"), compiled=False)
    near = np.array(full)[1:].T + np.random.default_rng(0).uniform(-0.05, 0.05, (len(q), 4))
    *x, missing = generated.passive_positions(q[:, None], near, params={"r": 0.1}).T
    assert missing.max() < 1e-12
    assert np.abs(np.array(x) - full[1:]).max() < 1e-12
    slope, _ = rates(robot, loops, full, {"r": 0.1})
    jacobian = generated.jacobian_plate(q[:, None], np.array(x).T, params={"r": 0.1})
    assert np.abs(jacobian[:, 5, 0] - slope[:3, 0].sum(axis=0)).max() < 1e-12
    *_, far = generated.passive_positions([0.3], near[0], params={"r": 3.0})
    assert far > 0.1


def test_formulas_are_compared_where_the_loops_close() -> None:
    robot, right = Robot.from_text(PLATE), "q1*(r*cos(q1) + 0.35*cos(q1 + q2) + 0.2*cos(q1 + q2 + q3) - 0.25*cos(q4))"
    ours, same, other = (read_formula(text, robot) for text in ("q1/2", right, right.replace("35", "36")))
    assert compare(robot, ours, same).equal
    assert not compare(robot, ours, other).equal
