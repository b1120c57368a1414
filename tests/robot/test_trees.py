"""Files of trees: what rows follow what, rows without motion, roots that move, ends; what is refused, and where."""

from itertools import product

import numpy as np
import pytest

from derive.errors import RobotFileError
from derive.programs.functions import ROWS
from derive.robot.description import BASE, Joint, Link, RootType, Stand
from derive.robot.evaluate import evaluate
from derive.robot.expression import ZERO, Name, to_text
from derive.robot.names import robot_symbols
from derive.robot.reading.table import SUFFIXES
from derive.robot.robot import Robot
from derive.robot.tree import ROOT_VARIABLES, arm, ends, explicit, parents
from derive.robot.units import located_expressions
from derive.robot.writer import robot_text
from tests.robot.test_writer import differing

TORSO = """\
name: torso
convention: standard
joints:
  - {type: revolute, q: w, theta: w, d: 0.3, limits: [-1, 1], name: "waist"}
  - {type: fixed, theta: pi/2, d: h, name: "head"}
  - {type: revolute, q: q2, after: "waist", mount: [[0, 0, 1, s], [1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 0, 1]], theta: q2}
  - {type: revolute, q: q3, theta: q3, a: u, limits: [0, 3]}
  - {type: fixed, after: "waist", mount: [[1, 0, 0, -s], [0, -1, 0, 0], [0, 0, -1, 0], [0, 0, 0, 1]], name: "shoulder"}
  - {type: prismatic, q: q4, d: q4, a: f, alpha: pi/2}
  - {type: revolute, q: q5, theta: q5}
gravity: [0, 0, -g]
ends:
  left: "q3"
  right: {after: "q5", tool: [[1, 0, 0, l], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]}
links:
  - mass: m1
  - mass: mh
    com: [0, 0, c]
  - mass: m2
  - mass: m3
    armature: J
  - mass: 0
  - mass: m4
  - mass: m5
figure:
  q: [0.1, 0.2, 0.3, 0.4, 0.5]
"""
BODY = """\
name: body
convention: modified
units: {angle: deg, length: mm}
joints:
  - {type: revolute, q: q1, gamma: 30, b: b1 + 20, alpha: 45, a: 100, theta: q1 + 90}
  - {type: fixed, a: 200, name: "tip"}
  - {type: revolute, q: q2, after: "base", gamma: g2, theta: q2, limits: [-90, 90]}
gravity: [0, -g, 0]
ends:
  pelvis: "base"
  hand: "tip"
  foot: "q2"
root:
  type: planar
  q: [x, y, turn]
  link:
    mass: m0
    com: [10, 0, 0]
links:
  - mass: m1
  - mass: m2
    com: [5, 0, 0]
  - mass: m3
"""
HEAD = "name: r\nconvention: standard\njoints:\n"
CHAIN = HEAD + "  - {type: revolute, q: q1, theta: q1, a: 1}\n"
TIPPED = CHAIN + '  - {type: fixed, d: 0.1, name: "plate"}\ntool:\n  - [1, 0, 0, 2]\n  - [0, 1, 0, 0]\n'
TIPPED += "  - [0, 0, 1, 0]\n  - [0, 0, 0, 1]\n"
FLOATING = CHAIN + "root:\n  type: floating\n  q: [x, y, z, yaw, pitch, roll]\n"


def screw(axis: int, angle: float, shift: float) -> np.ndarray:
    i, j = (axis + 1) % 3, (axis + 2) % 3
    found = np.eye(4)
    found[[i, j, i, j], [i, j, j, i]] = np.cos(angle), np.cos(angle), -np.sin(angle), np.sin(angle)
    found[axis, 3] = shift
    return found


def frame(robot: Robot, label: str, values: dict[str, float]) -> np.ndarray:
    """Of a row in frame 0: its own transform, as the grammar of the file has it, behind that of the row it follows."""
    row = next((row for row in (*explicit(robot).joints, *robot.fixed) if row.label == label), None)
    if row is None:
        return np.eye(4)
    number = {**dict.fromkeys(robot_symbols(robot), 0.7), **values}
    theta, d, a, alpha = (evaluate(cell, number) for cell in (row.theta, row.d, row.a, row.alpha))
    if isinstance(row, Joint):
        theta += row.sign * number[row.variable] * row.is_revolute
        d += row.sign * number[row.variable] * (not row.is_revolute)
    along_x, along_z = screw(0, alpha, a), screw(2, theta, d)
    own = along_z @ along_x if robot.convention == "standard" else along_x @ along_z
    mount = np.array([[evaluate(cell, number) for cell in line] for line in row.stand.mount])
    stand = mount @ screw(2, evaluate(row.stand.gamma, number), evaluate(row.stand.b, number))
    return frame(robot, row.stand.after, values) @ stand @ own


@pytest.mark.parametrize("text", [TORSO, BODY, CHAIN, TIPPED, FLOATING])
def test_trees_are_written_as_they_were_read(text: str) -> None:
    assert robot_text(Robot.from_text(text)) == text


def test_trees_are_what_their_files_say() -> None:
    robot = Robot.from_text(TORSO)
    assert (robot.n, parents(robot), robot.is_tree) == (5, (-1, 0, 1, 0, 3), True)
    assert [joint.stand and joint.stand.after for joint in robot.joints] == [None, "waist", None, "shoulder", None]
    assert [(row.row, row.stand.after) for row in robot.fixed] == [(1, "waist"), (4, "waist")]
    assert [row.link for row in robot.fixed] == [Link(Name("mh"), (ZERO, ZERO, Name("c"))), Link()]
    assert " ".join(robot_symbols(robot)) == "s h u f l g m1 mh c m2 m3 J m4 m5"
    places = {to_text(cell): place for place, cell in located_expressions(robot)}
    assert (places["u"], places["J"]) == (("joints", 3, "a"), ("links", 3, "armature"))
    assert (places["c"], places["l"]) == (("links", 1, "com", 2), ("ends", "right", "tool", 0, 3))
    shown = [line.split() for line in repr(robot).splitlines()]
    assert shown[1] == ["i", "joint", "name", "after", "theta", "d", "a", "alpha", "limits"]
    assert (shown[3][:3], shown[4][:6]) == (["fixed", "head", "waist"], ["2", "revolute", "q2", "waist", "+", "mount"])
    assert "<td>shoulder</td><td>waist + mount</td>" in robot._repr_html_()

    robot = Robot.from_text(BODY)
    cells = (robot.joints[3].stand.gamma, robot.joints[3].stand.b, robot.root.link.com[0], robot.fixed[1].a)
    assert [to_text(cell) for cell in cells] == ["pi/6", "b1 + 1/50", "1/100", "1/5"]
    assert (robot.fixed[0].link, robot.links[:3]) == (robot.root.link, (Link(),) * 3)


def test_what_goes_without_saying() -> None:
    robot = Robot.from_text(HEAD + "  - {type: fixed, name: a}\n  - {type: prismatic}\nroot: {type: planar}\n")
    assert [row.label for row in (*robot.joints, *robot.fixed)] == ["x", "y", "phi", "q1", BASE, "a"]
    assert (robot.fixed[1].stand, robot.joints[3].stand, robot.ends) == (Stand(BASE), Stand("a"), ())
    assert not Robot.from_text(CHAIN + "  - {type: revolute, after: q1}\n").is_tree
    assert Robot.from_text(CHAIN + "  - {type: revolute, name: base}\n").joints[1].label == BASE
    named = CHAIN + "  - {type: fixed, name: q2}\n  - {type: revolute, name: elbow}\n  - {type: revolute, after: q2}\n"
    assert parents(Robot.from_text(named + "ends: {a: q2, b: elbow}\n")) == (-1, 0, 0), "a name goes before a variable"


@pytest.mark.parametrize("kind", RootType)
@pytest.mark.parametrize("convention", ["standard", "modified"])
def test_a_root_moves_by_x_y_z_yaw_pitch_and_roll(kind: RootType, convention: str) -> None:
    robot = Robot.from_text(CHAIN.replace("standard", convention) + f"root: {{type: {kind.value}}}\n")
    values = dict(zip(ROOT_VARIABLES[kind], (0.3, -0.2, 0.7, 0.5, -0.4, 1.1), strict=False))
    yaw, pitch, roll = values.get("phi", values.get("yaw", 0.0)), values.get("pitch", 0.0), values.get("roll", 0.0)
    expected = screw(2, yaw, 0.0) @ screw(1, pitch, 0.0) @ screw(0, roll, 0.0)
    expected[:3, 3] = values["x"], values["y"], values.get("z", 0.0)
    assert np.allclose(frame(robot, BASE, values), expected, atol=1e-15)


@pytest.mark.parametrize("text", [TORSO, BODY])
def test_the_arm_to_an_end_reads_back_and_leads_there(text: str) -> None:
    robot = Robot.from_text(text)
    values = {joint.variable: 0.1 + 0.3 * i for i, joint in enumerate(robot.joints)}
    for end in robot.ends:
        serial, _ = arm(robot, end.name)
        assert np.allclose(frame(serial, ends(serial)[0].after, values), frame(robot, end.after, values), atol=1e-15)
        assert differing(Robot.from_text(robot_text(serial)), serial) == []


def test_no_end_is_called_as_names_of_functions_end() -> None:
    names, of_ends = [row.interface.name for row in ROWS], [row.interface.name for row in ROWS if row.of_end]
    rests = {long.removeprefix(f"{short}_") for short, long in product(of_ends, names)} - {*names}
    assert [rest for rest in rests if not SUFFIXES.fullmatch(f"{rest}_")] == []


# What of the torso is written otherwise, | before the place of the message, and words in it.
REFUSED = r"""
after: "waist", mount: [[0 ~ after: |wiast, mount: [[0 ~ allowed: base, waist, head; did you mean 'waist'?
after: "waist", mount: [[0 ~ after: |q2, mount: [[0 ~ joints row 3, after: the row itself; allowed: base, waist, head
after: "waist", mount: [[0 ~ after: |shoulder, mount: [[0 ~ 'shoulder' is row 5, below this one; allowed: base, waist
name: "waist" ~ after: |q5, name: "waist" ~ row 7, 'q5', follows this one: a circle
"shoulder" ~ |"head" ~ row name 'head' belongs to row 2 already
q3, a: u ~ q3, a: u, name: |head ~ joint name 'head' belongs to row 2 already
"shoulder" ~ |"base" ~ 'base' is what rows follow that stand on the base
left: " ~ base: |" ~ 'base' is what rows follow
- {type: fixed, theta: pi/2, d: h, name: "head"} ~ - |{type: fixed} ~ joints row 2: a fixed row without a name
d: h ~ d: h, limits: |[0, 1] ~ joints row 2, limits: a fixed row has no motion; allowed in a fixed row: name
[[0, 0, 1, s] ~ [[0, 0, 1, |q5] ~ joints row 3, mount row 1 entry 4: joint variable 'q5'
com: [0, 0, c] ~ motor: |{ratio: 1} ~ links row 2, motor: 'head' is fixed
mass: mh ~ mass: |-1 ~ links row 2, mass: negative mass -1
q2, after ~ q2, b: |1, after ~ write d, the offset along z
[[0, 0, 1, s] ~ [|[0, 0, 2, s] ~ joints row 3, mount row 1: row 1 of the rotation block has length 2
[[0, 0, 1, s] ~ [|[0, 0, 1.0000001, s] ~ joints row 3, mount row 1: row 1 of the rotation block has length 1.0000001
[[1, 0, 0, l] ~ [|[2, 0, 0, l] ~ ends, right, tool row 1: row 1 of the rotation block has length 2
limits: [0, 3] ~ limits: |[3, 0] ~ joints row 4, limits: lower limit is not below the upper
[0.1, 0.2, 0.3 ~ |[1, 0.1, 0.2, 0.3 ~ figure, q: 6 entries; allowed: exactly 5
[0.1, 0.2, 0.3 ~ [0.1, 0.2, |5 ~ outside of the limits of 'q3'
left: "q3" ~ left: |q6 ~ ends, left: no row 'q6'; allowed: base, waist, head, q2, q3, shoulder, q4, q5
after: "q5" ~ after: |"base" ~ ends, right, after: no joint moves 'base'
left: " ~ left-hand: |" ~ 'left-hand' is not a name
left: " ~ Position_DQ: |" ~ could be another one
left: " ~ end_right: |" ~ could be another one, or another end's
figure: ~ tool: |[[1, 0, 0, 1], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]\nfigure: ~ tool: a tool beside ends
links:\n ~ links:\n  |- mass: 1\n ~ links: 8 rows for 7 rows of joints; allowed: exactly 7
figure: ~ root: {type: planar, q: |[x, y]}\nfigure: ~ 2 names for a planar root; allowed: exactly 3; write q: [x, y
figure: ~ root: {type: |plannar}\nfigure: ~ allowed: 'planar' or 'floating'; did you mean 'planar'?
figure: ~ root: {type: planar, link: {|motor: {}}}\nfigure: ~ unknown key 'motor'; allowed: mass, com, inertia
figure: ~ root: {type: planar, q: [w, y, z]}\nfigure: ~ joints row 1, q: variable 'w' belongs to the root already
"""
OTHERS = [
    (CHAIN + "  - {type: revolute}\n  - {type: revolute, after: |q1}\n", "row 3 branches off, and the file names"),
    (CHAIN + "ends: |{}\n", "ends: no ends"),
    (CHAIN + "root: {type: planar, link: |{mass: 1}}\n", "a body of the root alone; allowed: all links or none"),
    (CHAIN + "  - {type: revolute}\n" * 250 + "root: {type: floating}\n", "257 joints and 0 fixed rows; allowed: 1 to"),
    (CHAIN + "  - {type: fixed, name: a}\n" * 257, "1 joints and 257 fixed rows; allowed: 1 to 256"),
]
EDITED = (line.replace("\\n", "\n").split(" ~ ") for line in REFUSED.strip().splitlines())
OTHERS += [(TORSO.replace(old, new), words) for old, new, words in EDITED]


@pytest.mark.parametrize(("text", "words"), OTHERS)
def test_what_is_wrong_is_refused_at_its_place(text: str, words: str) -> None:
    before, mark, after = text.partition("|")
    with pytest.raises(RobotFileError) as caught:
        Robot.from_text(before + after, "t.yaml")
    if place := mark and caught.value.location:
        assert (place.line, place.column) == (before.count("\n") + 1, len(before) - before.rfind("\n"))
    assert words in str(caught.value)
