"""Files with coupled joints: which names are variables, what bounds them, what is refused, and where."""

from fractions import Fraction

import pytest

from derive.errors import DeriveError, RobotFileError
from derive.robot.description import JointType, coupling
from derive.robot.evaluate import evaluate
from derive.robot.expression import number, to_text
from derive.robot.names import robot_symbols
from derive.robot.robot import Robot
from derive.robot.tree import require_arm, require_chain, require_own_variables
from derive.robot.writer import robot_text
from tests.refusals import one_message
from tests.robot.test_writer import differing

HEAD = "name: r\nconvention: standard\n"
FIRST = "joints:\n  - {type: revolute}\n"


def turning(cell: str, more: str = "") -> str:
    return f'  - {{type: revolute, theta: "{cell}"{more}}}\n'


def load(text: str) -> Robot:
    return Robot.from_text(HEAD + text)


def matrix(robot: Robot) -> list[list[str]]:
    return [[to_text(factor) for factor in row] for row in coupling(robot)]


def variables(robot: Robot) -> list[str]:
    return [variable.variable for variable in robot.variables]


def test_rows_of_one_variable_and_of_several() -> None:
    robot = load(FIRST + turning("q2 - q1") + "  - {type: prismatic, d: p*q1 + h}\n" + turning("(q2 + 3*q1)/2 + pi/6"))
    assert (robot.n, robot.dof, variables(robot)) == (4, 2, ["q1", "q2"])
    assert matrix(robot) == [["1", "0"], ["-1", "1"], ["p", "0"], ["3/2", "1/2"]]
    assert [joint.label for joint in robot.joints] == ["q1", "q2", "row 3", "row 4"]
    assert [to_text(cell) for cell in (robot.joints[2].d, robot.joints[3].theta)] == ["h", "pi/6"]
    assert robot_symbols(robot) == ("h", "p")


@pytest.mark.parametrize(
    ("cell", "factor"),
    [("2*q1", "2"), ("-q1", "-1"), ("q1/p", "1/p"), ("q1*sin(p)", "sin(p)"), ("q1 + q1/2", "3/2"), ("-(-q1)", "1")],
)
def test_factors_are_numbers_and_parameters(cell: str, factor: str) -> None:
    assert matrix(load(FIRST + turning(cell))) == [["1"], [factor]]


@pytest.mark.parametrize(
    ("text", "order"),
    [
        (FIRST + turning("q3 - q1") + "  - {type: revolute}\n", ["q1", "q3"]),
        (FIRST + turning("-q1", ", name: level") + "  - {type: revolute, q: q2}\n", ["q1", "q2"]),
        ("variables: {b: {}, a: {}}\njoints:\n" + turning("a + b") + turning("a - b"), ["b", "a"]),
        ("variables: {z: {}}\n" + FIRST + turning("z - q1"), ["q1", "z"]),
        ("variables: {q2: {}, q1: {}}\n" + FIRST + "  - {type: revolute}\n", ["q2", "q1"]),
        ("root: {type: planar}\njoints:\n" + turning("q2 - phi") + turning("q2"), ["x", "y", "phi", "q2"]),
    ],
)
def test_variables_come_in_the_order_of_the_rows_or_of_the_block(text: str, order: list[str]) -> None:
    assert variables(load(text)) == order


def test_limits_in_a_row_of_its_own_variable_are_the_variables_and_a_block_has_the_last_word() -> None:
    robot = load(
        "variables: {q1: {limits: [0, 1], torque: 5}}\njoints:\n"
        "  - {type: revolute, limits: [0, 3], speed: 2}\n"
        + turning("q2 - q1", ", limits: [-1, 4]")
        + turning("-q2", ", limits: [-9, 9]")
        + "  - {type: prismatic, d: q1/2}\n"
    )
    first, second = robot.coupled
    bounds = [[evaluate(limit, {}) for limit in variable.limits or ()] for variable in (first, second)]
    assert bounds == [[0, 1], [-1, 4]]
    assert (first.speed, first.torque, second.speed) == (number(Fraction(2)), number(Fraction(5)), None)
    assert [variable.type for variable in robot.coupled] == [JointType.REVOLUTE] * 2


@pytest.mark.parametrize(
    "text",
    [
        FIRST + turning("q2 - q1 + pi/3", ", limits: [0, 1], speed: 2") + "  - {type: prismatic, d: p*q2 - h}\n",
        "joints:\n  - {type: revolute, q: x}\n  - {type: revolute, q: y, theta: y - x}\n"
        "  - {type: revolute, after: y, theta: x/3}\nends: {a: y, b: row 3}\n",
        "units: {angle: deg, length: mm}\nvariables: {q3: {}, q2: {limits: [0, 90], speed: 30}, q1: {torque: 3}}\n"
        + FIRST
        + turning("q2 - q1 + 30")
        + "  - {type: prismatic, d: q3/2 + 100, limits: [0, 4]}\nfigure: {q: [2, 45, 0]}\n",
        "root: {type: planar}\nvariables: {x: {limits: [0, 1]}}\njoints:\n" + turning("phi") + turning("q2 - phi"),
        "variables: {a: {}, b: {}}\njoints:\n" + turning("a + b") + turning("a - b"),
    ],
)
def test_what_is_read_is_written_back(text: str) -> None:
    robot = load(text)
    again = Robot.from_text(robot_text(robot))
    assert not differing(robot, again)
    assert robot_text(again) == robot_text(robot)


def test_what_files_without_couplings_meant_is_unchanged() -> None:
    """Also where a cell names its variable, or counts it the other way."""
    robot = load("joints:\n" + turning("-q1 + a") + turning("q2") + "  - {type: revolute, q: x, theta: b + x}\n")
    assert (robot.coupled, robot.is_tree, variables(robot)) == ((), False, ["q1", "q2", "x"])
    assert [(joint.sign, joint.drive) for joint in robot.joints] == [(-1, ()), (1, ()), (1, ())]


ALIKE = "do not determine"
REFUSED = [
    *((FIRST + turning(cell), 5, "is not linear in q1") for cell in ("q1*q1", "sin(q1)", "q1**2", "2/q1")),
    *((FIRST + turning(cell), 5, "is not linear in q2, q1") for cell in ("q2*q1", "q2/q1", "p*(q2 + q1)")),
    (FIRST + turning("q1 - q1"), 5, "is constant"),
    (FIRST + turning("q1", ", a: q1"), 5, "joint variable 'q1' in the cell a"),
    (FIRST + turning("q1", ", limits: [0, q1]"), 5, "joint variable 'q1' in limits"),
    ("joints:\n" + turning("q2") + turning("q1"), 4, "if 'q2' is the variable, write q: q2"),
    (FIRST + "  - {type: revolute, q: q1, theta: 2*q1}\n", 5, "variable 'q1' belongs to row 1 already"),
    (FIRST + "  - {type: revolute, q: y, theta: q1}\n", 5, "variable 'y' moves no joint"),
    (FIRST + turning("q1", ", name: base"), 5, "'base' is what rows follow"),
    ("variables: {a: {}, b: {}}\njoints:\n" + turning("a + b") + turning("2*a + 2*b"), 5, f"{ALIKE} b"),
    ("variables: {a: {}, b: {}}\njoints:\n" + turning("a + p*b") + turning("a*p + p**2*b"), 5, f"{ALIKE} b"),
    ("variables: {a: {}}\njoints:\n" + turning("p*a") + "parameters: {p: 0}\n", 5, f"{ALIKE} a"),
    ("variables: {z: {}}\n" + FIRST + turning("q1"), 3, "variable 'z' moves no joint"),
    ("variables: {q1: {mass: 2}}\n" + FIRST + turning("q1"), 3, "unknown key 'mass'"),
    ("variables: {q1: {limits: [1, 0]}}\n" + FIRST + turning("q1"), 3, "lower limit is not below the upper"),
    ("variables: {q1: {limits: [0, q1]}}\n" + FIRST + turning("q1"), 3, "joint variable 'q1'"),
    ("variables: {q1: {speed: -1}}\n" + FIRST + turning("q1"), 3, "allowed: a number above zero"),
    ("variables: [q1]\n" + FIRST + turning("q1"), 3, "found a list"),
    ("parameters: {q1: 2}\n" + FIRST + turning("q1"), 3, "a joint variable has no fixed number"),
    ("variables: {q1: {}, qd1: {}}\n" + FIRST + turning("q1 + qd1"), 6, "that is a joint variable already"),
    ("units: {angle: deg}\n" + FIRST + "  - {type: prismatic, d: 2*q1}\n", 6, "an angle moves a length"),
    (FIRST + turning("2*q1") + "figure: {q: [1, 2]}\n", 6, "allowed: exactly 1"),
    ("variables: {q1: {limits: [0, 1]}}\n" + FIRST + turning("q1") + "figure: {q: [2]}\n", 7, "outside of the limits"),
    (FIRST + turning("2*q1") + "inverse: {given: [q2]}\n", 6, "'q2' is not a joint variable"),
]


@pytest.mark.parametrize(("text", "line", "words"), REFUSED, ids=[words for *_, words in REFUSED])
def test_what_is_wrong_is_refused_at_its_line(text: str, line: int, words: str) -> None:
    with one_message(RobotFileError, rf"<text>:{line}:\d+", words):
        load(text)


@pytest.mark.parametrize("require", [require_own_variables, require_chain, require_arm])
def test_robots_with_coupled_joints_are_no_chains_and_no_arms(require: object) -> None:
    assert callable(require)
    with pytest.raises(DeriveError, match="the sheet of r, whose joints are coupled; allowed: robots of which each"):
        require(load(FIRST + turning("2*q1")), "the sheet")
    require_own_variables(load(FIRST), "the sheet")
