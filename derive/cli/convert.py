"""``derive convert``: the same arm by the table of the other convention."""

import argparse

from derive.cli.terminal import add_shared, keywords, print_written
from derive.errors import DeriveError

DESCRIPTION = """\
Write the robot file of the same arm in the other Denavit-Hartenberg convention, symbolic and exact: T, J, B, C, g and
tau are the same functions. Standard to modified puts Trans(x, a_n) Rot(x, alpha_n) into the tool; back puts Rot(x,
alpha_0) Trans(x, a_0) into the base. Centres of mass, tensors and rotors are seen from the new frames.

Converting twice restores the original table: comments in the file store what is needed.

  derive convert stanford-deluca --convention modified -o stanford-mdh.yaml
  derive convert planar-2r-perugia --derivation
"""


def configure(parser: argparse.ArgumentParser) -> None:
    """The robot, the convention and the file."""
    add = parser.add_argument
    add_shared(parser, "robot")
    add("--convention", metavar="NAME", help="standard or modified (default: the other one)")
    add_shared(parser, "out")
    add_shared(parser, "inertia")
    add("--name", metavar="NAME", help="name of the new robot (default: the same)")
    add_shared(parser, "force", "quiet", "json")
    add("--derivation", action="store_true", help="print how the factors are regrouped into an equal product")
    add_shared(parser, "format", choices=("text", "latex"), help="form of the derivation: text (default) or latex")


def run(arguments: argparse.Namespace) -> None:
    """Convert the robot; write the file or print it."""
    from derive.api.convert import convert
    from derive.exchange.convert import moves

    if arguments.format and not arguments.derivation:
        raise DeriveError(f"--format {arguments.format} without --derivation", remedy="add --derivation")
    if arguments.json and arguments.derivation:
        raise DeriveError("--json with --derivation", remedy="leave one out")
    options = keywords(arguments, "inertia", "name", "force")
    made = convert(arguments.robot, arguments.convention, arguments.out, **options)
    lines = [*moves(made.conversion), *made.notes]
    if arguments.derivation:
        from derive.exchange.derivation import derivation_text
        from derive.handouts.render import fragment_text

        robot = made.conversion.source
        is_latex = arguments.format == "latex"  # as the handout prints it
        text = fragment_text(robot, robot.handout, "conversion") if is_latex else derivation_text(made.conversion)
        print(text, end="")
        return
    convention, remarks = made.robot.convention.value, made.conversion.source.remarks_as_dicts
    report = {"convention": convention, "report": lines, "remarks": remarks}
    kinds = "".join("R" if joint.is_revolute else "P" for joint in made.robot.joints)
    head = f"{arguments.out}: {made.robot.n} joint{'s' if made.robot.n > 1 else ''} ({kinds}), {convention}"
    print_written(arguments, made.text, report, [head, *(f"  {line}" for line in lines)])
