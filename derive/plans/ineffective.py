"""Keys of a plan from which nothing would follow: each is refused at its place, for nobody writes one in vain."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from derive.plans.points import Step
from derive.plans.profile import Profile
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
