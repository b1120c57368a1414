"""Runs of parallel axes: joint frames by sums of angles are those of the chain, joint after joint."""

from collections.abc import Sequence

import numpy as np
import pytest

from derive.mechanics.forward_kinematics import joint_poses
from derive.mechanics.vectors import Frame, Vector, add, column, identity, multiply
from derive.programs.formulations.trace import Trace
from derive.programs.tape.build import bake, cut
from derive.programs.tape.tape import Operations
from derive.programs.tape.value import Value
from derive.robot.robot import Robot
from tests.programs.parallel_arms import numbers, parallel_arm


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
    """All of them."""
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
    last: tuple[int, int] | None = None
    for run in trace.runs:
        for i, place in enumerate(run.placements, run.first):
            if joints[i].revolute:
                if last is not None:
                    parallel = np.linalg.norm(np.cross(axes[last[1]], axes[i])) < 1e-12
                    assert parallel == (last[0] == run.first)
                    assert not parallel or axes[last[1]] @ axes[i] == pytest.approx(
                        place.direction * direction_of(trace, last)
                    )
                last = (run.first, i)


def direction_of(trace: Trace, place: tuple[int, int]) -> int:
    run = next(run for run in trace.runs if run.first == place[0])
    return run.placements[place[1] - run.first].direction


def test_nearly_parallel_is_not_parallel() -> None:
    rows = "  - {type: revolute, alpha: 1e-9, a: 1}\n  - {type: revolute, a: 1}\n"
    trace = Trace(Robot.from_text(f"name: arm\nconvention: standard\njoints:\n{rows}"))
    assert [run.first for run in trace.runs] == [0, 1]


def test_a_sum_of_angles_costs_its_additions() -> None:
    rows = "  - {type: revolute}\n" * 3
    trace = Trace(Robot.from_text(f"name: arm\nconvention: standard\njoints:\n{rows}"))
    place = trace.runs[0].placements[2]
    tape = cut(*bake(trace.graph, [place.cosine.ref, place.sine.ref], trace.choice.numbers))
    assert tape.operations == Operations(add=2, sin=1, cos=1)
