"""What the generated functions are, in words, for every target that documents them."""

from __future__ import annotations

from dataclasses import dataclass

from derive.programs.program import Function, Program
from derive.programs.tape.tape import Operations
from derive.robot.robot import Robot


@dataclass(frozen=True, slots=True)
class Wording:
    """A function in words.

    Attributes:
        symbol: How the notes write its result.
        summary: One line.
        result: What the entries of the result are.
    """

    symbol: str
    summary: str
    result: str


WORDING = {
    "forward_kinematics": Wording(
        "T", "Pose of the end effector in the world frame.", "base A_1 ... A_n tool, a 4x4 homogeneous transform"
    ),
    "link_transforms": Wording(
        "T_i", "Poses of the DH frames 1..n in the world frame.", "base A_1 ... A_i for i = 1..n, without the tool"
    ),
    "jacobian": Wording(
        "J",
        "Geometric Jacobian at the end effector, in the world frame.",
        "rows: velocity of the end effector's origin [m/s], then angular velocity [rad/s], per unit of qd",
    ),
    "jacobian_dot": Wording(
        "dJ/dt",
        "Rate of change of the geometric Jacobian, in the world frame.",
        "the acceleration of the end effector is J qdd + dJ/dt qd, linear rows first",
    ),
    "analytic_jacobian_rpy": Wording(
        "J_A",
        "Analytic Jacobian for roll, pitch, yaw.",
        "rows: velocity of the end effector's origin [m/s], then rates of roll, pitch and yaw [rad/s], per unit of qd; "
        "no finite numbers where cos(pitch) = 0",
    ),
    "analytic_jacobian_zyz": Wording(
        "J_A",
        "Analytic Jacobian for Euler angles ZYZ.",
        "rows: velocity of the end effector's origin [m/s], then rates of phi, theta and psi [rad/s], per unit of qd; "
        "no finite numbers where sin(theta) = 0",
    ),
    "inertia_matrix": Wording(
        "B", "Inertia matrix, rotors and armatures included.", "symmetric; kinetic energy is qd^T B qd / 2"
    ),
    "coriolis_matrix": Wording(
        "C", "Coriolis and centrifugal matrix in Christoffel form.", "C qd is the velocity torque, and dB/dt = C + C^T"
    ),
    "gravity_vector": Wording("g", "Torques that hold the arm against gravity.", "dU/dq, U the potential energy"),
    "inverse_dynamics": Wording(
        "tau",
        "Joint torques and forces of a motion, friction included.",
        "B qdd + C qd + g + viscous*qd + coulomb*sign(qd)",
    ),
    "forward_dynamics": Wording(
        "qdd", "Joint accelerations under given torques and forces.", "solution of tau = B qdd + C qd + g + friction"
    ),
    "coriolis_vector": Wording("c", "Coriolis and centrifugal torques.", "C qd, quadratic in qd"),
    "inverse_dynamics_dq": Wording(
        "dtau/dq",
        "Derivatives of the joint torques with respect to q.",
        "row i, column j: d tau_i / d q_j at constant qd and qdd",
    ),
    "inverse_dynamics_dqd": Wording(
        "dtau/dqd",
        "Derivatives of the joint torques with respect to qd.",
        "2 C + viscous friction on the diagonal; Coulomb friction counts as constant",
    ),
    "regressor": Wording(
        "Y",
        "Regressor: tau = Y pi for the standard parameters pi, friction included.",
        "a column for each of STANDARD_PARAMETERS; links' parameters in DH frames, inertia about the frame's origin",
    ),
    "base_regressor": Wording(
        "Y_b",
        "Base regressor: tau = Y_b beta, of full column rank over all motions, friction included.",
        "a column for each of BASE_PARAMETERS, the torques that one unit of it in its joint frame takes",
    ),
    "base_parameters": Wording(
        "beta",
        "Base parameters: the fewest combinations of inertial parameters that determine the torques.",
        "one for each of BASE_PARAMETERS; inverse_dynamics is base_regressor @ beta",
    ),
}

ARGUMENTS = {
    "q": "joint variables [rad, m]",
    "qd": "joint velocities [rad/s, m/s]",
    "qdd": "joint accelerations [rad/s^2, m/s^2]",
    "tau": "joint torques and forces [N m, N]",
}


def cost_text(operations: Operations) -> str:
    """``301 mul, 240 add, 5 sin, 5 cos``; what does not occur is left out."""
    parts = [f"{count} {name}" for name, count in operations.as_dict().items() if count]
    return ", ".join(parts) or "no operations"


def operations_of(program: Program) -> dict[str, dict[str, int]]:
    """Counts for the manifest, by function."""
    return {function.name: function.operations.as_dict() for function in program}


def hoisted_operations_of(program: Program) -> dict[str, dict[str, int]]:
    """Counts of the work on run-time parameters alone, by function."""
    return {function.name: function.hoisted_operations.as_dict() for function in program}


def function_notes(function: Function) -> tuple[str, ...]:
    """Formulation and cost, for a docstring."""
    lines = [f"{function.formulation[0].upper()}{function.formulation[1:]}: {cost_text(function.operations)}."]
    if function.hoisted_operations.total:
        lines.append(f"Once per set of parameters: {cost_text(function.hoisted_operations)}.")
    return tuple(lines)


def joint_lines(robot: Robot) -> tuple[str, ...]:
    """One line per joint: place, name, type and unit."""
    return tuple(
        f"{i + 1}: {joint.variable}, {joint.type.value} [{'rad' if joint.is_revolute else 'm'}]"
        for i, joint in enumerate(robot.joints)
    )
