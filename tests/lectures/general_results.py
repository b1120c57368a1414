"""General formulas of Lagrange and Newton-Euler that are printed, each written out and compared."""

import random
from collections.abc import Callable, Iterator, Mapping
from functools import cache
from itertools import product
from typing import Any

import numpy as np
import sympy

from derive.checking.methods_file import SETS
from derive.lecture.sympy_conversion import expression_from_sympy, expression_to_sympy
from derive.mechanics.floats import FloatDomain
from derive.mechanics.printed_newton_euler import LinkStep, PrintedRecursion
from derive.model.equality import compare
from derive.model.model import Model
from derive.robot.description import Motor
from derive.robot.robot import Robot
from tests.lectures.results import Result, document, is_counted

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
    qd, qdd = sympy.Matrix(model.qd), sympy.Matrix(model.qdd)
    return same(model, model.tau, sympy.Matrix(model.B) * qdd + sympy.Matrix(model.C) * qd + sympy.Matrix(model.g))


ALL = (jacobian_column, jacobian_rotor, inertia, christoffel, skew, potential, equation)
FORMULAS: Mapping[str, Callable[[Model], bool]] = {formula.__name__: formula for formula in ALL}

METHODS = document("methods.yaml")
Values = dict[str, Any]


@cache
def method_results(name: str) -> tuple[Result, ...]:
    return tuple(_equation(name, item) for item in METHODS[name])


def _equation(name: str, item: Mapping[str, Any]) -> Result:
    correct = item.get("correct")
    holds, corrected = (None if text is None else _holds(name, item, text) for text in (item["printed"], correct))
    place = f"{name} {item['id']} {item['joint']}"
    return Result(place, place, item["status"] == "ok", holds, corrected, is_counted(item))


def variants(name: str) -> Iterator[tuple[str, bool]]:
    """Each single slip of an equation with two, and whether it would still hold."""
    for item in METHODS[name]:
        for text in item.get("variants", ()):
            yield f"{name} {item['id']}: {text}", _holds(name, item, text)


def _holds(name: str, item: Mapping[str, Any], text: str) -> bool:
    cases = [values for values in known_values(name) if item["joint"] in ("any", values["joint"])]
    assert cases
    known, right = {"__builtins__": {}, "cross": np.cross}, item["result"]  # the text is in Python's notation
    return all(np.allclose(eval(text, known, case), case["result"][right], atol=1e-10) for case in cases)


@cache
def known_values(name: str) -> tuple[Values, ...]:
    """For every link of the arms, the names of the equations of one set and what they stand for."""
    recursions = [recursion_of(name, robot) for robot in arms()]
    return tuple(_values(each.links, i) for each in recursions for i in range(len(each.links)))


def _values(links: tuple[LinkStep[float], ...], i: int) -> Values:
    step = links[i]
    data, previous, motion = step.data, step.previous, step.motion
    rotation, before = np.array(data.rotation), np.array(data.before)
    after = np.array(links[i + 1].data.before).T if i + 1 < len(links) else np.eye(3)
    z0 = np.array([0.0, 0.0, 1.0])
    found = {"w": motion.w, "wd": motion.wd, "vd": motion.vd, "a": step.a, "F": step.F, "N": step.N}
    found |= {"f": step.wrench.f, "n": step.wrench.n, "tau": step.tau}
    known = {"w_prev": previous.w, "wd_prev": previous.wd, "vd_prev": previous.vd, "v_prev": previous.v}
    known |= {"v": motion.v, "p": data.p, "s": data.s, "m": data.mass, "I": data.inertia, "b": data.viscous}
    known |= {"qd": data.qd, "qdd": data.qdd, "f_next": step.following.f, "n_next": step.following.n}
    frames = {"Rp": before, "Rn": after, "R0": rotation.T, "z0": z0, "z_prev": rotation @ before @ z0}
    arrays = {key: np.array(value) for key, value in {**found, **known}.items()}
    kind = "revolute" if data.revolute else "prismatic"
    result = {key: arrays[key] for key in found}
    return {**arrays, **frames, "p_in_next": after.T @ arrays["p"], "joint": kind, "result": result}


def recursion_of(name: str, robot: Robot) -> PrintedRecursion[float]:
    rng = random.Random(robot.name)
    q, qd, qdd = ([rng.uniform(-1.5, 1.5) for _ in range(robot.n)] for _ in range(3))
    return SETS[name](robot, FloatDomain(robot, q), qd, qdd)


@cache
def arms() -> tuple[Robot, ...]:
    return arm("rpr", 1), arm("rrp", 2), arm("prrpr", 3)


def arm(types: str, seed: int) -> Robot:
    """A numeric arm with odd twists, full inertia tensors and viscous friction."""
    rng = random.Random(seed)

    def cell(scale: float = 1.0) -> float:
        return round(rng.uniform(0.2, 1.2) * scale, 3)

    lines = [f"name: arm-{types}", "convention: standard", "joints:"]
    for letter in types:
        own = {"r": "d", "p": "theta"}[letter]
        kind = {"r": "revolute", "p": "prismatic"}[letter]
        lines.append(f"  - {{type: {kind}, {own}: {cell()}, a: {cell()}, alpha: {cell()}}}")
    lines += ["gravity: [0, 0, -9.8062]", "links:"]
    for _ in types:
        moments = ", ".join(f"{axes}: {2 + cell()}" for axes in ("xx", "yy", "zz"))
        tensor = moments + "".join(f", {axes}: {cell(0.1)}" for axes in ("xy", "xz", "yz"))
        body = f"mass: {cell()}, com: [{cell()}, {cell()}, {cell()}], inertia: {{{tensor}}}"
        lines.append(f"  - {{{body}, friction: {{viscous: {cell()}}}}}")
    return Robot.from_text("\n".join(lines) + "\n")
