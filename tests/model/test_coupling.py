"""Closed forms of coupled joints against the oracle at random points, and as identities."""

import random
from itertools import product

import numpy as np
import pytest
import sympy

from derive.lecture.sympy_conversion import Expr, expression_from_sympy
from derive.model.equality import compare
from derive.model.model import Model
from derive.robot.robot import Robot
from tests.model.test_model_against_oracle import Numbers, check_dynamics, close
from tests.model.test_trees import check_ends
from tests.random_robots import seeds
from tests.rows import robot_of_rows

TURNS, FACTORS = ("0", "pi/2", "-pi/2", "pi"), ("1", "-1", "2", "-3", "1/2", "p")


def random_text(rng: random.Random) -> str:
    """Up to four joints, perhaps on two branches, driven by up to three variables; angles are multiples of pi/2."""
    n = rng.randint(2, 4)
    variables = [f"v{k}" for k in range(1, rng.randint(1, min(n, 3)) + 1)]
    joints, links = [], []
    for i in range(n):
        used = {variables[i % len(variables)], *rng.sample(variables, rng.choice([0, 0, min(1, len(variables) - 1)]))}
        cell = " + ".join(f"({rng.choice(FACTORS[: 3 if i < len(variables) else 6])})*{name}" for name in sorted(used))
        slides = rng.random() < 0.3
        rest = rng.choice(("0", f"h{i}")) if slides else rng.choice(TURNS)
        row = f"type: {'prismatic' if slides else 'revolute'}, {'d' if slides else 'theta'}: {cell} + {rest}"
        joints.append(f"  - {{{row}, name: r{i}, a: {rng.choice(('0', f'a{i}'))}, alpha: {rng.choice(TURNS)}}}")
        motor = rng.choice(("", ", motor: {mass: 1/2, inertia: 1/9, ratio: 7}, armature: 1/5"))
        links.append(f"  - {{mass: m{i}, com: [x{i}, 0, 2], inertia: {{xx: 2, zz: I{i}, xy: 1/7}}, {FRICTION}{motor}}}")
    if branches := rng.random() < 0.3:
        joints[-1] = joints[-1].replace("name:", "after: r0, name:")
    ends = f"ends: {{left: r{n - 2}, right: r{n - 1}}}\n" * branches
    block = ", ".join(f"{name}: {{}}" for name in variables)
    tables = "\n".join(["joints:", *joints, "gravity: [1, -g, 2]", "links:", *links])
    convention = rng.choice(("standard", "modified"))
    return f"name: r\nconvention: {convention}\nvariables: {{{block}}}\n{ends}{tables}\n"


FRICTION = "friction: {viscous: 1/4, coulomb: [1/3, 1/8]}"


@pytest.mark.first(2)
@pytest.mark.parametrize("seed", seeds(60, 6, 60))
def test_closed_forms_agree_with_the_oracle(seed: int) -> None:
    n = Numbers(Robot.from_text(random_text(random.Random(seed))), seed)
    model = n.model
    check_ends(n)
    _, tau = check_dynamics(n)
    close((n.value(model.regressor) @ n.value(model.standard_parameters)).ravel(), tau)
    close((n.value(model.regressor_base) @ n.value(model.base_parameters)).ravel(), tau)
    skew = model.rate_coefficient("N")
    assert not any(skew(i, j, k) + skew(j, i, k) for i, j, k in product(range(model.n), repeat=3)), "Bdot - 2C is skew"


def planar(*cells: str, more: str = "") -> Model:
    rows = "|".join(f"R a: a{i}, theta: {cell}" for i, cell in enumerate(cells, 1))
    links = "".join(
        f"  - {{mass: m{i}, com: [x{i}, y{i}, 0], inertia: {{zz: I{i}}}, armature: J{i}{more}}}\n"
        for i in range(1, len(cells) + 1)
    )
    return Model(robot_of_rows(rows, f"gravity: [0, -g, 0]\nlinks:\n{links}"))


def same(robot: Robot, ours: Expr, theirs: Expr) -> bool:
    verdict = compare(robot, expression_from_sympy(ours), expression_from_sympy(theirs))
    return verdict.equal and verdict.exact


def test_relative_and_absolute_angles_are_two_sheets_of_one_arm() -> None:
    """With q = S a: T(S a), S^T B S, S^T C(S a, S ad) S and S^T g, exactly."""
    relative, absolute = planar("q1", "q2", more=", friction: {viscous: b}"), planar("q1", "q2 - q1")
    s = sympy.Matrix([[1, 0], [-1, 1]])
    there = (*(s * sympy.Matrix(absolute.q)), *(s * sympy.Matrix(absolute.qd)))
    changed = dict(zip((*relative.q, *relative.qd), there, strict=True))
    pairs = [
        (absolute.T, relative.T.subs(changed, simultaneous=True)),
        (absolute.J, relative.J.subs(changed, simultaneous=True) * s),
        (absolute.B, s.T * relative.B.subs(changed, simultaneous=True) * s),
        (absolute.C, s.T * relative.C.subs(changed, simultaneous=True) * s),
        (absolute.g, s.T * relative.g.subs(changed, simultaneous=True)),
    ]
    for ours, theirs in pairs:
        assert all(same(absolute.robot, *pair) for pair in zip(ours, theirs, strict=True))
    assert str(absolute.T[0, 3]) == "a1*cos(q1) + a2*cos(q2)"
    assert not sympy.Matrix([absolute.g[0], absolute.B[0, 0]]).has(absolute.q[1])


@pytest.mark.parametrize(
    ("cells", "angles", "turned"),
    [
        (("q1", "q2 - q1", "q1 - q2"), {"q1", "q2"}, "cos(q1)"),  # a parallelogram
        (("q1", "-q1"), {"q1"}, "1"),
        (("q1", "q1"), {"q1", "2*q1"}, "cos(2*q1)"),
        (("q1", "pi/2 - q1", "q1"), {"q1"}, "-sin(q1)"),
        (("q1", "q2", "pi - q1 - q2"), {"q1", "q1 + q2"}, "-1"),
    ],
)
def test_angles_that_are_equal_or_cancel_are_contracted(cells: tuple[str, ...], angles: set[str], turned: str) -> None:
    model = planar(*cells)
    shown = {str(call.args[0]) for call in model.T.atoms(sympy.sin, sympy.cos)}
    assert (shown, str(model.T[0, 0])) == (angles, turned)


@pytest.mark.parametrize(
    ("cells", "kept"),
    [
        (("q1", "pi/2 - q1", "q1"), 5),  # mx and my against gravity, and one inertia, viscous and dry friction
        (("q1", "q2 - q1", "q1 - q2"), 13),
        (("q1", "q2", "2*q2", "q1 + q2", "q1 - q2"), 20),
    ],
)
def test_base_parameters_are_as_few_as_the_rank_of_the_regressor(cells: tuple[str, ...], kept: int) -> None:
    """Offsets between coupled joints count, and friction of joints that move together is one."""
    model, rng = planar(*cells, more=", friction: {viscous: b, coulomb: f}"), np.random.default_rng(1)
    y = model.regressor_base
    symbols = sorted(y.free_symbols - {*model.q, *model.qd, *model.qdd}, key=str)
    numeric = sympy.lambdify([*model.q, *model.qd, *model.qdd], y.subs({s: rng.uniform(0.3, 1) for s in symbols}))
    rows = np.vstack([np.array(numeric(*rng.uniform(-2, 2, 3 * model.n)), dtype=float) for _ in range(60)])
    assert (np.linalg.matrix_rank(rows), y.shape[1]) == (kept, kept)
    n = Numbers(model.robot, 1)
    wanted = n.oracle.evaluate("inverse_dynamics", n.q, n.qd, n.qdd)
    close((n.value(y) @ n.value(model.base_parameters)).ravel(), wanted)


def test_names_of_rows_count_joints_and_indices_of_columns_count_variables() -> None:
    model = Model(Robot.load("palletiser"))
    assert [model.quantity(name).shape for name in ("J", "T[4,5]", "A[5]", "Jv_com[5]", "hessian[4]")] == [
        *((6, 4), (4, 4), (4, 4), (3, 4), (6, 4))
    ]
    assert model.transform("turntable", "flange") == model.quantity("T[1,5]")
    assert model.equal("T[1,4]", "c1*(a1 + a4 + a2*c2 + a3*c3)")
    assert not model.equal("T[1,4]", "c1*(a1 + a4 + a2*c2 + a3*c23)")
    assert model.equal("T[1,1]", "cos(q1 - q4)")
    assert not model.B[1, 1].has(*model.q), "inertia about absolute angles"
    assert {str(call) for call in model.B[1, 2].atoms(sympy.sin, sympy.cos)} == {"cos(q2 - q3)"}
