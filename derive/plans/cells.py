"""Cells of a motion plan: expressions whose symbols all have numbers, in the units of the plan's robot."""

from collections.abc import Callable, Mapping
from fractions import Fraction
from functools import cached_property

from derive.errors import listed, near_miss, quoted
from derive.plans.segments import Disturbance
from derive.robot.cells import Cells, check_symbol
from derive.robot.evaluate import evaluate, parameter_values
from derive.robot.expression import Expression, contains_pi, names, to_text
from derive.robot.names import file_symbols, robot_symbols
from derive.robot.reading.document import Document, KeyPath, YamlMapping
from derive.robot.robot import Robot

TIME_NAME = "t"  # the letter of time in curves
PAYLOAD = "payload"  # the key of a body among the numbers of the plant
# Where a plan has the formulas of the position and the angles of a base that moves.
PATHS: dict[str, KeyPath] = {
    **{key: ("base", key) for key in ("x", "y", "z")},
    **{angle: ("base", "rpy", k) for k, angle in enumerate(("roll", "pitch", "yaw"))},
}
Read = Callable[[KeyPath], Expression]  # reads a cell


class PlanCells:
    """The cells of a plan."""

    def __init__(self, document: Document, robot: Robot) -> None:
        self._document, self._robot = document, robot
        self.cells = Cells(document, robot.units, unitless=frozenset({TIME_NAME}))  # as written, in SI units and rad
        self.values: dict[str, Expression] = {}  # numbers of symbols that the plan gives
        for name in self.keys(("values",)):
            path: KeyPath = ("values", name)
            check_symbol(document, path, name)
            if name == TIME_NAME or any(joint.variable == name for joint in (*robot.joints, *robot.variables)):
                what = "the time" if name == TIME_NAME else "a joint variable"
                raise document.error(path, f"{name} is {what}", "allowed: symbols of the robot and of formulas")
            self.values[name] = self._with_numbers(path, self.cells.symbol(path, robot, name), parameter_values(robot))

    @cached_property
    def numbers(self) -> Mapping[str, Fraction | float]:
        """Numbers of all symbols."""
        numbers: dict[str, Fraction | float] = dict(parameter_values(self._robot))
        return numbers | {name: evaluate(expression, numbers) for name, expression in self.values.items()}

    def check_used(self) -> None:
        """Refuse numbers of symbols that neither the robot nor any cell that was read has."""
        robot = self._robot
        known = {*file_symbols(robot), *(name for name, _ in robot.parameters), *self.cells.first_use}
        for name in self.values:
            if name not in known:
                found = f"no symbol {quoted(name)} in {robot.name} or in a formula"
                raise self._document.error(("values", name), found, remedy=near_miss(name, known) or "remove it")

    def keys(self, path: KeyPath) -> tuple[str, ...]:
        """The keys of a mapping."""
        return tuple(node.entries) if isinstance(node := self._document.find(path), YamlMapping) else ()

    def number(self, path: KeyPath, read: Read) -> Expression:
        """A cell whose symbols all have numbers, and whose value exists."""
        return self._with_numbers(path, read(path), self.numbers)

    def _with_numbers(self, path: KeyPath, value: Expression, numbers: Mapping[str, Fraction | float]) -> Expression:
        self.check_symbols(path, value, numbers)
        try:
            evaluate(value, numbers)
        except ArithmeticError as error:
            raise self._document.error(path, str(error), "allowed: a finite real value") from None
        return value

    def check_symbols(self, path: KeyPath, value: Expression, known: Mapping[str, object]) -> None:
        """Refuse symbols without a number."""
        for name in names(value):
            if name not in known:
                remedy = near_miss(name, known) or f"write values: {{{name}: ...}}"
                raise self._document.error(path, f"the symbol '{name}' has no number", remedy=remedy)

    def formula(self, path: KeyPath, read: Read) -> Expression:
        """A formula of time."""
        value = read(path)
        self.check_symbols(path, value, {**self.numbers, TIME_NAME: 0})
        return value

    def plain(self, path: KeyPath) -> Expression:
        """A quantity that is always in SI units."""
        return self.number(path, self.cells.plain)

    def size(self, value: Expression) -> float:
        """The number of an expression."""
        return evaluate(value, self.numbers)

    def positive(self, path: KeyPath, default: Expression) -> Expression:
        """A time above zero."""
        if self._document.scalar(path) is None:
            return default
        return self.not_negative(path, "a time above zero [s]", above=True)

    def not_negative(self, path: KeyPath, allowed: str, remedy: str = "", *, above: bool = False) -> Expression:
        """A quantity of zero or more, or above zero."""
        value = self.plain(path)
        if self.size(value) < 0 or (above and self.size(value) == 0):
            found = f"found {quoted(self._document.text(*path))}"
            raise self._document.error(path, found, f"allowed: {allowed}", remedy)
        return value

    def of_joints(self, path: KeyPath, read: Read | None = None) -> tuple[Expression, ...]:
        """One cell a joint, by one of the readers of `cells`; None for angles and lengths in the units of the robot."""
        robot, count = self._robot, self._document.length(path)
        if count != robot.dof:
            variables = listed(tuple(joint.variable for joint in robot.variables))
            what = f"{'variable' if robot.coupled else 'joint'}{'' if robot.dof == 1 else 's'}"
            found = f"{count} value{'' if count == 1 else 's'} for {robot.dof} {what}"
            raise self._document.error(path, found, f"allowed: one for each of {variables}")
        for k, joint in enumerate(robot.variables):
            if read is None and not joint.is_revolute and contains_pi(self.cells.raw((*path, k))):
                found = f"an angle, {quoted(self._document.text(*path, k))}, for the slide {joint.variable}"
                raise self._document.error((*path, k), found, "allowed: a length, without pi")
        reads = (read or (self.cells.angle if joint.is_revolute else self.cells.length) for joint in robot.variables)
        return tuple(self.number((*path, k), cell) for k, cell in enumerate(reads))

    # -- what else a plan says of the arm

    def plant(self) -> dict[str, Expression]:
        """Numbers of symbols that differ in the simulated arm."""
        symbols, found = (*robot_symbols(self._robot), PAYLOAD), {}
        for name in self.keys(("plant",)):
            if name not in symbols:
                text, allowed = f"no symbol {quoted(name)} in {self._robot.name}", f"allowed: {listed(symbols)}"
                raise self._document.error(("plant", name), text, allowed, near_miss(name, symbols))
            if name != PAYLOAD:
                found[name] = self.plain(("plant", name))
        return found

    def disturbances(self) -> tuple[Disturbance, ...]:
        """What pushes the joints."""
        document, variables, found = self._document, tuple(joint.variable for joint in self._robot.variables), []
        for k in range(document.length(("disturbance",))):
            path: KeyPath = ("disturbance", k)
            if (name := document.text(*path, "joint")) not in variables:
                text, allowed = f"no joint {quoted(name)}", f"allowed: {listed(variables)}"
                raise document.error((*path, "joint"), text, allowed, near_miss(name, variables))
            start, torque, end = (self.plain((*path, key)) for key in ("start", "torque", "end"))
            if not 0 <= self.size(start) < self.size(end):
                text = f"from {to_text(start)} to {to_text(end)} s"
                raise document.error((*path, "end"), text, "allowed: an end after the start, neither below zero")
            found.append(Disturbance(variables.index(name), torque, start, end))
        return tuple(found)

    def base(self) -> tuple[Expression, ...]:
        """The formulas of the block ``base``: x, y, z [m], roll, pitch, yaw [rad]; none of a base that stands."""
        if self._document.find(("base",)) is None:
            return ()
        kinds = (*[self.cells.length] * 3, *[self.cells.angle] * 3)
        return tuple(self.formula(path, kind) for path, kind in zip(PATHS.values(), kinds, strict=True))
