"""Motions from Python: what ``derive move`` prints and writes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

from derive.api.robots import tell
from derive.errors import DeriveError
from derive.motion.motion import Motion
from derive.motion.simulation import Run
from derive.motion.table import csv_bytes
from derive.publish.atomic_folder import write_files

MotionLike = Motion | str | Path
"""A motion, the path of a plan, or the name of a built-in one."""

Writer = Callable[[Motion, Run | None, str], bytes]
"""Contents of a file from a motion, a simulation of it and the file's ending."""


@dataclass(frozen=True, slots=True)
class Form:
    """A kind of file.

    Attributes:
        endings: What its name may end with; empty for any.
        needs: Called before anything is computed; raises where something is not installed.
        contents: The contents of a file.
    """

    endings: tuple[str, ...]
    needs: Callable[[], object]
    contents: Writer


def _film(motion: Motion, run: Run | None, ending: str) -> bytes:
    from derive.motion.film import Film

    film = Film(motion, run)
    return film.gif() if ending == ".gif" else film.mp4()


def _page(motion: Motion, run: Run | None, _ending: str) -> bytes:
    from derive.motion.page import motion_page

    return motion_page(motion, run).encode()


def _part(motion: Motion, _run: Run | None, ending: str) -> bytes:
    from derive.motion.page import motion_sheet

    return motion_sheet(motion, ending)


def _plot(motion: Motion, run: Run | None, ending: str) -> bytes:
    from derive.motion.plot import plot_bytes

    return plot_bytes(motion, ending, run)


def _needs_figures() -> None:
    from derive.handouts.figure.writers import require_matplotlib

    require_matplotlib()


def _needs_pictures() -> None:
    from derive.motion.film import require_pillow

    require_pillow()


def _needs_films() -> None:
    from derive.motion.film import ffmpeg

    _needs_pictures()
    ffmpeg()


FORMS = {
    "csv": Form((), lambda: None, lambda motion, run, _: csv_bytes(motion, run)),
    "plot": Form((".pdf", ".svg", ".png"), _needs_figures, _plot),
    "html": Form((".html", ".htm"), lambda: None, _page),
    "part": Form((".tex", ".pdf"), lambda: None, _part),
    "gif": Form((".gif",), _needs_pictures, _film),
    "mp4": Form((".mp4",), _needs_films, _film),
}
"""What is written, by the name of its option."""


@dataclass(frozen=True, slots=True)
class Moved:
    """What was computed and written.

    Attributes:
        motion: The motion.
        run: Its simulation, where it was asked for.
        files: The files.
    """

    motion: Motion
    run: Run | None
    files: tuple[Path, ...]


def move(
    plan: MotionLike,
    *,
    simulate: bool = False,
    csv: str | Path | None = None,
    plot: str | Path | None = None,
    gif: str | Path | None = None,
    mp4: str | Path | None = None,
    html: str | Path | None = None,
    part: str | Path | None = None,
    language: str | None = None,
) -> Moved:
    """Compute a motion and write its files, as ``derive move`` does.

    Args:
        plan: A motion, the path of a plan, or the name of a built-in one.
        simulate: Whether the arm is simulated under the plan's control law; then the files show what happens.
        csv: File for the samples: time, q, qd, qdd, tau.
        plot: Figure of q, qd, qdd and tau: .pdf, .svg or .png.
        gif: Film of the arm.
        mp4: Film of the arm.
        html: Web page on which the arm plays the motion.
        part: The handout's part about the plan as a sheet: .tex, which stands alone, or .pdf.
        language: Code of the language of page and sheet; None for that of the robot file.

    Returns:
        The motion, its simulation, and the files, which are overwritten; either all are complete or none is touched.
        Remarks on the robot of a plan that is read here are issued as `RobotFileWarning`, but
        for links that no body can be, of which `derive build` and others tell.

    Raises:
        DeriveError: A file with another ending.
        RobotFileError: The file is no plan, or its arm cannot move so.
        TargetError: Matplotlib, Pillow or ffmpeg is missing.
        OutputError: A file cannot be written.
    """
    asked = {"csv": csv, "plot": plot, "gif": gif, "mp4": mp4, "html": html, "part": part}
    wanted = [(FORMS[name], Path(path)) for name, path in asked.items() if path is not None]
    for form, path in wanted:
        if form.endings and path.suffix.lower() not in form.endings:
            allowed = f"allowed: {', '.join(form.endings)}"
            raise DeriveError(f"{path.name!r} has the ending of another kind of file", allowed=allowed)
        if path.is_dir():
            raise DeriveError(f"{str(path)!r} is a folder", remedy="write the name of a file in it")
        form.needs()
    if twice := {str(path) for _, path in wanted if [other for _, other in wanted].count(path) > 1}:
        raise DeriveError(f"two contents for {min(twice)!r}", remedy="name two files")
    motion = plan if isinstance(plan, Motion) else Motion.load(plan)
    if motion is not plan:
        tell(remark for remark in motion.plan.robot.remarks if not remark.is_of_bodies)
    if language is not None:
        from derive.api.handout import with_options

        motion = Motion(replace(motion.plan, robot=with_options(motion.plan.robot, language=language)))
    run = motion.simulate() if simulate else None
    contents = [(path, form.contents(motion, run, path.suffix.lower())) for form, path in wanted]
    for path, data in contents:
        write_files({path.name: data}, path.parent, force=True)
    return Moved(motion, run, tuple(path for _, path in wanted))
