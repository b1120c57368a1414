"""What a robot file means: defaults, signs, dynamics, names."""

import dataclasses
import hashlib
from pathlib import Path

import pytest

from derive.errors import ExpressionError, RobotFileError, UnknownRobotError
from derive.robot.description import IDENTITY, Convention, JointType
from derive.robot.expression import ONE, ZERO, Name, to_text
from derive.robot.names import acceleration_name, free_symbols, joint_label, robot_symbols, velocity_name
from derive.robot.reading.size_limits import FILE_LIMITS
from derive.robot.robot import Robot
from tests.refusals import one_message

HEAD = "name: r\nconvention: standard\n"


def load(text: str) -> Robot:
    return Robot.from_text(text, "r.yaml")


def arm(*rows: str, tail: str = "") -> Robot:
    return load(HEAD + "joints:\n" + "".join(f"  - {row}\n" for row in rows) + tail)


def test_everything_optional_has_its_documented_default() -> None:
    robot = arm("{type: revolute}", "{type: prismatic}")
    first, second = robot.joints
    assert robot.title == robot.name == "r"
    assert robot.convention is Convention.STANDARD
    assert (first.variable, first.sign, first.theta, first.d, first.a, first.alpha) == ("q1", 1, *[ZERO] * 4)
    assert (second.type, second.variable, second.sign, second.d) == (JointType.PRISMATIC, "q2", 1, ZERO)
    assert (first.limits, robot.base, robot.tool) == (None, IDENTITY, IDENTITY)
    assert (robot.gravity, robot.links, robot.parameters, robot.runtime) == (None, (), (), ())


def test_a_full_row_is_read_cell_by_cell_quoted_or_bare() -> None:
    [joint] = arm("{type: revolute, q: th, theta: pi/2 - th, d: d1 + 1, a: 0.4318, alpha: al, limits: [-pi, x]}").joints
    assert (joint.variable, joint.sign) == ("th", -1)
    cells = (joint.theta, joint.d, joint.a, joint.alpha, *(joint.limits or ()))
    assert [to_text(cell) for cell in cells] == ["pi/2", "d1 + 1", "2159/5000", "al", "-pi", "x"]
    bare = arm("{type: revolute, a: 0.10, d: 1e3, theta: q1 + 1}")
    quoted = arm("{type: 'revolute', a: '0.10', d: \"1e3\", theta: \"q1 + 1\"}")
    assert bare.joints == quoted.joints


@pytest.mark.parametrize("name", ["I", "E", "S", "N", "Q", "lambda", "beta", "gamma", "no", "yes", "c1", "s12", "def"])
def test_names_are_never_anything_but_symbols(name: str) -> None:
    robot = arm(f"{{type: revolute, a: {name}}}", tail=f"parameters: {{{name}: 2}}\nruntime: [{name}]\n")
    assert robot.joints[0].a == Name(name)
    assert robot_symbols(robot) == free_symbols(robot) == (name,)


def test_links_have_zeros_where_the_file_is_silent() -> None:
    robot = arm("{type: revolute}", "{type: revolute}", tail="links: [{mass: 2}, {motor: {ratio: 5}}]\n")
    first, second = robot.links
    assert first.motor is None
    assert (first.com, first.inertia.xx, first.armature, first.viscous) == ((ZERO, ZERO, ZERO), ZERO, ZERO, ZERO)
    assert (second.mass, second.motor.mass, second.motor.inertia) == (ZERO, ZERO, ZERO)


def test_links_without_gravity_hang_in_a_field_g_along_minus_z_unless_g_means_something_else() -> None:
    robot = arm("{type: revolute}", tail="links: [{mass: m}]\nparameters: {g: 9.81}\n")
    assert [to_text(entry) for entry in robot.gravity] == ["0", "0", "-g"]
    assert robot_symbols(robot) == ("g", "m")
    assert free_symbols(robot) == ("m",)
    with pytest.raises(RobotFileError, match=r"r.yaml:5:\d+: links: .*'g' is used for something else"):
        arm("{type: revolute, a: g}", tail="links: [{mass: m}]\n")


def test_symbols_come_in_order_of_first_appearance_and_limits_do_not_count() -> None:
    robot = arm(
        "{type: revolute, a: z, d: y, limits: [-w, w]}",
        tail="gravity: [0, 0, -g]\nlinks: [{mass: m, com: [x, z, 0]}]\n"
        "tool: [[1,0,0,t],[0,1,0,0],[0,0,1,0],[0,0,0,1]]\n"
        "parameters: {z: 1, m: 2, w: 3}\nruntime: [m]\n",
    )
    assert robot_symbols(robot) == ("y", "z", "t", "g", "m", "x")
    assert free_symbols(robot) == ("y", "t", "g", "m", "x")


@pytest.mark.parametrize(
    ("variable", "velocity", "acceleration", "label"),
    [
        ("q1", "qd1", "qdd1", "1"),
        ("theta1", "thetad1", "thetadd1", "1"),
        ("d3", "dd3", "ddd3", "3"),
        ("theta", "thetad", "thetadd", ""),
        ("q12", "qd12", "qdd12", "12"),
        ("q_2", "q_d2", "q_dd2", "2"),
    ],
)
def test_names_of_derivatives_and_labels(variable: str, velocity: str, acceleration: str, label: str) -> None:
    assert velocity_name(variable) == velocity
    assert acceleration_name(variable) == acceleration
    assert joint_label(variable) == label


@pytest.mark.parametrize(
    "title", ["", '"', "\\input{x} % $", "{{ 7*7 }} {% raw %}", "# '''\n\"\"\"\n*/ -->", "日本 \U0001f916", "a\tb"]
)
def test_any_printable_title_is_legal(title: str) -> None:
    import json

    robot = load(f"{HEAD}title: {json.dumps(title)}\njoints: [{{type: revolute}}]\n")
    assert robot.title == (title or "r")


@pytest.mark.parametrize(
    "rotation",
    [
        "[[cos(b), -sin(b), 0, 0], [sin(b), cos(b), 0, 0], [0, 0, 1, h], [0, 0, 0, 1]]",
        "[[sqrt(2)/2, -sqrt(2)/2, 0, 0], [sqrt(2)/2, sqrt(2)/2, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]",
        "[[0.6, -0.8, 0, 0], [0.8, 0.6, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1.0]]",
        "[[0.7071068, -0.7071068, 0, 0], [0.7071068, 0.7071068, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]",
        "[[0, 0, 1, 0], [1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 0, 1]]",
        "[[k, -sqrt(1 - k**2), 0, 0], [sqrt(1 - k**2), k, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]",
        "[[x/n, -y/n, 0, 0], [y/n, x/n, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]".replace("n", "sqrt(x**2 + y**2)"),
    ],
)
def test_frames_that_are_rotations_for_all_parameters_load(rotation: str) -> None:
    assert arm("{type: revolute}", tail=f"base: {rotation}\n").base[3] == (ZERO, ZERO, ZERO, ONE)


def test_a_rotation_given_by_numbers_of_parameters_is_one_only_while_they_are_baked_in() -> None:
    tail = "tool: [[c, -s, 0, 0], [s, c, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]\nparameters: {c: 0.6, s: 0.8}\n"
    assert arm("{type: revolute}", tail=tail).tool[0][0] == Name("c")
    with pytest.raises(RobotFileError, match="rotation for all values"):
        arm("{type: revolute}", tail=tail + "runtime: [c]\n")


def test_a_path_and_a_text_give_the_same_robot(tmp_path: Path) -> None:
    text = HEAD + "joints: [{type: revolute}]\n"
    path = tmp_path / "r.yaml"
    path.write_bytes(b"\xef\xbb\xbf" + text.replace("\n", "\r\n").encode())
    robot = Robot.load(path)
    assert robot.source == str(path)
    assert robot.digest == hashlib.sha256(path.read_bytes()).hexdigest()
    assert dataclasses.replace(robot, source="", digest="") == dataclasses.replace(load(text), source="", digest="")


def test_what_is_no_robot_or_no_file_gives_one_message(tmp_path: Path) -> None:
    with pytest.raises(UnknownRobotError, match="did you mean 'scara-perugia'"):
        Robot.load("scara-perugai")
    with pytest.raises(UnknownRobotError, match="did you mean 'thumb'"):
        Robot.load("thumbs.yaml")
    with pytest.raises(UnknownRobotError):
        Robot.load("no\0such")
    with pytest.raises(UnknownRobotError):
        Robot.load("x" * 10_000)
    with pytest.raises(RobotFileError, match="not a file"):
        Robot.load(tmp_path)
    with pytest.raises(RobotFileError, match=r"/dev/null:1:1: not a file"):
        Robot.load("/dev/null")


def test_a_catalogue_name_wins_over_a_file_of_that_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "thumb").write_text(HEAD + "joints: [{type: revolute}]\n")
    assert Robot.load("thumb").n == 5
    assert Robot.load("./thumb").n == 1


CONTRADICTIONS = [
    ("{type: revolute, theta: 0}", "constant, but theta is the cell that moves"),
    ("{type: revolute, theta: 90}", "a figure's position"),
    ("{type: prismatic, d: d1}", "if 'd1' is the variable, write q: d1"),
    ("{type: revolute, theta: theta1}", "if 'theta1' is the variable, write q: theta1"),
    ("{type: revolute, theta: q1 - q1}", "constant"),
    ("{type: revolute, d: q1}", "write type: prismatic"),
    ("{type: prismatic, theta: q1}", "write type: revolute"),
    ("{type: revolute, a: q1}", "only in the cell theta"),
    ("{type: revolute, alpha: sin(q1)}", "only in the cell theta"),
    ("{type: revolute, theta: q1**2}", "is not linear in q1"),
    ("{type: revolute, theta: q1*cos(q1)}", "is not linear in q1"),
    ("{type: revolute, q: q2, theta: q1}", "constant"),
    ("{type: revolute, limits: [1, -1]}", "not below"),
    ("{type: revolute, limits: [0, q1]}", "in limits"),
    ("{type: revolute, q: pi}", "cannot be a symbol"),
    ("{type: revolute, q: q-1}", "is not a name"),
    ("{type: revolute, a: qd1}", "velocity of 'q1' is called 'qd1'"),
    ("{type: revolute, a: qdd1}", "acceleration of 'q1' is called 'qdd1'"),
    ("{type: revolute, a: sqrt(-1)}", "root of a negative"),
    ("{type: revolute, a: 1/sin(pi)}", "division by zero"),
    ("{type: revolute, a: tan(pi/2)}", "pole"),
    ("{type: revolute, alpha: ''}", "empty"),
]


PAIRS = [
    (("{type: revolute}", "{type: revolute, theta: q1*q2}"), "is not linear in q1, q2"),
    (("{type: revolute}", "{type: revolute, a: q1}"), "joint variable 'q1' in the cell a"),
    (("{type: revolute, q: x}", "{type: revolute, q: x}"), "belongs to row 1 already"),
    (("{type: revolute, q: q2}", "{type: revolute}"), "belongs to row 1 already"),
    (("{type: revolute, q: qd1}", "{type: revolute, q: q1}"), "is called 'qd1'"),
]


@pytest.mark.parametrize(("rows", "words"), [*(((row,), words) for row, words in CONTRADICTIONS), *PAIRS])
def test_contradictory_rows_are_refused_at_their_line(rows: tuple[str, ...], words: str) -> None:
    with one_message((RobotFileError, ExpressionError), rf"r.yaml:{3 + len(rows)}:\d+", words):
        arm(*rows)


def test_as_many_joints_load_as_are_allowed_and_no_more() -> None:
    assert arm(*["{type: revolute}"] * FILE_LIMITS.joints).n == 256
    with pytest.raises(RobotFileError, match="257 rows"):
        arm(*["{type: revolute}"] * 257)
