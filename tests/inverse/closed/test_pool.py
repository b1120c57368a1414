"""The pool of equations, what is solved from equations in one or two unknowns, conditions, and graphs of solutions."""

from collections import Counter
from fractions import Fraction
from functools import cache

import numpy as np
import pytest

from derive.algebra.residues import Residue
from derive.algebra.ring import Polynomial, Ring
from derive.handouts.notation.derivation import derivation_lines
from derive.handouts.notation.notation import Notation
from derive.inverse.closed.branches import InverseSolver
from derive.inverse.closed.elementary_solver import Branch, Solver, line_points
from derive.inverse.closed.evidence import Change, Evidence
from derive.inverse.closed.fields import FloatField
from derive.inverse.closed.formulas import GraphDerivation
from derive.inverse.closed.graph import Node, SolutionGraph
from derive.inverse.closed.nodes import NodeEquation, NodeFormula, NodeKind, Provenance, Unknown
from derive.inverse.closed.pool import ENTRIES, HIGHER, Cut, Links, Pool, dimension, frame_atoms
from derive.inverse.closed.pose import entry_conditions
from derive.inverse.closed.search import Search
from derive.inverse.closed.solve import counted, solve
from derive.inverse.closed.unknowns import InverseDomain, State, shifted, without
from derive.inverse.numeric.chain import NumericChain
from derive.inverse.words.solutions import inverse_kinematics
from derive.mechanics.vectors import Frame, dot, hat, matmul, multiply, transpose
from derive.model.model import Model
from derive.robot.robot import Robot
from tests.inverse.arms import arm_of

ARM = arm_of(
    "modified",
    "R 30 0.1 0.2 0; P 90 0.3 0 90; R -90 0 0.4 0; R 0 0.5 0.6 0",
    "tool: [[1, 0, 0, 0.1], [0, 1, 0, 0.2], [0, 0, 1, 0], [0, 0, 0, 1]]",
)
WHOLE = frozenset((i, j) for i in (1, 2, 3) for j in (1, 2, 3, 4))


DOMAIN = InverseDomain(shifted(ARM)[0])
LINKS = Links(DOMAIN.robot, DOMAIN, DOMAIN.joint_turn)


@cache
def evidence(*, special: bool = False) -> Evidence:
    return Evidence(DOMAIN, list(LINKS.cuts()), WHOLE, deep=True, special=special)


@pytest.mark.parametrize("special", [False, True])
def test_both_sides_of_every_equation_agree_where_the_arm_is(special: bool) -> None:
    found = evidence(special=special)
    for k, (cut, entry) in enumerate(found.equations):
        constant = found.effects[Change(0, 2)].coefficients[k]
        at_the_pose = (constant[:, 0] + constant[:, 1] + constant[:, 3]) % found.prime
        assert not at_the_pose.any(), (cut, entry)


def test_invariants_are_those_of_the_frame_however_it_was_composed() -> None:
    found = evidence()
    prime = found.prime
    pose = found.pose
    again = frame_atoms(Frame(pose.rotation, pose.position), Residue(prime, [[0]]), deep=True)
    for entry in (*ENTRIES, *HIGHER):
        assert not (pose.entry(entry) - again.entry(entry)).values.any(), entry
    turned = multiply(transpose(pose.rotation), pose.position)
    assert not (dot(turned, turned) - pose.square).values.any()
    moment = matmul(hat(pose.position, Residue(prime, [[0]])), pose.rotation)
    assert not (moment[0][1] - pose.entry("m[1,2]")).values.any()


def test_cuts_stand_at_both_ends_of_every_offset_and_entries_have_their_dimension() -> None:
    cuts = list(LINKS.cuts())
    assert Cut(0, 2, outer_right=True) in cuts
    assert not any(cut.outer_left for cut in cuts if cut.first == 0)
    assert [dimension(entry) for entry in ("R[1,1]", "p[1]", "u[2]", "p.p", "m[1,1]", "k[1,1]")] == [0, 1, 1, 2, 1, 2]
    inside, _ = Pool(LINKS, frame_atoms(LINKS.unit, LINKS.zero, deep=False)).sides(Cut(2, 3))
    assert inside.entry("p[3]") == DOMAIN.constant(DOMAIN.robot.joints[2].d)


def test_an_equation_depends_on_what_occurs_in_it_alone() -> None:
    found = evidence()
    search = Search(found)
    slide = found.effects[Change(-1, 1)]
    rotations = [k for k, (_, entry) in enumerate(found.equations) if entry[0] == "R"]
    assert not slide.depends[rotations].any()
    way = search.way()
    assert {step.group for step in way} == {-1, 0, 1}


def test_leaves_are_counted_and_constant_entries_found() -> None:
    robot = Robot.load("scara-perugia")
    graph = solve(robot)
    assert counted(graph, graph.domain, {}).count == 2
    assert [str(e.coefficient().raw) for e in graph.conditions] == ["T[1,3]", "T[2,3]", "T[3,3] + 1"]
    links = Links(graph.robot, graph.domain, graph.domain.joint_turn)
    arm = Evidence(graph.domain, list(links.cuts()), WHOLE)
    assert len(entry_conditions(graph, arm, {})) == 7


PARALLEL = InverseDomain(Robot.load("planar-3r"))
NOTHING = State(((0b0001, 0b0010, 0b0100, 0b1000),), frozenset())


def known(state: State) -> set[tuple[int, ...]]:
    return {u.joints for u in PARALLEL.unknowns() if all(PARALLEL.is_known(name, state) for name in u.generators)}


def test_of_sums_that_are_known_their_differences_are_known_and_between_parts_are_all_sums() -> None:
    whole = NOTHING.joined(0, 0b0001, 0b1000)
    assert known(NOTHING) == set()
    assert known(whole) == {(0, 1, 2)}
    assert known(whole.joined(0, 0b1001, 0b0100)) == {(0, 1), (2,), (0, 1, 2)}
    assert [u.joints for u in PARALLEL.between(0, (0b1001, 0b0010))] == [(0,), (1, 2)]


def test_an_equation_is_written_in_one_unknown_and_what_is_known() -> None:
    whole = NOTHING.joined(0, 0b0001, 0b1000)
    first, rest = PARALLEL.unknown(0), PARALLEL.unknown(1, 2)
    cosine, sine = map(PARALLEL.ring.generator, rest.generators)
    written = PARALLEL.rewritten(cosine * cosine + sine, whole, first)
    used = {name for name, degree in zip(PARALLEL.ring.names, written.degrees(), strict=True) if degree}
    assert used == {*first.generators, *PARALLEL.unknown(0, 1, 2).generators}
    (c, s), (e, f) = (map(PARALLEL.ring.generator, u.generators) for u in (first, PARALLEL.unknown(0, 1, 2)))
    assert written == (e * c + f * s) * (e * c + f * s) + f * c - e * s


ARMS = {  # rows of revolute (R) and prismatic (P) joints, and what a pose must fulfil
    "R 0 d1 0 0; P 0 0 0 -90; P 0 0 0 0": "r33 = 0, r31 = 0, r32 = -1, px*c1 = -py*s1",
    "P 0 0 0 90; P 90 0 0 90; P 0 0 0 0": "r13 = 1, r23 = 0, r33 = 0, r31 = 1, r32 = 0",
    "R 0 d1 0 -90; R 0 0 a2 0; R 0 0 a3 0; R 0 0 a4 -90; R 0 d5 0 0": "r23*c1 = r13*s1",
    "R 0 0 0 -90; R 0 0 0 90; R 0 d6 0 0": "px = d6*r13, py = d6*r23, pz = d6*r33",
}


@pytest.mark.parametrize("rows", ARMS)
def test_conditions_are_those_of_textbooks_with_their_signs(rows: str) -> None:
    robot = arm_of("standard", rows)
    lines = derivation_lines(Model(robot).inverse, "text", Notation.of(robot))
    assert lines[1] == f"a pose can be reached only if {ARMS[rows]}"


def test_an_angle_tells_the_orientation_of_a_planar_arm() -> None:
    """So the last link is taken off first, as textbooks do, and the elbow follows from the law of cosines."""
    robot = Robot.load("planar-3r")
    lines = derivation_lines(inverse_kinematics(robot, robot.style, ("x", "y", "phi")), "text", Notation.of(robot))
    assert "   wx = px - a3*r11" in lines
    assert "   D = (wx**2 + wy**2 - a1**2 - a2**2)/(2*a1*a2)" in lines


PLANAR = arm_of("standard", "R 0 0 a1 0; R 0 0 a2 0")


def planar_graph() -> SolutionGraph:
    """theta_2 by the law of cosines, then theta_1 from x and y."""
    robot, shifts = shifted(PLANAR)
    domain = InverseDomain(robot)
    x, y, a1, a2 = map(domain.ring.generator, ("T[1,4]", "T[2,4]", "a1", "a2"))
    (one,), (two,) = ((domain.unknown(k),) for k in (0, 1))
    c2, s2 = map(domain.ring.generator, two.generators)
    square = x * x + y * y - a1 * a1 - a2 * a2
    law = NodeEquation({(1, 0): 2 * (a1 * a2), (0, 0): -square}, 2, Provenance(1, 2, "p.p"))
    first = NodeEquation({(1, 0): a1 + a2 * c2, (0, 1): -(a2 * s2), (0, 0): -x}, 1, Provenance(1, 2, "p[1]"))
    second = NodeEquation({(1, 0): a2 * s2, (0, 1): a1 + a2 * c2, (0, 0): -y}, 1, Provenance(1, 2, "p[2]"))
    nodes = (
        Node(0, (two,), (NodeFormula(NodeKind.TYPE_2, (law,)),), (), 2),
        Node(1, (one,), (NodeFormula(NodeKind.TYPE_3, (first, second)),), (0,), 1),
    )
    reach = a1 * a1 + a2 * a2 + x * x + y * y
    return SolutionGraph(robot, domain, ("x", "y"), (), (), reach, nodes, shifts, (), 2, True, True)


def test_nodes_have_a_value_for_each_branch_and_joints_are_found_where_they_are_solved_for() -> None:
    graph = planar_graph()
    assert graph.axes == ((), (0,))
    assert graph.choices == (0,)
    assert graph.leaves == graph.slots == 2
    assert [node.unknown.joints for node in graph.nodes] == [(1,), (0,)]
    assert graph.places == ((0, 3), (1, 3))


RING = Ring(("x",))
X = RING.generator("x")
SOURCE = Provenance(1, 2, "p.p")


def _number(p: Polynomial) -> np.float64:
    return np.float64(sum(coefficient for _, coefficient in p.terms()))


def _equation(coefficients: dict[tuple[int, ...], Fraction | int]) -> NodeEquation:
    kept = {exponents: RING.number(Fraction(value)) for exponents, value in coefficients.items() if value}
    return NodeEquation(kept, 0, SOURCE)


def solved(kind: NodeKind, *equations: NodeEquation) -> list[Branch]:
    solver = Solver(FloatField({}), _number, np.float64(1))
    formula = NodeFormula(kind, equations)
    assert not solver.degenerate(formula)
    return [branch for branch in solver.solve(formula) if branch.exists]


def solver_at(x: float) -> Solver:
    return Solver(FloatField({}), lambda p: np.float64(sum(c * x ** e[0] for e, c in p.terms())), np.float64(1))


def rest(equation: NodeEquation, branch: Branch) -> float:
    terms = equation.terms.items()
    return float(sum(_number(p) * np.prod(np.power(branch.numbers, e)) for e, p in terms))


@pytest.mark.parametrize(("a", "b", "c"), [(3, 4, 2), (3, 0, 2), (0, -4, 1), (1, 2, 0), (-2, 1, -1)])
def test_one_equation_has_the_two_angles_that_satisfy_it(a: int, b: int, c: int) -> None:
    equation = _equation({(1, 0): a, (0, 1): b, (0, 0): -c})
    first, second = solved(NodeKind.TYPE_2, equation)
    assert max(abs(rest(equation, branch)) for branch in (first, second)) < 1e-14
    assert max(abs(np.hypot(*branch.numbers) - 1) for branch in (first, second)) < 1e-14
    assert np.abs(np.subtract(first.numbers, second.numbers)).max() > 0.1


@pytest.mark.parametrize(("c", "count"), [(4, 2), (5, 1), (6, 0)])
def test_where_two_angles_coincide_one_is_left_and_beyond_none(c: int, count: int) -> None:
    found = solved(NodeKind.TYPE_2, _equation({(1, 0): 3, (0, 1): 4, (0, 0): -c}))
    assert len(found) == count
    assert all(bool(branch.boundary) == (count == 1) for branch in found)


@pytest.mark.parametrize("kept", [(3, 4, -4, 3), (2, 0, 0, 5), (0, 2, 5, 0)])
def test_two_equations_have_the_angle_that_satisfies_both(kept: tuple[int, int, int, int]) -> None:
    a, b, d, e = kept
    cosine, sine = Fraction(3, 5), Fraction(-4, 5)
    first = _equation({(1, 0): a, (0, 1): b, (0, 0): -(a * cosine + b * sine)})
    second = _equation({(1, 0): d, (0, 1): e, (0, 0): -(d * cosine + e * sine)})
    (branch,) = solved(NodeKind.TYPE_3, first, second)
    assert np.allclose(branch.numbers, [0.6, -0.8], atol=1e-15)


@pytest.mark.parametrize(("a", "b", "c", "count"), [(0, 2, -3, 1), (1, 0, -4, 2), (2, 3, -5, 2), (1, 2, 3, 0)])
def test_lengths_satisfy_their_equation(a: int, b: int, c: int, count: int) -> None:
    equation = _equation({(2,): a, (1,): b, (0,): c})
    found = solved(NodeKind.QUADRATIC if a else NodeKind.TYPE_1, equation)
    assert len(found) == count
    assert all(abs(rest(equation, branch)) < 1e-13 for branch in found)


@pytest.mark.parametrize("sine_or_cosine", [0, 1])
@pytest.mark.parametrize("away", [1e-3, 1e-6, 1e-9])
def test_beside_a_folded_elbow_of_equal_lengths_the_angle_has_all_its_digits(away: float, sine_or_cosine: int) -> None:
    """2 c = x^2 - 2: beside c = -1 the sine is x, but for x^3, and 1 - c^2 would have lost it."""
    terms = {(1, 0) if sine_or_cosine else (0, 1): RING.number(2), (0, 0): 2 - X * X}
    both = solver_at(away).solve(NodeFormula(NodeKind.TYPE_2, (NodeEquation(terms, 2, SOURCE),)))
    assert all(branch.exists and not branch.boundary for branch in both)
    found = [branch.numbers[sine_or_cosine] for branch in both]
    np.testing.assert_allclose(found, np.array([1, -1]) * away * np.sqrt(1 - away**2 / 4), rtol=1e-12)


@pytest.mark.parametrize(("short", "known"), [(1e-3, True), (1e-9, True), (1e-13, False)])
def test_equations_that_are_one_turned_determine_an_angle_where_they_have_a_length(short: float, known: bool) -> None:
    rows = ({(1, 0): 3 * X, (0, 1): 4 * X, (0, 0): -5 * X}, {(1, 0): -4 * X, (0, 1): 3 * X})
    formula = NodeFormula(NodeKind.TYPE_3, tuple(NodeEquation(row, 1, SOURCE) for row in rows))
    assert bool(solver_at(short).degenerate(formula)) is not known


def test_a_length_that_may_be_negative_is_no_square_and_rounding_leaves_it_its_root() -> None:
    terms = {(1, 0): RING.one, (0, 0): 1 - X}
    first, second = solver_at(-1e-16).solve(NodeFormula(NodeKind.TYPE_2, (NodeEquation(terms, 1, SOURCE),)))
    assert (bool(first.exists), bool(first.boundary), bool(second.exists)) == (True, True, False)


def test_two_entries_of_a_rotation_are_nowhere_degenerate_and_nothing_is_computed_to_see_that() -> None:
    c, s = Fraction(3, 5), Fraction(4, 5)
    solver = Solver(FloatField({}), pytest.fail, np.float64(1))
    for rows in (({(1, 0): 1, (0, 0): -1}, {(0, 1): 1}), ({(1, 0): c, (0, 1): s}, {(1, 0): -s, (0, 1): c})):
        assert not solver.degenerate(NodeFormula(NodeKind.TYPE_3, tuple(map(_equation, rows))))


Array = np.ndarray


def conics_through(angles: Array, random: np.random.Generator) -> list[Array]:
    """Coefficients of a conic through four points of the circle each: two chords, and any multiple of the circle."""
    first, second = (
        [np.cos(0.5 * (a + b)), np.sin(0.5 * (a + b)), -np.cos(0.5 * (a - b))] for a, b in (angles[:2], angles[2:])
    )
    product = np.einsum("i...,j...->ij...", first, second)
    product = product + np.swapaxes(product, 0, 1)
    of_circle = random.normal(size=angles.shape[1])
    diagonal = [product[0, 0] / 2 + of_circle, product[1, 1] / 2 + of_circle, product[2, 2] / 2 - of_circle]
    return [diagonal[0], product[0, 1], diagonal[1], product[0, 2], product[1, 2], diagonal[2]]


def points(coefficients: list[Array]) -> tuple[Array, Array]:
    """Angles of the four points, not a number where there is none, and which are double."""
    found = line_points(FloatField({}), coefficients)
    angles = [np.where(exists, np.arctan2(sine, cosine), np.nan) for cosine, sine, exists, *_ in found]
    return np.array(angles), np.array([double for *_, double, _ in found])


def worst(angles: Array, wanted: Array) -> Array:
    """How far each wanted point is from the nearest that was found, the largest of each conic."""
    apart = np.abs(np.angle(np.exp(1j * (angles[:, None] - wanted[None]))))
    return np.asarray(np.where(np.isnan(apart), np.inf, apart).min(axis=0).max(axis=0))


@pytest.mark.parametrize(("gap", "error"), [(1.0, 1e-11), (1e-3, 1e-10), (0.0, 1e-11)])
def test_two_points_that_are_close_are_as_exact_as_others(gap: float, error: float) -> None:
    random = np.random.default_rng(3)
    a = random.uniform(-3, 3, 500)
    for order in ((0, 1, 2, 3), (0, 2, 1, 3)):
        wanted = np.array([a, a + gap, a + 1.9, a - 1.7])
        angles, double = points(conics_through(wanted[list(order)], random))
        assert worst(angles, wanted).max() < error
        assert double.any(axis=0).all() == (gap == 0)
        assert (np.isfinite(angles).sum(axis=0) == (3 if gap == 0 else 4)).all()


def test_four_right_angles_are_found_wherever_the_lines_are() -> None:
    wanted = np.array([0.0, 0.5, 1.0, -0.5])[:, None] * np.pi
    for order in ((0, 1, 2, 3), (0, 2, 1, 3), (0, 3, 1, 2)):
        angles, _ = points(conics_through(wanted[list(order)], np.random.default_rng(1)))
        assert worst(angles, wanted).max() < 1e-14


def test_random_conics_have_as_many_points_as_their_quartics_have_real_roots() -> None:
    cc, cs, ss, c, s, one = coefficients = list(np.random.default_rng(5).normal(size=(6, 400)))
    ascending = np.array([cc + c + one, 2 * (cs + s), 2 * (one - cc) + 4 * ss, 2 * (s - cs), cc - c + one])
    numbers = [int((abs(np.roots(row[::-1]).imag) < 1e-9).sum()) for row in ascending.T]
    angles, _ = points(coefficients)
    assert np.isfinite(angles).sum(axis=0).tolist() == numbers
    assert set(numbers) == {0, 2, 4}
    x, y = np.cos(angles), np.sin(angles)
    assert np.nanmax(abs(cc * x * x + cs * x * y + ss * y * y + c * x + s * y + one)) < 1e-14


def test_where_four_points_are_one_rounding_is_said_to_decide() -> None:
    touching = [np.array([x]) for x in (2.0, 0.0, 1.0, -2.0, 0.0, 0.0)]  # c^2 + s^2 - 1 + (c - 1)^2
    found = line_points(FloatField({}), touching)
    assert all(np.all(doubt) for *_, doubt in found)
    apart = [np.array([x]) for x in (1.0, 0.0, -1.0, 0.0, 0.0, 0.0)]
    assert not any(np.any(doubt) for *_, doubt in line_points(FloatField({}), apart))


def test_a_pair_of_the_first_degree_loses_its_angle_or_its_slide() -> None:
    made = Ring(["s", "c", "r", "a", "x", "y", "z"])
    made.relate_angle("s", "c")
    s, c, r, a, x, y, z = map(made.generator, made.names)
    angle, slide = (Unknown((0,), (1,), names) for names in (("c", "s"), ("r",)))
    found = without(made, angle, x * c + y * s - z, 2 * a * (x * s - y * c) - a)
    assert found == a * a * (4 * z * z + 1 - 4 * (x * x + y * y))
    found = without(made, angle, a * c - x, z * s - y)
    assert found == a * a * (y * y) + z * z * (x * x) - a * a * (z * z)
    assert without(made, angle, a * c * s - x, z * s - y) is None
    assert without(made, slide, a * r - x, 2 * a * r - y) == y - 2 * x
    assert without(made, slide, a * r * r - x, a * r - y) is None
    assert without(made, slide, x, a * r - y) is None


@cache
def derivation(name: str) -> GraphDerivation:
    robot = Robot.load(name)
    return GraphDerivation(robot, robot.inverse.task)


def test_a_rotation_has_two_numbers_with_parallel_axes_and_nine_in_space() -> None:
    (a, b, x), (c, d, y), (u, v, z) = derivation("scara-perugia").pose.atoms.rotation
    assert not any((x, y, u, v))
    assert z.is_constant
    assert z * z == 1
    assert (a * d - b * c) * z in (a * a + c * c, -(a * a) - c * c)
    entries = [entry for row in derivation("puma560-corke").pose.atoms.rotation for entry in row]
    assert len({str(entry) for entry in entries}) == 9
    assert not any(entry.is_constant for entry in entries)


def test_what_is_defined_comes_after_what_it_needs() -> None:
    known: set[str] = set()
    definitions = derivation("puma560-corke").pose.definitions
    for name, value in definitions.items():
        used = {other for other, degree in zip(value.ring.names, value.degrees(), strict=True) if degree}
        assert used & set(definitions) <= known
        known.add(name)


@pytest.mark.parametrize(
    ("joints", "task"),
    [
        ("R 0 0 0.5 0; R 0 0 0.5 0", "[x, y]"),
        ("R 0 0.3 0 90; R 0 0 0.5 0; R 0 0 0.5 0", "position"),
        ("R 0 0.3 0 90; R 0 0 1 0", "[x, z]"),
        ("R 0 1 0 90; R 0 0 1 0; R 0 0 1 0", "position"),
    ],
)
def test_equal_lengths_do_not_make_a_position_depend_on_the_orientation(joints: str, task: str) -> None:
    robot = arm_of("standard", joints, f"inverse: {{task: {task}}}")
    solver = InverseSolver.of(robot, solve(robot))
    pose = NumericChain.of(robot).pose_and_jacobian(np.full((1, robot.n), 0.7))[0][0]
    found = solver.solve(pose)
    pose[:3, :3] = [[0, 0.6, 0.8], [1, 0, 0], [0, 0.8, -0.6]]
    assert found.status.any()
    assert solver.solve(pose).q == pytest.approx(found.q, nan_ok=True)


@pytest.mark.parametrize("name", ["planar-3r", "puma560-corke"])
def test_each_joint_follows_from_those_before_it_and_sums_are_those_of_their_joints(name: str) -> None:
    graph = derivation(name).graph()
    assert {(k,) for k in range(graph.robot.n)} <= {node.unknown.joints for node in graph.nodes}
    sums = [node for node in graph.nodes if node.kind is NodeKind.SUM]
    assert sums
    for node in graph.nodes:
        assert all(need < node.index for need in node.needs)
    for node in sums:
        total: Counter[int] = Counter()
        for part, sign in node.formulas[0].parts:
            total.update({joint: sign * own for joint, own in zip(part.joints, part.signs, strict=True)})
        wanted = dict(zip(node.unknown.joints, node.unknown.signs, strict=True))
        assert {joint: count for joint, count in total.items() if count} == wanted
