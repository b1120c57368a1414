"""Handouts from Python: the sheet as LaTeX, PDF and web page, and single formulas for other notes."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from derive.api.robots import RobotLike, load, tell
from derive.errors import DeriveError, TargetError, listed
from derive.handouts.render import Format, fragment_text, handout_files, sheet_names
from derive.publish.atomic_folder import refuse_taken, write_files
from derive.robot.options.handout import chosen_pages
from derive.robot.options.style import Style
from derive.robot.presentation import with_options

if TYPE_CHECKING:
    from derive.motion.motion import Motion


@dataclass(frozen=True, slots=True)
class HandoutFile:
    """A file of a handout.

    Attributes:
        path: Where it is.
        bytes: Its size.
        pages: Pages of a PDF; None for other files.
    """

    path: Path
    bytes: int
    pages: int | None


@dataclass(frozen=True, slots=True)
class HandoutResult:
    """A handout that was written.

    Attributes:
        robot: Name of the robot.
        files: Its files.
        parts: The parts that it has, in their order.
        seconds: Wall time.
        shortened: Whether anything was left out on paper to keep to its number of pages; the sheet says what.
    """

    robot: str
    files: tuple[HandoutFile, ...]
    parts: tuple[str, ...]
    seconds: float
    shortened: bool = False

    def as_dict(self) -> dict[str, object]:
        """Plain data, for JSON."""
        files = [asdict(file) | {"path": str(file.path)} for file in self.files]
        return asdict(self) | {"files": files, "parts": list(self.parts), "seconds": round(self.seconds, 3)}


def handout(
    robot: RobotLike,
    out: str | Path = ".",
    *,
    formats: Iterable[str] = ("tex",),
    parts: Iterable[str] | None = None,
    language: str | None = None,
    derivation: str | None = None,
    notation: Mapping[str, str] | None = None,
    style: Style | str | Mapping[str, str] | None = None,
    q: Sequence[float | str] | None = None,
    exercise: bool = False,
    force: bool = False,
    progress: Callable[[str, str], None] | None = None,
    pages: int | None = None,
    plan: Motion | str | Path | None = None,
) -> HandoutResult:
    """Write the equations of a robot as a sheet to hand out, as ``derive handout`` does.

    What is not given here is as the block ``handout:`` of the robot file says.

    Args:
        robot: A robot, the path of a robot file, or a name of the catalogue.
        out: Folder of the files; made if there is none.
        formats: Of ``tex``, ``pdf`` (which brings the LaTeX too) and ``html``.
        parts: Only these parts, such as ``table`` and ``jacobian``.
        language: Code of the language, such as ``it``.
        derivation: ``result``, or ``steps`` for the steps to the results too.
        notation: Choices such as ``{"angle": "vartheta", "inertia": "M"}``.
        style: How expressions are grouped, as for ``Model``; see `derive.find_style`.
        q: Joint values that are drawn and computed, in the units of the robot file.
        exercise: Whether an exercise and its solutions are written instead of one sheet.
        force: Whether files that exist are overwritten.
        progress: Called with the robot's name and the stage that it has reached.
        pages: Most pages on paper, 20 where neither this nor the file says; 0 for any number. What is least useful is
            left out first.
        plan: A motion of this robot, the path of its plan, or the name of a built-in one: a part about it comes last,
            and the arm of the web page plays it.

    Returns:
        Paths, sizes and pages of the files, parts, seconds.

    Raises:
        RobotFileError: The file does not describe a robot.
        QuantityError: An unknown part, notation or style, or a number of pages that is none.
        DeriveError: A plan of another robot, or an exercise with a plan.
        TargetError: An unknown format or language, or a package for the web page is missing.
        LatexError: LaTeX is missing or refused the document.
        OutputError: There is such a file already, or it cannot be written.
    """
    started = time.perf_counter()
    wanted = set(formats)
    if unknown := sorted(wanted.difference(Format)):
        raise TargetError(f"unknown format {unknown[0]!r}", allowed=f"allowed: {listed(Format)}")
    if not wanted or Format.PDF in wanted:
        wanted.add(Format.TEX)
    shown = with_options(load(robot), parts, language, derivation, notation, q, style)
    if pages is not None:
        shown = replace(shown, handout=replace(shown.handout, pages=chosen_pages(str(pages))))
    forms, folder = [form for form in Format if form in wanted], Path(out)
    names = sheet_names(shown, exercise_sheets=exercise)
    refuse_taken([folder / f"{name}.{form}" for name in names for form in forms], force=force)
    addition = None
    if plan is not None:
        if exercise:
            raise DeriveError("an exercise with a motion plan", remedy="leave one out")
        from derive.motion.motion import Motion
        from derive.motion.output.page import motion_figure, plan_part

        motion = plan if isinstance(plan, Motion) else Motion.load(plan)
        moved = motion.plan.robot
        tell(remark for remark in motion.plan.remarks if motion is not plan and remark not in moved.remarks)
        if (moved.name, moved.joints) != (shown.name, shown.joints):
            raise DeriveError(f"the plan moves {moved.name}, not {shown.name}", remedy="name that robot")
        alike = replace(moved, handout=shown.handout, style=shown.style, figure=shown.figure)
        own, drawn = Motion(replace(motion.plan, robot=alike)), wanted != {Format.HTML}  # a page has plots of its own
        addition = partial(plan_part, own, drawn=drawn), partial(motion_figure, own)
    made = handout_files(shown, shown.handout, forms, exercise_sheets=exercise, progress=progress, addition=addition)
    paths = write_files({folder / name: data for name, data in made.files.items()}, force=force)
    files = tuple(HandoutFile(path, len(made.files[path.name]), made.pages.get(path.name)) for path in paths)
    return HandoutResult(shown.name, files, made.parts, time.perf_counter() - started, made.shortened)


def fragment(
    robot: RobotLike,
    name: str,
    *,
    parts: Iterable[str] | None = None,
    language: str | None = None,
    derivation: str | None = None,
    notation: Mapping[str, str] | None = None,
    style: Style | str | Mapping[str, str] | None = None,
    q: Sequence[float | str] | None = None,
    width: str | None = None,
) -> str:
    r"""LaTeX of one part or quantity, to ``\input`` into other notes, as ``derive handout --fragment`` gives it.

    Args:
        robot: A robot, the path of a robot file, or a name of the catalogue.
        name: A part such as ``inertia``, or a quantity such as ``B``, ``A[1]`` or ``T[0,2]``.
        parts: See `handout`.
        language: See `handout`.
        derivation: See `handout`.
        notation: See `handout`.
        style: See `handout`.
        q: See `handout`.
        width: Width of its lines, such as ``84mm``; None for that of the document into which it is put.

    Returns:
        The LaTeX, with the packages that it needs in a comment.

    Raises:
        RobotFileError: The file does not describe a robot.
        QuantityError: Neither a part nor a quantity, or one that this robot does not have.
    """
    shown = with_options(load(robot), parts, language, derivation, notation, q, style)
    return fragment_text(shown, shown.handout, name, width or "")
