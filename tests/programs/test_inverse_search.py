"""What generated code of arms without formulas takes of the arm."""

import numpy as np

from derive.algebra.constants import to_float
from derive.programs.inverse_search import FRAME_ENTRIES
from derive.programs.tape.tape import PARAMETER, evaluate
from derive.verification.oracle.frames import forward_kinematics, numeric_arm
from tests.programs.test_inverse import ARITHMETIC
from tests.targets.searched_arms import GENERAL, LOOSE, PARAMETERS, robot_of, search_of


def test_frames_and_motions_between_them_are_the_pose() -> None:
    robot, search = robot_of(GENERAL), search_of(GENERAL)
    values = evaluate(search.function.tape, {PARAMETER: list(PARAMETERS.values())}, ARITHMETIC | {"number": to_float})
    frames = np.tile(np.eye(4), (robot.n + 1, 1, 1))
    frames[:, :3] = np.reshape(np.array(values, dtype=float), (robot.n + 1, 3, FRAME_ENTRIES // 3))
    q = np.random.default_rng(1).uniform(-2, 2, robot.n)
    pose = np.eye(4)
    for joint, frame, value in zip(robot.joints, frames[:-1], joint_values(robot.joints, q), strict=True):
        motion = np.eye(4)
        if joint.is_revolute:
            motion[:2, :2] = [[np.cos(value), -np.sin(value)], [np.sin(value), np.cos(value)]]
        else:
            motion[2, 3] = value
        pose = pose @ frame @ motion
    expected = forward_kinematics(numeric_arm(robot, PARAMETERS), q[None])[0]
    np.testing.assert_allclose(pose @ frames[-1], expected, atol=1e-14)


def joint_values(joints: tuple, q: np.ndarray) -> list[float]:  # type: ignore[type-arg]
    """How far each joint moves about or along its axis."""
    return [joint.sign * value for joint, value in zip(joints, q, strict=True)]


def test_general_arms_have_eliminations_and_a_count_and_others_neither() -> None:
    general, loose = search_of(GENERAL), search_of(LOOSE)
    assert general.given == (3,)
    assert general.count == general.branches == 16
    assert general.summary.startswith(
        "A reachable pose has up to 16 solutions (complete), or infinitely many if joints are arbitrary, from the "
        "eigenvalues of a "
    )
    assert all(each.hidden != each.multiplied for each in general.eliminations)
    assert (loose.eliminations, loose.count, loose.branches) == ((), 0, 16)
    assert "solutions may be missing" in loose.summary
    assert set(loose.entries) == {(0, 0), (1, 0), (0, 3), (1, 3), (2, 3)}
