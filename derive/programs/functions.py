"""The generated functions, one row each: what it takes and gives, and the ways to compute it."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import partial
from math import inf
from operator import attrgetter
from typing import Any

from derive.programs.formulations import dynamics, kinematics
from derive.programs.formulations.choice import Formulation
from derive.programs.formulations.trace import Trace
from derive.programs.optimise.search_policy import POLICY
from derive.programs.program import Column, Interface
from derive.robot.inertial_parameters import has_regressor
from derive.robot.robot import Robot
from derive.robot.task_rows import task_rows

_has_links = attrgetter("has_dynamics")
# What functions of arms with links have in common, what poses and Jacobians of ends, and what needs no search.
_OF_LINKS: dict[str, Any] = {"exists": _has_links, "margin": POLICY.dynamics_margin}
_OF_ENDS: dict[str, Any] = {"margin": POLICY.kinematics_margin, "of_end": True}
_UNSEARCHED: dict[str, Any] = {"margin": 1.0, "search": False, "of_end": True}


# Axes of a wrench, what the names of their functions end in, and the axes in words.
_WRENCHES = ((kinematics.WORLD, "", "world"), (kinematics.END, "_end", "end effector"))


@dataclass(frozen=True, slots=True, kw_only=True)
class FunctionRow:
    """A generated function."""

    interface: Interface  # what it takes and gives
    formulations: Callable[[Trace], Iterable[Formulation]]  # the ways to compute it, of which the cheapest is emitted
    exists: Callable[[Robot], bool] = lambda robot: True  # which robots have it
    # How many times the cheapest a formulation may cost as traced to be improved at all; None for all.
    margin: float | None = None
    search: bool = True  # whether a long search for shared parts pays
    most_improved: float = inf  # nodes above which it is emitted as traced
    columns: Callable[[Trace], tuple[Column, ...]] | None = None  # names of the columns of the result
    of_end: bool = False  # whether a tree has one for each of its ends
    is_optional: bool = False  # whether it is left out where it has no value in any configuration
    without_value: Callable[[Trace], Formulation] | None = None  # what stands for it there otherwise

    @property
    def may_lack_value(self) -> bool:
        """Whether there are robots that have no value of it in any configuration."""
        return self.is_optional or self.without_value is not None


def _row(
    what: tuple[str, tuple[int | str, ...]],
    summary: str,
    result: str,
    formulations: Callable[[Trace], Iterable[Formulation]],
    **options: Any,
) -> FunctionRow:
    """A row by a call of the function and its shape, ``("J = jacobian(q)", (6, "n"))``."""
    call, shape = what
    symbol, _, rest = call.partition(" = ")
    name, _, arguments = rest.removesuffix(")").partition("(")
    taken = tuple(arguments.split(", ")) if arguments else ()
    interface = Interface(name, taken, shape, symbol, summary, result)
    return FunctionRow(interface=interface, formulations=formulations, **options)


# In the order in which they are printed.
ROWS = (
    _row(
        ("T = forward_kinematics(q)", (4, 4)),
        "Pose of the end effector in the world frame.",
        "base A_1 ... A_n tool, a 4x4 homogeneous transform",
        kinematics.poses,
        **_OF_ENDS,
    ),
    _row(
        ("T_i = link_transforms(q)", ("r", 4, 4)),
        "Poses of the DH frames 1..n in the world frame.",
        "base A_1 ... A_i for i = 1..n, without the tool",
        kinematics.link_poses,
        margin=POLICY.kinematics_margin,
    ),
    _row(
        ("J = jacobian(q)", (6, "n")),
        "Geometric Jacobian at the end effector, in the world frame.",
        "rows: velocity of the end effector's origin [m/s], then angular velocity [rad/s], per unit of qd",
        kinematics.jacobians,
        **_OF_ENDS,
    ),
    _row(
        ("J_end = jacobian_end(q)", (6, "n")),
        "Geometric Jacobian at the end effector, in the end effector's axes.",
        "rows: velocity of the end effector's origin [m/s], then angular velocity [rad/s], per unit of qd",
        kinematics.end_jacobians,
        **_OF_ENDS,
    ),
    _row(
        ("dJ/dt = jacobian_dot(q, qd)", (6, "n")),
        "Rate of change of the geometric Jacobian, in the world frame.",
        "the acceleration of the end effector is J qdd + dJ/dt qd, linear rows first",
        kinematics.jacobian_rates,
        of_end=True,
    ),
    _row(
        ("H = jacobian_hessian(q)", (6, "n", "n")),
        "Derivatives of the geometric Jacobian with respect to q, in the world frame.",
        "entry r, i, j: d J_ri / d q_j; dJ/dt is H qd",
        kinematics.hessians,
        exists=lambda robot: robot.n <= POLICY.most_derivatives and not robot.loops,
        **_UNSEARCHED,
    ),
    *(
        _row(
            (f"J_A = analytic_jacobian_{kind}(q)", (6, "n")),
            f"Analytic Jacobian for {angles}.",
            f"rows: velocity of the end effector's origin [m/s], then rates of {rates} [rad/s], per unit of qd; no "
            f"finite numbers where {singular} = 0",
            partial(kinematics.analytic_jacobians, kind),
            is_optional=True,
            of_end=True,
        )
        for kind, angles, rates, singular in (
            ("rpy", "roll, pitch, yaw", "roll, pitch and yaw", "cos(pitch)"),
            ("zyz", "Euler angles ZYZ", "phi, theta and psi", "sin(theta)"),
        )
    ),
    _row(
        ("B = inertia_matrix(q)", ("n", "n")),
        "Inertia matrix, rotors and armatures included.",
        "symmetric; kinetic energy is qd^T B qd / 2",
        dynamics.inertia_matrices,
        **_OF_LINKS,
    ),
    _row(
        ("C = coriolis_matrix(q, qd)", ("n", "n")),
        "Coriolis and centrifugal matrix in Christoffel form.",
        "C qd is the velocity torque, and dB/dt = C + C^T",
        dynamics.coriolis_matrices,
        **_OF_LINKS,
    ),
    _row(
        ("g = gravity_vector(q)", ("n",)),
        "Torques that hold the arm against gravity.",
        "dU/dq, U the potential energy",
        dynamics.gravity_vectors,
        **_OF_LINKS,
    ),
    _row(
        ("T = kinetic_energy(q, qd)", ()),
        "Kinetic energy, rotors and armatures included.",
        "qd^T B qd / 2 [J]",
        dynamics.kinetic_energies,
        **_OF_LINKS,
    ),
    _row(
        ("U = potential_energy(q)", ()),
        "Potential energy of links and rotors in the field of gravity.",
        "the sum of -m g . p [J], which is zero at the origin of the world frame",
        dynamics.potential_energies,
        **_OF_LINKS,
    ),
    _row(
        ("tau = inverse_dynamics(q, qd, qdd)", ("n",)),
        "Joint torques and forces of a motion, friction included.",
        "B qdd + C qd + g + viscous*qd + coulomb*sign(qd)",
        dynamics.torques,
        **_OF_LINKS,
    ),
    _row(
        ("qdd = forward_dynamics(q, qd, tau)", ("n",)),
        "Joint accelerations under given torques and forces.",
        "solution of tau = B qdd + C qd + g + friction",
        dynamics.accelerations,
        exists=_has_links,
        without_value=dynamics.no_accelerations,
    ),
    _row(
        ("c = coriolis_vector(q, qd)", ("n",)),
        "Coriolis and centrifugal torques.",
        "C qd, quadratic in qd",
        dynamics.coriolis_vectors,
        exists=_has_links,
    ),
    _row(
        ("dtau/dq = inverse_dynamics_dq(q, qd, qdd)", ("n", "n")),
        "Derivatives of the joint torques with respect to q.",
        "row i, column j: d tau_i / d q_j at constant qd and qdd",
        dynamics.torque_position_derivatives,
        exists=lambda robot: robot.has_dynamics and not robot.loops,
    ),
    _row(
        ("dtau/dqd = inverse_dynamics_dqd(q, qd)", ("n", "n")),
        "Derivatives of the joint torques with respect to qd.",
        "2 C + viscous friction on the diagonal; Coulomb friction counts as constant",
        dynamics.torque_velocity_derivatives,
        exists=lambda robot: robot.has_dynamics and not robot.loops,
    ),
    _row(
        ("Y = regressor(q, qd, qdd)", ("n", "p")),
        "Regressor: tau = Y pi for the standard parameters pi, friction included.",
        "a column for each of STANDARD_PARAMETERS; links' parameters in DH frames, inertia about the frame's origin",
        dynamics.regressors,
        exists=has_regressor,
        columns=dynamics.standard_columns,
        search=False,  # its entries share little beyond what the recursion shares
    ),
    _row(
        ("Y_b = base_regressor(q, qd, qdd)", ("n", "p")),
        "Base regressor: tau = Y_b beta, of full column rank over all motions, friction included.",
        "a column for each of BASE_PARAMETERS, the torques that one unit of it in its joint frame takes",
        dynamics.base_regressors,
        exists=has_regressor,
        columns=dynamics.base_columns,
        search=False,
    ),
    _row(
        ("beta = base_parameters()", ("p",)),
        "Base parameters: the fewest combinations of inertial parameters that determine the torques.",
        "one for each of BASE_PARAMETERS; inverse_dynamics is base_regressor @ beta",
        dynamics.base_parameters,
        exists=has_regressor,
        columns=dynamics.base_columns,
    ),
    # Last, so that what is traced before does not depend on them.
    *(
        _row(
            (f"w = manipulability{'_' * (part != 'all')}{part.removeprefix('all')}(q)", ()),
            f"Manipulability of the {what}.",
            "volume to which J takes unit rates: sqrt(det(J J^T)), |det J| if square",
            partial(kinematics.manipulabilities, part),
            exists=lambda robot: robot.n <= POLICY.most_derivatives and not robot.coupled,
            **_UNSEARCHED,
        )
        for part, what in (("all", "task"), ("position", "position"), ("orientation", "orientation"))
    ),
    _row(
        ("dw/dq = manipulability_dq(q)", ("n",)),
        "Gradient of the manipulability of the task.",
        "d w / d q_j; where w = 0 of an oblong J no finite numbers",
        kinematics.manipulability_gradients,
        exists=lambda robot: robot.n <= POLICY.most_derivatives and not robot.coupled,
        **_UNSEARCHED,
    ),
    *(
        row
        for frame, suffix, axes in _WRENCHES
        for row in (
            _row(
                (f"tau_h = wrench_torques{suffix}(q, h)", ("n",)),
                f"Torques and forces by which joints feel a wrench in the axes of the {axes}.",
                "J^T h; under it the joints' own torques are B qdd + C qd + g + friction - J^T h",
                partial(kinematics.wrench_torques, frame),
                search=False,
                **_OF_ENDS,
            ),
            _row(
                (f"dtau_h/dq = wrench_torques{suffix}_dq(q, h)", ("n", "n")),
                f"Derivatives of wrench_torques{suffix} with respect to q.",
                f"row i, column j: d tau_h_i / d q_j at a constant wrench in the axes of the {axes}",
                partial(kinematics.wrench_torque_derivatives, frame),
                exists=lambda robot: robot.has_dynamics and robot.n <= POLICY.most_derivatives and not robot.loops,
                **_UNSEARCHED,
            ),
        )
    ),
    _row(
        ("Lambda = task_inertia(q)", ("m", "m")),
        "Inertia that a force on the end effector meets in the task.",
        "(J B^-1 J^T)^-1 of the task's rows, symmetric; no finite numbers where these lose rank",
        dynamics.task_inertias,
        exists=lambda robot: (
            robot.has_dynamics and not robot.is_tree and len(task_rows(robot)) <= robot.n <= POLICY.most_derivatives
        ),
        search=False,
        most_improved=POLICY.most_eliminated,
        without_value=dynamics.no_task_inertia,
    ),
    *(
        row
        for frame, suffix, axes in _WRENCHES
        for row in (
            _row(
                (f"tau = inverse_dynamics_wrench{suffix}(q, qd, qdd, h)", ("n",)),
                f"Joint torques and forces of a motion under a wrench in the axes of the {axes}.",
                "B qdd + C qd + g + viscous*qd + coulomb*sign(qd) - J^T h",
                partial(dynamics.torques_under_wrench, frame),
                exists=lambda robot, frame=frame: frame in robot.wrench,
                margin=POLICY.dynamics_margin,
            ),
            _row(
                (f"qdd = forward_dynamics_wrench{suffix}(q, qd, tau, h)", ("n",)),
                f"Joint accelerations under given torques, forces and a wrench in the axes of the {axes}.",
                "solution of tau = B qdd + C qd + g + friction - J^T h",
                partial(dynamics.accelerations_under_wrench, frame),
                exists=lambda robot, frame=frame: frame in robot.wrench,
                without_value=dynamics.no_accelerations,
            ),
            _row(
                (f"dtau/dq = inverse_dynamics_wrench{suffix}_dq(q, qd, qdd, h)", ("n", "n")),
                f"Derivatives of inverse_dynamics_wrench{suffix} with respect to q.",
                f"row i, column j: d tau_i / d q_j at constant qd, qdd and h, h in the axes of the {axes}",
                partial(dynamics.slopes_under_wrench, frame),
                exists=lambda robot, frame=frame: frame in robot.wrench and robot.n <= POLICY.most_derivatives,
            ),
        )
    ),
    _row(
        ("q_p = passive_positions(q)", ("u",)),
        "Variables of the passive joints of closed loops.",
        "of each passive joint [rad, m], angles in (-pi, pi]; no numbers where a loop does not close",
        kinematics.passive_positions,
        exists=lambda robot: bool(robot.passive),
    ),
)
INTERFACES: Mapping[str, Interface] = {row.interface.name: row.interface for row in ROWS}
