"""Many configurations: what is said of them is what NumPy says of all, whoever computed it."""

from math import pi

import numpy as np
import pytest

import derive
from derive.api import sample
from derive.errors import DeriveError, RobotFileWarning
from derive.robot.robot import Robot
from derive.sampling.sample import BLOCK, KINDS, QUANTILES, Sampled
from derive.verification.oracle.functions import Oracle

ARM = Robot.from_text("""
name: arm
convention: standard
joints: [{type: revolute, a: 0.5, limits: [-2, 1], speed: 2}, {type: revolute, a: a2, speed: 3, limits: [-pi, pi]}]
gravity: [0, -9.81, 0]
links: [{mass: 2, com: [-0.2, 0, 0], inertia: {zz: 0.1}}, {mass: 1, com: [-0.1, 0, 0], inertia: {zz: 0.05}}]
parameters: {a2: 0.4}
""")
NUMBER = 3 * BLOCK + 1000


def tau(**options: object) -> Sampled:
    return derive.sample(ARM, "tau", number=NUMBER, reduce=KINDS, bounds={"qdd": [4, 5]}, **options)["inverse_dynamics"]


def test_reductions_are_those_of_the_oracle_at_all_configurations() -> None:
    """Drawn apart: the numbers of a block follow each other in Philox, those of two blocks are 2^64 apart."""
    generators = [np.random.Generator(np.random.Philox(key=0).advance(block << 64)) for block in range(4)]
    low, high = np.array([-2, -pi, -2, -3, -4, -5]), np.array([1, pi, 2, 3, 4, 5])
    rows = low + (high - low) * np.concatenate([each.random((BLOCK, 6)) for each in generators])[:NUMBER]
    q, qd, qdd = np.split(rows, 3, axis=1)
    expected = Oracle.of(ARM).evaluate("inverse_dynamics", q, qd, qdd)
    found = tau()
    for kind, reduction in (("min", np.min), ("mean", np.mean), ("max", np.max)):
        np.testing.assert_allclose(found.reductions[kind], reduction(expected, axis=0), rtol=1e-12, atol=1e-12)
    quantiles = np.quantile(expected, QUANTILES, axis=0)
    np.testing.assert_allclose(found.reductions["quantiles"], quantiles, rtol=2e-3, atol=2e-3)
    for kind, place in (("min", expected.argmin(axis=0)), ("max", expected.argmax(axis=0))):
        for name, values in (("q", q), ("qd", qd), ("qdd", qdd)):
            np.testing.assert_allclose(found.where[kind][name], values[place], atol=1e-14)


@pytest.mark.sweep
def test_neither_workers_nor_chunks_nor_a_scheduler_change_a_bit() -> None:
    usual = tau()
    ways: list[dict[str, object]] = [{"workers": 1}, {"workers": 4, "chunk": 1}, {"chunk": 2 * BLOCK}, {"chunk": 10**9}]
    distributed = pytest.importorskip("distributed")
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as local:
        for options in (*ways, {"scheduler": local.scheduler_address, "chunk": BLOCK}):
            found = tau(**options)
            assert all(found.reductions[kind].tobytes() == usual.reductions[kind].tobytes() for kind in KINDS), options
    assert tau(seed=1).reductions["mean"].tobytes() != usual.reductions["mean"].tobytes()


def test_a_grid_has_the_ends_of_every_range_and_a_mean_is_that_of_a_sine() -> None:
    """Of a planar arm w = a1 a2 |sin q2|."""
    name = "manipulability_position"
    found = derive.sample(ARM, name, over="grid", number=210)[name]
    assert found.number == 14 * 14
    np.testing.assert_allclose(found.reductions["max"], 0.2 * np.sin(7 * pi / 13), rtol=1e-12)
    assert found.where["min"]["q"].tolist() == [-2.0, -pi]
    mean = derive.sample(ARM, name, number=4e5)[name].reductions["mean"]
    assert abs(mean - 0.2 * 2 / pi) < 5 * 0.2 * 0.31 / np.sqrt(4e5)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"functions": "taw"}, "no function 'taw'; did you mean 'tau'"),
        ({"functions": "base_parameters"}, "is the same in every configuration"),
        ({"functions": "tau"}, "qdd has no bounds; give --qdd: one number or 2"),
        ({"functions": "tau", "bounds": {"qdd": [1, 2, 3]}}, "--qdd 1, 2, 3; allowed: one number from 0 on, or 2"),
        ({"functions": "g", "over": "grids"}, "no 'grids'; did you mean 'grid'"),
        ({"functions": "g", "reduce": "median"}, "no 'median'; did you mean"),
        ({"functions": "g", "number": 0}, "number 0, seed 0, chunk 100000; allowed: whole numbers"),
        ({"functions": "g", "workers": 2, "scheduler": "tcp://a:1"}, "--workers with --scheduler"),
    ],
)
def test_what_cannot_be_sampled_is_refused(options: dict[str, object], said: str) -> None:
    assert sample.OVER == ("limits", "grid")
    with pytest.raises(DeriveError, match=said):
        derive.sample(ARM, **options)


def test_joints_without_limits_and_symbols_without_numbers() -> None:
    rows = "name: x\nconvention: standard\njoints: [{type: %s, a: %s}]"
    with pytest.raises(DeriveError, match="q1 of x slides without limits; give it limits"):
        derive.sample(Robot.from_text(rows % ("prismatic", "1")), "T")
    free = Robot.from_text(rows % ("revolute", "a1"))
    with pytest.warns(RobotFileWarning, match="no limits of q1: full turns"):
        found = derive.sample(free, "T", number=2e4, parameters={"a1": 2.0})["forward_kinematics"]
    np.testing.assert_allclose(found.reductions["max"][0, 3], 2.0, atol=1e-4)
    with pytest.warns(RobotFileWarning), pytest.raises(DeriveError, match="no number for a1 of x; write parameters"):
        derive.sample(free, "T")
