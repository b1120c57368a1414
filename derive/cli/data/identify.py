"""``derive identify``: the parameters of a robot from a log."""

import argparse
from pathlib import Path

from derive.cli.terminal import add_shared, keywords, named_values, positive, print_columns, print_written

DESCRIPTION = """\
Identify masses, inertias, friction and armatures from a log of positions and torques: base parameters by least squares,
and the robot file nearest to ROBOT that has them.

LOG is a .csv or .parquet with the columns q1, q2, ..., tau1, tau2, ... and, if there are, qd1, ..., qdd1, ..., time; a
unit may stand in brackets, 'q1 [deg]'. Speeds and accelerations that are missing come from a filter without delay.

  derive identify puma560-corke log.parquet -o identified.yaml --report page.html
  derive identify arm.yaml log.csv --columns q=position_*,tau=effort_* --held-out 0.2 -o identified.yaml
  derive identify arm.yaml log.csv --method possible --held-out other.csv -o identified.yaml
"""


def configure(parser: argparse.ArgumentParser) -> None:
    """The robot, the log, what is read of it and what is written."""
    add = parser.add_argument
    add_shared(parser, "robot")
    add("log", metavar="LOG", help="log of the robot: .csv or .parquet")
    add_shared(parser, "out")
    add("--report", metavar="FILE", type=Path, help="write a web page: residuals and base parameters")
    methods = "least squares (ols), by each joint's noise (wls, default), within what bodies can have (possible)"
    add("--method", choices=("ols", "wls", "possible"), default="wls", help=methods)
    patterns = "names of columns: q, qd, qdd, tau, time; * is a joint's number or name, a minus turns the sign"
    add("--columns", metavar="NAME=COLUMN*,...", action="append", default=[], help=patterns)
    parts = "what to identify though the file does not give it: viscous, coulomb, armature, none"
    add("--add", metavar="PART,...", default="viscous,coulomb", help=f"{parts} (default: the first two)")
    validation = "log for validation, or the part of LOG's end that is kept for it, such as 0.2"
    add("--held-out", metavar="LOG|PART", help=validation)
    cutoff = "frequency of the filter (default: 10 where speeds or accelerations are missing)"
    add("--cutoff", metavar="HZ", type=float, help=cutoff)
    add("--decimate", metavar="N", type=positive, default=1, help="keep one of N rows, filtered")
    add("--drop", action="store_true", help="pass over rows without numbers, and gaps in time")
    add("--trust-torques", action="store_true", help="take torques that look like another unit's or sign's as they are")
    add_shared(parser, "force", "quiet", "json")


def run(arguments: argparse.Namespace) -> None:
    """Identify, write, and print what was found."""
    from derive.api.identify import identify
    from derive.identification.identified import JOINT_HEAD, PARAMETER_HEAD

    allowed = "allowed: q=...*,qd=...*,qdd=...*,tau=...*,time=..."
    columns = dict(named_values(arguments.columns, "--columns", allowed))
    how = keywords(arguments, "report", "method", "held_out", "cutoff", "decimate", "drop", "trust_torques", "force")
    added = [] if arguments.add == "none" else [name.strip() for name in arguments.add.split(",")]
    found = identify(arguments.robot, arguments.log, arguments.out, columns=columns, add=added, **how)
    lines = [f"{arguments.out}: {found.rows} rows, {found.method}", *(f"  {note}" for note in found.notes)]
    print_written(arguments, found.text, found.as_dict(), lines)
    if arguments.out is not None and not (arguments.quiet or arguments.json):
        print_columns(found.joint_rows(), JOINT_HEAD)
        print_columns([row[:-1] for row in found.parameter_rows()], PARAMETER_HEAD[:-1])
