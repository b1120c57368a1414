"""The inertia matrix and the gravity vector of unit parameters: what every parameter does to the arm, in closed form.

With w_a, v_a the screw of joint a in a frame of link k, a body with mass m, first moment h and tensor I there adds

    B_ab = m v_a.v_b + h.(v_a x w_b + v_b x w_a) + w_a.I w_b,    g_a = -m gamma.v_a - h.(gamma x w_a),

gamma being the acceleration of gravity; the rotor of joint i, on link i-1, adds its inertia times (w_a.u + k e_a)
(w_b.u + k e_b), with u its axis and k its ratio for its own joint (e_i = 1). Both are linear in the parameters.
"""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from operator import mul
from typing import Any, Generic

from derive.mechanics.chain import Chain
from derive.mechanics.joint_motion import axis, to_child
from derive.mechanics.regressor import Screw, next_screws, rotor_place
from derive.mechanics.vectors import Frame, S, Vector, add, cross, dot, multiply, transpose
from derive.robot.inertial_parameters import Parameter

# Entries (a, b), a <= b, of a symmetric matrix; joints from 0, what is missing is zero.
Pairs = Mapping[tuple[int, int], S]
_AXES = {"x": 0, "y": 1, "z": 2}


class UnitDynamics(Generic[S]):
    """B and g of every unit parameter."""

    def __init__(self, chain: Chain[S], ends: bool) -> None:
        self.chain = chain
        self.ends = ends
        self._carried: dict[int, tuple[list[Screw[S]], Vector[S]]] = {}
        self._known: list[tuple[list[Screw[S]], Vector[S]]] = [([], chain.gravity)]

    def inertia(self, parameter: Parameter) -> Pairs[S]:
        """B per unit of a parameter; of friction none."""
        i, part, signs = parameter.joint - 1, parameter.part, [joint.sign for joint in self.chain.joints]
        if part == "Ia":
            return {(i, i): self.chain.one}
        # what each joint does to the body, and the entry of two of them
        entry: Callable[[Any, Any], S] = dot
        moved: Sequence[Any] = ()
        if part == "Im":
            u = axis(self.chain.joints[i])
            moved = [*(dot(screw.angular, u) for screw in self._before(i)[0]), self.chain.joints[i].coupling]
            entry = mul
        elif part == "mm":
            moved = self._rotor_velocities(i)
        elif parameter.of_link:
            moved, entry = self._link(i)[0], partial(_body_entry, part)
        # B_ab is bilinear in what joints a and b do to the body; a reversed joint changes the sign.
        pairs = ((a, b) for a in range(len(moved)) for b in range(a, len(moved)))
        found = {(a, b): entry(moved[a], moved[b]) for a, b in pairs}
        return {(a, b): value if signs[a] == signs[b] else -value for (a, b), value in found.items()}

    def gravity(self, parameter: Parameter) -> list[S]:
        """g per unit of a parameter."""
        i, part = parameter.joint - 1, parameter.part
        along_z: list[S] = []
        if part == "mm":
            along_z = [-dot(self._before(i)[1], velocity) for velocity in self._rotor_velocities(i)]
        elif part in ("m", "mx", "my", "mz"):
            screws, gamma = self._link(i)
            if part == "m":
                along_z = [-dot(gamma, screw.linear) for screw in screws]
            else:
                along_z = [-cross(gamma, screw.angular)[_AXES[part[1]]] for screw in screws]
        return [value if joint.sign > 0 else -value for joint, value in zip(self.chain.joints, along_z, strict=False)]

    def _rotor_velocities(self, i: int) -> list[Vector[S]]:
        return [screw.at(rotor_place(self.chain, i + 1)) for screw in self._before(i)[0]] if i else []

    def _before(self, i: int) -> tuple[list[Screw[S]], Vector[S]]:
        """Screws and gravity in frame i; only as far out as needed, for further out they may be too long to write."""
        while len(self._known) <= i:
            joint, (screws, gamma) = self.chain.joints[len(self._known) - 1], self._known[-1]
            self._known.append((next_screws(self.chain, joint, screws), to_child(joint, gamma)))
        return self._known[i]

    def _link(self, i: int) -> tuple[list[Screw[S]], Vector[S]]:
        """Screws and gravity in the frame of a link's parameters."""
        if i not in self._carried:
            screws, gamma = self._before(i + 1)
            if self.ends:
                end: Frame[S] = self.chain.ends[i]
                screws = [screw.seen_from(end) for screw in screws]
                gamma = multiply(transpose(end.rotation), gamma)
            self._carried[i] = (screws, gamma)
        return self._carried[i]


def _body_entry(part: str, one: Screw[S], other: Screw[S]) -> S:
    """B_ab of a unit parameter of a body."""
    if part == "m":
        return dot(one.linear, other.linear)
    if part[0] == "m":
        return add(cross(one.linear, other.angular), cross(other.linear, one.angular))[_AXES[part[1]]]
    j, k = _AXES[part[1]], _AXES[part[2]]
    w, u = one.angular, other.angular
    return w[j] * u[j] if j == k else w[j] * u[k] + w[k] * u[j]
