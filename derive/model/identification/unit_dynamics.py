"""The inertia matrix and the gravity vector of unit parameters: what every parameter does to the arm, in closed form.

With w_a, v_a the screw of joint a in a frame of link k, a body with mass m, first moment h and tensor I there adds

    B_ab = m v_a.v_b + h.(v_a x w_b + v_b x w_a) + w_a.I w_b,    g_a = -m gamma.v_a - h.(gamma x w_a),

gamma being the acceleration of gravity; the rotor of joint i, on the link before, adds its inertia times (w_a.u + k
e_a) (w_b.u + k e_b), with u its axis and k its ratio for its own joint (e_i = 1). Both are linear in the parameters.
"""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from itertools import product
from operator import mul
from typing import Any, Generic

from derive.mechanics.chain import Chain
from derive.mechanics.joint_motion import axis, to_child
from derive.mechanics.regressor import Screw, Screws, next_screws
from derive.mechanics.vectors import Frame, S, Vector, add, cross, dot, multiply, transpose
from derive.robot.description import projected
from derive.robot.inertial_parameters import Parameter

# Entries (a, b), a <= b, of a symmetric matrix; joints from 0, what is missing is zero.
Pairs = Mapping[tuple[int, int], S]
_AXES = {"x": 0, "y": 1, "z": 2}


class UnitDynamics(Generic[S]):
    """B and g of every unit parameter."""

    def __init__(self, chain: Chain[S], ends: bool, coupling: Sequence[Sequence[S]] = ()) -> None:
        self.chain, self.coupling = chain, coupling
        self.ends = ends
        self._carried: dict[int, tuple[Screws[S], Vector[S]]] = {}
        self._known: dict[int, tuple[Screws[S], Vector[S]]] = {-1: ({}, chain.gravity)}

    def inertia(self, parameter: Parameter) -> Pairs[S]:
        """B per unit of a parameter; of friction none."""
        i, part, signs = parameter.joint - 1, parameter.part, [joint.sign for joint in self.chain.joints]
        # what each joint does to the body, and the entry of two of them
        entry: Callable[[Any, Any], S] = dot
        moved: Mapping[int, Any] = {}
        if part == "Ia":
            moved, entry = {i: self.chain.one}, mul
        elif part == "Im":
            joint = self.chain.joints[i]
            turned = {k: dot(screw.angular, axis(joint)) for k, screw in self._at(joint.parent)[0].items()}
            moved, entry = {**turned, i: joint.coupling}, mul
        elif part == "mm":
            moved = self._rotor_velocities(i)
        elif parameter.of_link:
            moved, entry = self._link(i)[0], partial(_body_entry, part)
        # B_ab is bilinear in what joints a and b do to the body; a reversed joint changes the sign.
        found = {(a, b): entry(moved[a], moved[b]) for a in moved for b in moved if a <= b}
        found = {(a, b): value if signs[a] == signs[b] else -value for (a, b), value in found.items()}
        if not self.coupling:
            return found
        # S^T B S, entry by entry of S
        whole: dict[tuple[int, int], S] = {}
        for (a, b), value in [*found.items(), *(((b, a), value) for (a, b), value in found.items() if a != b)]:
            for (j, left), (k, right) in product(enumerate(self.coupling[a]), enumerate(self.coupling[b])):
                if left and right and j <= k:
                    whole[j, k] = whole.get((j, k), self.chain.zero) + left * value * right
        return whole

    def gravity(self, parameter: Parameter) -> Mapping[int, S]:
        """g per unit of a parameter, by joints from 0; what is missing is zero."""
        i, part = parameter.joint - 1, parameter.part
        along_z: dict[int, S] = {}
        if part == "mm":
            gamma = self._at(self.chain.joints[i].parent)[1]
            along_z = {k: -dot(gamma, velocity) for k, velocity in self._rotor_velocities(i).items()}
        elif part in ("m", "mx", "my", "mz"):
            screws, gamma = self._link(i)
            if part == "m":
                along_z = {k: -dot(gamma, screw.linear) for k, screw in screws.items()}
            else:
                along_z = {k: -cross(gamma, screw.angular)[_AXES[part[1]]] for k, screw in screws.items()}
        felt = {k: value if self.chain.joints[k].sign > 0 else -value for k, value in along_z.items()}
        if not self.coupling:
            return felt
        zero = self.chain.zero
        return dict(enumerate(projected([felt.get(k, zero) for k in range(self.chain.n)], self.coupling, zero)))

    def _rotor_velocities(self, i: int) -> dict[int, Vector[S]]:
        joint = self.chain.joints[i]
        return {k: screw.at(joint.rotor) for k, screw in self._at(joint.parent)[0].items()}

    def _at(self, i: int) -> tuple[Screws[S], Vector[S]]:
        """Screws and gravity in joint frame i; no further out than needed, where they may be too long to write."""
        if i not in self._known:
            joint = self.chain.joints[i]
            screws, gamma = self._at(joint.parent)
            self._known[i] = next_screws(self.chain, i, screws), to_child(joint, gamma)
        return self._known[i]

    def _link(self, i: int) -> tuple[Screws[S], Vector[S]]:
        """Screws and gravity in the frame of a link's parameters."""
        if i not in self._carried:
            screws, gamma = self._at(i)
            if self.ends:
                end: Frame[S] = self.chain.ends[i]
                screws = {k: screw.seen_from(end) for k, screw in screws.items()}
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
