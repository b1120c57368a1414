"""Quantities that the registry lacks: motion, forces and energies of single links, rates, angles from one direction."""

import re
from contextlib import suppress
from itertools import combinations, product
from typing import Any

import sympy

from derive.errors import CheckError, QuantityError
from derive.lecture.sympy_conversion import Expr, Matrix, expression_from_sympy, expression_to_sympy
from derive.model.model import Model
from derive.model.quantity_names import of_one_end, parse
from derive.robot import tree
from derive.robot.description import Convention, derivatives
from derive.robot.expression import ZERO, Call
from derive.robot.names import acceleration_name, velocity_name
from derive.robot.robot import Robot

# A function of the difference of two angles, or a name for it, without which no inertia has angles from one direction.
_DIFFERENCE = re.compile(r"(?:(?:sin|cos)\s*(?:\\left)?|[A-Za-z}]\s*=)[\s({]*\\?([A-Za-z]+)_\{?\w+\}?\s*-\s*\\?\1_")


class ModelOfOneEnd(Model):
    """A model of a tree whose quantities of the end effector are those of its only end."""

    def quantity(self, name: str) -> Expr:
        """A quantity by its name; QuantityError where it asks for an end and does not say for which of several."""
        return super().quantity(of_one_end(self, name))


class AbsoluteModel(Model):
    """A model whose joint variables are angles from one direction, as those of a double pendulum from the vertical.

    With theta the angles of the text and q the joint variables, q = A theta: in a run of revolute joints with parallel
    axes q_k = theta_k - theta_{k-1}. So J becomes J A, torques A' tau, and B becomes A' B A.
    """

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
        return any(self._meanings.get(symbol, symbol) != symbol for symbol in value.free_symbols)

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


# Of a link in the axes of a frame, by Newton and Euler; accelerations count gravity as one of the base, or do not.
OF_LINK = (
    "omega", "alpha", "velocity", "acceleration", "acceleration_com", "still_acceleration", "still_acceleration_com",
    "inertial_force", "inertial_moment", "joint_force", "joint_moment",
)  # fmt: skip
OF_VELOCITIES = ("bias", "centrifugal", "coriolis")
# Besides ``p[i]-p[k]``, the way between the origins of two frames, and energies of one link.
OWN = (
    *OF_LINK,
    *("twist", "rates", "accelerations", "centre", "lagrangian", "gravity", "task", "centre_task", "base", "tool"),
    *("end", "J_at", "in_plane", "J_space", "screw", "body_screw", "momentum", "tensor"),
    *(STATICS := tuple(f"statics{kind}{axes}" for kind in ("", "_force", "_moment") for axes in ("", "_end"))),
    *OF_VELOCITIES,
)
_OF_TREES = ("twist", "rates", "accelerations", "centre", "lagrangian", "gravity", "base", "momentum")
WRENCH = ("F_x", "F_y", "F_z", "M_x", "M_y", "M_z")


def force_named(word: str) -> str:
    """The coordinate of a force or a moment on the end effector that a printed name is; empty where it is none."""
    match = re.fullmatch("([fFMN])_?([xyz])", word)
    return f"{'F' if match[1] in 'fF' else 'M'}_{match[2]}" if match else ""


def written(model: Model, e: Expr) -> Expr:
    """A sum of products as the model would write it; as it stands where it has names or angles that poses do not."""
    with suppress(KeyError):
        return model.form.determinant(model.domain.constant(expression_from_sympy(e)))
    return e


def own_quantity(model: Model, name: str) -> Expr | Matrix | None:
    """A quantity by its name, in the world; None where it is one of the registry."""
    robot, places = model.robot, list(map(int, re.findall("[0-9]+", name)))
    kind = name.partition("[")[0]
    if kind in ("tool", "end") and robot.is_tree and tree.is_row_by_row(robot):  # its rows without motion are the tool
        return model.quantity(f"T[{places[0] if places else model.n},{model.n + len(robot.fixed)}]")
    if robot.is_tree and kind in OWN and kind not in _OF_TREES:
        raise QuantityError(f"{kind} of {robot.name}, whose table is a tree", allowed="allowed: robots of one chain")
    has_jacobian = kind == "twist" or not robot.is_tree
    rates, jacobian = sympy.Matrix(model.qd), sympy.Matrix(model.quantity("J") if has_jacobian else [])
    match kind, places:
        case (("twist" | "momentum"), _):  # p of Hamilton's equations, the derivatives of L by the velocities
            return (jacobian if kind == "twist" else sympy.Matrix(model.quantity("B"))) * rates
        case (("rates" | "accelerations"), _):
            return rates if kind == "rates" else sympy.Matrix(model.qdd)
        case (kind, [link, frame]) if kind in OF_LINK:
            if (link == 0 and kind in ("omega", "alpha")) or (link > model.n and kind.startswith("joint")):
                return sympy.zeros(3, 1)  # of the base, and of the end effector that nothing holds
            of_link = _of_link(model, kind, link)
            return model.frame(frame)[:3, :3].T * of_link if frame else of_link
        case "tensor", [link, *base]:  # of inertia about the centre of mass, in the axes of the link or of the base
            return _tensor(model, link, in_base=bool(base))
        case "J_at", [frame]:  # of the origin of a frame
            return sympy.Matrix(model.frame(frame)[:3, 3]).jacobian(model.q).col_join(jacobian[3:, :])
        case "J_space", _:  # of the point of the end effector that is at the origin (Lynch and Park, section 5.1.1)
            end = sympy.Matrix(model.quantity("T")[:3, 3])
            columns = [jacobian[:3, k] + end.cross(jacobian[3:, k]) for k in range(model.n)]
            return sympy.Matrix.hstack(*columns).applyfunc(lambda e: written(model, e)).col_join(jacobian[3:, :])
        case (kind, _) if kind in STATICS:
            return _held(model, name, *places)
        case (("screw" | "body_screw"), [joint]):  # of a joint in the home position
            whole = own_quantity(model, "J_space") if name[0] == "s" else model.quantity("J_end")
            return sympy.Matrix(whole)[:, joint - 1].subs(dict.fromkeys(model.q, 0))
        case "end", [frame]:  # the end effector seen from a frame
            last = model.quantity(f"T[{frame},{model.n}]")
            return last * own_quantity(model, "tool") if robot.tool else last
        case (("base" | "tool"), _):
            cells = robot.base if name == "base" else robot.tool
            return sympy.Matrix([[expression_to_sympy(cell) for cell in row] for row in cells or ()])
        case (("task" | "centre_task"), _):
            return _coordinates(model, places)
        case "in_plane", _:  # homogeneous, (x, y, 1)
            return sympy.Matrix([*model.quantity("T")[:2, 3], 1])
        case "gravity", _:
            return sympy.Matrix([expression_to_sympy(cell) for cell in robot.gravity or ()])
        case "centre", [link]:
            return (model.frame(link) * _centre(robot, link))[:3, :]
        case "centre", [link, frame]:  # from a frame, in its axes
            return (model.quantity(f"T[{frame},{link}]") * _centre(robot, link))[:3, :]
        case "p", [end, start] if "-" in name:
            return model.frame(end)[:3, 3] - model.frame(start)[:3, 3]
    return _energy(model, kind, places)


def _coordinates(model: Model, places: list[int]) -> Matrix:
    """x, y and the angle of a planar arm, or of the centre of mass of one of its links."""
    if places:
        jacobian = sympy.Matrix(model.quantity("J"))
        turning, point = jacobian[3:, : places[0]], sympy.Matrix(own_quantity(model, f"centre[{places[0]}]"))
        if any(turning[:2, :]):
            raise QuantityError("the angle of an arm that is not planar")
        return sympy.Matrix([point[0], point[1], (turning[2, :] * sympy.Matrix(model.q[: places[0]]))[0, 0]])
    first = expression_from_sympy(model.quantity("T")[0, 0])
    if not (isinstance(first, Call) and first.function == "cos"):
        raise QuantityError("the angle of an arm that is not planar")
    return sympy.Matrix([*model.quantity("T")[:2, 3], expression_to_sympy(first.arguments[0])])


def _energy(model: Model, kind: str, places: list[int]) -> Expr | Matrix | None:
    """The Lagrangian, the energies of one link, and torques of velocities."""
    robot, rates = model.robot, sympy.Matrix(model.qd)
    match kind, places:
        case "bias", _:  # all of the torques but those of accelerations
            return model.quantity("Cqd") + (model.quantity("g") if robot.gravity else sympy.zeros(model.n, 1))
        case (("centrifugal" | "coriolis"), _):  # what stands before qd_j^2 and qd_j qd_k (Craig, section 6.9)
            pairs = combinations(rates, 2) if kind == "coriolis" else ((rate, rate) for rate in rates)
            columns = [model.quantity("Cqd").diff(a, b) / (1 + (a == b)) for a, b in pairs]
            return sympy.Matrix.hstack(*columns).applyfunc(lambda e: written(model, e))
        case "lagrangian", _:
            return model.quantity("kinetic") - (model.quantity("potential") if robot.gravity else 0)
        case "kinetic", [link]:  # qd' B_i qd / 2
            return (rates.T * model.quantity(f"B_link[{link}]") * rates)[0, 0] / 2
        case "potential", [link]:  # -m_i g' p_i
            gravity = sympy.Matrix([*map(expression_to_sympy, robot.gravity or (ZERO,) * 3), 0])
            height = (gravity.T * model.quantity(f"T[0,{link}]") * _centre(robot, link))[0, 0]
            return -expression_to_sympy(robot.links[link - 1].mass) * height
    return None


def _of_link(model: Model, kind: str, link: int) -> Matrix:
    """Motion of a link, in the base; the link behind the last one is the end effector (Craig, section 6.5)."""
    robot, moving = model.robot, min(link, model.n)
    if kind.startswith(("inertial", "joint")):
        return _force_on_link(model, kind, link)
    if kind in ("omega", "alpha"):  # the sum over the joints before it
        turn = turning(model)
        rates = turn * sympy.Matrix(model.qd)
        omega = (sympy.Matrix(model.quantity("J"))[3:, :] * turn.inv())[:, :moving] * rates[:moving, :]
        return omega if kind == "omega" else slope(robot, omega, "t")
    frame = model.quantity("T") if link > model.n else model.frame(link)
    place = own_quantity(model, f"centre[{link}]") if kind.endswith("_com") else frame[:3, 3]
    velocity = slope(robot, place, "t")
    if kind == "velocity":
        return velocity
    is_still = kind.startswith("still") or robot.gravity is None
    gravity = sympy.zeros(3, 1) if is_still else own_quantity(model, "gravity")
    return slope(robot, velocity, "t") - gravity


def _force_on_link(model: Model, kind: str, link: int) -> Matrix:
    """What moves a link, or what the link before exerts on it, in the base."""
    robot = model.robot
    if kind == "inertial_force":  # F = m a_C, with gravity in a_C
        return expression_to_sympy(robot.links[link - 1].mass) * _of_link(model, "acceleration_com", link)
    if kind == "inertial_moment":  # N = I alpha + omega x I omega
        inertia = _tensor(model, link, in_base=True)
        omega = _of_link(model, "omega", link)
        return inertia * _of_link(model, "alpha", link) + omega.cross(inertia * omega)
    # at the frame of its joint: the sums of F, and of N + r x F, over the links from it on
    joint = model.frame(link - (robot.convention is not Convention.MODIFIED))[:3, 3]
    total = sympy.zeros(3, 1)
    for k in range(link, model.n + 1):
        force = _force_on_link(model, "inertial_force", k)
        arm = sympy.Matrix(own_quantity(model, f"centre[{k}]")) - joint
        total += force if kind == "joint_force" else _force_on_link(model, "inertial_moment", k) + arm.cross(force)
    return total


def _tensor(model: Model, link: int, *, in_base: bool) -> Matrix:
    inertia, turn = model.robot.links[link - 1].inertia, model.frame(link)[:3, :3]
    cells = [expression_to_sympy(getattr(inertia, min(i + j, j + i))) for i in "xyz" for j in "xyz"]
    tensor = sympy.Matrix(3, 3, cells)
    return turn * tensor * turn.T if in_base else tensor


def _held(model: Model, name: str, link: int = 0, frame: int = 0) -> Matrix:
    """J^T F of what the text names, or how the link before holds one, in the axes of a frame (Craig, section 5.9)."""
    wrench = sympy.Matrix([sympy.Symbol(force) if force in name else 0 for force in WRENCH])
    if not link:
        return sympy.Matrix(model.quantity("J_end" if "_end" in name else "J")).T * wrench
    end, joint = sympy.Matrix(model.quantity("T")), link - (model.robot.convention is not Convention.MODIFIED)
    axes = end[:3, :3] if "_end" in name else sympy.eye(3)
    push, turn = axes * wrench[:3, :], axes * wrench[3:, :]
    arm = end[:3, 3] - (model.frame(joint)[:3, 3] if link <= model.n else end[:3, 3])
    value = push if "force" in name else turn + arm.cross(push)
    return (end if frame > model.n else sympy.Matrix(model.frame(frame)))[:3, :3].T * value


def _centre(robot: Robot, link: int) -> Matrix:
    """The centre of mass of a link in its frame, homogeneous."""
    return sympy.Matrix([*map(expression_to_sympy, robot.links[link - 1].com), 1])


def slope(robot: Robot, value: Expr | Matrix, by: str) -> Any:
    """The derivative by a variable, a velocity, or "t" with accelerations; by "q" or "qd" a column of all."""
    joints = [joint.variable for joint in robot.movers]
    if robot.passive and (by != "t" or any(value.has(sympy.Symbol(n.name)) for n in derivatives(robot).values())):
        raise CheckError("derivative along a closed loop", allowed="allowed: G and H, and what they are part of")
    if by in ("q", "qd") and by not in joints:
        moving = joints if by == "q" else map(velocity_name, joints)
        return sympy.Matrix([value[0, 0].diff(sympy.Symbol(name)) for name in moving])
    if by != "t":
        return value.diff(sympy.Symbol(by))
    rates = {q: velocity_name(q) for q in joints} | {velocity_name(q): acceleration_name(q) for q in joints}
    return sum((value.diff(sympy.Symbol(name)) * sympy.Symbol(rate) for name, rate in rates.items()), 0 * value)
