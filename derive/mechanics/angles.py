"""Orientation angles in closed form from R, and the Jacobians of their rates.

Roll, pitch, yaw: R = Rot(z, yaw) Rot(y, pitch) Rot(x, roll). Euler ZYZ: R = Rot(z, phi) Rot(y, theta) Rot(z, psi).
(Siciliano, Sciavicco, Villani, Oriolo, Robotics, sections 2.4 and 3.6.)
"""

from __future__ import annotations

from typing import Any

import sympy

from derive.errors import QuantityError

Matrix = Any


def rpy(r: Matrix, cosine: Any = None) -> Matrix:
    """(roll, pitch, yaw), 3x1 [rad], pitch in (-pi/2, pi/2).

    Args:
        r: The rotation, 3x3.
        cosine: A shorter form of sqrt(r32^2 + r33^2), the cosine of pitch.

    Singular where r11 = r21 = 0 (pitch = +-pi/2): only yaw - roll or yaw + roll is then determined. Where that holds in
    every configuration, roll is taken as 0.
    """
    if r[0, 0] == 0 and r[1, 0] == 0:
        return sympy.ImmutableMatrix([0, -r[2, 0] * sympy.pi / 2, sympy.atan2(-r[0, 1], r[1, 1])])
    return sympy.ImmutableMatrix(
        [
            sympy.atan2(r[2, 1], r[2, 2]),
            sympy.atan2(-r[2, 0], sympy.sqrt(r[2, 1] ** 2 + r[2, 2] ** 2) if cosine is None else cosine),
            sympy.atan2(r[1, 0], r[0, 0]),
        ]
    )


def euler_zyz(r: Matrix, sine: Any = None) -> Matrix:
    """(phi, theta, psi), 3x1 [rad], theta in (0, pi).

    Args:
        r: The rotation, 3x3.
        sine: A shorter form of sqrt(r13^2 + r23^2), the sine of theta.

    Singular where r13 = r23 = 0 (theta = 0 or pi): only phi + psi or phi - psi is then determined. Where that holds in
    every configuration, as for planar arms, psi is taken as 0.
    """
    if r[0, 2] == 0 and r[1, 2] == 0:
        sign = r[2, 2]
        theta = sympy.pi * (1 - sign) / 2
        return sympy.ImmutableMatrix([sympy.atan2(sign * r[1, 0], sign * r[0, 0]), theta, 0])
    return sympy.ImmutableMatrix(
        [
            sympy.atan2(r[1, 2], r[0, 2]),
            sympy.atan2(sympy.sqrt(r[0, 2] ** 2 + r[1, 2] ** 2) if sine is None else sine, r[2, 2]),
            sympy.atan2(r[2, 1], -r[2, 0]),
        ]
    )


def analytic_jacobian(kind: str, r: Matrix, jacobian: Matrix) -> Matrix:
    """6xn: rows of velocity, then of the rates of the angles ``rpy`` or ``zyz``, from the geometric Jacobian.

    The matrix that turns angular velocity into rates is written in entries of R, so that no inverse trigonometric
    function occurs.
    """
    column = 0 if kind == "rpy" else 2
    x, y, z = r[0, column], r[1, column], r[2, column]
    if x == 0 and y == 0:
        other = "rpy" if kind == "zyz" else "zyz"
        raise QuantityError(
            f"the analytic Jacobian for {kind}",
            allowed="angles that are not singular in every configuration of this arm",
            remedy=f"use {other}, or the geometric Jacobian J",
        )
    square = x**2 + y**2
    rates = []
    for k in range(jacobian.shape[1]):
        wx, wy, wz = jacobian[3, k], jacobian[4, k], jacobian[5, k]
        about = (x * wx + y * wy) / square
        across = (x * wy - y * wx) / sympy.sqrt(square)
        turn = wz - z * about
        rates.append([about, across, turn] if kind == "rpy" else [turn, across, about])
    return sympy.ImmutableMatrix(sympy.Matrix.vstack(sympy.Matrix(jacobian[:3, :]), sympy.Matrix(rates).T))
