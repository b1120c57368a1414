"""``derive move``: a motion from a plan."""

from __future__ import annotations

import argparse
from pathlib import Path

from derive.cli.terminal import DONE, FAILED, print_columns

SUMMARY = "a motion from via points: speeds, torques, work, samples"
DESCRIPTION = """\
Read a plan (the robot, points, the way between them) and print what each segment asks of the joints.
"""


def configure(parser: argparse.ArgumentParser) -> None:
    """The plan and what is written.

    Args:
        parser: Where the arguments are added.
    """
    add = parser.add_argument
    add("plan", metavar="PLAN", help="motion plan")
    add("--simulate", action="store_true", help="run the arm under the plan's control law")
    add("--csv", metavar="FILE", type=Path, help="write time, q, qd, qdd and tau of every sample")
    add("--out", metavar="DIR", type=Path, help="write the motion as code: motion.h, motion.c, motion_casadi.py")
    add("--name", help="what stands before _motion in C (default: the robot's name)")
    add("--force", action="store_true", help="let --out overwrite files that derive did not write")


def run(arguments: argparse.Namespace) -> int:
    """Print the table and write what was asked for.

    Args:
        arguments: As parsed.

    Returns:
        The exit status.
    """
    from derive.motion.motion import Motion
    from derive.motion.table import HEADER, samples, table, violations

    motion = Motion.load(arguments.plan)
    rows = table(motion)
    print_columns(rows, HEADER[: len(rows[0])])
    exceeded = violations(motion)
    for line in exceeded:
        print(line)
    if arguments.simulate:
        run = motion.simulate()
        error = motion(run.t)[0] - run.q
        worst = abs(error).max()
        print(f"simulated {run.t[-1]:.6g} s: largest position error {worst:.3g}, ledger {run.energy_error:.2g} J")
    if arguments.csv:
        names, values = samples(motion)
        lines = [",".join(names), *(",".join(map(repr, map(float, row))) for row in values)]
        arguments.csv.write_text("\n".join(lines) + "\n", encoding="utf-8")
        print(f"{arguments.csv}: {len(values)} rows")
    if arguments.out:
        from derive.motion.code import write_code

        written = write_code(motion, arguments.out, name=arguments.name, force=arguments.force)
        unverified = f"; {', '.join(written.left_out)} not, for lack of a C compiler" if written.left_out else ""
        files = ", ".join(path.name for path in written.paths)
        print(f"{arguments.out}: {files}, verified to {written.worst:.1g}{unverified}")
    return FAILED if exceeded else DONE
