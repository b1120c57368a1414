"""A robot as URDF."""

from math import atan2, hypot
from typing import Any
from xml.sax.saxutils import escape

from derive.exchange.body_chain import BodyChain, ChainSegment, is_world, roll_pitch_yaw
from derive.exchange.carried_table import table_text
from derive.exchange.certificate import ball
from derive.exchange.numeric import text, texts
from derive.exchange.urdf import SLIDE, UNLIMITED
from derive.mechanics.space import Frame, Point, length
from derive.targets.escape import xml_text
from derive.targets.templating import render

ROOT = "base_link"  # the world, which URDF takes as the root link
TIP = "tool"  # the end effector
THICKNESS = 0.06  # radius of the cylinders, of the longest link


def urdf_text(arm: BodyChain, head: list[str]) -> str:
    """The file."""
    n = len(arm.segments)
    named = [f"link{i}" for i in range(1, n + 1)]
    root = ROOT if is_world(arm.base) else "link0"
    taken = {segment.joint.label for segment in arm.segments}
    base, flange, tool = (name + "_" * (name in taken) for name in ("base-joint", "flange-joint", "tool-joint"))
    joints = [] if root == ROOT else [_fixed(base, ROOT, root, arm.base)]
    for i, segment in enumerate(arm.segments):
        joints.append(_joint(segment, named[i - 1] if i else root, named[i]))
    last = arm.segments[-1].dh
    joints.append(_fixed(flange, named[-1], "flange", last))
    joints.append(_fixed(tool, "flange", TIP, arm.tool))
    radius = THICKNESS * arm.size
    frames: list[dict[str, Any]] = [
        {"name": name, "is_frame": True} for name in dict.fromkeys((ROOT, root, "flange", TIP))
    ]
    links: list[dict[str, Any]] = []
    for name, segment in zip(named, arm.segments, strict=True):
        inertial = None  # of what moves with a joint, in the joint's frame
        if segment.body is not None:
            body = segment.body.moved(segment.dh)
            entries = zip(("ixx", "iyy", "izz", "ixy", "ixz", "iyz"), map(text, body.entries), strict=True)
            inertial = {"mass": text(body.mass), "xyz": texts(body.com), "inertia": dict(entries)}
        links.append({"name": name, "is_frame": False, "inertial": inertial, "rod": rod(segment.end, radius)})
    return render(
        "exchange/robot.urdf.jinja",
        name=arm.robot.name,
        head=head,
        table=escape(table_text(arm.robot)),
        links=[*frames[:-2], *links, *frames[-2:]],
        joints=joints,
        radius=f"{radius:.3g}",
        thick=f"{1.4 * radius:.3g}",
        height=f"{3 * radius:.3g}",
    )


def _origin(frame: Frame) -> dict[str, str]:
    return {"xyz": texts(frame.origin), "rpy": texts(roll_pitch_yaw(frame))}


def _fixed(name: str, parent: str, child: str, frame: Frame) -> dict[str, Any]:
    return {"name": name, "type": "fixed", "parent": parent, "child": child, **_origin(frame), "axis": ""}


def _joint(segment: ChainSegment, parent: str, child: str) -> dict[str, Any]:
    """A joint that moves; effort and speed are mandatory where there are limits."""
    joint, link = segment.joint, segment.link
    limits = joint.limits or (None if joint.is_revolute else ())
    kind = "prismatic" if not joint.is_revolute else "continuous" if limits is None else "revolute"
    bounds: dict[str, str] = {}
    if limits is not None:
        ends = [text(ball(cell)) for cell in limits] or [f"-{SLIDE}", str(SLIDE)]
        bounds |= dict(zip(("lower", "upper"), ends, strict=True))
    for key, cell in (("effort", joint.torque), ("velocity", joint.speed)):
        bounds[key] = str(UNLIMITED) if cell is None else text(ball(cell))
    dynamics = {"damping": text(ball(link.viscous)), "friction": text(ball(link.signed[0]))}
    return {
        "name": xml_text(joint.label),
        "type": kind,
        "parent": parent,
        "child": child,
        **_origin(segment.origin),
        "axis": f"0 0 {joint.sign}",
        "limit": bounds,
        "dynamics": dynamics if set(dynamics.values()) != {"0"} else {},
    }


def rod(end: Point, radius: float) -> dict[str, str] | None:
    """The cylinder from a frame's origin to a point; None where it would be as short as thick."""
    x, y, z = (float(c) for c in end)
    reach = float(length(end))
    if reach <= radius:
        return None
    middle = " ".join(f"{c / 2:.6g}" for c in (x, y, z))
    turned = f"0 {atan2(hypot(x, y), z):.6g} {atan2(y, x):.6g}"
    return {"xyz": middle, "rpy": turned, "length": f"{reach:.6g}", "to": " ".join(f"{c:.6g}" for c in (x, y, z))}
