"""The registry of quantities: symbol, shape, unit and definition of whatever can be asked for by name."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from derive.errors import QuantityError, listed
from derive.lecture.sympy_conversion import Expr, Matrix, columns_matrix
from derive.mechanics.vectors import subtract
from derive.model.dynamic_model import DynamicModel
from derive.robot.reading.size_limits import FILE_LIMITS
from derive.robot.robot import Robot
from derive.robot.tree import require_chain

_BLOCKS = ("J_rows", "J_11", "J_11_reduced", "J_12", "J_21", "J_22")
_DETERMINANTS = ("detJ", "detJv", "detJxy", "detJ_11", "detJ_22", "detJ_rows")
OF_LOOPS = frozenset(("closure", "G", "H"))  # what only robots with closed loops have
# What a tree has not; nor has it what `DESCRIBED` describes.
OF_CHAINS = frozenset(("singularities", "manipulability", *_BLOCKS, *_DETERMINANTS))
# What a tree has for each of its ends; T only where no frame is named.
_POSES = ("T", "p", "R", "rpy", "euler_zyz", "inverse")
OF_ENDS = frozenset((*_POSES, "J", "J_end", "J_dot", "hessian", "J_rpy", "J_zyz", "Jv", "Jw", "Jxy"))
ANY = range(1, FILE_LIMITS.joints + 1)  # any number of joints


@dataclass(frozen=True)
class Quantity:
    """One row of the registry."""

    name: str  # as the user writes it
    symbol: str  # as notes write it, in LaTeX; i, j, k stand for its indices
    # ``6xn``: n joints, m = n - 3, k indices, p standard, b base parameters, s solutions, of loops l passive joints and
    # d pairs of variables; empty: scalar
    shape: str
    unit: str  # SI unit of its entries; empty where these differ or have none
    summary: str  # what it is, for lists
    indices: tuple[int, ...] = (0,)  # how many indices it takes (alternatives allowed); further ones pick an entry
    formula: Callable[..., Expr] | None = None  # of the model and the indices; by default its attribute or method
    joints: range = ANY  # for how many joints it is defined

    @property
    def function(self) -> str:
        """The generated function from whose result it follows at once; empty if none does."""
        return next((function for function, names in _OF_FUNCTIONS.items() if self.name in names), "")

    @property
    def words(self) -> tuple[str, ...]:
        """What books call it besides."""
        return _WORDS.get(self.name, ())

    @property
    def dynamic(self) -> bool:
        """Whether it needs links."""
        return self in _DYNAMIC

    @property
    def call(self) -> str:
        """Its name with its indices: ``christoffel[i,j,k]``."""
        letters = "i,..." if len(self.indices) > len("ijk") else ",".join("ijk"[: min(self.indices)])
        return f"{self.name}[{letters}]" if letters else self.name

    def shape_of(self, robot: Robot) -> str:
        """Its shape for a robot: ``6x2``; empty for a scalar."""
        sizes = {"n": robot.dof, "m": robot.dof - 3, "l": len(robot.passive), "d": robot.dof * (robot.dof + 1) // 2}
        return "".join(str(sizes.get(letter, letter)) for letter in self.shape)

    def is_of(self, robot: Robot) -> bool:
        """Whether a robot has it."""
        is_known = not (robot.is_tree and self.name in OF_CHAINS) and not (robot.coupled and self.name == "inverse")
        if self.name in OF_LOOPS or "base" in self.name:  # of passive joints there are derivatives, no base parameters
            is_known = bool(robot.passive) == (self.name in OF_LOOPS)
        return is_known and robot.dof in self.joints and (robot.has_dynamics or not self.dynamic)

    def value(self, model: DynamicModel, *indices: int) -> Expr:
        """The quantity of a model; of a tree with named ends that of each end."""
        if self.name in OF_CHAINS:
            require_chain(model.robot, self.name)
        if model.n not in self.joints:
            first, last = self.joints[0], self.joints[-1]
            count = f"{first}" if first == last else f"{first} or more" if last == ANY[-1] else f"{first} to {last}"
            found = f"{self.name} of {model.robot.name}, an arm of {model.n} joint{'s' * (model.n != 1)}"
            raise QuantityError(found, allowed=f"allowed: {count} joints")
        if self.formula is not None:
            return self.formula(model, *indices)
        found = getattr(model, self.name)
        return found(*indices) if indices else found


def _rows(model: DynamicModel, *rows: int) -> Matrix:
    if len(set(rows)) < len(rows) or not all(1 <= row <= 6 for row in rows):
        raise QuantityError(f"rows {listed(map(str, rows))} of J", allowed="allowed: different rows, from 1 to 6")
    return model.J.extract([row - 1 for row in rows], list(range(model.n)))


def _reduced_block(model: DynamicModel) -> Matrix:
    """J_11 with its second column subtracted from the first: the same determinant, shorter entries."""
    linear, _ = model.jacobian_columns
    first, second, *others = linear[:3]
    return columns_matrix([subtract(first, second), second, *others], write=model.form.kinematic)


def _rank(model: DynamicModel) -> Expr:
    found = model.singularities
    if found.determinant is None:
        what = f"one determinant that decides the rank of the {found.shape[0]}x{found.shape[1]} Jacobian"
        allowed = "allowed: arms of six joints, or with a task of as many coordinates as joints"
        raise QuantityError(f"{what} of {model.robot.name}", allowed=allowed, remedy="leave the point out")
    return found.determinant


_END = "end effector in the world; T[i] frame i there; T[i,j] frame j in frame i"
_DETERMINANT = "determinant of J; of fewer than six joints, of the rows that move, or of the position"
_DECIDES = "where J loses rank: its determinant for a task in factors, or the zeros of all minors"
_ROWS = "determinant of as many rows of J as joints, such as detJ_rows[1,2,6]"
_J_11, _J_12 = "rows 1-3, columns 1-3 of J", "rows 1-3, the other columns of J"
_J_21, _J_22 = "rows 4-6, columns 1-3 of J", "rows 4-6, the other columns of J"
_VOLUME = "manipulability sqrt(det(J J^T)), J of the task; |det J| if that is square"
_RPY, _ZYZ = "analytic Jacobian for roll, pitch, yaw", "analytic Jacobian for Euler ZYZ"
_DET_V, _DET_XY = "determinant of Jv of three joints", "determinant of Jxy of two joints"
_DET_11, _DET_22 = "determinant of J_11", "determinant of J_22 of six joints"
_REDUCED = "J_11, its second column subtracted from the first"
_VELOCITY = "velocity part of tau, C qd: Coriolis and centrifugal"
_FORCE = "N m or N"
_INVERSE = "inverse kinematics: every solution, how it is derived; entry i,k: joint i of solution k"
_CLOSURE = "how passive joints of closed loops follow from the variables, every branch"
_SLOPES = "first derivatives of the passive joints of closed loops, qd_p = G qd"
_BENDS = "their second derivatives, a column for each pair of variables"
_SIX = tuple(range(1, 7))
_BLOCK, _WRIST = range(3, ANY.stop), range(4, ANY.stop)

_KINEMATIC = (
    Quantity("A", r"\mathbf{A}_i^{i-1}", "4x4", "", "DH transform of row i", (1,)),
    Quantity(
        "T", r"\mathbf{T}", "4x4", "", _END, (0, 1, 2),
        lambda m, *of: m.transform(*of) if len(of) == 2 else m.frame(*of) if of else m.T,
    ),
    Quantity("p", r"\mathbf{p}", "3x1", "m", "position of the end effector"),
    Quantity("R", r"\mathbf{R}", "3x3", "", "orientation of the end effector"),
    Quantity("rpy", r"\boldsymbol{\phi}", "3x1", "rad", "roll, pitch, yaw"),
    Quantity("euler_zyz", r"\boldsymbol{\phi}", "3x1", "rad", "Euler angles ZYZ"),
    Quantity("J", r"\mathbf{J}", "6xn", "", "geometric Jacobian, world frame"),
    Quantity("J_end", r"\mathbf{J}^n", "6xn", "", "geometric Jacobian, end-effector frame"),
    Quantity("J_dot", r"\dot{\mathbf{J}}", "6xn", "", "rate of change of J, world frame"),
    Quantity("hessian", r"\partial \mathbf{J}/\partial q_i", "6xn", "", "derivative of J by q_i, world frame", (1,)),
    Quantity("J_rpy", r"\mathbf{J}_A", "6xn", "", _RPY, (0,), lambda m: m.J_analytic("rpy")),
    Quantity("J_zyz", r"\mathbf{J}_A", "6xn", "", _ZYZ, (0,), lambda m: m.J_analytic("zyz")),
    Quantity("Jv", r"\mathbf{J}_v", "3xn", "", "rows 1-3 of J: velocity", (0,), lambda m: m.J[:3, :]),
    Quantity("Jw", r"\mathbf{J}_\omega", "3xn", "", "rows 4-6 of J: angular velocity", (0,), lambda m: m.J[3:, :]),
    Quantity("Jxy", r"\mathbf{J}_{xy}", "2xn", "", "rows 1 and 2 of J", (0,), lambda m: m.J[:2, :]),
    Quantity("J_rows", r"\mathbf{J}_{i,\ldots}", "kxn", "", "rows i, ... of J, such as J_rows[1,2,6]", _SIX, _rows),
    Quantity("J_11", r"\mathbf{J}_{11}", "3x3", "", _J_11, (0,), lambda m: m.J[:3, :3], _BLOCK),
    Quantity("J_11_reduced", r"\mathbf{J}_{11}", "3x3", "", _REDUCED, (0,), _reduced_block, _BLOCK),
    Quantity("J_12", r"\mathbf{J}_{12}", "3xm", "", _J_12, (0,), lambda m: m.J[:3, 3:], _WRIST),
    Quantity("J_21", r"\mathbf{J}_{21}", "3x3", "", _J_21, (0,), lambda m: m.J[3:, :3], _BLOCK),
    Quantity("J_22", r"\mathbf{J}_{22}", "3xm", "", _J_22, (0,), lambda m: m.J[3:, 3:], _WRIST),
    Quantity("detJ", r"\det \mathbf{J}", "", "", _DETERMINANT, (0,), lambda m: m.det_J(), range(1, 7)),
    Quantity("detJv", r"\det \mathbf{J}_v", "", "", _DET_V, (0,), lambda m: m.det_J((1, 2, 3)), range(3, 4)),
    Quantity("detJxy", r"\det \mathbf{J}_{xy}", "", "", _DET_XY, (0,), lambda m: m.det_J((1, 2)), range(2, 3)),
    Quantity(
        "detJ_11", r"\det \mathbf{J}_{11}", "", "", _DET_11, (0,), lambda m: m.det_J((1, 2, 3), (1, 2, 3)), range(3, 8),
    ),
    Quantity(
        "detJ_22", r"\det \mathbf{J}_{22}", "", "", _DET_22, (0,), lambda m: m.det_J((4, 5, 6), (4, 5, 6)), range(6, 7),
    ),
    Quantity("detJ_rows", r"\det \mathbf{J}_{i,\ldots}", "", "", _ROWS, _SIX, lambda m, *of: m.det_J(of), range(1, 7)),
    Quantity("manipulability", "w", "", "", _VOLUME, joints=range(1, 8)),
    Quantity("singularities", r"\det \mathbf{J}", "", "", _DECIDES, (0,), _rank, range(2, ANY.stop)),
    Quantity("inverse", r"\mathbf{q}(\mathbf{T})", "nxs", "", _INVERSE),
    Quantity("closure", r"\mathbf{q}_p(\mathbf{q})", "lx1", "", _CLOSURE),
    Quantity("G", r"\partial \mathbf{q}_p/\partial \mathbf{q}", "lxn", "", _SLOPES, (0,), lambda m: m.closure.G),
    Quantity("H", r"\partial^2 \mathbf{q}_p/\partial \mathbf{q}^2", "lxd", "", _BENDS, (0,), lambda m: m.closure.H),
)  # fmt: skip

_DYNAMIC = (
    Quantity("Jv_com", r"\mathbf{J}_v^{l_i}", "3xn", "", "velocity of the centre of mass of link i", (1,)),
    Quantity("Jw_com", r"\mathbf{J}_w^{l_i}", "3xn", "", "angular velocity of link i", (1,)),
    Quantity("Jv_motor", r"\mathbf{J}_v^{m_i}", "3xn", "", "velocity of rotor i", (1,)),
    Quantity("Jw_motor", r"\mathbf{J}_w^{m_i}", "3xn", "", "angular velocity of rotor i", (1,)),
    Quantity("kinetic", r"\mathcal{T}", "", "J", "kinetic energy", (0,), lambda m: m.energy.kinetic),
    Quantity("potential", r"\mathcal{U}", "", "J", "potential energy", (0,), lambda m: m.energy.potential),
    Quantity("B", r"\mathbf{B}", "nxn", "", "inertia matrix"),
    Quantity("B_link", r"\mathbf{B}^{l_i}", "nxn", "", "part of B that link i contributes", (1,)),
    Quantity("Bdot", r"\dot{\mathbf{B}}", "nxn", "", "time derivative of B"),
    Quantity("christoffel", "c_{ijk}", "", "", "Christoffel symbol c_ijk", (3,)),
    Quantity("C", r"\mathbf{C}", "nxn", "", "Coriolis matrix"),
    Quantity("N", r"\mathbf{N}", "nxn", "", "Bdot - 2C"),
    Quantity("tau", r"\boldsymbol{\tau}", "nx1", _FORCE, "equations of motion: B_qdd + Cqd + g + friction"),
    Quantity("B_qdd", r"\mathbf{B}\ddot{\mathbf{q}}", "nx1", _FORCE, "inertial part of tau, B qdd"),
    Quantity("Cqd", r"\mathbf{C}\dot{\mathbf{q}}", "nx1", _FORCE, _VELOCITY, (0,), lambda m: m.coriolis_vector),
    Quantity("g", r"\mathbf{g}", "nx1", _FORCE, "gravity part of tau"),
    Quantity("friction", r"\boldsymbol{\tau}_f", "nx1", _FORCE, "friction part of tau"),
    Quantity("regressor", r"\mathbf{Y}", "nxp", "", "Y with tau = Y pi, standard parameters pi"),
    Quantity("standard_parameters", r"\boldsymbol{\pi}", "px1", "", "the standard parameters pi"),
    Quantity("regressor_base", r"\mathbf{Y}", "nxb", "", "Y with tau = Y beta"),
    Quantity("base_parameters", r"\boldsymbol{\beta}", "bx1", "", "the base parameters beta"),
)  # fmt: skip

# What books call them besides; case counts in one letter, spaces and signs never.
_WORDS: Mapping[str, tuple[str, ...]] = {
    "T": ("fkine", "fk", "forward kinematics", "direct kinematics", "pose", "transform", "frame", "H"),
    "p": ("position", "P"),
    "R": ("rotation", "orientation"),
    "rpy": ("roll pitch yaw", "euler angles"),
    "euler_zyz": ("zyz", "euler angles"),
    "J": ("jacobian", "jacob0"),
    "J_end": ("jacobe", "jacobian end", "end jacobian"),
    "J_dot": ("dJ/dt", "dot J", "jacobian dot"),
    "hessian": ("jacobian hessian", "dJ/dq", "hessian0"),
    "J_rpy": ("analytic jacobian", "J_analytic", "J_A"),
    "J_zyz": ("analytic jacobian", "J_analytic", "J_A"),
    "Jv": ("linear jacobian", "J_P"),
    "Jw": ("angular jacobian", "J_O", "Jomega"),
    "detJ": ("determinant", "determinant of J", "jacobian determinant"),
    "detJv": ("detJ_P",),
    "manipulability": ("yoshikawa", "manipulability measure", "manipulability index"),
    "singularities": ("singularity", "singular configurations"),
    "inverse": ("inverse kinematics", "ik", "ikine", "inverse solution", "inverse position"),
    "kinetic": ("kinetic energy", "energy", "K"),
    "potential": ("potential energy", "energy", "U", "P", "V"),
    "B": ("inertia", "inertia matrix", "mass matrix", "mass", "M", "D", "H", "b", "crba"),
    "Bdot": ("dB/dt", "Mdot", "dM/dt"),
    "christoffel": ("christoffel symbols", "c_ijk", "c", "h"),
    "C": ("coriolis", "coriolis matrix", "centrifugal matrix"),
    "N": ("Bdot - 2C", "Mdot - 2C", "skew"),
    "tau": ("torque", "torques", "inverse dynamics", "rne", "dynamics", "equations of motion", "newton-euler"),
    "B_qdd": ("M*qdd", "tau_inertia", "inertia torque", "inertial torques", "inertia vector"),
    "Cqd": ("coriolis vector", "tau_velocity", "velocity torques", "coriolis torques", "centrifugal torques", "V", "h"),
    "g": ("gravity", "gravity vector", "tau_gravity", "gravity torques", "gravload", "G"),
    "friction": ("tau_friction", "friction torques", "tau_f", "F"),
    "regressor": ("Y",),
    "standard_parameters": ("pi",),
    "regressor_base": ("base regressor", "Y"),
    "base_parameters": ("beta", "minimal parameters", "dynamic parameters"),
}
# By generated function the quantities that follow at once from its result.
_OF_FUNCTIONS = {
    "forward_kinematics": ("T", "p", "R"),
    "jacobian": ("J", "Jv", "Jw", "Jxy", "J_rows", "J_11", "J_12", "J_21", "J_22"),
    "jacobian_end": ("J_end",),
    "jacobian_dot": ("J_dot",),
    "jacobian_hessian": ("hessian",),
    "manipulability": ("manipulability",),
    "analytic_jacobian_rpy": ("J_rpy",),
    "analytic_jacobian_zyz": ("J_zyz",),
    "kinetic_energy": ("kinetic",),
    "potential_energy": ("potential",),
    "inertia_matrix": ("B",),
    "coriolis_matrix": ("christoffel", "C", "N"),
    "inverse_dynamics": ("tau",),
    "coriolis_vector": ("Cqd",),
    "gravity_vector": ("g",),
    "regressor": ("regressor",),
    "base_regressor": ("regressor_base",),
    "base_parameters": ("base_parameters",),
    "link_transforms": ("A",),
}
# Every quantity that can be asked for by name, in the order of lists.
REGISTRY = {quantity.name: quantity for quantity in (*_KINEMATIC, *_DYNAMIC)}
# What is described by sentences, and has no entries: attributes of the model.
DESCRIBED = {
    "workspace": "where the arm reaches, in formulas, if no joint has limits",
    "aspects": "sets of configurations without a singularity; whether the arm is cuspidal",
    "decoupling": "with which parameters B is diagonal, entry by entry and as a whole",
}
