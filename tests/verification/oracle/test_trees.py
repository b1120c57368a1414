"""The oracle of trees against Pinocchio, and against the serial arms to their ends."""

import random
from collections.abc import Callable, Sequence

import numpy as np
import pytest

from derive.robot.inertial_parameters import LINK_PARTS, Parameter, standard_parameters
from derive.robot.robot import Robot
from derive.robot.task_rows import PARTS
from derive.robot.tree import arm
from derive.verification.oracle import functions
from derive.verification.oracle.frames import task_rows
from derive.verification.oracle.functions import ANGLES, FUNCTIONS, Oracle, stem
from derive.verification.oracle.rates import distance_from_singularity
from derive.verification.samples import SampleSet
from derive.verification.tolerance import Bounds, expectation
from tests.random_robots import configurations, seeds
from tests.random_trees import RandomTree, random_tree
from tests.verification.oracle.pinocchio_reference import Array, Reference, TreeBuilder
from tests.verification.oracle.test_physics import TOLERANCE, motion, relative_error
from tests.verification.test_trials import NOT_BOUNDED


def check_functions(drawn: RandomTree, robot: Robot, s: Array, wanted_of: Callable[..., Array], seed: int) -> None:
    """Every function of a robot whose joints, those of a tree in Pinocchio, are s times its variables."""
    oracle, builder = Oracle.of(robot), TreeBuilder(drawn)
    whole, arguments = builder.build(), motion(robot.dof, seed)
    for name in oracle.functions:
        function, numbers, outside = stem(name), oracle.seen(name), whole
        given = [arguments[argument] for argument in FUNCTIONS[function].arguments]
        if function.startswith((*functions.OF_AN_END, "task")):
            rows = {part: tuple(task_rows(numbers, part)) for part in ("all", *PARTS)}
            outside = builder.at(whole, name.removeprefix(function)[1:], rows)
        got, wanted, joints = oracle.evaluate(name, *given), wanted_of(outside, function, s, given), s @ given[0]
        got = got[builder.before :] if function == "link_transforms" else got
        near = distance_from_singularity(numbers, ANGLES[function], joints) if function in ANGLES else 1.0
        if outside.determines(function, joints):
            assert relative_error(got, wanted) * near < TOLERANCE, name
            batch = tuple(argument[None] for argument in given)
            if function != "link_transforms":  # entry by entry, as generated code is compared
                assert expectation(name, SampleSet({}, oracle, {}), batch).errors(wanted[None]).max() < 1e-9, name


@pytest.mark.parametrize("seed", seeds(200, 4, 200))
def test_every_function_agrees_with_pinocchio(seed: int) -> None:
    drawn = random_tree(random.Random(seed))

    def _wanted(outside: Reference, name: str, _: Array, given: Sequence[Array]) -> Array:
        return np.asarray(getattr(outside, name)(*given))

    check_functions(drawn, drawn.robot, np.eye(drawn.robot.n), _wanted, seed)


@pytest.mark.parametrize("seed", seeds(40, 3, 20))
def test_functions_of_an_end_are_those_of_the_serial_arm_to_it(seed: int) -> None:
    """Joints off the way have columns of zeros."""
    drawn = random_tree(random.Random(seed))
    oracle, q = Oracle.of(drawn.robot), configurations(random.Random(seed), drawn.robot.n)[0]
    for end in drawn.ends:
        robot, places = arm(drawn.robot, end)
        serial, suffix = Oracle.of(robot), f"_{end}" if end else ""
        for name in ("forward_kinematics", "manipulability", "manipulability_position", "manipulability_orientation"):
            assert relative_error(oracle.evaluate(name + suffix, q), serial.evaluate(name, q[list(places)])) < TOLERANCE
        wanted = np.zeros((6, len(q)))
        wanted[:, list(places)] = serial.evaluate("jacobian_end", q[list(places)])
        assert relative_error(oracle.evaluate(f"jacobian_end{suffix}", q), wanted) < TOLERANCE


@pytest.mark.parametrize("seed", seeds(40, 3, 20))
def test_the_regressor_of_a_link_and_of_what_is_fixed_on_it_gives_the_torques(seed: int) -> None:
    robot = random_tree(random.Random(seed), 1 + seed % 6).robot
    oracle, (q, qd, qdd, *_) = Oracle.of(robot, base=()), motion(robot.n, seed).values()
    numbers = oracle.arm
    values = dict[Parameter, float]()
    for parameter in standard_parameters(robot):
        i, part = parameter.joint - 1, parameter.part
        joint = {"mm": "rotor_mass", "Im": "rotor_inertia", "Ia": "armature", "b": "viscous"}.get(part)
        values[parameter] = getattr(numbers, joint)[i] if joint else numbers.coulomb[0, i] if part == "f" else 0.0
    for i, mass, com, tensor in zip(numbers.carrier, numbers.mass, numbers.com, numbers.inertia, strict=True):
        about_origin = tensor + mass * (com @ com * np.eye(3) - np.outer(com, com))
        of_body = [mass, *(mass * com), *about_origin[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]]
        for part, value in zip(LINK_PARTS, of_body if i >= 0 else (), strict=False):
            values[Parameter(i + 1, part)] += value
    found = oracle.evaluate("regressor", q, qd, qdd) @ np.array(list(values.values()))
    assert relative_error(found, oracle.evaluate("inverse_dynamics", q, qd, qdd)) < TOLERANCE


@pytest.mark.parametrize("seed", seeds(40, 3, 20))
def test_values_of_trees_keep_within_their_natural_size(seed: int) -> None:
    oracle = Oracle.of(random_tree(random.Random(seed)).robot)
    arguments = motion(oracle.arm.n, seed)
    for name in oracle.functions:
        given = tuple(arguments[argument] for argument in FUNCTIONS[stem(name)].arguments)
        if stem(name) not in NOT_BOUNDED | {"manipulability_dq"}:
            limits = Bounds(oracle, given[0], name)
            # Of slides' derivatives they count the reach of bodies, of positions that of frames.
            size = limits.natural_size(name, given) * max(1.0, limits.reach / limits.extent)
            assert (np.abs(oracle.evaluate(name, *given)) <= size * (1 + 1e-12)).all(), name
