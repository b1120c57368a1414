"""Reads a motion plan: the robot, its points, the way between them and what moves it; exact, in SI units, radians."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path

from derive.errors import DeriveError, Location, RobotFileError, listed, near_miss, quoted
from derive.motion.catalogue import plan_bytes
from derive.motion.disturbance import PAYLOAD, Disturbance, disturbances, plant_numbers
from derive.motion.moving_base import MovingBase, read_base
from derive.motion.plan_schema import PlanFile
from derive.motion.points import Payload, Point, Pose, Vector
from derive.motion.profile import Profile
from derive.robot.cells import Cells
from derive.robot.document import Document, KeyPath, YamlMapping, YamlScalar, read_tree
from derive.robot.evaluate import evaluate, parameter_values
from derive.robot.expression import ONE, ZERO, Expression, contains_pi, names, number
from derive.robot.load import catalogue_names
from derive.robot.robot import Robot
from derive.robot.schema import check_structure

TIME = "t"
"""The letter of time in curves."""

Most = tuple[Expression | None, ...]
"""The largest value of each joint; None where nothing limits it."""


@dataclass(frozen=True, slots=True)
class Step:
    """One segment of the path.

    Attributes:
        to: Name of the point at its end.
        time: Its length [s]; None where limits decide.
        profile: How the arm goes.
        stops: Whether it stands at the end.
        cruise: Trapezoid: top speed as a multiple of distance by time; None for the usual one.
        straight: Whether the end effector moves on a line.
        through: Point of an arc in space; empty for none.
        by_hand: Whether the end effector moves on a spline in space, through this point and those beside it.
        payload: What the tool carries.
        location: Where it stands in the plan.
    """

    to: str
    time: Expression | None
    profile: Profile
    stops: bool
    cruise: Expression | None
    straight: bool
    through: str
    by_hand: bool
    payload: Payload | None
    location: Location

    @property
    def in_space(self) -> bool:
        """Whether the end effector moves on a line or an arc."""
        return self.straight or bool(self.through)

    @property
    def follows(self) -> bool:
        """Whether the joints follow the end effector."""
        return self.in_space or self.by_hand


@dataclass(frozen=True, slots=True)
class Control:
    """Who moves the arm in a simulation.

    Attributes:
        law: ``none``, ``pd``, ``pd-gravity`` or ``computed-torque``.
        kp: Gain of the position, one a joint.
        kd: Gain of the velocity, one a joint.
        period: Time between two samples of the controller [s]; None for a continuous one.
    """

    law: str
    kp: Vector
    kd: Vector
    period: Expression | None


@dataclass(frozen=True, slots=True)
class Plan:
    """A motion as its file describes it.

    Attributes:
        robot: The robot.
        title: Free text for people.
        sample: Time between two rows of a table [s].
        sample_location: Where it stands in the file.
        points: By name, in the order of the file.
        start: Name of the first point of the path; empty where curves are given.
        steps: The segments.
        curves: Each joint variable as an expression in `TIME`; empty where a path is given.
        duration: How long curves last [s].
        recording: A CSV file with the motion, or None.
        base: How the base moves, or None.
        speed: Largest speed of each joint, by default that of the robot; None where nothing limits it.
        acceleration: Largest acceleration of each joint.
        torque: Largest torque of each joint, by default that of the robot.
        values: Numbers of symbols of the robot.
        control: Who moves the arm in a simulation.
        friction: ``none``, ``smooth`` or ``exact``.
        plant: Numbers of symbols in the simulated arm that the controller does not know.
        plant_payload: What the tool carries all the time and the controller does not know.
        disturbances: What pushes joints in a simulation.
        source: Name of the file, for messages.
        digest: SHA-256 of its bytes.
    """

    robot: Robot
    title: str
    sample: Expression
    sample_location: Location
    points: Mapping[str, Point]
    start: str
    steps: tuple[Step, ...]
    curves: Mapping[str, Expression]
    duration: Expression
    recording: Path | None
    base: MovingBase | None
    speed: Most
    acceleration: Most
    torque: Most
    values: Mapping[str, Expression]
    control: Control
    friction: str
    plant: Mapping[str, Expression]
    plant_payload: Payload | None
    disturbances: tuple[Disturbance, ...]
    source: str
    digest: str


def load_plan(path: str | Path) -> Plan:
    """Read a plan.

    Args:
        path: Of a YAML file, or the name of a built-in plan.

    Returns:
        The plan.

    Raises:
        RobotFileError: The file cannot be read or is no plan.
        UnknownRobotError: Neither a file nor the name of a plan.
    """
    return plan_from_bytes(plan_bytes(path), str(path))


def plan_from_bytes(data: bytes, source: str) -> Plan:
    """Read a plan from the bytes of a file.

    Args:
        data: YAML in UTF-8.
        source: Name for messages; the path of a robot is relative to its folder.

    Returns:
        The plan.

    Raises:
        RobotFileError: The bytes are no plan.
        ExpressionError: A cell is outside the grammar.
        UnknownRobotError: The robot is neither a file nor a catalogue name.
    """
    root = read_tree(data, source)
    if not isinstance(root, YamlMapping):
        allowed = "allowed: keys such as robot, points, path"
        raise RobotFileError("this is no motion plan", allowed=allowed, location=Location(source))
    document = Document(root, source, hashlib.sha256(data).hexdigest())
    check_structure(document, PlanFile)
    return _Reader(document, _robot(document, data)).read()


def _robot(document: Document, data: bytes) -> Robot:
    """The robot: the block, a name, or a file beside the plan."""
    scalar = document.scalar(("robot",))
    if scalar is None:
        return Robot.from_bytes(data, document.source)
    beside = Path(document.source).parent / scalar.text
    try:
        return Robot.load(beside if scalar.text not in catalogue_names() and beside.is_file() else scalar.text)
    except DeriveError as error:
        raise error.at(scalar.location) from None


class _Reader:
    """Reads the blocks of a plan in the units of its robot."""

    def __init__(self, document: Document, robot: Robot) -> None:
        self._document = document
        self._robot = robot
        self._cells = Cells(document, robot.units)
        self._values = {name: self._cells.plain(("values", name)) for name in self._keys(("values",))}

    @property
    def _floats(self) -> dict[str, Fraction | float]:
        """Numbers of all symbols."""
        numbers: dict[str, Fraction | float] = dict(parameter_values(self._robot))
        return numbers | {name: evaluate(expression, numbers) for name, expression in self._values.items()}

    def read(self) -> Plan:
        """The whole plan."""
        document = self._document
        points = {name: self._point(name) for name in self._keys(("points",))}
        count = document.length(("path",))
        steps = tuple(self._step(index, points) for index in range(1, count))
        start = self._target(("path", 0), points) if count else ""
        curves = self._curves()
        recorded = document.scalar(("recorded",))
        given = [key for key, has in (("path", count), ("curves", curves), ("recorded", recorded)) if has]
        if document.text("spline") == "hand" and not any(step.by_hand for step in steps):
            remedy = "write profile: spline, or leave spline: out"
            raise document.error(("spline",), "hand, and no profile is spline", remedy=remedy)
        if len(given) != 1:
            found = "neither path nor curves nor recorded" if not given else f"both {given[0]} and {given[1]}"
            raise document.error((), found, "allowed: one of them", "write path: [rest, {to: A, time: 3}]")
        return Plan(
            robot=self._robot,
            title=document.text("title"),
            sample=self._positive(("sample",), number(Fraction(1, 100))),
            sample_location=document.location(("sample",)),
            points=points,
            start=start,
            steps=steps,
            curves=curves,
            duration=self._positive(("time",), ZERO) if curves else ZERO,
            recording=self._recording(recorded) if recorded else None,
            base=read_base(document, self._cells, {*parameter_values(self._robot), *self._values, TIME}),
            speed=self._most("speed", tuple(joint.speed for joint in self._robot.joints)),
            acceleration=self._most("acceleration", (None,) * self._robot.n),
            torque=self._most("torque", tuple(joint.torque for joint in self._robot.joints)),
            values=self._values,
            control=self._control(),
            friction=document.text("friction") or "smooth",
            plant=plant_numbers(document, self._robot, self._plain),
            plant_payload=self._payload(("plant", PAYLOAD)),
            disturbances=disturbances(document, self._robot, self._plain),
            source=document.source,
            digest=document.digest,
        )

    def _keys(self, path: KeyPath) -> tuple[str, ...]:
        node = self._document.find(path)
        return tuple(node.entries) if isinstance(node, YamlMapping) else ()

    def _number(self, path: KeyPath, read: Callable[[KeyPath], Expression]) -> Expression:
        """A cell whose symbols all have numbers, and whose value exists."""
        value, numbers = read(path), self._floats
        for name in names(value):
            if name not in numbers:
                remedy = near_miss(name, numbers) or f"write values: {{{name}: ...}}"
                raise self._document.error(path, f"the symbol '{name}' has no number", remedy=remedy)
        try:
            evaluate(value, numbers)
        except ArithmeticError as error:
            raise self._document.error(path, str(error), "allowed: a finite real value") from None
        return value

    def _plain(self, path: KeyPath) -> Expression:
        return self._number(path, self._cells.plain)

    def _positive(self, path: KeyPath, default: Expression) -> Expression:
        """A time."""
        if self._document.scalar(path) is None:
            return default
        value = self._number(path, self._cells.plain)
        if evaluate(value, self._floats) <= 0:
            found = f"found {quoted(self._document.text(*path))}"
            raise self._document.error(path, found, "allowed: a time above zero [s]")
        return value

    def _joint_cells(self, path: KeyPath, read: Callable[[KeyPath], Expression] | None = None) -> Vector:
        """One cell a joint, in the units of the robot."""
        robot, count = self._robot, self._document.length(path)
        if count != robot.n:
            variables = listed(tuple(joint.variable for joint in robot.joints))
            found = f"{count} value{'' if count == 1 else 's'} for {robot.n} joints"
            raise self._document.error(path, found, f"allowed: one for each of {variables}")
        for k, joint in enumerate(robot.joints):
            if read is None and not joint.is_revolute and contains_pi(self._cells.raw((*path, k))):
                found = f"an angle, {quoted(self._document.text(*path, k))}, for the slide {joint.variable}"
                raise self._document.error((*path, k), found, "allowed: a length, without pi")
        reads = (read or (self._cells.angle if joint.is_revolute else self._cells.length) for joint in robot.joints)
        return tuple(self._number((*path, k), cell) for k, cell in enumerate(reads))

    def _most(self, key: str, default: Most) -> Most:
        """The largest value of each joint."""
        if self._document.find((key,)) is None:
            return default
        if key == "torque" and not self._robot.has_dynamics:
            found = f"{self._robot.name} has no dynamics"
            raise self._document.error((key,), found, remedy="leave it out, or write links into the robot file")
        most = self._joint_cells((key,), self._cells.plain if key == "torque" else None)
        for k, value in enumerate(most):
            if evaluate(value, self._floats) <= 0:
                raise self._document.error((key, k), "not above zero", "allowed: a positive number")
        return most

    def _point(self, name: str) -> Point:
        path: KeyPath = ("points", name)
        location = self._document.key_location(path)
        if isinstance(self._document.find(path), YamlMapping):
            return Point(name, None, self._pose((*path, "pose")), self._document.text(*path, "branch"), location)
        q = self._joint_cells(path)
        self._check_limits(path, q)
        return Point(name, q, None, "", location)

    def _check_limits(self, path: KeyPath, q: Vector) -> None:
        numbers = self._floats
        for k, (joint, value) in enumerate(zip(self._robot.joints, q, strict=True)):
            if joint.limits is None or any(name not in numbers for limit in joint.limits for name in names(limit)):
                continue
            low, high = (evaluate(limit, numbers) for limit in joint.limits)
            at = evaluate(value, numbers)
            if not low - 1e-12 <= at <= high + 1e-12:
                unit = "rad" if joint.is_revolute else "m"
                found = f"{joint.variable} = {at:.6g} {unit} is outside its limits"
                raise self._document.error((*path, k), found, f"allowed: {low:.6g} to {high:.6g} {unit}")

    def _pose(self, path: KeyPath) -> Pose:
        def _three(key: str, read: Callable[[KeyPath], Expression]) -> Vector:
            return tuple(self._number((*path, key, k), read) for k in range(3))

        given = [key for key in ("rpy", "zyz") if self._document.find((*path, key)) is not None]
        if len(given) > 1:
            raise self._document.error(path, "both rpy and zyz", "allowed: one of the two", "remove one")
        angles = _three(given[0], self._cells.angle) if given else None
        return Pose(_three("p", self._cells.length), angles, given == ["zyz"])

    def _target(self, path: KeyPath, points: Mapping[str, Point]) -> str:
        """The point at which a segment ends."""
        path = path if isinstance(self._document.find(path), YamlScalar) else (*path, "to")
        name = self._document.text(*path)
        if name not in points:
            allowed = f"allowed: {listed(tuple(points))}" if points else "write points: {rest: [0, 0], ...}"
            raise self._document.error(path, f"unknown point {quoted(name)}", allowed, near_miss(name, points))
        return name

    def _step(self, index: int, points: Mapping[str, Point]) -> Step:
        path: KeyPath = ("path", index)
        document = self._document
        time = (*path, "time")
        through = document.text(*path, "through")
        if through and through not in points:
            raise document.error(
                (*path, "through"), f"unknown point {quoted(through)}", remedy=near_miss(through, points)
            )
        cruise = (*path, "cruise")
        profile = Profile(document.text(*path, "profile") or document.text("profile") or Profile.QUINTIC)
        passes = "pass" if profile is Profile.SPLINE else document.text("via")
        if profile is Profile.FASTEST and document.scalar(time):
            remedy = "leave out time, or name another profile"
            raise document.error(time, "a fastest motion takes the time that the limits allow", remedy=remedy)
        return Step(
            to=self._target(path, points),
            time=self._positive(time, ONE) if document.scalar(time) else None,
            profile=profile,
            stops=(document.text(*path, "via") or passes or "stop") == "stop",
            cruise=self._number(cruise, self._cells.plain) if document.scalar(cruise) else None,
            straight=bool(document.text(*path, "line")),
            through=through,
            by_hand=profile is Profile.SPLINE and document.text("spline") == "hand",
            payload=self._payload((*path, "payload")),
            location=document.location(path),
        )

    def _payload(self, path: KeyPath) -> Payload | None:
        node = self._document.find(path)
        if node is None:
            return None
        cells = self._cells
        mass = self._number(path if isinstance(node, YamlScalar) else (*path, "mass"), cells.plain)
        if evaluate(mass, self._floats) < 0:
            raise self._document.error(path, "negative mass", "allowed: zero or more [kg]")
        com = tuple(cells.length((*path, "com", k)) for k in range(3))
        return Payload(mass, com, tuple(cells.plain((*path, "inertia", k)) for k in range(3)))

    def _recording(self, file: YamlScalar) -> Path:
        """The file that the plan names, beside it."""
        beside = Path(self._document.source).parent / file.text
        if not beside.is_file():
            raise RobotFileError(f"no file {quoted(str(beside))}", location=file.location)
        return beside

    def _control(self) -> Control:
        path: KeyPath = ("control",)
        period = (*path, "period")
        return Control(
            law=self._document.text(*path, "law") or "none",
            kp=self._gains((*path, "kp")),
            kd=self._gains((*path, "kd")),
            period=self._positive(period, ONE) if self._document.scalar(period) else None,
        )

    def _gains(self, path: KeyPath) -> Vector:
        """One gain for all joints, or one for each."""
        n, count = self._robot.n, self._document.length(path)
        if count and count != n:
            raise self._document.error(path, f"{count} gains for {n} joints", f"allowed: one, or {n}")
        paths = [(*path, k) for k in range(n)] if count else [path] * n
        gains = tuple(self._number(place, self._cells.plain) for place in paths)
        for place, gain in zip(paths, gains, strict=True):
            if evaluate(gain, self._floats) < 0:
                found = f"found {quoted(self._document.text(*place))}"
                raise self._document.error(place, found, "allowed: zero or more", "a gain below zero drives away")
        return gains

    def _curves(self) -> dict[str, Expression]:
        """Formulas of time, one for each joint variable; a joint that is left out stands still at zero."""
        variables = {joint.variable: joint for joint in self._robot.joints}
        found = {}
        for name in self._keys(("curves",)):
            if name not in variables:
                allowed = f"allowed: {listed(tuple(variables))}"
                raise self._document.error(("curves", name), f"no joint {quoted(name)}", allowed)
            read = self._cells.angle if variables[name].is_revolute else self._cells.length
            value = read(("curves", name))
            known = {*parameter_values(self._robot), *self._values, TIME}
            if unknown := [symbol for symbol in names(value) if symbol not in known]:
                raise self._document.error(("curves", name), f"the symbol '{unknown[0]}' has no number")
            found[name] = value
        if found and self._document.scalar(("time",)) is None:
            raise self._document.error((), "curves without a time", remedy="write time: 10 beside curves [s]")
        return {name: found.get(name, ZERO) for name in variables} if found else {}
