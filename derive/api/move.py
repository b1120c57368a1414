"""Motions from Python: what ``derive move`` prints and writes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from derive.api.robots import tell
from derive.errors import DeriveError
from derive.handouts.figure.writers import require_matplotlib
from derive.motion.motion import Motion
from derive.motion.output.printed import csv_bytes
from derive.plans.catalogue import plan_names
from derive.publish.atomic_folder import ending_of, refuse_taken, write_files
from derive.robot.presentation import with_options

if TYPE_CHECKING:
    from derive.motion.output.code import VerifiedCode
    from derive.motion.simulation.simulation import Run

MotionLike = Motion | str | Path  #: a motion, the path of a plan, or the name of a built-in one

FORMS: Mapping[str, tuple[str, ...]] = {
    "csv": (),
    "plot": (".pdf", ".svg", ".png"),
    "html": (".html", ".htm"),
    "part": (".tex", ".pdf"),
    "gif": (".gif",),
    "mp4": (".mp4",),
}
"""What is written, by the name of its option, and what the name of such a file may end with; empty for any."""


@dataclass(frozen=True, slots=True)
class Moved:
    """What was computed and written.

    Attributes:
        motion: The motion.
        run: Its simulation, where it was asked for.
        files: The files.
        code: The motion as code, where it was asked for, and how it was verified.
    """

    motion: Motion
    run: Run | None
    files: tuple[Path, ...]
    code: VerifiedCode | None = None


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
    code: str | Path | None = None,
    name: str | None = None,
    force: bool = False,
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
        code: Folder for the motion as code: motion.h, motion.c, motion_casadi.py.
        name: What stands before ``_motion`` in C; None for the name of the robot.
        force: Whether files that exist are overwritten.

    Returns:
        The motion, its simulation, and the files; either all are complete or none is touched.
        Remarks on a plan that is read here, its robot and its loads, are issued as `RobotFileWarning`; on bodies of
        built-in plans they are not.

    Raises:
        DeriveError: A file with another ending.
        RobotFileError: The file is no plan, or its arm cannot move so.
        TargetError: Matplotlib, Pillow or ffmpeg is missing.
        VerificationError: Code differs from Python's values.
        OutputError: There is such a file or folder already, or it cannot be written.
    """
    asked = {"csv": csv, "plot": plot, "gif": gif, "mp4": mp4, "html": html, "part": part}
    paths = {form: Path(path) for form, path in asked.items() if path is not None}
    endings = {form: ending_of(path, FORMS[form]) for form, path in paths.items()}
    if plot is not None:
        require_matplotlib()
    if gif is not None or mp4 is not None:
        from derive.motion.output.film import ffmpeg, require_pillow

        require_pillow()
        if mp4 is not None:
            ffmpeg()
    if twice := {str(path) for path in paths.values() if [*paths.values()].count(path) > 1}:
        raise DeriveError(f"two contents for {min(twice)!r}", remedy="name two files")
    of_code: list[Path] = []
    if code is not None:
        from derive.motion.output.code import FILES, verified_code

        of_code = [Path(code) / file for file in FILES]
    refuse_taken([*paths.values(), *of_code], force=force)
    motion = plan if isinstance(plan, Motion) else Motion.load(plan)
    if motion is not plan:
        tell(remark for remark in motion.plan.remarks if not (remark.is_of_bodies and str(plan) in plan_names()))
    if language is not None:
        motion = Motion(replace(motion.plan, robot=with_options(motion.plan.robot, language=language)))
    run = motion.simulate() if simulate else None
    contents = {path: _contents(motion, run, form, endings[form]) for form, path in paths.items()}
    made = None if code is None else verified_code(motion, name)
    if made is not None:
        contents |= zip(of_code, made.files.values(), strict=True)
    return Moved(motion, run, tuple(write_files(contents, force=force)), made)


def _contents(motion: Motion, run: Run | None, form: str, ending: str) -> bytes:
    """A file, of the motion or of a simulation of it; what makes it is imported where it is asked for."""
    match form:
        case "plot":
            from derive.motion.output.plot import plot_bytes

            return plot_bytes(motion, ending, run)
        case "html":
            from derive.motion.output.page import motion_page

            return motion_page(motion, run).encode()
        case "part":
            from derive.motion.output.page import motion_sheet

            return motion_sheet(motion, ending)
        case "gif" | "mp4":
            from derive.motion.output.film import Film

            film = Film(motion, run)
            return film.gif() if form == "gif" else film.mp4()
    return csv_bytes(motion, run)
