"""Matrices of SymPy from frames, columns and triangles."""

from __future__ import annotations

import sympy

from derive.lecture.matrices import columns_matrix, symmetric_matrix


def test_a_symmetric_matrix_comes_from_its_upper_triangle_row_by_row() -> None:
    assert symmetric_matrix(3, [1, 2, 3, 4, 5, 6]) == sympy.Matrix([[1, 2, 3], [2, 4, 5], [3, 5, 6]])


def test_linear_rows_of_a_jacobian_stand_above_angular_ones() -> None:
    assert columns_matrix([(1, 2, 3)], [(4, 5, 6)], write=sympy.Integer) == sympy.Matrix([1, 2, 3, 4, 5, 6])
