"""What the controller of a simulation does not know: other numbers of the arm, and what pushes its joints."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from derive.errors import Location, RobotFileError, listed, near_miss, quoted
from derive.plans.cells import PlanCells
from derive.robot.evaluate import evaluate
from derive.robot.expression import Expression, to_text
from derive.robot.names import robot_symbols
from derive.robot.reading.document import Document, KeyPath, YamlMapping
from derive.robot.robot import Robot

PAYLOAD = "payload"  # the key of a body among the numbers of the plant


@dataclass(frozen=True, slots=True)
class Disturbance:
    """What pushes a joint for a time."""

    joint: int  # index of the joint
    torque: Expression  # torque or force [N m or N]
    start: Expression  # when it begins [s]
    end: Expression  # when it ends [s]


def plant_numbers(document: Document, robot: Robot, numbers: PlanCells) -> dict[str, Expression]:
    """Numbers of symbols that differ in the simulated arm."""
    node, symbols, found = document.find(("plant",)), (*robot_symbols(robot), PAYLOAD), {}
    for name in node.entries if isinstance(node, YamlMapping) else ():
        if name not in symbols:
            text, allowed = f"no symbol {quoted(name)} in {robot.name}", f"allowed: {listed(symbols)}"
            raise document.error(("plant", name), text, allowed, near_miss(name, symbols))
        if name != PAYLOAD:
            found[name] = numbers.plain(("plant", name))
    return found


def disturbances(document: Document, robot: Robot, numbers: PlanCells) -> tuple[Disturbance, ...]:
    """What pushes the joints."""
    variables, found = tuple(joint.variable for joint in robot.joints), []
    for k in range(document.length(("disturbance",))):
        path: KeyPath = ("disturbance", k)
        name = document.text(*path, "joint")
        if name not in variables:
            text, allowed = f"no joint {quoted(name)}", f"allowed: {listed(variables)}"
            raise document.error((*path, "joint"), text, allowed, near_miss(name, variables))
        start, torque, end = (numbers.plain((*path, key)) for key in ("start", "torque", "end"))
        if not 0 <= numbers.size(start) < numbers.size(end):
            text = f"from {to_text(start)} to {to_text(end)} s"
            raise document.error((*path, "end"), text, "allowed: an end after the start, neither below zero")
        found.append(Disturbance(variables.index(name), torque, start, end))
    return tuple(found)


def check_starts(
    disturbances: Iterable[Disturbance], places: Mapping[str, Location], values: Mapping[str, float], duration: float
) -> None:
    """Refuse a disturbance that begins when the motion has ended [s]."""
    for k, each in enumerate(disturbances):
        if (start := evaluate(each.start, values)) >= duration:
            found = f"a disturbance from {start:.6g} s on, and the motion ends after {duration:.6g} s"
            raise RobotFileError(found, remedy="leave it out", location=places[f"disturbance, {k}"])
