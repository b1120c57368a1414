"""``derive move``: a motion from a plan."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from derive.cli.terminal import FAILED, STDOUT, add_shared, keywords, positive, print_columns, print_error, print_json

if TYPE_CHECKING:
    from collections.abc import Sequence

    from derive.motion.incremental import Increments
    from derive.motion.motion import Motion
    from derive.motion.simulation.simulation import Run

DESCRIPTION = """\
Read a motion plan (robot, points, paths between them) and print what each segment requires of the joints.

PLAN is the path of a motion plan or a name that `derive list --plans` shows; `derive new NAME --plan ROBOT` writes one
to start from. Exit status 1: a limit of the robot is exceeded, the simulation diverges, or increments do not converge.

  derive move scara-pick-and-place
  derive move scara-pick-and-place --plot tau.svg --csv run.csv
  derive move my-plan.yaml --simulate --gif run.gif
  derive move my-plan.yaml --html page.html --lang it
"""


def configure(parser: argparse.ArgumentParser) -> None:
    """The plan and what is written."""
    add = parser.add_argument
    add("plan", metavar="PLAN", help="motion plan, or the name of a built-in one")
    add("--simulate", action="store_true", help="simulate the closed loop; output files then contain the simulation")
    add("--joints", action="store_true", help="print a row for each joint, with RMS of torque, power and work")
    add("--show", action="store_true", help="print q(t) of every joint and segment instead of the table")
    add("--hand", action="store_true", help="print the end-effector path and what each joint adds to its speed")
    add("--increments", metavar="N", type=positive, help="follow the path in N steps of differential kinematics (J^+)")
    add_shared(parser, "format", choices=("text", "latex"), help="form of --show and --hand: text (default) or latex")
    add("--html", metavar="FILE", type=Path, help="write a web page on which the arm plays the motion")
    add("--part", metavar="FILE", type=Path, help="write the handout's part about the plan: .tex or .pdf")
    add_shared(parser, "lang", help="language of page and part: en, it, pt (default: that of the robot file)")
    add("--csv", metavar="FILE", type=Path, help="write time, q, qd, qdd and tau of every sample; - prints them")
    add("--plot", metavar="FILE", type=Path, help="draw q, qd, qdd and tau with their peaks: .pdf, .svg or .png")
    add("--gif", metavar="FILE", type=Path, help="write an animation of the arm")
    add("--mp4", metavar="FILE", type=Path, help="write a video of the arm; needs ffmpeg")
    add_shared(parser, "folder", help="write the motion as code: motion.h, motion.c, motion_casadi.py")
    add("--name", help="prefix of _motion in C (default: the robot's name)")
    add_shared(parser, "force", "quiet", "json")


def run(arguments: argparse.Namespace) -> int:
    """Compute, write what was asked for, and print."""
    from derive.api.move import FORMS, move
    from derive.errors import DeriveError
    from derive.motion.incremental import increments_of, not_closed

    if arguments.format and not (arguments.show or arguments.hand):
        raise DeriveError(f"--format {arguments.format} without --show", remedy="add --show")
    if arguments.lang and not (arguments.html or arguments.part):
        raise DeriveError("--lang without --html or --part", remedy="add --html page.html")
    if arguments.name and not arguments.out:
        raise DeriveError("--name without --out", remedy="add --out DIR")
    for name in ("show", "hand", "increments", "joints"):
        if getattr(arguments, name) and arguments.json:
            raise DeriveError(f"--{name} with --json", remedy="leave one out")
    rows_alone = arguments.csv == STDOUT
    if rows_alone and (arguments.json or arguments.show or arguments.hand or arguments.increments):
        raise DeriveError(f"--csv {STDOUT} with another output", remedy="name a file")
    forms = [name for name in FORMS if not (name == "csv" and rows_alone)]
    options = keywords(arguments, *forms, "simulate", "name", "force")
    found = move(arguments.plan, language=arguments.lang, code=arguments.out, **options)
    steps = increments_of(found.motion, arguments.increments) if arguments.increments else []
    if rows_alone:
        from derive.motion.output.printed import csv_bytes

        print(csv_bytes(found.motion, found.run).decode(), end="")
    elif arguments.json:
        from derive.motion.output.printed import summary

        print_json({**summary(found.motion, found.run), "files": list(map(str, found.files))})
    elif not arguments.quiet:
        _print(found.motion, found.run, steps, arguments)
        for path in found.files[: len(found.files) - (len(found.code.files) if found.code else 0)]:
            print(path)
        if code := found.code:
            unverified = f"; {', '.join(code.left_out)} not, for lack of a C compiler" if code.left_out else ""
            print(f"{arguments.out}: {', '.join(code.files)}, verified to {code.worst:.1g}{unverified}")
    if steps and (wrong := not_closed(found.motion, steps)):
        print_error(wrong)
        return FAILED
    if found.run is not None and not found.run.reached:
        from derive.motion.output.printed import diverged

        print_error(diverged(found.motion, found.run))
        return FAILED
    exceeded = found.motion.violations or (found.run is not None and found.motion.violations_of(found.run))
    return FAILED if exceeded else 0


def _print(motion: Motion, run: Run | None, steps: Sequence[Increments], arguments: argparse.Namespace) -> None:
    """The formulas, or the tables."""
    from derive.motion.incremental import printed_increments
    from derive.motion.output import printed

    as_latex = arguments.format == "latex"
    if arguments.show or arguments.hand or steps:
        if arguments.show:
            print(*printed.printed(motion, as_latex=as_latex), sep="\n")
        if arguments.hand:
            way, weights = (make(motion, as_latex=as_latex) for make in (printed.printed_hand, printed.printed_weights))
            print(*way, *weights, sep="\n")
        if steps:
            print(*printed_increments(motion, arguments.increments, steps), sep="\n")
        return
    rows = printed.joint_table(motion) if arguments.joints else printed.table(motion)
    print_columns(rows, (printed.JOINT_HEADER if arguments.joints else printed.HEADER)[: len(rows[0])])
    for line in printed.violations(motion):
        print(line)
    if run is not None:
        print()
        given = (printed.GIVEN[name] for name in printed.given_in(run))
        print_columns(printed.simulated_table(motion, run), (*printed.SIMULATED_HEADER, *given))
        control, where = motion.plan.control, "energy in the world" if motion.base else "energy"
        print(f"{control.law}, friction {motion.plan.friction}: {where} balances to {run.energy_error:.1g} J")
        for line in printed.violations(motion, run):
            print(line)
