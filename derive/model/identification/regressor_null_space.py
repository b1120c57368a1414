"""The null space of the regressor: changes of the links' inertial parameters that leave every torque the same.

Torques depend on the base parameters alone (`derive.model.identification.base_parameters`), so bodies may change along
the directions in which no base parameter does. They are of two kinds:

- what of a link looks the same however its joint moves may as well be on the link before: of a revolute joint's link
  its mass, its first moment along the axis, and the second moment along the axis, diag(1, 1, 0); of a prismatic joint's
  link its inertia tensor without the mass. From link 1 it goes to the ground;
- for each parameter of a link that others replace: one of it more, and of the others less by its coefficients.

A vector of parameters has ten numbers a link in the order of `LINK_PARTS`, in joint frames: on the axis of joint i,
which is DH frame i in the modified convention, and DH frame i before its a and alpha in the standard one.
"""

from collections.abc import Sequence
from dataclasses import replace
from itertools import chain as joined

from flint import fmpq

from derive.mechanics.chain import Body, Chain, build_chain
from derive.mechanics.joint_motion import body_to_parent
from derive.mechanics.vectors import Symmetric
from derive.model.identification.base_parameters import base_set, parameters_of
from derive.model.identification.exact_scalars import Exact, ExactDomain, is_zero, null_space
from derive.robot.inertial_parameters import LINK_PARTS, Parameter
from derive.robot.robot import Robot

WIDTH = len(LINK_PARTS)  # parameters of a link
Direction = list[Exact]  # a change of all links' parameters


def bare_chain(robot: Robot, domain: ExactDomain) -> Chain[Exact]:
    """The links of an arm without the rotors that they carry."""
    return build_chain(replace(robot, links=tuple(replace(link, motor=None) for link in robot.links)), domain)


def body_of(parameters: Sequence[Exact]) -> Body[Exact]:
    """The body of ten parameters."""
    mass, x, y, z, *tensor = parameters
    return Body(mass, (x, y, z), Symmetric(*tensor))


def directions(robot: Robot, chain: Chain[Exact], domain: ExactDomain) -> list[Direction]:
    """A basis of the changes of bodies that change no torque."""
    found, zero = [], [chain.zero] * WIDTH
    for i, joint in enumerate(chain.joints):
        # Mass, m z and the second moment along z look the same from link i-1 however joint i turns.
        units = [("m",), ("mz",), ("Ixx", "Iyy")] if joint.revolute else [(part,) for part in LINK_PARTS[4:]]
        for unit in units:
            own = [chain.one if part in unit else chain.zero for part in LINK_PARTS]
            links = [list(zero) for _ in range(chain.n)]
            links[i] = [-value for value in own]
            if i:
                links[i - 1] = parameters_of(body_to_parent(joint, body_of(own)))
            found.append(list(joined.from_iterable(links)))
    base = base_set(robot)
    for relation in base.relations:
        if not relation.parameter.of_link:
            continue
        direction = zero * chain.n
        direction[_place(relation.parameter)] = domain.number(1)
        for parameter, factor in relation.terms:
            numerator, denominator = map(domain.constant, base.fraction(factor))
            direction[_place(parameter)] = -numerator / denominator
        found.append(direction)
    return found


def _place(parameter: Parameter) -> int:
    return WIDTH * (parameter.joint - 1) + LINK_PARTS.index(parameter.part)


def fixing(basis: Sequence[Direction], places: Sequence[int]) -> list[Direction]:
    """Those changes that leave some parameters as they are."""
    rows = [[direction[place] for direction in basis] for place in places]
    return [combined(basis, weights) for weights in null_space(rows, len(basis)).values()]


def combined(basis: Sequence[Direction], weights: Sequence[Exact]) -> Direction:
    """A sum of changes."""
    total: Direction = [fmpq(0)] * len(basis[0])
    for weight, direction in zip(weights, basis, strict=True):
        if not is_zero(weight):
            total = [old + weight * x if not is_zero(x) else old for old, x in zip(total, direction, strict=True)]
    return total
