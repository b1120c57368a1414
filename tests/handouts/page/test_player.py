"""A motion on the page: what the script is given, and the words around it."""

import json
from dataclasses import replace
from itertools import pairwise

from derive.handouts.page.player import (
    Exceeded,
    Playback,
    PlayedPiece,
    PlayedRun,
    PlayedSegment,
    function_names,
    player_texts,
)
from derive.handouts.page.viewer import viewer
from derive.handouts.sheet.language import Text
from derive.programs.build import build_program
from derive.programs.optimise.search_policy import Effort
from derive.robot.robot import Robot

ARM = """
name: arm
convention: standard
joints: [{type: revolute, a: 1}, {type: prismatic, limits: [0, 1]}]
"""
MOTION = Playback(
    tracks=(
        (PlayedPiece("cosine", 0.0, 2.0, (0.0, 4.0)),),
        (PlayedPiece("curve", 0.0, 2.0, formulas=("t", 1.0, 0.0)),),
    ),
    segments=(PlayedSegment("a -> <b>", 0.0, ((3, 0.5),)),),
    basis={},
    duration=2.0,
    sample=0.01,
    ranges=((0.0, 4.0), (0.0, 2.0)),
    functions=(),
)
ROWS = [{"label": f"<i>q</i><sub>{j}</sub>", "name": f"q{j}", "place": j} for j in range(2)]


def test_the_script_gets_plain_data() -> None:
    plain = json.loads(json.dumps(MOTION.configuration))
    assert plain["tracks"] == [[["cosine", 0.0, 2.0, 0.0, 4.0]], [["curve", 0.0, 2.0, "t", 1.0, 0.0]]]
    assert plain["segments"] == [["a -> <b>", 0.0, [[3, 0.5]], 0]]


def test_polynomials_that_meet_are_told_by_their_values_at_the_times_of_a_grid() -> None:
    """Both joints on one grid; where a velocity jumps a new entry begins, and odd lengths are told."""
    times = (0.0, 0.1, 0.2, 0.3, 0.4)

    def track(scale: float, longer: float = 0.0) -> tuple[PlayedPiece, ...]:
        return tuple(
            PlayedPiece("hermite", a, b - a + longer, (scale * a, scale, scale * b, scale)) for a, b in pairwise(times)
        )

    jump = PlayedPiece("hermite", 0.4, 0.6, (0.4, 5.0, 1.0, 0.0))
    plain = replace(MOTION, tracks=((*track(1.0), jump), track(2.0), track(1.0, 0.01))).configuration
    first = [0.0, 1.0, 0.1, 1.0, 0.2, 1.0, 0.3, 1.0, 0.4, 1.0]
    assert plain["tracks"][0] == [["chain", 0, *first], ["hermite", 0.4, 0.6, 0.4, 5.0, 1.0, 0.0]]
    assert plain["tracks"][1] == [["chain", 0, *(2 * x if i % 2 == 0 else 2.0 for i, x in enumerate(first))]]
    assert plain["grids"][0] == (list(times), None)
    assert plain["grids"][1][1] == [b - a + 0.01 for a, b in pairwise(times)]


def test_joints_that_turn_and_those_that_slide_have_plots_of_their_own() -> None:
    robot = Robot.from_text(ARM)
    made = player_texts(MOTION, robot, ROWS, Text())
    assert [(plot["order"], plot["revolute"]) for plot in made["plots"]] == [
        (k, b) for k in range(3) for b in (True, False)
    ]
    with_torques = player_texts(replace(MOTION, functions=("inverse_dynamics",)), robot, ROWS, Text())
    assert [plot["title"] for plot in with_torques["plots"][6:]] == ["Torque [N m]", "Force [N]"]
    assert with_torques["joints"][1]["units"] == ["m", "m/s", "m/s²", "N"]


def test_a_plot_says_which_joint_is_beyond_its_limit_and_when() -> None:
    exceeded = (Exceeded("speed", 1, 0.25, -3.0),)
    made = player_texts(replace(MOTION, exceeded=exceeded), Robot.from_text(ARM), ROWS, Text())
    assert [plot["exceeded"] for plot in made["plots"]] == [[], [], [], ["q2 beyond its limit at 0.25 s"], [], []]


def test_of_a_simulation_torques_and_errors_stand_where_accelerations_do() -> None:
    rows = ((0.0, 0.0), (1.0, 1.0))
    run = PlayedRun((0.0, 2.0), rows, rows, rows, "pd", "smooth", reached=False)
    bounds = {"torque": ((None, 2.0), (-1.0, 1.0)), "acceleration": ((-1.0, 1.0), (-1.0, 1.0))}
    played = replace(
        MOTION, functions=("inverse_dynamics",), run=run, bounds=bounds, exceeded=(Exceeded("torque", 0, 1.0, 3.0),)
    )
    assert played.quantities == ("position", "speed", "torque", "error")
    plain = json.loads(json.dumps(played.configuration))
    assert plain["run"][0] == [0.0, 2.0]
    assert plain["bounds"] == [None, None, [[None, 2.0], [-1.0, 1.0]], None]
    assert plain["exceeded"] == [[2, 0, 1.0, 3.0]]
    made = player_texts(played, Robot.from_text(ARM), ROWS, Text())
    assert [plot["title"] for plot in made["plots"]][-2:] == ["Error [rad]", "Error [m]"]
    assert made["notes"].startswith("Simulated: control law pd, friction smooth. ")
    assert "The simulation diverges after 2 s." in made["notes"]


def test_words_are_translated_and_inert() -> None:
    made = player_texts(MOTION, Robot.from_text(ARM), ROWS, Text("xx", {"Play": '<b>"Via"</b>'}, comma=True))
    assert made["words"]["play"] == "&lt;b&gt;&quot;Via&quot;&lt;/b&gt;"
    assert made["segments"] == ["a → &lt;b&gt;"]
    assert (0.25, "0,25", False) in made["speeds"]


def test_the_script_calls_functions_by_their_names_there() -> None:
    assert function_names(replace(MOTION, functions=("inverse_dynamics",))) == ("inverseDynamics",)
    assert function_names(None) == ()


def test_sliders_hold_all_of_the_motion() -> None:
    robot = Robot.from_text(ARM)
    program = build_program(robot, Effort.QUICK)
    plain, played = (viewer(robot, program, {}, Text(), playback=motion) for motion in (None, MOTION))
    assert 'max="1"' in plain.html
    assert 'max="2"' in played.html
    assert 'class="player-play"' in played.html
    assert "player" not in plain.html + plain.css
