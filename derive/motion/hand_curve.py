"""The curve of the hand: where the end effector is and how fast it goes, in numbers and, of formulas, as a formula."""

from collections.abc import Iterator
from functools import cached_property

import numpy as np
from sympy import Expr, Matrix, Symbol, latex, powdenest, sqrt, sstr

from derive.arrays import Array
from derive.errors import QuantityError
from derive.lecture.sympy_conversion import expression_to_sympy
from derive.mechanics.vectors import dot
from derive.model.kinematic_model import KinematicModel
from derive.motion.motion import Motion
from derive.motion.torques.functions import Functions, check_numbers, kinematics_alone
from derive.plans.hermite import TIME
from derive.robot.names import free_symbols

AXES = ("x", "y", "z")


class HandCurve:
    """The end effector of a motion."""

    def __init__(self, motion: Motion) -> None:
        self._motion = motion
        self._robot = kinematics_alone(motion.plan.robot)

    def __call__(self, t: Array) -> tuple[Array, Array]:
        """Position [m] and velocity [m/s] in the world frame, (times, 3) each."""
        times = np.asarray(t, dtype=float)
        q, qd, _ = self._motion(times)
        p = self._functions("forward_kinematics", q)[..., :3, 3]
        v = np.einsum("tij,tj->ti", self._functions("jacobian", q)[..., :3, :], qd)  # v = J_v qd
        base = self._motion.base
        if base is None:
            return p, v
        # On a base with the pose (R, o): p_world = R p + o, v_world = R' p + R v + o'.
        now, rate = base(times, 0), base(times, 1)
        turned = np.einsum("tij,tj->ti", rate[:, :3, :3], p) + np.einsum("tij,tj->ti", now[:, :3, :3], v)
        return np.einsum("tij,tj->ti", now[:, :3, :3], p) + now[:, :3, 3], turned + rate[:, :3, 3]

    @cached_property
    def _functions(self) -> Functions:
        robot, place = self._robot, self._motion.plan.places["robot"]
        check_numbers(free_symbols(robot), self._motion.values, robot.name, place)
        return Functions(robot, frozenset({"forward_kinematics", "jacobian"}), self._motion.values)

    @cached_property
    def position(self) -> tuple[Expr, Expr, Expr]:
        """x, y, z of the end effector in the joint variables and the symbols of the robot, the base moving."""
        p = Matrix([*KinematicModel(self._robot).p, 1])
        if self._motion.base is not None:
            p = self._motion.base.transform * p
        x, y, z = p[:3]
        return x, y, z

    @cached_property
    def formula(self) -> tuple[Expr, Expr, Expr]:
        """x, y, z of the end effector as formulas of time, of a motion by curves."""
        curves = self._motion.plan.curves
        if not curves:
            raise QuantityError("no formula of the hand", remedy="only curves: have one")
        plain = Symbol(TIME.name)
        joints = {Symbol(name): expression_to_sympy(value).subs(plain, TIME) for name, value in curves.items()}
        x, y, z = (entry.subs(joints, simultaneous=True) for entry in self.position)
        return x, y, z

    @cached_property
    def weights(self) -> tuple[Expr, ...]:
        """How far the hand goes when a joint alone moves by one: the length of each column of J (slide 27).

        Symbols of lengths are taken as positive.
        """
        model = KinematicModel(self._robot)
        columns, _ = model.jacobian_columns
        squares = (model.form.kinematic(dot(column, column)) for column in columns)
        return tuple(powdenest(sqrt(square), force=True) for square in squares)


def printed_hand(motion: Motion, *, as_latex: bool = False) -> Iterator[str]:
    """The curve of the hand as people write it."""
    yield ("% " if as_latex else "") + "hand"
    hand, plain = HandCurve(motion), Symbol(TIME.name)
    by_time = [hand.formula, [entry.diff(TIME) for entry in hand.formula]] if motion.plan.curves else [hand.position]
    for letter, entries in zip("pv", by_time, strict=False):
        for axis, entry in zip(AXES, entries, strict=True):
            value = entry.subs(TIME, plain)
            if value != 0:
                yield f"{letter}_{axis}(t) = {latex(value)}" if as_latex else f"  {letter}{axis} = {sstr(value)}"


def printed_weights(motion: Motion, *, as_latex: bool = False) -> Iterator[str]:
    """Which joint moves the hand most."""
    for joint, weight in zip(motion.plan.robot.joints, HandCurve(motion).weights, strict=True):
        if as_latex:
            yield f"\\lVert J_{{{latex(Symbol(joint.variable))}}} \\rVert = {latex(weight)}"
        else:
            yield f"{joint.variable} moves the hand by {sstr(weight)}"
