"""Many configurations: what is said of them is what NumPy says of all, whoever computed it."""

from math import pi

import numpy as np
import pytest

import derive
from derive.api.sample import Sample
from derive.errors import DeriveError
from derive.robot.robot import Robot
from derive.sampling.configurations import BLOCK
from derive.sampling.reductions import QUANTILES
from derive.verification.oracle.functions import Oracle

ARM = Robot.from_text("""
name: arm
convention: standard
joints: [{type: revolute, a: 0.5, limits: [-2, 1], speed: 2}, {type: revolute, a: a2, speed: 3}]
gravity: [0, -9.81, 0]
links: [{mass: 2, com: [-0.2, 0, 0], inertia: {zz: 0.1}}, {mass: 1, com: [-0.1, 0, 0], inertia: {zz: 0.05}}]
parameters: {a2: 0.4}
""")
KINDS = ("min", "mean", "max", "quantiles")
NUMBER = 3 * BLOCK + 1000


def tau(**options: object) -> Sample:
    return derive.sample(ARM, "tau", number=NUMBER, reduce=KINDS, qdd=[4, 5], **options)


def drawn(seed: int = 0) -> np.ndarray:
    """All configurations of ``tau``, drawn apart from `Configurations`, from one counter of Philox after another."""
    rows = []
    for block in range(4):
        generator = np.random.Generator(np.random.Philox(key=seed, counter=np.array([0, block, 0, 0], np.uint64)))
        rows.append(generator.random((BLOCK, 6)))
    low, high = np.array([-2, -pi, -2, -3, -4, -5]), np.array([1, pi, 2, 3, 4, 5])
    return (low + (high - low) * np.concatenate(rows))[:NUMBER]


def test_reductions_are_those_of_the_oracle_at_all_configurations() -> None:
    q, qd, qdd = np.split(drawn(), 3, axis=1)
    expected = Oracle.of(ARM).evaluate("inverse_dynamics", q, qd, qdd)
    found = tau().functions["inverse_dynamics"]
    for kind, reduction in (("min", np.min), ("mean", np.mean), ("max", np.max)):
        np.testing.assert_allclose(found.reductions[kind], reduction(expected, axis=0), rtol=1e-12, atol=1e-12)
    quantiles = np.quantile(expected, QUANTILES, axis=0)
    np.testing.assert_allclose(found.reductions["quantiles"], quantiles, rtol=2e-3, atol=2e-3)
    for kind, place in (("min", expected.argmin(axis=0)), ("max", expected.argmax(axis=0))):
        for name, values in (("q", q), ("qd", qd), ("qdd", qdd)):
            np.testing.assert_allclose(found.where[kind][name], values[place], atol=1e-14)


def test_neither_workers_nor_chunks_change_a_bit() -> None:
    usual = tau()
    for options in ({"workers": 1}, {"workers": 4, "chunk": 1}, {"chunk": 2 * BLOCK}, {"workers": 2, "chunk": 10**9}):
        assert same(usual, tau(**options)), options
    assert not same(usual, tau(seed=1))


def same(one: Sample, other: Sample) -> bool:
    pairs = [(one.functions[name], other.functions[name]) for name in one.functions]
    return all(a.reductions[kind].tobytes() == b.reductions[kind].tobytes() for a, b in pairs for kind in a.reductions)


def test_processes_and_a_scheduler_give_the_same_bytes() -> None:
    """Workers compile for themselves what they are sent."""
    distributed = pytest.importorskip("distributed")
    usual = tau()
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as local:
        assert same(usual, tau(scheduler=local.scheduler_address, chunk=BLOCK))


def test_a_grid_has_the_ends_of_every_range() -> None:
    """Of a planar arm w = a1 a2 |sin q2|."""
    found = derive.sample(ARM, ["manipulability_position", "U"], over="grid", number=210)
    assert found.number == 14 * 14
    best, angles = found.functions["manipulability_position"], np.linspace(-pi, pi, 14)
    np.testing.assert_allclose(best.reductions["max"], 0.2 * np.abs(np.sin(angles)).max(), rtol=1e-12)
    assert best.where["min"]["q"].tolist() == [-2.0, -pi]


def test_the_mean_over_a_turn_is_that_of_a_sine() -> None:
    mean = (
        derive.sample(ARM, "manipulability_position", number=4e5)
        .functions["manipulability_position"]
        .reductions["mean"]
    )
    assert abs(mean - 0.2 * 2 / pi) < 5 * 0.2 * 0.31 / np.sqrt(4e5)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"functions": "taw"}, "no function 'taw'; did you mean 'tau'"),
        ({"functions": "base_parameters"}, "is the same in every configuration"),
        ({"functions": "tau"}, "qdd has no bounds; give --qdd: one number or 2"),
        ({"functions": "tau", "qdd": [1, 2, 3]}, "--qdd 1, 2, 3; allowed: one number from 0 on, or 2"),
        ({"functions": "g", "over": "grids"}, "no 'grids'; did you mean 'grid'"),
        ({"functions": "g", "reduce": "median"}, "no 'median'; did you mean"),
        ({"functions": "g", "number": 0}, "number 0, seed 0, chunk 100000; allowed: whole numbers"),
        ({"functions": "g", "workers": 2, "scheduler": "tcp://a:1"}, "--workers with --scheduler"),
    ],
)
def test_what_cannot_be_sampled_is_refused(options: dict[str, object], said: str) -> None:
    with pytest.raises(DeriveError, match=said):
        derive.sample(ARM, **options)


def test_a_slide_without_limits_and_a_symbol_without_a_number_are_refused() -> None:
    rows = "name: x\nconvention: standard\njoints: [{type: %s, a: %s}]"
    with pytest.raises(DeriveError, match="q1 of x slides without limits; give it limits"):
        derive.sample(Robot.from_text(rows % ("prismatic", "1")), "T")
    free = Robot.from_text(rows % ("revolute", "a1"))
    with pytest.raises(DeriveError, match="no number for a1 of x; write parameters"):
        derive.sample(free, "T")
    best = (
        derive.sample(free, "T", number=2e4, parameters={"a1": 2.0}).functions["forward_kinematics"].reductions["max"]
    )
    np.testing.assert_allclose(best[0, 3], 2.0, atol=1e-4)
