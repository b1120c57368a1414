"""The unknown joints of loops that rods close, by |p_A - p_B|^2 = L^2: one joint of a rod, or a point by three rods.

Seen from before that joint one end of the rod is where the variables put it, p. The other end moves with the joint and
is a vector linear in its cosine and sine, or in its length. The square of the distance is A cos + B sin + C of an angle
and a quadratic in a length: two solutions, real where the rod is long and short enough.

Three rods to one point: its three slides x are at right angles, and |b_i + D x|^2 = L_i^2 are three spheres. Two less
the first one are the planes n_i . x + e_i = 0, of whose line two points are on the sphere.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from derive.errors import QuantityError
from derive.inverse.closed.graph import Node, SolutionGraph
from derive.inverse.closed.nodes import NodeEquation, NodeFormula, NodeKind, Provenance
from derive.inverse.closed.unknowns import InverseDomain, baked, shifted, with_numbers
from derive.inverse.loops.closing import slides
from derive.mechanics.chain import Domain, build_chain
from derive.mechanics.forward_kinematics import forward_kinematics
from derive.mechanics.vectors import Frame, S, cross, dot
from derive.robot import tree
from derive.robot.description import Convention, Joint, JointType, Loop
from derive.robot.expression import ZERO
from derive.robot.options.inverse import TASKS, InverseOptions
from derive.robot.robot import Robot


def rod_graph(arm: Robot, is_zero: Sequence[bool]) -> SolutionGraph:
    """The solutions of the first joint of an arm whose first link is the rod.

    Later joints are given, and of the pose the position, of which ``is_zero`` says what vanishes.
    """
    plain, shifts = shifted(with_numbers(arm, {k: cell for k, cell in baked(arm).items() if cell == ZERO}))
    domain, (first, *others) = InverseDomain(plain), plain.joints
    end = forward_kinematics(build_chain(replace(plain, joints=(replace(first, a=ZERO), *others)), domain)).position
    place = (domain.ring.zero if zero else domain.ring.generator(f"T[{i},4]") for i, zero in enumerate(is_zero, 1))
    square = sum(((p - x) ** 2 for p, x in zip(place, end, strict=True)), -(domain.constant(first.a) ** 2))
    unknown = domain.unknown(0)
    terms = domain.ring.coefficients(square, [domain.ring.index[name] for name in unknown.generators])
    if not any(map(any, terms)):
        raise QuantityError("the joint does not change the distance of the ends")
    kind, given = NodeKind.TYPE_2 if unknown.is_angle else NodeKind.QUADRATIC, tuple(range(1, plain.n))
    formula = NodeFormula(kind, (NodeEquation(terms, 2, Provenance(1, 1, "rod")),))
    nodes = [Node(k - 1, (domain.unknown(k),), (NodeFormula(NodeKind.GIVEN),)) for k in given]
    nodes.append(Node(len(given), (unknown,), (formula,), tuple(range(len(given))), formula.branches))
    scale = domain.square_reach
    return SolutionGraph(
        plain, domain, (), given, (), scale, tuple(nodes), shifts, count=2, complete=True, everywhere=True
    )


@dataclass(frozen=True, slots=True)
class ThreeRods:
    """Three rods to a point that three slides move; what is known of them stands in place of a pose."""

    robot: Robot
    loops: tuple[Loop, ...]
    places: tuple[int, ...]  # of the slides; the last one's equation is the quadratic one

    @property
    def arm(self) -> Robot:
        """The slides alone."""
        names = [self.robot.joints[k].variable for k in self.places]
        rows = tuple(Joint(JointType.PRISMATIC, name, 1, ZERO, ZERO, ZERO, ZERO) for name in names)
        own = Robot(
            f"{self.robot.name}-rods", "", Convention.MODIFIED, rows, inverse=InverseOptions(TASKS["position"], ())
        )
        return tree.plain(replace(own, parameters=self.robot.parameters, runtime=self.robot.runtime))

    def pose(self, domain: Domain[S]) -> Frame[S]:
        """Columns n_2, n_3, b_1 of differences n_i.x + e_i = 0 and of x.x + 2 b_1.x + c_1 = 0; then e_2, e_3, c_1."""
        columns, rests = [], []
        for loop in self.loops:
            way, ways = slides(self.robot, loop, domain, self.places)
            length = domain.constant(loop.length)
            columns.append([dot(own, way) for own in ways])
            rests.append(dot(way, way) - length * length)
        (b, *others), (c, *ends) = columns, rests
        half = domain.number(Fraction(1, 2))
        normals = [[x - y for x, y in zip(own, b, strict=True)] for own in others]
        x, y, z = zip(*normals, b, strict=True)
        first, second = (half * (end - c) for end in ends)
        return Frame((x, y, z), (first, second, c))


def point_graph(arm: Robot, is_zero: Sequence[Sequence[bool]]) -> SolutionGraph:
    """The solutions of three slides, of whose numbers in place of a pose ``is_zero`` says which vanish."""
    domain = InverseDomain(arm)
    ring = domain.ring
    known = [
        [ring.zero if zero else ring.generator(f"T[{i},{j}]") for j, zero in enumerate(row, 1)]
        for i, row in enumerate(is_zero, 1)
    ]
    (n, m, b), (e, f, c) = zip(*(row[:3] for row in known), strict=True), (row[3] for row in known)
    # The line u along both planes: u_3 x_1 = u_1 x_3 + v_2 and u_3 x_2 = u_2 x_3 - v_1.
    values = [*cross(n, m), *(f * x - e * y for x, y in zip(n[:2], m[:2], strict=True))]
    named = dict(zip(("W[1,4]", "W[2,4]", "W[3,4]", "W[1,1]", "W[2,1]"), values, strict=True))
    u, v, w, one, two = (ring.generator(name) if value else ring.zero for name, value in named.items())
    source, last = Provenance(1, 3, "rods"), domain.unknown(2)
    middle = 2 * (u * two - v * one + w * dot(b, (u, v, w)))
    rest = one * one + two * two + 2 * w * (b[0] * two - b[1] * one) + w * w * c
    square = NodeEquation({(2,): dot((u, v, w), (u, v, w)), (1,): middle, (0,): rest}, 6, source)
    nodes = [Node(0, (last,), (NodeFormula(NodeKind.QUADRATIC, (square,)),), (), 2)]
    for k, start in enumerate((u * ring.generator(*last.generators) + two, v * ring.generator(*last.generators) - one)):
        formula = NodeFormula(NodeKind.TYPE_1, (NodeEquation({(1,): w, (0,): -start}, 3, source),))
        nodes.append(Node(k + 1, (domain.unknown(k),), (formula,), (0,)))
    scale = sum((x * x for row in known for x in row[:3]), ring.zero)
    given = tuple(pair for pair in named.items() if pair[1])
    own = arm, domain, (), (), given, scale, tuple(nodes), (ZERO,) * 3
    return SolutionGraph(*own, count=2, complete=True, everywhere=True)
