"""Films of a motion."""

import sys
from io import BytesIO
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from derive.errors import DeriveError, OutputError
from derive.motion.motion import Motion
from derive.motion.output import film
from derive.motion.output.film import HEIGHT, RATE, WIDTH, Film
from tests.motion.plans import PICK_AND_PLACE, swing

Image = pytest.importorskip("PIL.Image")

SHORT = "robot: planar-2r-perugia\npoints: {a: [0, 0], b: [pi/2, pi/3]}\npath: [a, {to: b, time: 1/4}]\n"
SHORT += "values: {a1: 1, a2: 0.8}\n"


@pytest.fixture(scope="module")
def short() -> Film:
    return Film(Motion.from_text(SHORT))


def test_a_film_lasts_as_long_as_its_motion_and_a_long_one_is_shown_faster(short: Film) -> None:
    assert short.times.tolist() == pytest.approx([0.0, 0.05, 0.1, 0.15, 0.2, 0.25])
    assert short.pace == 1
    found = Film(Motion.from_text(PICK_AND_PLACE.replace("time: 3", "time: 300")))
    assert found.pace == 20
    assert found.times.size == 1501


def test_gif_has_all_frames_and_the_same_bytes_each_time(short: Film) -> None:
    data = short.gif()
    assert data == Film(Motion.from_text(SHORT)).gif()
    picture = Image.open(BytesIO(data))
    assert (picture.size, picture.n_frames, picture.info["duration"]) == ((WIDTH, HEIGHT), 6, 1000 // RATE)


def test_the_arm_stays_in_the_picture_and_its_hand_draws_a_trace(short: Film) -> None:
    frames = [np.asarray(frame, dtype=int) for frame in short.frames()]
    for frame in frames:
        ink = (frame < 245).any(axis=2)
        border = np.concatenate([ink[0], ink[-1], ink[:, 0], ink[:, -1]])
        assert not border.any()
    red = [int(((frame[..., 0] - frame[..., 2]) > 90).sum()) for frame in frames]
    assert red[0] == 0
    assert all(after > before for before, after in pairwise(red[1:]))


def test_of_a_simulation_the_way_that_is_wanted_is_faint() -> None:
    """A pendulum on a weak spring: at the end the trace covers what happened, and not what was wanted."""
    motion = Motion.from_text(swing("0.3", "kp: 3, kd: 1"))

    def ghost(film: Film) -> int:
        last = list(film.frames())[-1]
        return sum(count for count, color in last.getcolors(1 << 20) if color == (214, 222, 236))

    assert ghost(Film(motion)) < 20
    assert ghost(Film(motion, motion.simulate())) > 100


def put_ffmpeg(folder: Path, monkeypatch: pytest.MonkeyPatch, script: str) -> None:
    """A program in its place."""
    (folder / "ffmpeg").write_text(f"#!/bin/sh\n{script}\n")
    (folder / "ffmpeg").chmod(0o755)
    monkeypatch.setenv("PATH", f"{folder}:/usr/bin:/bin")


def test_mp4_is_what_ffmpeg_makes_of_the_frames(short: Film, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    put_ffmpeg(tmp_path, monkeypatch, 'for last; do :; done\nwc -c > "$last"')
    assert int(short.mp4()) == 6 * WIDTH * HEIGHT * 3
    put_ffmpeg(tmp_path, monkeypatch, "cat > /dev/null\necho no encoder >&2\nexit 1")
    with pytest.raises(OutputError, match="ffmpeg made no film: no encoder"):
        short.mp4()


def test_without_ffmpeg_one_message_says_what_to_do(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", "")
    monkeypatch.setattr(film, "find_spec", lambda name: None)
    with pytest.raises(DeriveError, match=r"MP4 needs ffmpeg, which was not found; install ffmpeg.*--gif"):
        film.ffmpeg()
    monkeypatch.setitem(sys.modules, "PIL", None)
    with pytest.raises(DeriveError, match=r"films need Pillow.*-m pip install 'pillow>="):
        film.require_pillow()
