"""``derive excite``: a motion that tells the parameters of a robot."""

import argparse

from derive.cli.terminal import add_shared, keywords, positive, print_columns, print_written

DESCRIPTION = """\
Find a motion from which the base parameters of ROBOT follow best, and say how well: Fourier series of each joint, from
rest to rest, within the limits of the robot file and of the options, found by IPOPT of CasADi.

The plan is for `derive move`, its log for `derive identify`. Values are one for all joints or one a joint, in the units
of the robot file.

  derive excite puma560-corke --speed 100 --floor none -o excite.yaml
  derive excite arm.yaml --criterion condition --period 20 --torque 50,50,30,8,8,8 -o excite.yaml
"""
LIMITS = ("position", "speed", "acceleration", "torque")


def configure(parser: argparse.ArgumentParser) -> None:
    """The robot, the series, the limits and the noise."""
    add = parser.add_argument
    add_shared(parser, "robot", "out")
    add("--period", metavar="S", type=float, default=10.0, help="how long the motion lasts (default: 10)")
    add("--harmonics", metavar="N", type=positive, default=5, help="of the Fourier series (default: 5)")
    criteria = "make the determinant of the covariance small (default), or the condition number"
    add("--criterion", choices=("determinant", "condition"), default="determinant", help=criteria)
    for name in LIMITS:
        usual = "none" if name == "acceleration" else "the robot file's"
        add(f"--{name}", metavar="V1,V2,...", help=f"largest {name} either way (default: {usual})")
    usual = "height above which frames stay, in metres, or none (default: 0)"
    add("--floor", metavar="Z", type=height, default=0.0, help=usual)
    usual = "of the torques: N m or N, or %% of the largest (default: 1%%)"
    add("--noise", metavar="V1,V2,...", default="1%", help=usual)
    add("--sample", metavar="S", type=float, default=0.01, help="time between two samples (default: 0.01)")
    parts = "what to identify though the file does not give it: viscous, coulomb, armature, none"
    add("--add", metavar="PART,...", default="viscous,coulomb", help=f"{parts} (default: the first two)")
    add("--starts", metavar="N", type=positive, default=2, help="random motions to start from (default: 2)")
    add("--seed", metavar="N", type=positive, default=1, help="of the random motions (default: 1)")
    add_shared(parser, "force", "quiet", "json")


def run(arguments: argparse.Namespace) -> None:
    """Find the motion, write its plan, and print how well it tells each parameter."""
    from derive.api.excite import excite
    from derive.identification.excitation import HEAD

    names = ("period", "harmonics", "criterion", *LIMITS, "floor", "noise", "sample", "starts", "seed", "force")
    added = [] if arguments.add == "none" else [name.strip() for name in arguments.add.split(",")]
    found = excite(arguments.robot, arguments.out, add=added, **keywords(arguments, *names))
    lines = [f"{arguments.out}: condition number {found.condition:.4g}", *(f"  {note}" for note in found.notes)]
    print_written(arguments, found.text, found.as_dict(), lines)
    if arguments.out is not None and not (arguments.quiet or arguments.json):
        rows = [(name, f"{value:.4g}", f"{sigma:.2g}", text or "") for name, value, sigma, text in found.rows()]
        print_columns(rows, HEAD)


def height(text: str) -> float | None:
    """Of a floor [m]; None for ``none``."""
    return None if text == "none" else float(text)
