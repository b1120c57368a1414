"""``derive import``: robot files from URDF, xacro and MJCF."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from derive.cli.terminal import add_shared, keywords, one_line, print_json
from derive.errors import DeriveError

if TYPE_CHECKING:
    from collections.abc import Mapping

    from derive.exchange.from_tree import ImportedTree
    from derive.exchange.from_urdf import Imported

DESCRIPTION = """\
Read a URDF, or a .xacro file, and write the robot file of one of its chains.

The Denavit-Hartenberg table follows from the joint axes by common normals, with a constant base and tool. The head of
the file states a bound on the pose error between table and URDF over all joint values, proven in ball arithmetic;
`derive verify` tests it again. Without -o the file is printed. --tree takes a whole URDF or MJCF as one tree.

  derive import panda.urdf --tip panda_hand -o panda.yaml
  derive import ur5.urdf --chain base..tool0 -o ur5.yaml
  derive import torso.urdf --all -o arms
  derive import humanoid.urdf --tree --root floating -o humanoid.yaml
  derive import arm.urdf.xacro --packages ~/ros/src --arg name=arm -o arm.yaml
"""


def configure(parser: argparse.ArgumentParser) -> None:
    """The URDF, which chain of it, and where the robot file goes."""
    add = parser.add_argument
    add("file", metavar="FILE", help="URDF or .xacro file; - reads a URDF from standard input")
    add("--tip", metavar="LINK", help="end link of the chain (default: the only leaf link)")
    add("--chain", metavar="BASE..TIP", help="first and end link; the chain may first lead up the tree")
    add("--all", action="store_true", help="one robot file for every end link, in the folder given by -o")
    add("--tree", action="store_true", help="one robot file of all joints, a tree with several ends; also of an MJCF")
    add("--root", metavar="KIND", help="with --tree: planar or floating, how the root moves (default: it stands)")
    add("--ends", metavar="LINK,...", help="with --tree: links that are ends (default: those at the ends of limbs)")
    usual = "standard or modified (default: that of the table that the URDF carries, else standard; of a tree modified)"
    add("--convention", metavar="NAME", help=usual)
    add("--snap", default="1e-6", metavar="RAD", help="round angles this close to fractions of pi (default 1e-6)")
    add_shared(parser, "inertia")
    add("--symbols", action="store_true", help="name the lengths d1, a2, ... and store their numbers as parameters")
    add("--name", help="name of the robot (default: that of the URDF)")
    add_shared(parser, "out", help="file to write, with --all a folder (default: standard output)")
    add_shared(parser, "force", "quiet", "json")
    packages = "folder in which xacro looks for packages, or NAME=DIR; repeatable"
    add("--packages", metavar="DIR", action="append", default=[], help=packages)
    add("--arg", metavar="NAME=VALUE", action="append", default=[], help="argument of xacro; repeatable")


def run(arguments: argparse.Namespace) -> None:
    """Import and write."""
    from derive.api.importing import import_all, import_tree, import_urdf
    from derive.publish.atomic_folder import refuse_taken

    base, tip = None, arguments.tip
    if arguments.chain is not None:
        if tip is not None:
            raise DeriveError("--tip with --chain", remedy="leave one out")
        base, dots, tip = arguments.chain.partition("..")
        if not (base and dots and tip):
            raise DeriveError(f"--chain {arguments.chain!r}", allowed="allowed: two names of links as BASE..TIP")
    if arguments.all and tip is not None:
        raise DeriveError("--all with --tip or --chain", remedy="leave one out")
    if arguments.tree and (arguments.all or tip is not None):
        raise DeriveError("--tree with --all, --tip or --chain", remedy="leave one out")
    if not arguments.tree and (arguments.root or arguments.ends):
        raise DeriveError("--root and --ends are of trees alone", remedy="write --tree, too")
    file = sys.stdin.buffer.read() if arguments.file == "-" else arguments.file
    options = keywords(arguments, "convention", "snap", "name", "packages", "inertia", "symbols")
    options["arguments"] = {}
    for text in arguments.arg:
        name, sign, value = text.partition("=")
        if not (name.rstrip(":") and sign):
            raise DeriveError(f"--arg {text!r}", allowed="allowed: NAME=VALUE")
        options["arguments"][name.rstrip(":")] = value
    if arguments.all:
        options["folder"] = folder = arguments.out or Path()
        every = import_all(file, **options)
        _deliver({folder / f"{arm.robot.name}.yaml": arm for arm in every.arms}, every.refused, arguments)
        return
    refuse_taken([arguments.out] if arguments.out else [], force=arguments.force)
    options["folder"] = arguments.out.parent if arguments.out else Path()
    if arguments.tree:
        ends = arguments.ends.split(",") if arguments.ends else ()
        _deliver({arguments.out: import_tree(file, root=arguments.root, ends=ends, **options)}, {}, arguments)
    else:
        _deliver({arguments.out: import_urdf(file, tip=tip, base=base, **options)}, {}, arguments)


def _deliver(arms: Mapping[Path, Imported | ImportedTree], refused: Any, arguments: argparse.Namespace) -> None:
    from derive.api.robots import Robot, tell
    from derive.publish.atomic_folder import write_files

    is_printed = not arguments.all and arguments.out is None
    if not is_printed:
        write_files({path: arm.text.encode() for path, arm in arms.items()}, force=arguments.force)
        for robot in [Robot.from_text(arm.text, str(path)) for path, arm in arms.items()]:
            tell(remark for remark in robot.remarks if not remark.is_of_bodies)  # the report names these links
    if arguments.json:
        where = [{"text": arm.text} if is_printed else {"file": str(path)} for path, arm in arms.items()]
        robots = [place | arm.as_dict() for place, arm in zip(where, arms.values(), strict=True)]
        print_json({"robots": robots, "refused": refused})
    elif is_printed:
        (arm,) = arms.values()
        print(arm.text, end="")
        if not arguments.quiet:
            print("\n".join(one_line(line) for line in arm.report), file=sys.stderr)
    elif not arguments.quiet:
        for path, arm in arms.items():
            head, *rest = arm.report
            print(one_line(f"{path}: {head}"), *(f"  {one_line(line)}" for line in rest), sep="\n")
        for tip, reason in refused.items():
            print(one_line(f"{tip}: not imported: {reason}"))
