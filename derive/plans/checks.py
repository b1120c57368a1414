"""What a plan says in vain or of no body: keys without effect are refused, impossible loads and links remarked on."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from fractions import Fraction

from derive.errors import path_text
from derive.plans.points import Payload, Step
from derive.plans.profile import Profile
from derive.robot.body_remarks import REMEDY, impossible_links, lack_of, too_large
from derive.robot.description import Remark
from derive.robot.evaluate import evaluate, parameter_values
from derive.robot.expression import Expression
from derive.robot.options.inverse import FREEDOMS
from derive.robot.reading.document import Document, KeyPath
from derive.robot.robot import Robot

OF_PATHS = ("points", "profile", "via", "spline")  # keys of a plan that are about its path
Idle = tuple[KeyPath, str, str]  # a key without effect: its place, what is found, and what to do


def check_effects(document: Document, robot: Robot, given: str, points: Iterable[str], steps: Sequence[Step]) -> None:
    """Refuse the first key of a plan without effect; ``given`` is which of path, curves and recorded it has."""
    for path, found, remedy in _idle(document, robot, given, points, steps):
        if document.find(path) is not None:
            raise document.error(path, found, remedy=remedy)


def _idle(document: Document, robot: Robot, given: str, points: Iterable[str], steps: Sequence[Step]) -> Iterator[Idle]:
    if given != "path":
        yield from (((key,), f"{key} beside {given}, and there is no path", f"leave {key} out") for key in OF_PATHS)
    if not any(step.profile is Profile.SPLINE for step in steps):
        found = f"{document.text('spline')}, and no profile is spline"
        yield ("spline",), found, "write profile: spline, or leave spline: out"
    if FREEDOMS.keys().isdisjoint(robot.inverse.task):
        found = f"an orientation, and the task of {robot.name} has none"
        poses: list[KeyPath] = [("points", name, "pose") for name in points]
        yield from (((*path, key), found, "leave it out") for path in poses for key in ("rpy", "zyz"))
    if document.text("control", "law") == "none":
        remedy = "name another law, or leave it out"
        yield from ((("control", key), f"{key} of no control law", remedy) for key in ("kp", "kd", "period"))
    if not robot.has_dynamics:
        remedy = "leave it out, or write links into the robot file"
        bodies: list[KeyPath] = [("path", k, "payload") for k in range(1, len(steps) + 1)]
        yield from ((path, f"{robot.name} has no dynamics", remedy) for path in (*bodies, ("plant",), ("disturbance",)))
    yield from _stopped(document, steps)


def _stopped(document: Document, steps: Sequence[Step]) -> Iterator[Idle]:
    """Points that shall be passed where the arm stops; the end of a path only where its own segment says so."""
    for k, (step, after) in enumerate(zip(steps, [*steps, None][1:], strict=True), 1):
        path: KeyPath = ("path", k, "via")
        own = document.text(*path)
        if (own or document.text("via")) != "pass" or not (after or own):
            continue
        if after is None:
            why = "where the path ends"
        elif step.in_space or after.in_space:
            why = "between a line or an arc and another segment"
        elif step.profile is not after.profile:
            why = f"between {step.profile} and {after.profile}"
        else:
            continue
        remedy = "leave via out" if after is None else f"write {{to: {step.to}, via: stop, ...}}"
        yield path if own else ("via",), f"{step.to} is not passed: the arm stops {why}", remedy


def remarks_on_loads(
    document: Document,
    robot: Robot,
    numbers: tuple[Mapping[str, Expression], Mapping[str, Expression]],
    payloads: Mapping[KeyPath, Payload],
) -> Iterator[Remark]:
    """Of a plan with numbers of its own and such of the plant for the symbols of its robot."""
    values = dict(parameter_values(robot))
    told = impossible_links(robot, values) if robot.remarks else {}
    for key, given in zip(("values", "plant"), numbers, strict=True):
        values |= {name: evaluate(value, values) for name, value in given.items()}
        lacks = impossible_links(robot, values)
        if given and lacks and lacks != told:
            links = ", ".join(str(index + 1) for index in lacks)
            found = f"with these {key} links {links}, inertia: {too_large(lacks.values())}"
            yield Remark(document.location((key,)), found, REMEDY, is_of_bodies=True)
            told = lacks
    for path, payload in payloads.items():
        xx, yy, zz = (Fraction(evaluate(cell, values)) for cell in payload.inertia)
        if lack := lack_of((xx, yy, zz, Fraction(0), Fraction(0), Fraction(0))):
            found = f"{path_text(path)}, inertia: {too_large([lack])}"
            remedy = "write the moments of a body about its centre of mass"
            yield Remark(document.location((*path, "inertia")), found, remedy, is_of_bodies=True)
