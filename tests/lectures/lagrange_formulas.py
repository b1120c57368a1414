"""The general formulas of Lagrange dynamics that document 004 prints, each written out and compared identically."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from itertools import product
from typing import Any

import sympy

from derive.lecture.sympy_conversion import expression_from_sympy, expression_to_sympy
from derive.model.equality import compare
from derive.model.model import Model
from derive.robot.description import Motor

Matrix = Any


def same(model: Model, ours: Matrix, theirs: Matrix) -> bool:
    pairs = zip(sympy.Matrix(ours), sympy.Matrix(theirs), strict=True)
    return all(compare(model.robot, expression_from_sympy(a), expression_from_sympy(b)).equal for a, b in pairs)


def frame(model: Model, i: int) -> tuple[Matrix, Matrix, Matrix]:
    """Rotation, z axis and origin of frame i."""
    T = sympy.Matrix(model.frame(i))
    return T[:3, :3], T[:3, 2], T[:3, 3]


def jacobian_column(model: Model) -> bool:
    """Revolute: [z x (o - o_{i-1}); z]; prismatic: [z; 0], with z = z_{i-1}."""
    columns = []
    for i, joint in enumerate(model.robot.joints, 1):
        _, z, o = frame(model, i - 1)
        arm = sympy.Matrix(model.p) - o
        column = [*z.cross(arm), *z] if joint.is_revolute else [*z, 0, 0, 0]
        columns.append(sympy.Matrix(column))
    return same(model, model.J, sympy.Matrix.hstack(*columns))


def jacobian_rotor(model: Model) -> bool:
    """Jw of rotor i: of link i-1 for the joints before, k_ri z_{i-1} for joint i."""
    for i in range(1, model.n + 1):
        motor = model.robot.links[i - 1].motor or Motor()
        _, z, _ = frame(model, i - 1)
        right = sympy.Matrix(model.Jw_com(i - 1)) if i > 1 else sympy.zeros(3, model.n)
        right[:, i - 1] = expression_to_sympy(motor.ratio) * z
        if not same(model, model.Jw_motor(i), right):
            return False
    return True


def inertia(model: Model) -> bool:
    """B = sum m Jv^T Jv + Jw^T R I R^T Jw over links and rotors."""
    total = sympy.zeros(model.n, model.n)
    for i, link in enumerate(model.robot.links, 1):
        rotation, _, _ = frame(model, i)
        xx, yy, zz, xy, xz, yz = (
            expression_to_sympy(getattr(link.inertia, key)) for key in ("xx", "yy", "zz", "xy", "xz", "yz")
        )
        tensor = rotation * sympy.Matrix([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) * rotation.T
        total += expression_to_sympy(link.mass) * model.Jv_com(i).T * model.Jv_com(i)
        total += model.Jw_com(i).T * tensor * model.Jw_com(i)
        motor = link.motor or Motor()
        _, z, _ = frame(model, i - 1)
        spin = sympy.Matrix(model.Jw_motor(i)).T * z
        total += expression_to_sympy(motor.mass) * model.Jv_motor(i).T * model.Jv_motor(i)
        total += expression_to_sympy(motor.inertia) * spin * spin.T
    return same(model, model.B, total)


def christoffel(model: Model) -> bool:
    """c_ijk = (db_ij/dq_k + db_ik/dq_j - db_jk/dq_i)/2 = c_ikj, C_ij = sum_k c_ijk qd_k."""
    n, b, q = range(model.n), model.B, model.q
    c = {(i, j, k): (b[i, j].diff(q[k]) + b[i, k].diff(q[j]) - b[j, k].diff(q[i])) / 2 for i, j, k in product(n, n, n)}
    symbols = [model.christoffel(i + 1, j + 1, k + 1) for i, j, k in c]
    coriolis = sympy.Matrix(model.n, model.n, lambda i, j: sum(c[i, j, k] * model.qd[k] for k in n))
    mirrored = [c[i, k, j] for i, j, k in c]
    return same(model, symbols, list(c.values())) and same(model, symbols, mirrored) and same(model, model.C, coriolis)


def skew(model: Model) -> bool:
    """N = Bdot - 2C is skew-symmetric."""
    n = sympy.Matrix(model.Bdot) - 2 * sympy.Matrix(model.C)
    return same(model, model.N, n) and same(model, n + n.T, sympy.zeros(model.n, model.n))


def potential(model: Model) -> bool:
    """U = -sum(m_li g0^T p_li + m_mi g0^T p_mi), g_i = dU/dq_i."""
    g0 = sympy.Matrix([expression_to_sympy(cell) for cell in model.robot.gravity or ()])
    total = sympy.Integer(0)
    for i, link in enumerate(model.robot.links, 1):
        rotation, _, o = frame(model, i)
        com = o + rotation * sympy.Matrix([expression_to_sympy(cell) for cell in link.com])
        _, _, rotor = frame(model, i - 1)
        motor = link.motor or Motor()
        total -= expression_to_sympy(link.mass) * g0.dot(com) + expression_to_sympy(motor.mass) * g0.dot(rotor)
    gradient = [total.diff(q) for q in model.q]
    return same(model, [model.energy.potential], [total]) and same(model, model.g, gradient)


def equation(model: Model) -> bool:
    """B qdd + C qd + g = tau."""
    qd, qdd = sympy.Matrix(model.qd), sympy.Matrix(model.qdd)
    return same(model, model.tau, sympy.Matrix(model.B) * qdd + sympy.Matrix(model.C) * qd + sympy.Matrix(model.g))


FORMULAS: Mapping[str, Callable[[Model], bool]] = {
    "jacobian_column": jacobian_column,
    "jacobian_rotor": jacobian_rotor,
    "inertia": inertia,
    "christoffel": christoffel,
    "skew": skew,
    "potential": potential,
    "equation": equation,
}
