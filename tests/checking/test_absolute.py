"""Quantities for angles that are counted from one direction, against Lagrange's equations written with such angles."""

from itertools import product

import numpy as np
import pytest
import sympy

from derive.checking.latex.quantities import AbsoluteModel, may_count_from_one_direction, turning
from derive.model.model import Model
from derive.robot.robot import Robot
from tests.checking.test_pages import checked
from tests.rows import robot_of_rows

POINT = "{mass: %s, com: [0, 0, 0]}"
CART = f"""
base: [[0, 0, 1, 0], [0, -1, 0, 0], [1, 0, 0, 0], [0, 0, 0, 1]]
gravity: [0, 0, -g]
links: [{{mass: m0}}, {POINT % "m1"}, {POINT % "m2"}, {POINT % "m3"}]
"""
ARM = robot_of_rows("P q: x, alpha: pi/2 | R q: t1, a: l1 | R q: t2, a: l2 | R q: t3, a: l3", CART)


def vanishes(gap: sympy.Matrix) -> bool:
    """Whether all entries are zero at numbers without a pattern."""
    names = sorted(gap.free_symbols, key=str)
    values = np.random.default_rng(1).uniform(-2, 2, (3, len(names)))
    numeric = sympy.lambdify(names, gap)
    return bool(max(np.abs(numeric(*at)).max() for at in values) < 1e-9)


def test_quantities_are_those_of_lagranges_equations() -> None:
    model = AbsoluteModel(Model(ARM))
    q, qd = sympy.Matrix(model.q), sympy.Matrix(model.qd)
    m, lengths = sympy.symbols("m0:4"), sympy.symbols("l1:4")
    points = [sympy.Matrix([q[0], 0])]
    turn = model.frame(1)[:3, :3]  # from the world into the plane of the arm
    for angle, length in zip(q[1:], lengths, strict=True):
        place = turn * sympy.Matrix([length * sympy.cos(angle), length * sympy.sin(angle), 0])
        points.append(points[-1] + sympy.Matrix([place[0], place[2]]))
    speeds = [point.jacobian(q) * qd for point in points]
    kinetic = sum(mass * v.dot(v) / 2 for mass, v in zip(m, speeds, strict=True))
    inertia = sympy.hessian(kinetic, list(qd))
    gravity = sympy.Matrix([sympy.Symbol("g") * sum(a * b[1] for a, b in zip(m, points, strict=True))]).jacobian(q).T
    n = range(model.n)
    symbols = {
        (i, j, k): (inertia[i, j].diff(q[k]) + inertia[i, k].diff(q[j]) - inertia[j, k].diff(q[i])) / 2
        for i, j, k in product(n, repeat=3)
    }
    coriolis = sympy.Matrix(model.n, model.n, lambda i, j: sum(symbols[i, j, k] * qd[k] for k in n))
    wanted = {
        "kinetic": kinetic,
        "B": inertia,
        "C": coriolis,
        "g": gravity,
        "tau": inertia * sympy.Matrix(model.qdd) + coriolis * qd + gravity,
        "christoffel[2,3,3]": symbols[1, 2, 2],
        "B[2,3]": inertia[1, 2],
    }
    for name, value in wanted.items():
        assert vanishes(sympy.Matrix([model.quantity(name) - value])), name
    place = sympy.Matrix(model.quantity("T")[:3, 3])
    assert vanishes(place.jacobian(q) - model.quantity("J")[:3, :])
    assert turning(model) * q == sympy.Matrix([q[0], q[1], q[2] - q[1], q[3] - q[2]])


@pytest.mark.parametrize(
    ("name", "has"), [("planar-2r-perugia", True), ("puma560-corke", True), ("spherical-wrist", False)]
)
def test_joints_behind_each_other_with_parallel_axes_may_have_such_angles(name: str, has: bool) -> None:
    assert may_count_from_one_direction(Model(Robot.load(name)), r"\cos(\theta_1 - \theta_2)") is has


PENDULUM = robot_of_rows(
    "R q: theta1, theta: theta1 - pi/2, a: l1 | R q: theta2, a: l2",
    f"gravity: [0, -g, 0]\nlinks: [{POINT % 'm1'}, {POINT % 'm2'}]",
)
PAGE = r"""
$$x_2 = l_1 \sin\theta_1 + l_2 \sin\theta_2$$
$$T = \frac{1}{2}(m_1 + m_2) l_1^2 \dot\theta_1^2 + \frac{1}{2} m_2 l_2^2 \dot\theta_2^2
  + m_2 l_1 l_2 \dot\theta_1 \dot\theta_2 \cos(\theta_1 - \theta_2)$$
$$V = -(m_1 + m_2) g l_1 \cos\theta_1 - m_2 g l_2 \cos\theta_2$$
$$M_{12} = m_2 l_1 l_2 \cos(\theta_1 - \theta_2)$$
$$\omega_2 = \dot\theta_2$$
$$g_1 = SIGN(m_1 + m_2) g l_1 \sin\theta_1$$
"""


@pytest.mark.parametrize(("sign", "wrong"), [("", []), ("-", ["g[1]"])])
def test_a_page_is_read_with_such_angles_where_more_of_it_is_right_then(sign: str, wrong: list[str]) -> None:
    report = checked(PENDULUM, PAGE.replace("SIGN", sign))
    assert [finding.entry for finding in report.wrong] == wrong
    assert (report.equal, report.unread) == (6 - len(wrong), ())
    assert "from one direction" in report.readings[0]


def test_a_slip_of_an_index_does_not_change_the_reading() -> None:
    report = checked(
        PENDULUM, r"$$x = l_1 \sin\theta_1 + l_2 \sin\theta_2$$ $$y = -l_1 \cos\theta_1 - l_2 \cos\theta_2$$"
    )
    assert ([finding.entry for finding in report.wrong], report.readings) == (["p[1]", "p[2]"], ())


def test_a_page_with_right_poses_is_not_read_again(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(AbsoluteModel, "quantity", lambda *_: pytest.fail("read again"))
    place = r"$$x = l_1 \sin\theta_1 + l_2 \sin(\theta_1 + \theta_2)$$"
    report = checked(PENDULUM, place + r"$$w = m_2 l_1 \cos(\theta_1 - \theta_2)$$")
    assert (report.equal, report.wrong, report.readings) == (1, (), ())
