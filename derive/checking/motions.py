"""Printed equations of motion: what each should be, and which torques make the arm move so that it holds."""

from collections.abc import Mapping, Sequence
from contextlib import suppress
from itertools import permutations

import numpy as np
import numpy.typing as npt
import sympy

from derive.checking.formulas.edits import NO_VALUE, float_value
from derive.lecture.sympy_conversion import Matrix, expression_from_sympy, expression_to_sympy
from derive.model.model import Model
from derive.model.quantities import REGISTRY
from derive.robot.expression import Expression, names
from derive.robot.names import acceleration_name, own_names, velocity_name

MOST_ACCELERATED = 3  # joints of arms whose accelerations people write out
_EXACT, _ROUGH = 1e-9, 1e-4  # what rounding leaves of a zero, and what squares leave of one that holds near rest
_SMALL = 1e-5  # a motion near rest

Array = npt.NDArray[np.float64]


class Motions:
    """The motions of one arm at random points."""

    def __init__(self, model: Model, points: Sequence[Mapping[str, float]]) -> None:
        self._model, self._robot, self._points = model, model.robot, points
        self._joints = [joint.variable for joint in self._robot.variables]
        self._rates = {velocity_name(q) for q in self._joints}
        self._accelerations = [acceleration_name(q) for q in self._joints]

    def meant(self, value: Expression) -> tuple[str, Expression | None]:
        """What an equation of motion should be: solved for an acceleration, or the torque, divided as that is."""
        joints, inertia = self._joints, self._model.quantity("B")
        torques, printed = self._model.quantity("tau"), expression_to_sympy(value).expand()
        slopes = {i: slope for i, q in enumerate(joints) if (slope := printed.diff(acceleration_name(q))) != 0}
        if printed.is_Symbol:  # nothing accelerates, or by what nobody says
            return "", None
        if [*slopes.values()] == [1]:
            rest = torques.subs({acceleration_name(q): 0 for q in joints})
            solved = inertia.adjugate() * rest / inertia.det(method="berkowitz")  # qdd = -B^-1 (C qd + g + f)
            name = acceleration_name(joints[min(slopes)])
            return name, expression_from_sympy(sympy.Symbol(name) + solved[min(slopes)])
        # what may be left out on purpose: gravity, all that velocities add, the motion of a joint
        weight = {n for e in self._robot.gravity or () for n in names(e)}
        lost = [weight, self._rates, *({velocity_name(q), acceleration_name(q)} for q in joints)]
        best: tuple[int, str, Expression | None] = (0, "", None)
        terms = printed.as_coefficients_dict()
        for i, torque in enumerate(torques):
            for factor in dict.fromkeys([sympy.S.One, *(sympy.cancel(inertia[i, j] / slopes[j]) for j in slopes)]):
                if factor == 0 or not factor.free_symbols.isdisjoint(map(sympy.Symbol, joints)):
                    continue
                own = (right := (torque / factor).expand()).as_coefficients_dict()
                is_part = any(right.subs(dict.fromkeys(n, 0)).as_coefficients_dict() == terms != own for n in lost)
                common = 0 if is_part else len(own.items() & terms.items())
                if common > best[0] and 2 * common >= max(len(own), len(terms)):
                    best = common, f"tau[{i + 1}]" + f"/({factor})" * (factor != 1), expression_from_sympy(right)
        return best[1:]

    def driven(self, zero: Expression, letters: Sequence[str]) -> str:
        """Which torques, its letters perhaps, make a formula with accelerations zero if they alone drive, or none."""
        is_known = self._robot.has_dynamics and max(len(self._joints), len(letters)) <= MOST_ACCELERATED
        if not is_known or {*names(zero)}.isdisjoint(self._accelerations):
            return ""
        for driving in permutations(range(len(self._joints)), max(len(letters), 1)):
            torques = dict(zip(driving, letters or [""], strict=True))
            if any(x[-1:].isdigit() and x[-1] != str(i + 1) for i, x in torques.items()):
                continue
            said = " and ".join(f"tau[{i + 1}]" + f" = {letter}" * bool(letter) for i, letter in torques.items())
            with suppress(*NO_VALUE):
                if all(abs(self._left(zero, at, torques, 1)) < _EXACT for at in self._points):
                    return f"where {said} alone drives"
                # the torque of a joint less its friction, f_theta = -mu qd
                if letters and all(abs(self._left(zero, at, torques, 1, drags=False)) < _EXACT for at in self._points):
                    return f"where {said} less friction alone drives"
                near = (self._left(zero, at, torques, _SMALL) / _SMALL for at in self._points)
                if max(map(abs, near)) < _ROUGH and self._is_linear(zero):
                    return f"where {said} alone drives, near rest with all joint variables zero"
        return ""

    def _left(
        self, zero: Expression, at: Mapping[str, float], torques: Mapping[int, str], size: float, *, drags: bool = True
    ) -> float:
        """The value of a formula while torques alone drive; size scales angles, velocities and torques."""
        point = {name: at[name] for name in (*own_names(self._robot), *names(zero))}
        point |= {name: at[name] * size for name in (*self._joints, *self._rates)}
        point |= dict.fromkeys(self._accelerations, 0.0)
        torque = np.zeros((len(self._joints), 1))
        for i, letter in torques.items():
            torque[i] = point[f"?{letter}"] = at[f"?{i}"] * size
        inertia, rest = (matrix_value(self._model.quantity(name), point) for name in ("B", "tau"))
        if not drags and REGISTRY["friction"].is_of(self._robot):
            rest -= matrix_value(self._model.quantity("friction"), point)
        moved = np.linalg.solve(inertia, torque - rest)[:, 0]  # B qdd = tau - (C qd + g + f)
        return float_value(zero, point | dict(zip(self._accelerations, moved, strict=True)))

    def _is_linear(self, zero: Expression) -> bool:
        """Whether a formula doubles with all that moves in it."""
        moving = {*self._joints, *self._rates, *self._accelerations}
        scales = {name: 2 if name in moving or name[0] == "?" else 1 for name in names(zero)}
        once, twice = ([{n: at[n] * k**i for n, k in scales.items()} for at in self._points] for i in (0, 1))
        pairs = zip(once, twice, strict=True)
        return all(abs(float_value(zero, there) - 2 * float_value(zero, here)) < _EXACT for here, there in pairs)


def matrix_value(matrix: Matrix, at: Mapping[str, float]) -> Array:
    """The value of a matrix at a point."""
    return np.array([float_value(expression_from_sympy(e), at) for e in matrix]).reshape(matrix.shape)
