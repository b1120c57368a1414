"""From where the arm of a motion is seen."""

from __future__ import annotations

import numpy as np
import pytest

from derive.motion.motion import Motion
from derive.motion.output.film import Film
from derive.motion.output.page import motion_page
from derive.motion.output.plane import frames_of, motion_normal
from tests.motion.plans import PICK_AND_PLACE
from tests.motion.skeleton import REACH, ROOT


@pytest.mark.parametrize("text", [ROOT, REACH, REACH.replace("rpy: [0, 0, t/7]", "x: t").replace("x: 3*t/10, ", "")])
def test_skeletons_are_seen_in_their_plane(text: str) -> None:
    normal = motion_normal(Motion.from_text(text))
    assert normal is not None
    assert np.abs(normal) == pytest.approx([0, 0, 1], abs=1e-12)


@pytest.mark.parametrize(
    "text", [PICK_AND_PLACE, REACH.replace("[0, 0, t/7]", "[t, 0, 0]"), REACH.replace("x: 3*t/10", "z: 3*t/10")]
)
def test_what_leaves_a_plane_is_seen_in_space(text: str) -> None:
    assert motion_normal(Motion.from_text(text)) is None


def test_the_film_of_a_planar_arm_keeps_lengths() -> None:
    film = Film(Motion.from_text(ROOT))
    ends = film._view.project(film._poses[:, [2, 3, -1]][..., :3, 3])[..., :2]
    lengths = np.linalg.norm(np.diff(ends, axis=1), axis=-1)
    assert lengths == pytest.approx(np.tile([0.4, 0.3], (len(lengths), 1)), rel=1e-6)


def test_the_page_faces_the_plane() -> None:
    assert '"facing": [' in motion_page(Motion.from_text(ROOT))


def test_frames_go_with_the_base() -> None:
    motion = Motion.from_text(REACH)
    t = np.array([0.0, 2.0])
    frames = frames_of(motion, t, motion(t)[0])
    base = motion.base
    assert base is not None
    assert frames[:, 0, :3, 3] == pytest.approx(np.array([at[:3, :3] @ [0.1, 0.2, 0] + at[:3, 3] for at in base(t, 0)]))
