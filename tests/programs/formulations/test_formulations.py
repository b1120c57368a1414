"""All formulations of one function, and all choices of frames, compute the same values; the search finds cheap ones."""

import random
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache
from itertools import pairwise, product

import numpy as np
import numpy.typing as npt
import pytest

from derive.mechanics.energy import gravity_vector, inertia_matrix, kinetic_energy, potential_energy
from derive.mechanics.forward_kinematics import forward_kinematics, jacobian, joint_poses, link_transforms
from derive.mechanics.newton_euler import PLAIN, FrameChoice, inverse_dynamics
from derive.mechanics.torque_derivatives import coriolis_matrix
from derive.mechanics.vectors import Frame, Vector, add, column, identity, multiply
from derive.programs.build import build_program
from derive.programs.formulations import dynamics, kinematics
from derive.programs.formulations.cheapest_kinematics import cheapest_jacobian, cheapest_links, cheapest_pose
from derive.programs.formulations.choice import choose
from derive.programs.formulations.frame_choice import (
    ALL_CHOICES,
    FrameChoices,
    FrameChoiceSearch,
    holdable,
    parallel_runs,
    places,
    starting_choices,
)
from derive.programs.formulations.trace import CLOSED_FORMS, ClosedForm, Trace, flat
from derive.programs.optimise.search_policy import POLICY, Effort
from derive.programs.tape.build import bake, cut, program_cost
from derive.programs.tape.graph import Graph, Ref
from derive.programs.tape.tape import PARAMETER, Operations, evaluate
from derive.programs.tape.value import QD, QDD, Q, Value
from derive.robot.evaluate import evaluate as number_in
from derive.robot.names import robot_symbols
from derive.robot.robot import Robot
from tests.programs.formulations.test_recursions import ARITHMETIC
from tests.random_robots import random_robot, seeds
from tests.rows import TWO_BARS, robot_of_rows

TWISTS = ["0", "0", "0", "pi", "pi", "pi/2", "-pi/2", "0.4", "w"]
TOOL = "[[0, 0, 1, 0.1], [cos(e), sin(e), 0, f], [-sin(e), cos(e), 0, 0.3], [0, 0, 0, 1]]"


def parallel_arm(seed: int, joints: int | None = None) -> Trace:
    rng = random.Random(seed)
    rows = [_row_of(rng, i) for i in range(1, (joints or rng.randint(2, 6)) + 1)]
    lines = ["name: arm", f"convention: {rng.choice(['standard', 'modified'])}", "joints:", *rows]
    lines += [f"{key}: {TOOL}" for key in ("base", "tool") if rng.random() < 0.3]
    return Trace(Robot.from_text("\n".join(lines) + "\n"))


def _row_of(rng: random.Random, i: int) -> str:
    sign, offset = rng.choice(["", "", "-"]), rng.choice(["", "", " + pi/2", " - 0.3", " + t"])
    cells = f"a: {rng.choice(['0', f'a{i}', '-0.4'])}, alpha: {rng.choice(TWISTS)}"
    if rng.random() < 0.7:
        return f"  - {{type: revolute, q: q{i}, theta: '{sign}q{i}{offset}', d: {rng.choice(['0', f'd{i}'])}, {cells}}}"
    return f"  - {{type: prismatic, q: q{i}, d: '{sign}q{i}', theta: {rng.choice(['0', '0.7', 'u'])}, {cells}}}"


def numbers(trace: Trace, values: Sequence[Value]) -> npt.NDArray[np.float64]:
    """The values as traced, at q = 0.3, 0.7, ..., qd = 1.3, ..., qdd = 2.3, ... and free symbols 0.5, 0.6, ..."""
    tape = cut(trace.graph, [value.ref for value in values])
    given, symbols = dict(trace.robot.parameters), robot_symbols(trace.robot)
    inputs = {kind: [0.3 + 0.4 * i + k for i in range(trace.n)] for k, kind in enumerate((Q, QD, QDD))}
    inputs[PARAMETER] = [number_in(given[x], {}) if x in given else 0.5 + 0.1 * k for k, x in enumerate(symbols)]
    return np.array(evaluate(tape, inputs, ARITHMETIC)).real


FORMULATIONS = {
    "T": kinematics.poses,
    "T_i": kinematics.link_poses,
    "J": kinematics.jacobians,
    "J_end": kinematics.end_jacobians,
    "dJ/dt": kinematics.jacobian_rates,
    "B": dynamics.inertia_matrices,
    "C": dynamics.coriolis_matrices,
    "g": dynamics.gravity_vectors,
    "kinetic": dynamics.kinetic_energies,
    "potential": dynamics.potential_energies,
    "tau": dynamics.torques,
    "C qd": dynamics.coriolis_vectors,
    "d tau / d q": dynamics.torque_position_derivatives,
    "d tau / d qd": dynamics.torque_velocity_derivatives,
    "Y": dynamics.regressors,
    "Y_b": dynamics.base_regressors,
    "beta": dynamics.base_parameters,
}


@cache
def trace_of(seed: int) -> Trace:
    return Trace(Robot.from_text(random_robot(random.Random(seed), 1 + seed % 3).text), Effort.QUICK)


@pytest.mark.first(25)
@pytest.mark.parametrize("name", FORMULATIONS)
@pytest.mark.parametrize("seed", range(6))
def test_formulations_agree(name: str, seed: int) -> None:
    trace = trace_of(seed)
    found = {way.words: numbers(trace, way.trace()) for way in FORMULATIONS[name](trace)}
    assert found
    first = next(iter(found.values()))
    for words, values in found.items():
        assert np.abs(values - first).max(initial=0.0) <= 1e-11 * max(1.0, np.abs(first).max(initial=0.0)), words


def test_most_functions_can_be_computed_in_several_ways() -> None:
    several = {name for name, ways in FORMULATIONS.items() for seed in range(6) if len(list(ways(trace_of(seed)))) > 1}
    assert len(several) >= 8


def by_runs(trace: Trace) -> list[Frame[Value]]:
    poses: list[Frame[Value]] = []
    pose = trace.chain.base
    unit = identity(trace.chain.zero, trace.chain.one)
    for run in trace.runs:
        entry = pose @ run.fixed
        for place in run.placements:
            x, y, z = (multiply(entry.rotation, place.turned(column(unit, k))) for k in range(3))
            rotation: tuple[Vector[Value], Vector[Value], Vector[Value]] = tuple(zip(x, y, z, strict=True))  # type: ignore[assignment]
            poses.append(Frame(rotation, add(entry.position, multiply(entry.rotation, place.origin))))
        pose = poses[-1]
    return poses


def entries(poses: Sequence[Frame[Value]]) -> list[Value]:
    return [v for pose in poses for row in (*pose.rotation, pose.position) for v in row]


@pytest.mark.parametrize("seed", range(15))
def test_frames_by_sums_of_angles_are_those_joint_after_joint(seed: int) -> None:
    trace = parallel_arm(seed)
    found, wanted = (numbers(trace, entries(poses)) for poses in (by_runs(trace), joint_poses(trace.chain)))
    assert np.abs(found - wanted).max() < 1e-13


@pytest.mark.parametrize("seed", range(15))
def test_axes_of_a_run_are_parallel_and_runs_are_as_long_as_can_be(seed: int) -> None:
    trace = parallel_arm(seed)
    poses, joints = joint_poses(trace.chain), trace.chain.joints
    axes = numbers(trace, [v for pose in poses for v in column(pose.rotation, 2)]).reshape(-1, 3)
    placed = [
        (run.first, place.direction, i) for run in trace.runs for i, place in enumerate(run.placements, run.first)
    ]
    for (run, direction, i), (own, turned, k) in pairwise(row for row in placed if joints[row[2]].revolute):
        parallel = np.linalg.norm(np.cross(axes[i], axes[k])) < 1e-12
        assert parallel == (run == own)
        assert not parallel or axes[i] @ axes[k] == pytest.approx(direction * turned)


def test_nearly_parallel_is_not_parallel_and_a_sum_of_angles_costs_its_additions() -> None:
    trace = Trace(robot_of_rows("R alpha: 1e-9, a: 1 | R a: 1"))
    assert [run.first for run in parallel_runs(trace.chain, trace.domain.cosine_sine_of_sum)] == [0, 1]
    trace = Trace(robot_of_rows("R | R | R"))
    place = trace.runs[0].placements[2]
    tape = cut(*bake(trace.graph, [place.cosine.ref, place.sine.ref], trace.choice.numbers))
    assert tape.operations == Operations(add=2, sin=1, cos=1)


PUMA = "R alpha: pi/2 | R a: a2 | R a: a3, d: d3, alpha: -pi/2 | R d: d4, alpha: pi/2 | R alpha: -pi/2 | R"
SQUARE = (
    "R alpha: pi/2 | R alpha: -pi/2 | R d: d3, alpha: -pi/2 | R alpha: pi/2 | R d: d5, alpha: pi/2 | R alpha: -pi/2 | R"
)


def any_arm(seed: int) -> Trace:
    return Trace(Robot.from_text(random_robot(random.Random(seed), dynamics=False).text))


def long_arm(seed: int) -> Trace:
    return parallel_arm(3, joints=24)


@pytest.mark.parametrize("make", [parallel_arm, any_arm, long_arm])
@pytest.mark.parametrize("seed", seeds(12, usual=5))
def test_the_cheapest_ways_give_pose_frames_and_jacobian(make: Callable[[int], Trace], seed: int) -> None:
    if make is long_arm and seed:  # one of them
        return
    trace = make(seed)
    chain, stations = trace.chain, trace.stations
    pairs: list[tuple[list[Frame[Value]], list[Frame[Value]]]] = [
        ([cheapest_pose(stations)], [forward_kinematics(chain)]),
        (cheapest_links(stations), link_transforms(chain)),
    ]
    outputs = [
        tuple([v for frame in frames for v in flat(frame.rows(chain.zero, chain.one))] for frames in pair)
        for pair in pairs
    ]
    outputs.append((flat(cheapest_jacobian(stations)), flat(jacobian(chain))))
    for found, wanted in outputs:
        assert np.abs(numbers(trace, found) - numbers(trace, wanted)).max() < 1e-13 * 4**trace.n


@pytest.mark.parametrize(
    ("joints", "pose", "links", "columns"),
    [(SQUARE, 84, 99, 83), (PUMA, 60, 78, 45), ("R a: a1 | R a: a2", 7, 7, 7), ("|".join(["R a: a1"] * 4), 11, 17, 17)],
    ids=["7R", "PUMA", "2R", "4R"],
)
def test_counts(joints: str, pose: int, links: int, columns: int) -> None:
    program = build_program(robot_of_rows(joints))
    names = ("forward_kinematics", "link_transforms", "jacobian")
    assert [program[name].operations.arithmetic for name in names] == [pose, links, columns]


def test_a_planar_arm_needs_a_sine_and_a_cosine_per_joint() -> None:
    program = build_program(robot_of_rows("R a: a1 | R a: a2"))
    assert program["forward_kinematics"].operations == Operations(mul=4, add=3, sin=2, cos=2)


def test_a_tool_that_is_a_rotation_in_six_places_is_taken_as_written() -> None:
    tool = "tool: [[0.8660254, -0.5, 0, 0.2], [0.5, 0.8660254, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]\n"
    trace = Trace(robot_of_rows(PUMA, tool))
    assert trace.stations is None
    assert build_program(trace.robot)["jacobian"].operations.arithmetic > 0


Groups = list[list[list[Ref]]]


def random_groups(seed: int) -> tuple[Graph, Groups]:
    rng, graph = random.Random(seed), Graph()
    pool = [graph.input("q", i) for i in range(4)]
    for _ in range(25):
        pool.append(rng.choice([graph.add, graph.multiply])(*rng.sample(pool, 2)))
    return graph, [[rng.sample(pool, 2) for _ in range(rng.randint(1, 4))] for _ in range(4)]


def spent(graph: Graph, groups: Groups, places: tuple[int, ...]) -> int:
    return program_cost(
        graph, [ref for options, place in zip(groups, places, strict=True) for ref in options[place]]
    ).body


@pytest.mark.parametrize("seed", range(15))
def test_no_combination_with_one_change_is_cheaper(seed: int) -> None:
    graph, groups = random_groups(seed)
    places = choose(graph, groups)
    for group, options in enumerate(groups):
        for place in range(len(options)):
            assert spent(graph, groups, places) <= spent(graph, groups, (*places[:group], place, *places[group + 1 :]))


def test_the_cheapest_combination_is_nearly_always_found() -> None:
    cases = [random_groups(seed) for seed in range(15)]
    best = [
        min(spent(graph, groups, places) for places in product(*(range(len(options)) for options in groups)))
        for graph, groups in cases
    ]
    found = [spent(graph, groups, choose(graph, groups)) for graph, groups in cases]
    assert sum(found) <= 1.02 * sum(best)


def test_a_sine_is_worth_many_products() -> None:
    graph = Graph()
    x, y = graph.input("q", 0), graph.input("q", 1)
    products = x
    for _ in range(20):
        products = graph.multiply(products, y)
    assert choose(graph, [[[graph.sine(x)], [products]]]) == (1,)


def recursions(trace: Trace) -> list[list[Value]]:
    chain, rates = trace.chain, trace.arguments(QD)
    return [
        flat(inertia_matrix(chain)),
        flat(coriolis_matrix(chain, rates, trace.half)),
        gravity_vector(chain),
        [kinetic_energy(chain, rates, trace.half)],
        [potential_energy(chain)],
        inverse_dynamics(chain, rates, trace.arguments(QDD)),
    ]


@pytest.mark.parametrize("sums", [False, True], ids=["angles", "sums"])
@pytest.mark.parametrize("seed", range(8))
def test_closed_forms_are_the_recursions(seed: int, sums: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("derive.programs.formulations.trace.POLICY", replace(POLICY, closed_form_terms=4000))
    robot = random_robot(random.Random(seed), 1 + seed % 2)
    trace = Trace(Robot.from_text(robot.text))
    form = ClosedForm(trace.robot, trace.domain, sums=sums)
    found = [form.values(name) for name in CLOSED_FORMS]
    for values, wanted in zip(found, recursions(trace), strict=True):
        if values is not None:
            expected = numbers(trace, wanted)
            assert np.abs(numbers(trace, values) - expected).max() <= 1e-12 * max(1, np.abs(expected).max())
    assert found[0] is not None


def test_textbook_arms_are_as_in_the_textbook_and_long_closed_forms_not_offered() -> None:
    program = build_program(robot_of_rows("R a: a1 | R a: a2", TWO_BARS))
    assert program["inertia_matrix"].operations.arithmetic <= 4
    assert program["coriolis_matrix"].operations.arithmetic <= 4
    assert program["gravity_vector"].operations.arithmetic <= 5
    assert program["inverse_dynamics"].operations.arithmetic <= 26
    robot = Robot.from_text(random_robot(random.Random(4), 6).text)
    trace = Trace(robot)
    assert [form.values("inverse_dynamics") for form in trace.closed_forms] == [None] * len(trace.closed_forms)


LINK = "  - {mass: 2.5, com: [0.1, -0.2, 0.3], inertia: {xx: 0.3, yy: 0.2, zz: 0.4, xy: 0.01, xz: 0.02, yz: 0.03}}\n"


def scara(crossing: str = "") -> Robot:
    rows = f"R a: 0.4 | R a: 0.3, d: 0.1, alpha: pi | P | R d: 0.2{crossing} | R alpha: pi/2"
    return robot_of_rows(rows, "gravity: [0, 0, -9.81]\nlinks:\n" + 5 * LINK)


def random_choices(trace: Trace, rng: random.Random) -> FrameChoices:
    return tuple(
        FrameChoice(
            place=rng.choice(places(trace.chain, i)),
            held=holdable(trace.chain, i) and rng.random() < 0.5,
            second_moments=rng.random() < 0.5,
            column=rng.random() < 0.5,
            squares=rng.random() < 0.5,
            grown=rng.random() < 0.5,
        )
        for i in range(trace.n)
    )


def outputs(trace: Trace, choices: FrameChoices) -> list[Value]:
    chain, rates, gains = trace.arranged(choices), trace.arguments("qd"), trace.arguments("qdd")
    torques = inverse_dynamics(trace.arranged(choices, axial=True), rates, gains, choices)
    matrices = [*flat(inertia_matrix(chain)), *flat(coriolis_matrix(chain, rates, trace.half))]
    return [*torques, *matrices, *gravity_vector(chain)]


@pytest.mark.parametrize("seed", [*seeds(24, usual=8), pytest.param(-1, id="parallel axes that point either way")])
def test_every_form_gives_the_same_values(seed: int) -> None:
    rng = random.Random(seed)
    trace = Trace(scara() if seed < 0 else Robot.from_text(random_robot(rng, 1 + seed % 6).text))
    expected = numbers(trace, outputs(trace, (PLAIN,) * trace.n))
    for _ in range(12 if seed < 0 else 3):
        found = numbers(trace, outputs(trace, random_choices(trace, rng)))
        assert np.abs(found - expected).max() <= 1e-12 * max(1.0, np.abs(expected).max())


@pytest.mark.parametrize(("crossing", "held"), [("", [True] * 5), (", alpha: pi/2", [True, True, True, False, True])])
def test_links_between_parallel_axes_are_held_and_one_before_a_crossing_axis_is_not(
    crossing: str, held: list[bool]
) -> None:
    chain = Trace(scara(crossing)).chain
    assert [holdable(chain, i) for i in range(5)] == held


def test_the_search_never_ends_above_its_starts() -> None:
    trace = Trace(scara())

    def trial(choices: FrameChoices) -> tuple[int, ...]:
        return tuple(value.ref for value in outputs(trace, choices))

    price = trace.choice.price
    starts = starting_choices(trace.chain)
    best, *close = FrameChoiceSearch(trace.chain, ALL_CHOICES, trial, price).best(starts, 3)
    costs = [price(trial(choices)).body for choices in (best, *close)]
    assert costs == sorted(costs)
    assert costs[0] < min(price(trial(choices)).body for choices in starts)
