"""A robot as scripts for programs that take Denavit-Hartenberg tables, and as a table of numbers."""

import csv
from collections.abc import Iterator
from io import StringIO
from typing import Any

from flint import arb

from derive.exchange.body_chain import BodyChain, is_world
from derive.exchange.certificate import ball
from derive.exchange.numeric import angle_text, text, texts
from derive.mechanics.space import NOTHING, Frame
from derive.robot.description import Convention
from derive.robot.expression import ZERO
from derive.targets.escape import matlab_package, matlab_string, one_line
from derive.targets.templating import render

EARTH, UPWARDS = "0, 0, -9.81", "0; 0; 9.81"  # gravity where the robot file gives none, and against it [m/s^2]
SPIN = ("cos({0}), -sin({0}), 0, 0", "sin({0}), cos({0}), 0, 0", "0, 0, 1, 0", "0, 0, 0, 1")  # rows of Rot(z, angle)
SHIFT = ("1, 0, 0, 0", "0, 1, 0, 0", "0, 0, 1, {0}", "0, 0, 0, 1")  # rows of Trans(z, length)


def script_text(template: str, arm: BodyChain, head: list[str]) -> str:
    """A Python script or a MATLAB function that makes the robot for a toolbox."""
    gravity, function = arm.robot.gravity, matlab_package(arm.robot.name)
    return render(
        template,
        name=arm.robot.name,
        function=function,
        heading=function.upper(),
        head=head,
        convention=arm.robot.convention.value,
        modified=arm.robot.convention is Convention.MODIFIED,
        rows=[_row(arm, i) for i in range(len(arm.segments))],
        base=None if is_world(arm.base) else _matrix(arm.base),
        tool=None if is_world(arm.tool) else _matrix(arm.tool),
        gravity=EARTH if gravity is None else texts(map(ball, gravity), ", "),
        upwards=UPWARDS if gravity is None else texts([-ball(cell) for cell in gravity], "; "),
        parts=_parts(arm),
    )


def _matrix(frame: Frame) -> list[str]:
    columns = (frame.x, frame.y, frame.z, frame.origin)
    return [texts((column[k] for column in columns), ", ") for k in range(3)] + ["0, 0, 0, 1"]


def _row(arm: BodyChain, i: int) -> dict[str, Any]:
    """A row of the table with what its link weighs, in its own DH frame, and its motor."""
    joint, body = arm.segments[i].joint, None
    if (weighed := arm.segments[i].body) is not None:
        about = weighed.about((arb(0), arb(0), arb(0)))  # rigidBodyTree wants the tensor about the frame
        body = {
            "mass": text(weighed.mass),
            "com": texts(weighed.com, ", "),
            "inertia": [texts(row, ", ") for row in weighed.inertia.matrix],
            "origin": texts((getattr(about, key) for key in ("xx", "yy", "zz", "yz", "xz", "xy")), ", "),
        }
    cells = {"theta": angle_text(joint.theta), "alpha": angle_text(joint.alpha)}
    cells |= {"d": text(ball(joint.d)), "a": text(ball(joint.a))}
    moving, link, rotor = "theta" if joint.is_revolute else "d", arm.segments[i].link, arm.segments[i].rotor
    # Motor inertia, gear ratio and frictions as the toolboxes count them: on the motor's side of the gear.
    inertia, ratio = ball(link.armature), arb(1)
    if rotor is not None and abs(rotor.ratio) > NOTHING:
        ratio = rotor.ratio
        inertia = inertia / (ratio * ratio) + rotor.inertia
    motor = {"Jm": inertia, "G": ratio, "B": ball(link.viscous) / (ratio * ratio)}
    ahead, back = (ball(cell) / abs(ratio) for cell in link.dry)
    rubs = max(abs(ahead), abs(back)) > NOTHING
    has_motor = arm.robot.links and (rubs or any(abs(motor[key]) > NOTHING for key in ("Jm", "B")))
    written = {key: text(value) for key, value in motor.items()} | {"Tc": texts((ahead, -back), ", ") if rubs else ""}
    return {
        **cells,
        "variable": joint.variable,
        "label": joint.label,
        "comment": one_line(joint.name),
        "revolute": joint.is_revolute,
        "offset": "" if getattr(joint, moving) == ZERO else cells[moving],
        "limits": texts(map(ball, joint.limits), ", ") if joint.limits else "",
        "body": body,
        "motor": written if has_motor else {},
    }


def _parts(arm: BodyChain) -> Iterator[dict[str, Any]]:
    """The bodies of a rigidBodyTree: a variable has no offset there, so that a fixed joint beside it takes it."""
    if not is_world(arm.base):
        yield _part("base-frame", "base-joint", frame=_matrix(arm.base), spaced=True)
    modified = arm.robot.convention is Convention.MODIFIED
    for i in range(len(arm.segments)):
        row, link = _row(arm, i), f"link{i + 1}"
        moved = [line.format(row["offset"]) for line in (SPIN if row["revolute"] else SHIFT)] if row["offset"] else None
        beside = (row["d"], "0") if row["revolute"] else ("0", row["theta"])
        if moved and not modified:
            yield _part(f"offset{i + 1}", f"{row['label']}-offset", frame=moved, spaced=True)
        yield _part(
            f"turned{i + 1}" if moved and modified else link,
            row["label"],
            "revolute" if row["revolute"] else "prismatic",
            cells=", ".join((row["a"], row["alpha"], *beside)),
            order="mdh" if modified else "dh",
            flip=arm.segments[i].joint.sign < 0,
            limits=row["limits"] or "-Inf, Inf",
            mass=None if moved and modified else row["body"],
            spaced=modified or not moved,
        )
        if moved and modified:
            yield _part(link, f"{row['label']}-offset", frame=moved, mass=row["body"])
    if not is_world(arm.tool):
        yield _part("tool", "tool-joint", frame=_matrix(arm.tool), spaced=True)


def _part(body: str, joint: str, type: str = "fixed", **more: Any) -> dict[str, Any]:
    nothing = {"frame": None, "flip": False, "limits": "", "mass": None, "spaced": False}
    return nothing | {"body": body, "joint": matlab_string(joint), "type": type} | more


def csv_text(arm: BodyChain, head: list[str]) -> str:
    """The table and the links as comma-separated values, SI units and radians."""
    out = StringIO()
    out.writelines(f"# {line}\n" for line in head)
    for name, frame in (("base", arm.base), ("tool", arm.tool)):
        out.write(f"# {name}: {'; '.join(_matrix(frame)).replace(',', '')}\n")
    if arm.robot.gravity is not None:
        out.write(f"# gravity: {texts(map(ball, arm.robot.gravity))}\n")
    rows, by_direction = [], any(isinstance(link.coulomb, tuple) for link in arm.robot.links)
    for segment in arm.segments:
        joint, link = segment.joint, segment.link
        cells: dict[str, Any] = {key: getattr(joint, key) for key in ("theta", "d", "a", "alpha")}
        cells |= dict(zip(("lower", "upper"), joint.limits or (None, None), strict=True))
        cells |= {"speed": joint.speed, "torque": joint.torque}
        if arm.robot.links:
            cells |= {"mass": link.mass, **dict(zip(("x", "y", "z"), link.com, strict=True))}
            cells |= {f"I{key}": getattr(link.inertia, key) for key in ("xx", "yy", "zz", "xy", "xz", "yz")}
            cells |= {"armature": link.armature, "viscous": link.viscous, "coulomb": link.dry[0]}
            cells |= {"coulomb_minus": link.dry[1]} if by_direction else {}
            cells |= {f"motor_{key}": link.motor and getattr(link.motor, key) for key in ("mass", "inertia", "ratio")}
        row = {"convention": arm.robot.convention.value, "joint": joint.label, "type": joint.type.value}
        row["sign"] = str(joint.sign)
        rows.append(row | {key: "" if cell is None else text(ball(cell)) for key, cell in cells.items()})
    table = csv.DictWriter(out, list(rows[0]), lineterminator="\n")
    table.writeheader()
    table.writerows(rows)
    return out.getvalue()
