"""Reads a motion plan: the robot, its points, the way between them and what moves it; exact, in SI units, radians."""

import hashlib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import pairwise
from pathlib import Path

from derive.errors import DeriveError, Location, QuantityError, RobotFileError, listed, near_miss, path_text, quoted
from derive.plans.catalogue import plan_bytes
from derive.plans.cells import PATHS, PAYLOAD, PlanCells, Read
from derive.plans.profile import Profile
from derive.plans.schema import PlanFile
from derive.plans.segments import Disturbance, Payload, Point, Pose, Step, Vector
from derive.robot.description import Remark
from derive.robot.evaluate import evaluate, parameter_values
from derive.robot.expression import ONE, ZERO, Expression, names, number, substitute
from derive.robot.load import catalogue_names
from derive.robot.options.inverse import FREEDOMS
from derive.robot.reading.document import Document, KeyPath, YamlMapping, YamlScalar, read_tree
from derive.robot.reading.schema import check_structure
from derive.robot.robot import Robot
from derive.robot.tree import end_named
from derive.robot.validate import REMEDY, impossible_links, lack_of, numbered, too_large

OF_PATHS = ("points", "profile", "via", "spline")  # keys of a plan that are about its path
Most = tuple[Expression | None, ...]  # the largest value of each joint; None where nothing limits it
Idle = tuple[KeyPath, str, str]  # a key without effect: its place, what is found, and what to do


@dataclass(frozen=True, slots=True)
class Control:
    """Who moves the arm in a simulation."""

    law: str  # ``none``, ``pd``, ``pd-gravity`` or ``computed-torque``
    kp: Vector  # gain of the position, one a joint
    kd: Vector  # gain of the velocity, one a joint
    period: Expression | None  # time between two samples of the controller [s]; None for a continuous one


@dataclass(frozen=True, slots=True)
class Plan:
    """A motion as its file describes it."""

    robot: Robot
    title: str  # free text for people
    sample: Expression  # time between two rows of a table [s]
    places: Mapping[str, Location]  # of robot, sample, period and formulas, by ``robot``, ``curves, q1``, ``base, x``
    points: Mapping[str, Point]  # by name, in the order of the file
    start: str  # name of the first point of the path; empty where curves are given
    steps: tuple[Step, ...]  # the segments
    curves: Mapping[str, Expression]  # each joint variable in `TIME_NAME`; empty where a path is given
    duration: Expression  # how long curves last [s]
    recording: Path | None  # a CSV file with the motion, or None
    base: tuple[Expression, ...]  # where the base stands, as `PlanCells.base` has it; empty where it does not move
    speed: Most  # largest speed of each joint, by default that of the robot; None where nothing limits it
    acceleration: Most  # largest acceleration of each joint
    torque: Most  # largest torque of each joint, by default that of the robot
    values: Mapping[str, Expression]  # numbers of symbols of the robot
    control: Control  # who moves the arm in a simulation
    friction: str  # ``none``, ``smooth`` or ``exact``
    plant: Mapping[str, Expression]  # numbers of symbols in the simulated arm that the controller does not know
    plant_payload: Payload | None  # what the tool carries all the time and the controller does not know
    disturbances: tuple[Disturbance, ...]  # what pushes joints in a simulation
    source: str  # name of the file, for messages
    digest: str  # SHA-256 of its bytes
    remarks: tuple[Remark, ...] = ()  # on its robot, on the numbers that it gives it, and on its loads


def load_plan(path: str | Path) -> Plan:
    """Read a plan."""
    return plan_from_bytes(plan_bytes(path), str(path))


def plan_from_bytes(data: bytes, source: str) -> Plan:
    """Read a plan from the bytes of a file."""
    if not isinstance(root := read_tree(data, source), YamlMapping):
        allowed = "allowed: keys such as robot, points, path"
        raise RobotFileError("this is not a motion plan", allowed=allowed, location=Location(source))
    document = Document(root, source, hashlib.sha256(data).hexdigest(), "the plan")
    check_structure(document, PlanFile)
    plan = _PlanReader(document, _robot(document, data)).read()
    own = dict(plan.robot.parameters)  # replaced by the numbers of the plan, where it has others
    numbers = tuple((name, substitute(plan.values.get(name, value), own)) for name, value in own.items())
    robot = replace(plan.robot, parameters=numbers)
    carried: dict[KeyPath, Payload | None] = {("plant", PAYLOAD): plan.plant_payload}
    carried |= {("path", k, "payload"): step.payload for k, step in enumerate(plan.steps, 1)}
    loads = {path: body for path, body in carried.items() if body}
    remarks = remarks_on_loads(document, robot, (plan.values, plan.plant), loads)
    return replace(plan, robot=robot, remarks=(*plan.robot.remarks, *remarks))


def _robot(document: Document, data: bytes) -> Robot:
    if (scalar := document.scalar(("robot",))) is None:
        return Robot.from_bytes(data, document.source)
    if not scalar.text:
        raise document.error(("robot",), "found nothing", "allowed: a name from derive list, or a path")
    beside = Path(document.source).parent / scalar.text
    try:
        return Robot.load(beside if scalar.text not in catalogue_names() and beside.is_file() else scalar.text)
    except DeriveError as error:
        raise error.at(scalar.location) from None


class _PlanReader:
    def __init__(self, document: Document, robot: Robot) -> None:
        self._document, self._robot, self._numbers = document, robot, PlanCells(document, robot)
        self._cells = self._numbers.cells

    def read(self) -> Plan:
        document, numbers, period = self._document, self._numbers, ("control", "period")
        points = {name: self._point(name) for name in numbers.keys(("points",))}
        count = document.length(("path",))
        steps = tuple(self._step(index, points) for index in range(1, count))
        start = self._start(points) if count else ""
        curves = self._curves()
        recorded, joints = document.scalar(("recorded",)), self._robot.variables
        given = self._check_way([("path", count), ("curves", len(curves)), ("recorded", recorded is not None)])
        check_effects(document, self._robot, given, points, steps)
        self._check_ends(steps, points)
        recording = Path(document.source).parent / recorded.text if recorded else None
        if recorded and recording and not recording.is_file():
            allowed = "allowed: a CSV file, its path relative to the plan"
            raise RobotFileError(f"no file {quoted(str(recording))}", allowed=allowed, location=recorded.location)
        plan = Plan(
            robot=self._robot,
            title=document.text("title"),
            sample=numbers.positive(("sample",), number(Fraction(1, 100))),
            places=self._places(curves),
            points=points,
            start=start,
            steps=steps,
            curves=curves,
            duration=numbers.positive(("time",), ZERO) if curves else ZERO,
            recording=recording,
            base=numbers.base(),
            speed=self._most("speed", tuple(joint.speed for joint in joints)),
            acceleration=self._most("acceleration", (None,) * self._robot.dof),
            torque=self._most("torque", tuple(joint.torque for joint in joints)),
            values=numbers.values,
            control=Control(
                law=document.text("control", "law") or "none",
                kp=self._gains(("control", "kp")),
                kd=self._gains(("control", "kd")),
                period=numbers.positive(period, ONE) if document.scalar(period) else None,
            ),
            friction=document.text("friction") or "smooth",
            plant=numbers.plant(),
            plant_payload=self._payload(("plant", PAYLOAD)),
            disturbances=numbers.disturbances(),
            source=document.source,
            digest=document.digest,
        )
        numbers.check_used()
        return plan

    def _check_way(self, ways: Sequence[tuple[str, int]]) -> str:
        """Which of path, curves and recorded the plan has: one of them, and a time beside curves alone."""
        document, given = self._document, [key for key, has in ways if has]
        if len(given) != 1:
            found = "neither path nor curves nor recorded" if not given else f"both {given[0]} and {given[1]}"
            place: KeyPath = (given[1],) if given else ()
            raise document.error(place, found, "allowed: one of them", "write path: [rest, {to: A, time: 3}]")
        if document.find(("time",)) is not None and given != ["curves"]:
            remedy = "write the time of each segment: {to: A, time: 3}" if given == ["path"] else "remove it"
            raise document.error(("time",), f"a time beside {given[0]}", "allowed: beside curves", remedy)
        return given[0]

    def _places(self, curves: Mapping[str, Expression]) -> dict[str, Location]:
        """Where that stands in the file which is checked with numbers."""
        document = self._document
        long = next((key for key in ("sample", "time", "path", "recorded") if document.find((key,)) is not None), "")
        places: dict[str, KeyPath] = {"robot": ("robot",), "sample": (long,), "period": ("control", "period")}
        places |= {f"curves, {name}": ("curves", name) for name in curves}
        places |= {f"base, {name}": path for name, path in PATHS.items()}
        places |= {f"disturbance, {k}": ("disturbance", k) for k in range(document.length(("disturbance",)))}
        return {name: document.location(path) for name, path in places.items()}

    def _most(self, key: str, default: Most) -> Most:
        if self._document.find((key,)) is None:
            return default
        if key == "torque" and not self._robot.has_dynamics:
            found = f"{self._robot.name} has no dynamics"
            raise self._document.error((key,), found, remedy="leave it out, or write links into the robot file")
        most = self._numbers.of_joints((key,), self._cells.plain if key == "torque" else None)
        for k, value in enumerate(most):
            if self._numbers.size(value) <= 0:
                raise self._document.error((key, k), "not above zero", "allowed: a positive number")
        return most

    def _point(self, name: str) -> Point:
        path: KeyPath = ("points", name)
        location = self._document.key_location(path)
        if isinstance(self._document.find(path), YamlMapping):
            if (branch := self._document.scalar((*path, "branch"))) and not branch.text.strip(" ,"):
                raise self._document.error((*path, "branch"), "found nothing", remedy="leave it out for the nearest")
            place: KeyPath = (*path, "pose")

            def _three(key: str, read: Read) -> Vector:
                return tuple(self._numbers.number((*place, key, k), read) for k in range(3))

            if len(given := [key for key in ("rpy", "zyz") if self._document.find((*place, key)) is not None]) > 1:
                raise self._document.error(place, "both rpy and zyz", "allowed: one of the two", "remove one")
            angles = _three(given[0], self._cells.angle) if given else None
            pose = Pose(_three("p", self._cells.length), angles, given == ["zyz"])
            end = self._followed(path, self._end(path, "a pose"), "a pose")
            return Point(name, None, pose, branch.text if branch else "", location, end)
        numbers, q = self._numbers, self._numbers.of_joints(path)
        for k, (joint, value) in enumerate(zip(self._robot.variables, q, strict=True)):
            ends = joint.limits or ()
            if not ends or any(name not in numbers.numbers for limit in ends for name in names(limit)):
                continue
            low, high = map(numbers.size, ends)
            at = numbers.size(value)
            if not low - 1e-12 <= at <= high + 1e-12:
                unit = "rad" if joint.is_revolute else "m"
                found = f"{joint.variable} = {at:.6g} {unit} is outside its limits"
                raise self._document.error((*path, k), found, f"allowed: {low:.6g} to {high:.6g} {unit}")
        return Point(name, q, None, "", location)

    def _end(self, path: KeyPath, what: str, default: str = "") -> str:
        """The end of a tree that a place names; empty for one without a name, or for no ``what`` that needs one."""
        names, place = [end.name for end in self._robot.ends if end.name], (*path, "end")
        if self._document.scalar(place) is not None:
            try:
                return end_named(self._robot, self._document.text(*place)).name
            except QuantityError as error:
                raise self._document.error(place, error.found, error.allowed, error.remedy) from None
        if what and len(names) > 1 and not default:
            found, allowed = f"{what} of {self._robot.name} without end", f"allowed: one of {listed(names)}"
            raise self._document.error(path, found, allowed, f"write end: {names[0]}")
        return default or (names[0] if len(names) == 1 else "")

    def _followed(self, path: KeyPath, end: str, what: str) -> str:
        """An end that the joints follow, which those of a root that moves and coupled ones cannot."""
        if (robot := self._robot).root or robot.coupled:
            found = f"{what} of {robot.name}, whose {'joints are coupled' if robot.coupled else 'root moves'}"
            allowed = f"allowed: poses of {'uncoupled joints' if robot.coupled else 'robots that stand'}"
            remedy = "write joint variables, without line, through and spline: hand"
            raise self._document.error(path, found, allowed, remedy)
        return end

    def _check_ends(self, steps: Sequence[Step], points: Mapping[str, Point]) -> None:
        """Refuse ways of an end to or through a pose of another one."""
        for k, step in enumerate(steps, 1):
            for name in (step.to, step.through) if step.follows else ():
                if name and points[name].pose and points[name].end != step.end:
                    found = f"{name} is a pose of end {points[name].end}, and end {step.end} follows the way there"
                    raise self._document.error(("path", k), found, remedy=f"write end: {points[name].end}")
        for k, (step, after) in enumerate(pairwise(steps), 2):
            if step.by_hand and after.by_hand and not step.stops and step.end != after.end:
                found = f"a spline of end {step.end} and then of end {after.end}"
                raise self._document.error(("path", k), found, remedy=f"stop between: {{to: {step.to}, via: stop}}")

    def _target(self, path: KeyPath, points: Mapping[str, Point]) -> str:
        """The name of a point that stands at a place, or under ``to`` there."""
        path = path if isinstance(self._document.find(path), YamlScalar) else (*path, "to")
        if (name := self._document.text(*path)) not in points:
            allowed = f"allowed: {listed(tuple(points))}" if points else "write points: {rest: [0, 0], ...}"
            found = f"unknown point {quoted(name)}" if name else "found nothing"
            raise self._document.error(path, found, allowed, near_miss(name, points))
        return name

    def _start(self, points: Mapping[str, Point]) -> str:
        path: KeyPath = ("path", 0)
        for key in self._numbers.keys(path):
            if key != "to":
                remedy = f"write {self._document.text(*path, 'to')} alone, and {key} for where the arm goes then"
                raise self._document.error((*path, key), f"{key} at the start of the path", "allowed: a point", remedy)
        if self._document.length(("path",)) == 1:
            remedy = "write path: [rest, {to: A, time: 3}]"
            raise self._document.error(("path",), "one point", "allowed: two or more", remedy)
        return self._target(path, points)

    def _step(self, index: int, points: Mapping[str, Point]) -> Step:
        path: KeyPath = ("path", index)
        document = self._document
        time = (*path, "time")
        through = self._target((*path, "through"), points) if document.scalar((*path, "through")) else ""
        straight = document.text(*path, "line") in ("yes", "true")
        if through and straight:
            raise document.error((*path, "through"), "both line and through", "allowed: one of the two", "remove one")
        cruise = (*path, "cruise")
        profile = Profile(document.text(*path, "profile") or document.text("profile") or Profile.QUINTIC)
        passes = document.text("via") or ("pass" if profile is Profile.SPLINE else "stop")
        if profile is not Profile.TRAPEZOIDAL and document.scalar(cruise):
            remedy = "leave it out, or write profile: trapezoidal"
            raise document.error(cruise, f"a cruise of a {profile} motion", "allowed: of a trapezoid", remedy)
        if profile is Profile.FASTEST and document.scalar(time):
            remedy = "leave out time, or name another profile"
            raise document.error(time, "a fastest motion takes the time that the limits allow", remedy=remedy)
        to, by_hand = self._target(path, points), profile is Profile.SPLINE and document.text("spline") == "hand"
        what = f"the way to {to}" if straight or through or by_hand else ""
        end = self._end(path, what or (document.scalar((*path, "payload")) and "a payload") or "", points[to].end)
        return Step(
            to=to,
            time=self._numbers.positive(time, ONE) if document.scalar(time) else None,
            profile=profile,
            stops=(document.text(*path, "via") or passes) == "stop",
            cruise=self._numbers.plain(cruise) if document.scalar(cruise) else None,
            straight=straight,
            through=through,
            by_hand=by_hand,
            payload=self._payload((*path, "payload"), end),
            location=document.location(path),
            end=self._followed(path, end, what) if what else end,
        )

    def _payload(self, path: KeyPath, end: str = "") -> Payload | None:
        if (node := self._document.find(path)) is None:
            return None
        numbers, length = self._numbers, self._cells.length
        mass = numbers.not_negative(path if isinstance(node, YamlScalar) else (*path, "mass"), "zero or more [kg]")
        com = tuple(numbers.number((*path, "com", k), length) for k in range(3))
        inertia = tuple(numbers.not_negative((*path, "inertia", k), "zero or more [kg m^2]") for k in range(3))
        return Payload(mass, com, inertia, self._end(path, "a payload", end))

    def _gains(self, path: KeyPath) -> Vector:
        n, count = self._robot.dof, self._document.length(path)
        if count and count != n:
            found = f"{count} gain{'s' * (count > 1)} for {n} joint{'s' * (n > 1)}"
            raise self._document.error(path, found, f"allowed: one, or {n}")
        paths = [(*path, k) for k in range(n)] if count else [path] * n
        allowed, remedy = "zero or more", "a gain below zero drives away"
        return tuple(self._numbers.not_negative(place, allowed, remedy) for place in paths)

    def _curves(self) -> dict[str, Expression]:
        """Formulas of time, one for each joint variable; a joint that is left out stands still at zero."""
        variables = {joint.variable: joint for joint in self._robot.variables}
        found = {}
        for name in self._numbers.keys(("curves",)):
            if name not in variables:
                allowed = f"allowed: {listed(tuple(variables))}"
                raise self._document.error(("curves", name), f"no joint {quoted(name)}", allowed)
            read = self._cells.angle if variables[name].is_revolute else self._cells.length
            found[name] = self._numbers.formula(("curves", name), read)
        if found and self._document.scalar(("time",)) is None:
            raise self._document.error(("curves",), "no time", remedy="write time: 10 beside curves [s]")
        return {name: found.get(name, ZERO) for name in variables} if found else {}


def check_effects(document: Document, robot: Robot, given: str, points: Iterable[str], steps: Sequence[Step]) -> None:
    """Refuse the first key of a plan without effect; ``given`` is which of path, curves and recorded it has."""
    idle: list[Idle] = []
    if given != "path":
        idle += (((key,), f"{key} beside {given}, and there is no path", f"leave {key} out") for key in OF_PATHS)
    if not any(step.profile is Profile.SPLINE for step in steps):
        found = f"{document.text('spline')}, and no profile is spline"
        idle.append((("spline",), found, "write profile: spline, or leave spline: out"))
    if FREEDOMS.keys().isdisjoint(robot.inverse.task):
        found = f"an orientation, and the task of {robot.name} has none"
        poses: list[KeyPath] = [("points", name, "pose") for name in points]
        idle += (((*path, key), found, "leave it out") for path in poses for key in ("rpy", "zyz"))
    if document.text("control", "law") == "none":
        remedy = "name another law, or leave it out"
        idle += ((("control", key), f"{key} of no control law", remedy) for key in ("kp", "kd", "period"))
    bodies: list[KeyPath] = [("path", k, "payload") for k in range(1, len(steps) + 1)]
    if not robot.has_dynamics:
        remedy = "leave it out, or write links into the robot file"
        idle += ((path, f"{robot.name} has no dynamics", remedy) for path in (*bodies, ("plant",), ("disturbance",)))
    if robot.coupled:
        found, loads = f"not known of {robot.name}, whose joints are coupled", (("base",), ("plant", PAYLOAD), *bodies)
        idle += ((path, found, "leave it out") for path in loads)
        idle += [(("friction",), found, "write friction: smooth")] * (document.text("friction") == "exact")
    moved = "an end, and no line, arc or payload is its own"
    ends: list[tuple[KeyPath, Step]] = [(("path", k, "end"), step) for k, step in enumerate(steps, 1)]
    idle += ((path, moved, "leave it out") for path, step in ends if not (step.follows or step.payload))
    for path, found, remedy in (*idle, *_stopped(document, steps)):
        if document.find(path) is not None:
            raise document.error(path, found, remedy=remedy)


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
            found = f"with these {key} links {numbered(lacks)}, inertia: {too_large(lacks.values())}"
            yield Remark(document.location((key,)), found, REMEDY, is_of_bodies=True)
            told = lacks
    for path, payload in payloads.items():
        xx, yy, zz = (Fraction(evaluate(cell, values)) for cell in payload.inertia)
        if lack := lack_of((xx, yy, zz, Fraction(0), Fraction(0), Fraction(0))):
            found = f"{path_text(path)}, inertia: {too_large([lack])}"
            remedy = "write the moments of a body about its centre of mass"
            yield Remark(document.location((*path, "inertia")), found, remedy, is_of_bodies=True)
