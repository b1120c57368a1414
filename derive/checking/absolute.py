"""Angles of links that a text counts from one direction, as those of a double pendulum from the vertical.

With theta the angles of the text and q the joint variables, q = A theta: in a run of revolute joints with parallel
axes q_k = theta_k - theta_{k-1}. So J becomes J A, torques A' tau, and B becomes A' B A.
"""

import re
from itertools import product

import sympy

from derive.lecture.sympy_conversion import Expr, Matrix
from derive.model.model import Model
from derive.model.quantity_names import of_one_end, parse

# A function of the difference of two angles, or a name for it, without which no inertia has angles from one direction.
_DIFFERENCE = re.compile(r"(?:(?:sin|cos)\s*(?:\\left)?|[A-Za-z}]\s*=)[\s({]*\\?([A-Za-z]+)_\{?\w+\}?\s*-\s*\\?\1_")


class ModelOfOneEnd(Model):
    """A model of a tree whose quantities of the end effector are those of its only end."""

    def quantity(self, name: str) -> Expr:
        """A quantity by its name; QuantityError where it asks for an end and does not say for which of several."""
        return super().quantity(of_one_end(self, name))


class AbsoluteModel(Model):
    """A model in whose formulas the joint variables are such angles."""

    def __init__(self, model: Model) -> None:
        super().__init__(model.robot, model.style)
        self._relative, self.turning = model, _turning(model)
        pairs = ((symbols, self.turning * sympy.Matrix(symbols)) for symbols in (self.q, self.qd, self.qdd))
        self._meanings = {s: value for symbols, values in pairs for s, value in zip(symbols, values, strict=True)}

    def quantity(self, name: str) -> Expr:
        """A quantity by its name, with its rows and columns for the angles of the text."""
        quantity, indices, entry = parse(self, name)
        turn = self.turning
        if quantity.name != "christoffel":
            value = quantity.value(self._relative, *indices)
        else:  # A is constant: each index turns as a column of J does
            i, j, k = indices
            value = sum(
                turn[a, i - 1] * turn[b, j - 1] * turn[c, k - 1] * self._relative.christoffel(a + 1, b + 1, c + 1)
                for a, b, c in product(range(self.n), repeat=3)
            )
        # qd = A thetad, and by equal power the torques are A' tau
        value = (turn.T * value).expand() if quantity.shape.startswith("nx") else value
        value = (value * turn).expand() if quantity.shape.endswith("xn") else value
        value = value.xreplace(self._meanings)
        value = value if quantity.shape else value.expand()
        return value if entry is None else value[tuple(index - 1 for index in entry)]

    def moves(self, value: Expr) -> bool:
        """Whether a formula of the pose has joint variables that are others than the angles of the text."""
        return any(self._meanings.get(symbol, symbol) != symbol for symbol in sympy.sympify(value).free_symbols)

    def frame(self, i: int | str) -> Matrix:
        """DH frame i in the world."""
        return self._relative.frame(i).xreplace(self._meanings)

    def christoffel(self, i: int, j: int, k: int) -> Expr:
        """c_ijk for the angles of the text."""
        return self.quantity(f"christoffel[{i},{j},{k}]")


def turning(model: Model) -> Matrix:
    """The joint variables by the angles of the text, n x n."""
    return model.turning if isinstance(model, AbsoluteModel) else sympy.eye(model.n)


def may_count_from_one_direction(model: Model, text: str) -> bool:
    """Whether two joints behind each other turn about parallel axes, and a text has the difference of two angles."""
    is_chain = not model.robot.is_tree  # whose file says what its variables are
    return is_chain and bool(_DIFFERENCE.search(text) and _turning(model) != sympy.eye(model.n))


def _turning(model: Model) -> Matrix:
    """A with q = A theta."""
    a, axes, joints = sympy.eye(model.n), model.quantity("J")[3:, :], model.robot.joints
    for k in range(1, model.n):
        if joints[k - 1].is_revolute and joints[k].is_revolute and axes[:, k - 1] == axes[:, k]:
            a[k, k - 1] = -1
    return a
