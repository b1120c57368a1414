"""Films of a motion: the arm frame by frame with the trace of its hand, as GIF through Pillow or MP4 through ffmpeg."""

import shutil
import subprocess
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cache, cached_property
from importlib.util import find_spec
from io import BytesIO
from math import ceil
from typing import Any

import numpy as np

from derive.arrays import Array
from derive.errors import OutputError, TargetError, optional, pip_install
from derive.handouts.figure.arm import arm_view
from derive.handouts.figure.drawing import Color
from derive.handouts.figure.projection import OUTLINE, Sizes, View, plane_normal, seen, solid_faces, view_along
from derive.handouts.figure.scene import Scene, arm_scene
from derive.interrupts import TemporaryFolder
from derive.motion.motion import Motion
from derive.motion.simulation.simulation import Run
from derive.motion.torques.functions import joint_positions
from derive.robot.tree import ends
from derive.workspace.poses import RobotPoses

RATE = 20  # frames per second
MOST_FRAMES = 1500  # of a film; a motion of more than a minute is shown faster than it is
WIDTH, HEIGHT = 480, 360  # of a frame [pixels]; even, as MP4 wants
FINE = 2  # frames are drawn so many times larger and made smaller, which makes their edges smooth
MARGIN = 46  # around everything that the arm reaches in the film, room for joints and hand [pixels]
COLORS = 96  # of a GIF, the same in all its frames
TIMES = 9  # when is looked whether a base that moves leaves the plane of its arm
_GHOST, _TRACE, _INK = (214, 222, 236), (178, 58, 42), (60, 60, 66)


def frames_of(motion: Motion, times: Array, q: Array) -> Array:
    """Where the frames of the arm are."""
    robot, values = motion.plan.robot, (*motion.plan.robot.parameters, *motion.plan.values.items())
    poses = RobotPoses(replace(robot, parameters=tuple(dict(values).items())))
    joints = joint_positions(robot, q, motion.values, motion.reached)[0].tolist() if motion.reached else [()] * len(q)
    frames = np.array([poses.frames(row, own) for row, own in zip(q.tolist(), joints, strict=True)])
    return frames if (moving := motion.base) is None else moving(times, 0)[:, None] @ frames


def ways_of(motion: Motion, times: Array, q: Array) -> list[Array]:
    """The way of the end effector, or of each end of a tree, (times, 3) [m]."""
    return list(np.moveaxis(frames_of(motion, times, q)[:, -len(ends(motion.plan.robot)) :, :3, 3], 1, 0))


def motion_normal(motion: Motion) -> Array | None:
    """The unit normal of the plane in which an arm moves; None where it moves in space, by its joints or its base."""
    times = np.linspace(0.0, motion.duration, TIMES)
    robot = motion.plan.robot
    return plane_normal([arm_scene(robot, frames) for frames in frames_of(motion, times, motion(times)[0])])


def require_pillow() -> Any:
    """The module PIL."""
    return optional("PIL", "films need Pillow", "motion")


def ffmpeg() -> str:
    """The path of ffmpeg: of the system, or that of the package imageio-ffmpeg."""
    if found := shutil.which("ffmpeg"):
        return found
    if find_spec("imageio_ffmpeg") is not None:
        import imageio_ffmpeg

        return str(imageio_ffmpeg.get_ffmpeg_exe())
    remedy = f"install ffmpeg, or {pip_install('imageio-ffmpeg')}; --gif needs neither"
    raise TargetError("MP4 needs ffmpeg, which was not found", remedy=remedy)


@dataclass(frozen=True)
class Film:
    """A motion in pictures."""

    motion: Motion
    run: Run | None = None  # a simulation of it, which is shown instead; the way that is wanted is faint

    @property
    def pace(self) -> int:
        """How many times faster than the motion the film is."""
        return max(1, ceil(self._end * RATE / MOST_FRAMES))

    @property
    def _end(self) -> float:
        return self.motion.duration if self.run is None else float(self.run.t[-1])

    @cached_property
    def times(self) -> Array:
        """The time of each frame [s], the end included."""
        return np.linspace(0.0, self._end, max(2, ceil(self._end * RATE / self.pace) + 1))

    @cached_property
    def _q(self) -> Array:
        """Joint variables, (frames, n)."""
        q = self.motion(self.times)[0]
        if self.run is not None:
            q = np.stack([np.interp(self.times, self.run.t, column) for column in self.run.q.T], axis=1)
        return q

    @cached_property
    def _scenes(self) -> list[Scene]:
        return [arm_scene(self.motion.plan.robot, frames) for frames in frames_of(self.motion, self.times, self._q)]

    @cached_property
    def _view(self) -> View:
        normal, scenes = motion_normal(self.motion), self._scenes
        return arm_view(scenes[len(scenes) // 2]) if normal is None else view_along(normal, scenes[0].up)

    @cached_property
    def _draw(self) -> Callable[[Any, int], None]:
        """Draws a frame: the ways that are wanted of the hands, the arm, and the traces of the hands up to then."""
        scenes, view = self._scenes, self._view
        traces = [view.project(way)[:, :2] for way in ways_of(self.motion, self.times, self._q)]
        wanted = traces
        if self.run is not None:
            wanted = [view.project(way)[:, :2] for way in ways_of(self.motion, self.times, self.motion(self.times)[0])]
        flat = np.concatenate([*wanted, *(view.project(scene.places)[:, :2] for scene in scenes)])
        low, high = flat.min(axis=0), flat.max(axis=0)
        scale = float(min((np.array((WIDTH, HEIGHT), dtype=float) - 2 * MARGIN) / np.maximum(high - low, 1e-9)))
        gaps = sorted(segment.length * scale for segment in scenes[0].segments)
        sizes = Sizes(float(np.clip(gaps[len(gaps) // 3] / 62.0, 0.55, 1.0)) if gaps else 1.0)
        right, up = (low + high) / 2 * scale
        page = FINE * np.array(((1.0, 0.0, WIDTH / 2 - right), (0.0, -1.0, HEIGHT / 2 + up)))
        lines, faint = (
            [(way * scale @ page[:, :2].T + page[:, 2]).ravel().tolist() for way in ways] for ways in (traces, wanted)
        )

        def _frame(pen: Any, k: int) -> None:
            for line in faint:
                pen.line(line, fill=_GHOST, width=2 * FINE)
            faces, _ = solid_faces(scenes[k], scale, sizes)
            for corners, color, solid in seen(faces, view, page):
                pen.polygon(corners, fill=_rgb(color), outline=_rgb(OUTLINE) if solid.edge else None)
            for line in lines if k else ():
                pen.line(line[: 2 * (k + 1)], fill=_TRACE, width=2 * FINE, joint="curve")

        return _frame

    def frames(self) -> Iterator[Any]:
        """The pictures, as ``PIL.Image`` each."""
        require_pillow()
        from PIL import Image, ImageDraw, ImageFont

        font, segments = ImageFont.load_default(13 * FINE), self.motion.trajectory.segments
        for k, time in enumerate(self.times):
            image = Image.new("RGB", (WIDTH * FINE, HEIGHT * FINE), "white")
            pen = ImageDraw.Draw(image)
            self._draw(pen, k)
            pace = f"   {self.pace} x" if self.pace > 1 else ""
            name = next(s.name for s in reversed(segments) if float(s.start) <= time + 1e-9) if segments[1:] else ""
            pen.text((10 * FINE, 8 * FINE), f"t = {time:.2f} s   {name}{pace}", fill=_INK, font=font)
            yield image.reduce(FINE)

    def gif(self) -> bytes:
        """The film as GIF, which repeats itself."""
        frames = list(self.frames())
        palette = frames[-1].quantize(COLORS)
        first, *others = (frame.quantize(palette=palette, dither=0) for frame in frames)
        file = BytesIO()
        first.save(file, "GIF", save_all=True, append_images=others, duration=1000 // RATE, loop=0, comment=b"derive")
        return file.getvalue()

    def mp4(self) -> bytes:
        """The film as MP4."""
        raw = ["-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{WIDTH}x{HEIGHT}", "-r", str(RATE), "-i", "-"]
        plain = ["-an", "-pix_fmt", "yuv420p", "-movflags", "+faststart", "-fflags", "+bitexact", "-threads", "1"]
        with TemporaryFolder() as folder:
            path = folder.path / "film.mp4"
            command = [ffmpeg(), "-v", "error", *raw, *plain, "-flags:v", "+bitexact", str(path)]
            data = b"".join(frame.tobytes() for frame in self.frames())
            done = subprocess.run(command, input=data, capture_output=True, check=False)
            if done.returncode or not path.is_file():
                reason = done.stderr.decode(errors="replace").strip().splitlines() or ["no reason given"]
                raise OutputError(f"ffmpeg made no film: {reason[-1]}", remedy="--gif needs no ffmpeg")
            return path.read_bytes()


@cache
def _rgb(color: Color) -> tuple[int, ...]:
    return tuple(round(255 * part) for part in color)
