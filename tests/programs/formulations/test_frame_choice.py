"""Whatever choices the joints take, the recursions compute the same; the search finds cheap ones and stops."""

import random
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
import pytest

from derive.mechanics.coriolis import coriolis_matrix
from derive.mechanics.inertia_matrix import gravity_vector, inertia_matrix
from derive.mechanics.newton_euler import PLAIN, FrameChoice, inverse_dynamics
from derive.programs.formulations.frame_choice import (
    ALL_CHOICES,
    FrameChoices,
    FrameChoiceSearch,
    holdable,
    places,
    starting_choices,
)
from derive.programs.formulations.trace import Trace, flat
from derive.programs.tape.build import bake, cut
from derive.programs.tape.tape import PARAMETER, evaluate
from derive.programs.tape.value import Value
from derive.robot.names import free_symbols
from derive.robot.robot import Robot
from tests.programs.formulations.test_recursions import ARITHMETIC
from tests.random_robots import random_robot, seeds

SCARA = """
name: scara
convention: standard
joints:
  - {type: revolute, a: 0.4}
  - {type: revolute, a: 0.3, d: 0.1, alpha: pi}
  - {type: prismatic}
  - {type: revolute, d: 0.2}
  - {type: revolute, alpha: pi/2}
gravity: [0, 0, -9.81]
links:
"""
LINK = "  - {mass: 2.5, com: [0.1, -0.2, 0.3], inertia: {xx: 0.3, yy: 0.2, zz: 0.4, xy: 0.01, xz: 0.02, yz: 0.03}}\n"


def scara() -> Robot:
    return Robot.from_text(SCARA + 5 * LINK)


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


def numbers(robot: Robot, trace: Trace, values: Sequence[Value], known: dict[str, float]) -> npt.NDArray[np.float64]:
    rng = random.Random(5)
    inputs = {kind: [rng.uniform(-1.5, 1.5) for _ in range(trace.n)] for kind in ("q", "qd", "qdd")}
    inputs[PARAMETER] = [known.get(name, 0.7) for name in free_symbols(robot)]
    tape = cut(*bake(trace.graph, [value.ref for value in values], trace.choice.numbers))
    return np.array(evaluate(tape, inputs, ARITHMETIC)).real


@pytest.mark.parametrize("seed", seeds(24, usual=8))
def test_every_form_gives_the_same_values(seed: int) -> None:
    rng = random.Random(seed)
    case = random_robot(rng, 1 + seed % 6)
    robot = Robot.from_text(case.text)
    trace = Trace(robot)
    expected = numbers(robot, trace, outputs(trace, (PLAIN,) * robot.n), case.values)
    for _ in range(3):
        found = numbers(robot, trace, outputs(trace, random_choices(trace, rng)), case.values)
        assert np.abs(found - expected).max() <= 1e-12 * max(1.0, np.abs(expected).max())


def test_parallel_axes_may_be_held_whichever_way_they_point() -> None:
    robot = scara()
    trace = Trace(robot)
    assert [holdable(trace.chain, i) for i in range(5)] == [True, True, True, True, True]
    expected = numbers(robot, trace, outputs(trace, (PLAIN,) * 5), {})
    for seed in range(12):
        found = numbers(robot, trace, outputs(trace, random_choices(trace, random.Random(seed))), {})
        assert np.abs(found - expected).max() <= 1e-12 * np.abs(expected).max()


def test_a_link_before_a_crossing_axis_is_not_held() -> None:
    robot = Robot.from_text(SCARA.replace("d: 0.2}", "d: 0.2, alpha: pi/2}") + 5 * LINK)
    assert [holdable(Trace(robot).chain, i) for i in range(5)] == [True, True, True, False, True]


def test_the_search_never_ends_above_its_starts() -> None:
    robot = scara()
    trace = Trace(robot)

    def trial(choices: FrameChoices) -> tuple[int, ...]:
        return tuple(value.ref for value in outputs(trace, choices))

    price = trace.choice.price
    starts = starting_choices(trace.chain)
    best, *close = FrameChoiceSearch(trace.chain, ALL_CHOICES, trial, price).best(starts, 3)
    costs = [price(trial(choices)).body for choices in (best, *close)]
    assert costs == sorted(costs)
    assert costs[0] < min(price(trial(choices)).body for choices in starts)
