"""The figure as text: inert, deterministic, with a way for every joint, and what of an end effector is dragged."""

import math
import random
import re
from dataclasses import replace

import pytest

from derive.handouts.figure.scene import upwards
from derive.handouts.page.target import dragging
from derive.handouts.page.viewer import Viewer, html_symbol, symbol_values, three, travels, viewer
from derive.handouts.sheet.language import Text
from derive.programs.build import build_program
from derive.programs.optimise.search_policy import Effort
from derive.robot.options.inverse import POSE, InverseOptions
from derive.robot.robot import Robot
from derive.workspace.poses import RobotPoses
from tests.handouts.page.page_documents import assumed
from tests.random_robots import random_robot, seeds

BUNDLE_BUDGET = 600_000


def figure(robot: Robot, text: Text | None = None) -> Viewer:
    return viewer(robot, build_program(robot, Effort.QUICK), assumed(robot), text or Text())


def arm(rows: str, more: str = "") -> Robot:
    return Robot.from_text(f"name: arm\nconvention: standard\njoints:\n{rows}\n{more}")


@pytest.mark.parametrize("seed", seeds(12, usual=4))
def test_any_robot_gets_a_figure_that_starts_within_its_limits(seed: int) -> None:
    robot = Robot.from_text(random_robot(random.Random(4000 + seed)).text)
    made = figure(robot)
    assert "</script" not in made.script
    assert made.html.count('type="range"') == robot.n
    for travel in travels(robot, symbol_values(robot, (), assumed(robot)), None):
        assert travel.lower <= travel.start <= travel.upper
        assert travel.lower < travel.upper


def test_the_same_robot_gives_the_same_figure() -> None:
    assert figure(Robot.load("thumb")) == figure(Robot.load("thumb"))


def test_the_bundle_is_small_and_ends_no_script() -> None:
    assert len(three()) <= BUNDLE_BUDGET
    assert not re.search(r"</script|<!--", three(), re.IGNORECASE)


def test_words_are_translated_and_inert() -> None:
    words = {
        "Reset joints": 'Azzera <b>"x"</b>',
        "Symbols without a number are drawn with %(values)s (metres, radians).": "Con %(values)s.",
    }
    robot = Robot.load("scara-perugia")
    html = figure(robot, Text("it", words)).html
    assert "Azzera &lt;b&gt;&quot;x&quot;&lt;/b&gt;" in html
    assert "Con <i>a</i><sub>1</sub> = " in html


def test_a_prismatic_joint_without_limits_goes_as_far_as_the_longest_link() -> None:
    robot = arm(
        "  - {type: revolute, a: 0.3}\n  - {type: prismatic, d: q2 + 0.75}\n  - {type: revolute, limits: [1, 2]}"
    )
    first, second, third = travels(robot, symbol_values(robot, (), {}), None)
    assert (first.lower, first.upper, first.start) == (-math.pi, math.pi, 0)
    assert (second.lower, second.upper, second.start) == (0, 0.75, 0.375)
    assert (third.lower, third.upper, third.start) == (1, 2, 1.5)


def test_the_figure_configuration_is_where_it_starts() -> None:
    robot = arm("  - {type: revolute, a: 0.3}\n  - {type: revolute, a: a2}", "figure: {q: [pi/2, -1]}\n")
    assert [travel.start for travel in travels(robot, symbol_values(robot, (), {"a2": 1.0}), None)] == [math.pi / 2, -1]
    assert [travel.start for travel in travels(robot, symbol_values(robot, (), {"a2": 1.0}), [0, 9])] == [0, math.pi]


def test_up_is_against_gravity() -> None:
    link = "links: [{mass: 1}]"
    assert upwards(arm("  - {type: revolute, a: 1}", f"gravity: [0, -9.81, 0]\n{link}\n"), {}) == (0, 1, 0)
    assert upwards(arm("  - {type: revolute, a: 1}"), {}) == (0, 0, 1)


def test_symbols_are_letters_with_indices() -> None:
    assert html_symbol(r"\theta_{1}") == "<i>\N{GREEK SMALL LETTER THETA}</i><sub>1</sub>"
    assert "<script" not in html_symbol("<script>")


def test_values_of_the_poses_are_those_of_the_figure() -> None:
    robot = Robot.load("stanford-laschi")
    poses = RobotPoses(robot)
    caption = figure(robot).html
    assert all(f"= {value:.4g}" in caption for _, value, _ in poses.assumed)


VERTICAL = """
name: vertical
convention: standard
base: [[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]]
joints: [{type: revolute, a: 0.5}, {type: revolute, a: 0.4}]
"""
HEAD = """
name: head
convention: standard
joints: [{type: revolute, alpha: pi/2}, {type: revolute, a: 0.4}]
"""


def numbers(robot: Robot) -> dict[str, float]:
    return symbol_values(robot, (), assumed(robot))


@pytest.mark.parametrize(
    ("name", "task", "normal"),
    [
        ("planar-2r-perugia", ("x", "y"), (0.0, 0.0, 1.0)),
        ("planar-3r", POSE, (0.0, 0.0, 1.0)),
        ("scara-perugia", POSE, None),
        ("anthropomorphic-arm", ("x", "y", "z"), None),
        ("puma560-laschi", POSE, None),
        ("kuka-lwr4", POSE, None),
        ("thumb", ("x", "y", "z"), None),
    ],
)
def test_the_orientation_is_kept_where_the_arm_can_keep_it(
    name: str, task: tuple[str, ...], normal: tuple[float, float, float] | None
) -> None:
    robot = Robot.load(name)
    found = dragging(robot, numbers(robot))
    assert found is not None
    assert (found.task.task, found.normal) == (task, normal)


def test_a_plane_may_stand_upright() -> None:
    robot = Robot.from_text(VERTICAL)
    found = dragging(robot, numbers(robot))
    assert found is not None
    assert (found.task.task, found.normal) == (("x", "z"), (0.0, 1.0, 0.0))


@pytest.mark.parametrize(
    "robot", [Robot.from_text(HEAD), Robot.load("dh-general-laschi"), Robot.load("spherical-wrist")]
)
def test_what_moves_on_a_line_on_a_sphere_or_not_at_all_is_not_dragged(robot: Robot) -> None:
    assert dragging(robot, numbers(robot)) is None


def test_the_task_of_the_file_is_kept() -> None:
    robot = replace(Robot.load("planar-3r"), inverse=InverseOptions(("x", "y", "phi")))
    found = dragging(robot, numbers(robot))
    assert found is not None
    assert (found.task, found.normal) == (robot.inverse, (0.0, 0.0, 1.0))
