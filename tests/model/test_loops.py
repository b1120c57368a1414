"""What a reader is shown of closed loops: positions of passive joints in formulas, and their derivatives G and H."""

import json
from functools import cache
from itertools import islice
from pathlib import Path
from typing import Any

import mpmath
import numpy as np
import pytest
import sympy

from derive.algebra.domain import polynomial_expression
from derive.checking.latex.quantities import slope
from derive.errors import CheckError, QuantityError
from derive.inverse.loops.linkage import linkage, positions, slopes
from derive.lecture.sympy_conversion import Matrix, expression_from_sympy, expression_to_sympy
from derive.model.closure import OnClosure, find_closure
from derive.model.equality import DIGITS, compare, evaluate, samples
from derive.notebook import Model
from derive.robot.description import derivatives
from derive.robot.expression import ZERO, Name, names
from derive.robot.robot import Robot
from tests.cli.command import accepted

LENGTHS = {"l0": 0.3, "l1": 0.5, "l2": 1, "l3": 0.45, "l4": 0.9}
TURNING, FIXED = "  - {type: revolute, name: ", "  - {type: fixed, name: "
BARS = f"{TURNING}crank, a: l1}}\n{TURNING}coupler, a: l2, passive: true, q: u}}\n"
ROCKER = f"{FIXED}ground, after: base, a: l0}}\n{TURNING}rocker, after: ground, a: l4, passive: true, q: v}}\n"
FIVE = ROCKER.replace(f"{TURNING}rocker, after: ground", f"{TURNING}right, a: l3, q: q2}}\n{TURNING}rocker")
SLIDER = f"{FIXED}rail, after: base, theta: pi/2, alpha: pi/2}}\n  - {{type: prismatic, passive: true, q: s}}\n"
# In a plane that turns, with an offset, and the rocker's variable backwards.
TURNED = (
    (f"{TURNING}turn, alpha: pi/2, q: w}}\n" + BARS + ROCKER).replace("base", "turn").replace("q: v", "q: v, theta: -v")
)
ROBOTS = {  # rows, and numbers of the variables
    "four": (BARS + ROCKER, [0.7]),
    "five": (BARS + FIVE, [0.7, 0.9]),
    "slider": (f"{BARS}{SLIDER}{FIXED}rocker, alpha: -pi/2}}\n", [0.7]),
    "rod": (f"{TURNING}coupler, a: l1}}\n{ROCKER}", [0.7]),  # in place of the coupler, from crank to rocker
    "turned": (TURNED.replace("crank", "crank, q: q1, theta: q1 + pi/6"), [0.4, 0.2]),
}
every = pytest.mark.parametrize("name", ROBOTS)


def text_of(name: str) -> str:
    rows, by = ROBOTS[name][0], "distance, length: l2" if name == "rod" else "revolute"
    cells = ", ".join(f"{k}: {x}" for k, x in (LENGTHS | {"g": 9.8, "m": 2, "c": 0.2}).items() if k in f"gmc{by}{rows}")
    text = f"name: {name}\nconvention: standard\ngravity: [0, -g, 0]\nparameters: {{{cells}}}\njoints:\n{rows}"
    bodies = ", ".join(["{mass: m, com: [c, 0, 0], inertia: {zz: m*c**2}}"] * rows.count("\n"))
    return f"{text}loops: [{{join: [coupler, rocker], by: {by}}}]\nends: {{pin: coupler}}\nlinks: [{bodies}]\n"


@cache
def model_of(name: str) -> Model:
    return Model(Robot.from_text(text_of(name)))


def at(name: str, quantity: str, q: Any, qd: Any = ()) -> Any:
    found = model_of(name).at(quantity, list(q), qd=list(qd))
    return np.array(getattr(found, "tolist", lambda: [[found]])(), dtype=float)


def slopes_of(name: str, quantity: str) -> list[Any]:
    """By differences along each variable, with the loops closed on both sides."""
    q = ROBOTS[name][1]
    return [(at(name, quantity, q + d) - at(name, quantity, q - d)) / 2e-6 for d in 1e-6 * np.eye(len(q))]


@every
def test_derivatives_are_those_of_positions_along_the_loop(name: str) -> None:
    robot, q, (one,) = model_of(name).robot, ROBOTS[name][1], find_closure(model_of(name)).loops
    assert (one.inverse.complete, len(one.solution.signs)) == (True, 1)
    full, exists = positions(robot, linkage(robot), [np.array([x]) for x in q])
    here = [full[robot.joints.index(joint)] for joint in robot.passive]
    assert exists.all()
    assert np.abs(np.exp(1j * at(name, "closure", q)) - np.exp(1j * np.array(here))).max() < 1e-9
    assert np.allclose(at(name, "G", q), np.hstack(slopes_of(name, "closure")), atol=1e-7)
    second = [column for k, found in enumerate(slopes_of(name, "G")) for column in found.T[k:]]
    assert np.allclose(at(name, "H", q), np.column_stack(second), atol=1e-7)


@every
def test_closed_forms_are_derivatives_along_the_loop(name: str) -> None:
    q, qd = ROBOTS[name][1], [0.3, -0.5][: len(ROBOTS[name][1])]
    turning, inertia = slopes_of(name, "J[pin]"), slopes_of(name, "B")
    assert np.allclose(at(name, "Jv[pin]", q), np.hstack(slopes_of(name, "p[pin]")), atol=1e-7)
    assert np.allclose(at(name, "J_dot[pin]", q, qd), np.tensordot(qd, turning, 1), atol=1e-7)
    assert np.allclose(at(name, "hessian[pin][1]", q), turning[0], atol=1e-7)
    coriolis = at(name, "C", q, qd)
    assert np.allclose(coriolis + coriolis.T, np.tensordot(qd, inertia, 1), atol=1e-6)
    assert np.allclose(at(name, "g", q), np.vstack(slopes_of(name, "potential")), atol=1e-6)


@pytest.mark.first(2)
@every
def test_what_is_printed_is_the_quotient_of_the_determinants(name: str) -> None:
    model = model_of(name)
    known = slopes(model.robot, linkage(model.robot)[0], model.domain)
    for k, p in {**known.first, **known.second}.items():
        top, below = (expression_to_sympy(polynomial_expression(e, model.domain)) for e in (p, known.determinant))
        gap = sympy.expand_trig(model.closure.loops[0].slope(k) * below - top)
        rest = sympy.fraction(sympy.together(gap))[0].expand()
        for q in rest.free_symbols:  # the ring of sines and cosines
            rest = sympy.rem(rest, sympy.sin(q) ** 2 + sympy.cos(q) ** 2 - 1, sympy.sin(q))
        assert rest.expand() == 0


def test_a_four_bar_linkage_is_told_in_every_form(tmp_path: Path) -> None:
    (tmp_path / "four.yaml").write_text(text_of("four"))
    asked = {form: accepted("show", "four.yaml", "closure", "G", "B", "--format", form, folder=tmp_path).stdout
             for form in ("text", "latex", "python", "json")}  # fmt: skip
    shown = asked["text"].splitlines()
    assert "   px = l1*c1 - l0" in shown
    assert "2 solutions (complete)" in shown
    assert "branch of the file: psi1 = atan2(sqrt(1 - D**2), D)" in shown
    assert "  -1 - l1*sin(q1 - v)/(l2*sin(q1 + u - v))" in shown
    assert "# rows u, v; columns q1, of H their pairs; no value where sin(q1 + u - v) = 0" in shown
    assert shown[-1] == "# G_u_q1 = du/dq1: derive show four.yaml G"
    assert r"p_{x} &= l_{1}c_{1} - l_{0} \\" in asked["latex"]
    assert json.loads(asked["json"])["quantities"]["closure"][0]["known"]["px"] == "-l0 + l1*cos(q1)"
    known: dict[str, Any] = {"sin": np.sin, "cos": np.cos, "sqrt": np.sqrt, "atan2": np.arctan2, "q1": 0.7, **LENGTHS}
    exec(asked["python"].partition("\nG = ")[0], known)
    assert np.allclose(np.exp(1j * at("four", "closure", [0.7])[:, 0]), np.exp([1j * known["u"], 1j * known["v"]]))


def test_what_only_some_robots_have_is_refused_or_means_what_books_say() -> None:
    scara, model = Model(Robot.load("scara-perugia")), model_of("four")
    assert scara.g == scara.G
    with pytest.raises(QuantityError, match="closed loops of scara-perugia, which has none"):
        scara.quantity("closure")
    assert model.quantity("G[2,1]") == model.G[1, 0] == model.closure.G[1, 0]
    for name in ("inverse[pin]", "singularities", "detJ", "base_parameters", "regressor_base", "workspace"):
        with pytest.raises(QuantityError, match="which has closed loops; allowed: robots"):
            model.quantity(name)
    with pytest.raises(QuantityError, match=r"coupler, rocker, at this point: it is open, or singular"):
        model.at("B", [0.7], values={"l1": 9})


@pytest.mark.sweep
def test_lengths_without_numbers_and_rates_without_poles_are_built_and_told(tmp_path: Path) -> None:
    rows = f"{BARS}{ROCKER}loops: [{{join: [coupler, rocker], by: revolute}}]\nends: {{pin: coupler}}\n"
    (tmp_path / "bars.yaml").write_text(f"name: bars\nconvention: standard\njoints:\n{rows}")
    accepted("build", "bars.yaml", "--target", "numpy", folder=tmp_path)  # a loop that closes with some numbers
    rail = f"{FIXED}rail, after: base, theta: pi/2, alpha: pi/2}}\n  - {{type: prismatic, passive: true, q: s, "
    slides = f"{rail}theta: pi/2, alpha: pi/2}}\n  - {{type: prismatic, passive: true, q: t}}\n"
    text = f"{TURNING}crank, a: r}}\n{slides}{FIXED}pin, theta: pi/2, alpha: pi/2}}\n"
    loop = "name: yoke\nconvention: standard\nloops: [{join: [crank, pin], by: revolute}]\nends: {slide: s}\n"
    (tmp_path / "yoke.yaml").write_text(f"{loop}joints:\n{text}")
    assert "have values wherever" in accepted("show", "yoke.yaml", "closure", folder=tmp_path).stdout


def gap(name: str) -> Matrix:
    """The way between the joined frames, from forward kinematics alone."""
    one, other = (model_of(name).frame(row)[:3, 3] for row in ("coupler", "rocker"))
    if name == "rod":
        return sympy.Matrix([(one - other).dot(one - other) - sympy.Symbol("l2") ** 2])
    return sympy.Matrix(one - other)


@every
def test_samples_are_closed_and_move_along_the_loop(name: str) -> None:
    robot, start = model_of(name).robot, gap(name)
    speed = slope(robot, start, "t")
    formulas = [expression_from_sympy(e) for e in (*start, *speed, *slope(robot, speed, "t")) if e != 0]
    wanted = sorted({n for e in formulas for n in names(e)})
    points = list(islice(samples(robot, wanted), 4))
    assert len(points) == 4
    with mpmath.workdps(DIGITS):
        assert all(abs(evaluate(e, point)) < 1e-35 for point in points for e in formulas)


@every
def test_what_the_closure_says_is_proven_exactly_and_nothing_else(name: str) -> None:
    model = model_of(name)
    robot, first = model.robot, next(e for e in gap(name) if e != 0)
    assert compare(robot, expression_from_sympy(first), ZERO).exact
    wrong = compare(robot, expression_from_sympy(first.subs(sympy.Symbol("l1"), 2 * sympy.Symbol("l1"))), ZERO)
    assert not wrong.equal
    assert wrong.counter_example is not None
    (joint, by), derivative = next((key, e) for key, e in derivatives(robot).items() if len(key) == 2)
    row, column = [j.variable for j in robot.passive].index(joint), list(map(str, model.q)).index(by)
    formula = expression_from_sympy(model.G[row, column])
    assert compare(robot, formula, derivative).exact
    assert not compare(robot, formula, Name(by)).equal
    on = OnClosure(robot)
    assert {*names(on.reduced(derivative))} <= {*on.free, *(each.variable for each in robot.passive)}
    with pytest.raises(CheckError, match="along a closed loop"):  # a partial derivative could be that of the tree
        slope(robot, model.B, by)
