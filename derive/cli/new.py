"""``derive new``: a commented robot file or motion plan to start from; it loads as it is."""

import argparse
import re
from pathlib import Path
from textwrap import dedent

from derive.cli.terminal import add_shared, line_range, positive, print_json
from derive.errors import OutputError, RobotFileError, quoted
from derive.robot.reading.size_limits import FILE_LIMITS

DESCRIPTION = """\
Write NAME.yaml, a commented robot file that builds as it is: a typical arm of N joints (3: anthropomorphic, 4: SCARA,
5 and 6: with a wrist, 7: redundant, any other number: planar), or a copy of another robot under the new name, with its
comments and units; or the robot of a printed table or of a product of transforms; or a motion plan for a robot, or a
copy of a built-in plan.

  derive new my-arm --joints 3
  derive new my-puma --from puma560-corke
  derive new my-arm --from-transforms 'Rz(q1) Tz(d1) Tx(a1) Rx(pi/2) Rz(q2) Tx(a2)'
  derive new my-move --plan puma560-corke
  derive new my-move --from scara-pick-and-place
"""

_COLUMN, _UPPER_ARM, _FOREARM = ("", "d1", "0", "pi/2"), ("", "0", "a2", "0"), ("", "0", "a3", "0")
_SWIVEL, _BEND = ("", "0", "0", "pi/2"), ("", "0", "0", "-pi/2")
# By number of joints the rows of a typical arm: what is added to theta, then d, a, alpha; None: one that slides.
_ARMS = {
    3: (_COLUMN, _UPPER_ARM, _FOREARM),
    4: (("", "d1", "a1", "0"), ("", "0", "a2", "pi"), None, ("", "d4", "0", "0")),
    5: (_COLUMN, _UPPER_ARM, _FOREARM, (" + pi/2", "0", "0", "pi/2"), ("", "d5", "0", "0")),
    6: (_COLUMN, _UPPER_ARM, (" + pi/2", *_SWIVEL[1:]), ("", "d4", "0", "-pi/2"), _SWIVEL, ("", "d6", "0", "0")),
    7: (_COLUMN, _BEND, ("", "d3", "0", "-pi/2"), _SWIVEL, ("", "d5", "0", "pi/2"), _BEND, ("", "d7", "0", "0")),
}
_LENGTHS = {"d1": 0.4, "a1": 0.3, "a2": 0.35, "a3": 0.3, "d3": 0.4, "d4": 0.35, "d5": 0.3, "d6": 0.1, "d7": 0.1}


def configure(parser: argparse.ArgumentParser) -> None:
    """The robot's name and its number of joints."""
    parser.add_argument("name", metavar="NAME", help="name of the robot or plan, [a-z0-9-]+; the file is NAME.yaml")
    parser.add_argument("--joints", type=positive, metavar="N", help="number of joints (default 2)")
    parser.add_argument("--from", dest="model", metavar="ROBOT", help="copy this robot file, built-in robot or plan")
    parser.add_argument("--plan", metavar="ROBOT", help="write a motion plan for this robot instead")
    table = "write the robot of the Denavit-Hartenberg table that this .tex, .md, .ipynb or .txt file prints"
    parser.add_argument("--from-table", dest="table", metavar="FILE", help=table)
    product = "write the robot of a product of elementary transforms, such as 'Rz(q1) Tz(d1) Tx(a1) Rx(pi/2)'"
    parser.add_argument("--from-transforms", dest="transforms", metavar="PRODUCT", help=product)
    convention = "of the table of --from-transforms: standard (default) or modified"
    parser.add_argument("--convention", metavar="NAME", help=convention)
    parser.add_argument("--lines", metavar="A-B", type=line_range, help="read only these lines of FILE")
    add_shared(parser, "force", "quiet", "json")


def run(arguments: argparse.Namespace) -> None:
    """Write the file and say where."""
    from derive.plans.catalogue import new_plan_text, plan_bytes, plan_names
    from derive.publish.atomic_folder import write_files

    if arguments.plan is not None and (arguments.joints is not None or arguments.model is not None):
        other = "--joints" if arguments.joints is not None else "--from"
        raise OutputError(f"{other} with --plan", remedy="leave one out")
    if arguments.model is not None and arguments.joints is not None:
        raise OutputError("--joints with --from", allowed="a copy has the joints of its model", remedy="leave one out")
    others = [option for option in (arguments.plan, arguments.model, arguments.joints) if option is not None]
    sources = {"--from-table": arguments.table, "--from-transforms": arguments.transforms}
    given = [option for option, value in sources.items() if value is not None]
    if given and (others or len(given) > 1):
        raise OutputError(f"{given[0]} with another source of the robot", remedy="leave one out")
    if arguments.convention is not None and arguments.transforms is None:
        raise OutputError("--convention without --from-transforms", remedy="derive convert writes the other table")
    if arguments.lines is not None and arguments.table is None:
        raise OutputError("--lines without --from-table", remedy="name the document with --from-table")
    _check_name(arguments.name)
    if arguments.table is not None:
        from derive.checking.documents import read_document
        from derive.checking.table import robot_of_table

        document = read_document(arguments.table)
        text, _ = robot_of_table(document.within(arguments.lines) if arguments.lines else document, arguments.name)
    elif arguments.transforms is not None:
        from derive.exchange.convert import convention_named
        from derive.exchange.transforms import robot_of_transforms

        convention = convention_named(arguments.convention or "standard")
        text = robot_of_transforms(arguments.transforms, arguments.name, convention)
    elif arguments.plan is not None:
        from derive.api.robots import load

        text = new_plan_text(arguments.name, load(arguments.plan, remarks_on_bodies=False), arguments.plan)
    elif arguments.model in plan_names():
        text = plan_bytes(arguments.model).decode("utf-8")
    elif arguments.model is not None:
        text = copied_robot_text(arguments.name, arguments.model)
    else:
        text = new_robot_text(arguments.name, joints=arguments.joints or 2)
    (path,) = write_files({Path(f"{arguments.name}.yaml"): text.encode()}, force=arguments.force)
    if arguments.json:
        print_json({"file": str(path)})
    elif not arguments.quiet:
        print(path)


def new_robot_text(name: str, joints: int = 2) -> str:
    """A commented robot file: a typical arm of so many joints, else parallel axes, all lengths and masses names."""
    from derive.targets.templating import render

    _check_name(name)
    if not 1 <= joints <= FILE_LIMITS.joints:
        raise RobotFileError(f"{joints} joints", allowed=f"allowed: 1 to {FILE_LIMITS.joints}")
    is_spatial = joints in _ARMS
    rows, lengths = [], dict[str, float]()
    for i, row in enumerate(_ARMS.get(joints) or [("", "0", f"a{k}", "0") for k in range(1, joints + 1)], 1):
        theta, d, a, alpha = row or ("", "0", "0", "0")
        own = f"theta: q{i}{theta}, d: {d}" if row else f"theta: 0, d: q{i}"
        kind, limits = ("revolute", "") if row else ("prismatic", ", limits: [0, 0.3]")
        joint = f"{{type: {kind}, q: q{i}, {own}, a: {a}, alpha: {alpha}{limits}}}"
        if is_spatial:  # the bodies grow lighter towards the hand
            lengths |= {length: _LENGTHS[length] for length in (d, a) if length != "0"}
            # The middle of a link in its own frame, at its end: -a/2 along x, or -d/2 along the z of the joint.
            turned = {"pi/2": f"[0, -{d}/2, 0]", "-pi/2": f"[0, {d}/2, 0]"}
            along = "[0, 0, 0]" if d == "0" else turned.get(alpha, f"[0, 0, -{d}/2]")
            weight, com = max(12 - 2 * i, 1), f"[-{a}/2, 0, 0]" if a != "0" else along
            mass, moment = str(weight), weight / 100
            inertia = f"{{xx: {moment}, yy: {moment}, zz: {moment}}}   "
        else:
            mass, com, inertia = f"m{i}", f"[l{i} - a{i}, 0, 0]", f"{{zz: I{i}}}      "
        rows.append({"joint": joint, "mass": mass, "com": com, "inertia": inertia})
    up, gravity, runtime = ("z", "[0, 0, -g]", "d1") if is_spatial else ("y", "[0, -g, 0]", f"m{joints}")
    values = {"file": f"{name}.yaml", "up": up, "gravity": gravity, "runtime": runtime}
    return render("new/robot.yaml.jinja", name=name, rows=rows, lengths=lengths, **values)


def copied_robot_text(name: str, model: str) -> str:
    """The file of another robot under a new name, comments and units kept."""
    from derive.api.robots import load
    from derive.robot.load import robot_file_bytes

    _check_name(name)
    robot = load(model, remarks_on_bodies=False)
    text = robot_file_bytes(model).decode("utf-8-sig").replace("\r\n", "\n").rstrip("\n") + "\n"
    # of a corpus file the robot without what is printed about it
    if block := re.search(r"(?m)^robot:[ \t]*(?:#.*)?\n((?:[ \t].*\n|[ \t]*\n|#.*\n)*)", text):
        text = dedent(block[1])
    named = re.compile(rf"(?m)^(\{{?\s*(?:\"name\"|'name'|name)\s*:\s*)(['\"]?){re.escape(robot.name)}\2(?=[\s,}}]|$)")
    text = named.sub(rf"\g<1>{name}", text, count=1)
    if type(robot).from_text(text, f"{name}.yaml").name != name:
        found = f"the name '{robot.name}' in {quoted(model)} cannot be exchanged"
        raise RobotFileError(found, remedy="copy the file and write the new name into it")
    head = f"# A copy of {robot.name}. Check it:  derive show {name}.yaml T      Build it:  derive build {name}.yaml"
    return f"{head}\n{text}"


def _check_name(name: str) -> None:
    from derive.robot.load import is_robot_name

    if not is_robot_name(name):
        found = f"{quoted(name)} is not a robot name"
        allowed = f"allowed: a-z, 0-9 and -, not first, at most {FILE_LIMITS.name_length} characters"
        raise RobotFileError(found, allowed=allowed, remedy="no Python keyword and no name of an imported package")
