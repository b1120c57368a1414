"""The web page as text: everything in one file and escaped, the figure with its joints and target, and the motion."""

import ast
import json
import math
import random
import re
from dataclasses import replace
from html import unescape
from html.parser import HTMLParser
from itertools import chain, pairwise

import pytest

from derive.handouts.figure.scene import upwards
from derive.handouts.page.player import Playback, PlayedPiece, PlayedRun, html_messages, player_texts
from derive.handouts.page.viewer import Viewer, dragging, html_symbol, symbol_values, three, travels, viewer
from derive.handouts.page.writer import formula, formula_style, page, safe_script, unicode_name
from derive.handouts.sheet.document import SheetFormula, blocks_of
from derive.handouts.sheet.language import Text
from derive.programs.build import build_program
from derive.programs.optimise.search_policy import Effort
from derive.robot.options.inverse import POSE, InverseOptions
from derive.robot.robot import Robot
from derive.workspace.poses import RobotPoses
from tests.handouts.page.page_documents import ENTRIES, TITLE, assumed, document
from tests.handouts.reading import lines
from tests.random_robots import random_robot, seeds
from tests.rows import robot_of_rows

BUNDLE_BUDGET = 600_000


def figure(robot: Robot, text: Text | None = None) -> Viewer:
    return viewer(robot, build_program(robot, Effort.QUICK), assumed(robot), text or Text())


@pytest.mark.parametrize("seed", seeds(12, usual=4))
@pytest.mark.first(2)
def test_any_robot_gets_a_figure_that_starts_within_its_limits(seed: int) -> None:
    robot = Robot.from_text(random_robot(random.Random(4000 + seed)).text)
    made = figure(robot)
    assert "</script" not in made.script
    assert made.html.count('type="range"') == robot.n
    for travel in travels(robot, symbol_values(robot, (), assumed(robot))):
        assert travel.lower <= travel.start <= travel.upper
        assert travel.lower < travel.upper


def test_the_bundle_is_small_and_no_script_ends_its_element() -> None:
    assert len(three()) <= BUNDLE_BUDGET
    assert not re.search(r"</script|<!--", three(), re.IGNORECASE)
    assert "</script" not in safe_script('var a = "</script><!--";')


def test_words_are_translated_and_inert() -> None:
    words = {
        "Reset joints": 'Azzera <b>"x"</b>',
        "Symbols without a number are drawn with %(values)s (metres, radians).": "Con %(values)s.",
    }
    robot = Robot.load("scara-perugia")
    html = figure(robot, Text("it", words)).html
    assert "Azzera &lt;b&gt;&quot;x&quot;&lt;/b&gt;" in html
    assert "Con <i>a</i><sub>1</sub> = " in html


def test_a_joint_starts_as_the_figure_says_or_within_its_limits_or_as_far_as_the_longest_link() -> None:
    robot = robot_of_rows("R a: 0.3 | P d: q2 + 0.75 | R limits: [1, 2]")
    first, second, third = travels(robot, symbol_values(robot, (), {}))
    assert (first.lower, first.upper, first.start) == (-math.pi, math.pi, 0)
    assert (second.lower, second.upper, second.start) == (0, 0.75, 0.375)
    assert (third.lower, third.upper, third.start) == (1, 2, 1.5)
    robot = robot_of_rows("R a: 0.3 | R a: a2", "figure: {q: [pi/2, -1]}")
    assert [travel.start for travel in travels(robot, symbol_values(robot, (), {"a2": 1.0}))] == [math.pi / 2, -1]


def test_up_is_against_gravity_and_symbols_are_letters_with_indices() -> None:
    assert upwards(robot_of_rows("R a: 1", "gravity: [0, -9.81, 0]\nlinks: [{mass: 1}]"), {}) == (0, 1, 0)
    assert upwards(robot_of_rows("R a: 1"), {}) == (0, 0, 1)
    assert html_symbol(r"\theta_{1}") == "<i>\N{GREEK SMALL LETTER THETA}</i><sub>1</sub>"
    assert "<script" not in html_symbol("<script>")


def test_values_of_the_poses_are_those_of_the_figure() -> None:
    robot = Robot.load("stanford-laschi")
    poses = RobotPoses(robot)
    caption = figure(robot).html
    assert all(f"= {value:.4g}" in caption for _, value, _ in poses.assumed)


# a plane that stands upright; an end that moves on a sphere alone
VERTICAL = robot_of_rows("R a: 0.5 | R a: 0.4", "base: [[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]]")
HEAD = robot_of_rows("R alpha: pi/2 | R a: 0.4")
KEPT = replace(Robot.load("planar-3r"), inverse=InverseOptions(("x", "y", "phi")))  # the task of the file


@pytest.mark.parametrize(
    ("robot", "task", "normal"),
    [
        ("planar-2r-perugia", ("x", "y"), (0.0, 0.0, 1.0)),
        ("planar-3r", POSE, (0.0, 0.0, 1.0)),
        ("scara-perugia", POSE, None),
        ("anthropomorphic-arm", ("x", "y", "z"), None),
        ("puma560-laschi", POSE, None),
        ("kuka-lwr4", POSE, None),
        ("thumb", ("x", "y", "z"), None),
        (VERTICAL, ("x", "z"), (0.0, 1.0, 0.0)),
        (KEPT, KEPT.inverse.task, (0.0, 0.0, 1.0)),
        # what moves on a line, on a sphere or not at all is not dragged
        *((robot, None, None) for robot in (HEAD, "dh-general-laschi", "spherical-wrist")),
    ],
)
def test_the_orientation_is_kept_where_the_arm_can_keep_it(
    robot: str | Robot, task: tuple[str, ...] | None, normal: tuple[float, float, float] | None
) -> None:
    robot = Robot.load(robot) if isinstance(robot, str) else robot
    found = dragging(robot, symbol_values(robot, (), assumed(robot)))
    assert (found and (found.task.task, found.normal)) == (task and (task, normal))


ARM = robot_of_rows("R a: 1 | P limits: [0, 1]")
MOTION = Playback(
    tracks=(
        (PlayedPiece("cosine", 0.0, 2.0, (0.0, 4.0)),),
        (PlayedPiece("curve", 0.0, 2.0, ("t", 1.0, 0.0)),),
    ),
    segments=(("a -> <b>", 0.0, ((3, 0.5),), 0),),
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


def test_joints_that_turn_and_slide_have_plots_that_say_which_is_beyond_its_limit() -> None:
    made = player_texts(MOTION, ARM, ROWS, Text())
    assert [(plot["order"], plot["revolute"]) for plot in made["plots"]] == [
        (k, b) for k in range(3) for b in (True, False)
    ]
    with_torques = player_texts(replace(MOTION, functions=("inverse_dynamics",)), ARM, ROWS, Text())
    assert [plot["title"] for plot in with_torques["plots"][6:]] == ["Torque [N m]", "Force [N]"]
    assert with_torques["joints"][1]["units"] == ["m", "m/s", "m/s²", "N"]
    exceeded = (("speed", 1, 0.25, -3.0),)
    made = player_texts(replace(MOTION, exceeded=exceeded), ARM, ROWS, Text())
    assert [plot["exceeded"] for plot in made["plots"]] == [[], [], [], ["q2 beyond its limit at 0.25 s"], [], []]


def test_of_a_simulation_torques_and_errors_stand_where_accelerations_do() -> None:
    rows = ((0.0, 0.0), (1.0, 1.0))
    run = PlayedRun((0.0, 2.0), rows, rows, rows, "pd", "smooth", reached=False)
    bounds = {"torque": ((None, 2.0), (-1.0, 1.0)), "acceleration": ((-1.0, 1.0), (-1.0, 1.0))}
    played = replace(
        MOTION, functions=("inverse_dynamics",), run=run, bounds=bounds, exceeded=(("torque", 0, 1.0, 3.0),)
    )
    assert played.quantities == ("position", "speed", "torque", "error")
    plain = json.loads(json.dumps(played.configuration))
    assert plain["run"][0] == [0.0, 2.0]
    assert plain["bounds"] == [None, None, [[None, 2.0], [-1.0, 1.0]], None]
    assert plain["exceeded"] == [[2, 0, 1.0, 3.0]]
    made = player_texts(played, ARM, ROWS, Text())
    assert [plot["title"] for plot in made["plots"]][-2:] == ["Error [rad]", "Error [m]"]
    assert made["notes"].startswith("Simulated: control law pd, friction smooth. ")
    assert "The simulation diverges after 2 s." in made["notes"]


def test_words_of_the_player_are_translated_and_inert() -> None:
    made = player_texts(MOTION, ARM, ROWS, Text("xx", comma=True))
    assert html_messages(Text("xx", {"Play": '<b>"Via"</b>'}))("Play") == "&lt;b&gt;&quot;Via&quot;&lt;/b&gt;"
    assert made["segments"] == ["a → &lt;b&gt;"]
    assert (0.25, "0,25", False) in made["speeds"]


def test_the_script_calls_functions_by_name_and_sliders_hold_all_of_the_motion() -> None:
    motion = replace(MOTION, functions=("inverse_dynamics",))
    robot = Robot.load("planar-2r-perugia")
    script = viewer(robot, build_program(robot, Effort.QUICK), {}, Text(), playback=motion).script
    assert "return { forwardKinematics, linkTransforms, inverseDynamics };" in script
    program = build_program(ARM, Effort.QUICK)
    plain, played = (viewer(ARM, program, {}, Text(), playback=motion) for motion in (None, MOTION))
    assert 'max="1"' in plain.html
    assert 'max="2"' in played.html
    assert 'class="player-play"' in played.html
    assert "player" not in plain.html + plain.css


VOID = {"meta", "link", "br", "img", "input", "hr"}


class Reader(HTMLParser):
    def __init__(self, html: str) -> None:
        super().__init__()
        self.found: list[tuple[str, dict[str, str | None]]] = []
        self.texts: list[str] = []
        self._open: list[str] = []
        self.feed(html)
        assert not self._open

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.found.append((tag, dict(attrs)))
        if tag not in VOID:
            self._open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.found.append((tag, dict(attrs)))

    def handle_endtag(self, tag: str) -> None:
        assert self._open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.texts.append(data)

    def all(self, tag: str) -> list[dict[str, str | None]]:
        return [attributes for name, attributes in self.found if name == tag]


@pytest.fixture(scope="module")
def html() -> str:
    return page(document(), Text("it"))


@pytest.fixture(scope="module")
def reader(html: str) -> Reader:
    return Reader(html)


def test_the_page_states_its_language_names_no_other_file_and_refuses_every_request(html: str, reader: Reader) -> None:
    assert not re.findall(r"https?://|//[a-z]+\.", re.sub(r"<script>.*?</script>", "", html, flags=re.DOTALL))
    for _, attributes in reader.found:
        for name in ("src", "href", "srcset", "action"):
            assert (attributes.get(name) or "#").startswith(("#", "data:"))
    assert all(address.startswith("data:") for address in re.findall(r"url\(([^)]*)\)", html))
    assert reader.all("html") == [{"lang": "it"}]
    policies = [meta["content"] for meta in reader.all("meta") if "http-equiv" in meta]
    assert [policy for policy in policies if (policy or "").startswith("default-src 'none'")]


def test_the_title_is_text_whatever_it_holds(html: str, reader: Reader) -> None:
    assert len(reader.all("script")) == 2
    assert "".join(reader.texts).count(TITLE.removesuffix("</title>")) == 2
    assert "alert(" not in html[html.index("<script>") :]
    assert "<b>nothing</b>" in "".join(reader.texts)
    assert formula(r"a < b \& c", display=True) == r"<div class=math>a &lt; b \&amp; c</div>"


def test_every_section_can_be_reached_and_tables_have_heads(reader: Reader) -> None:
    assert {attributes["scope"] for attributes in reader.all("th")} == {"col", "row"}
    anchors = {attributes["href"] for attributes in reader.all("a")}
    assert {f"#{attributes['id']}" for attributes in reader.all("section")} <= anchors


def test_every_formula_stands_in_the_page_as_its_latex_and_entries_can_be_copied(html: str, reader: Reader) -> None:
    sheet = document()
    found = [block for section in sheet.sections for block in blocks_of(section)]
    parts = ((*b.named, *lines([b]), *b.omitted) if isinstance(b, SheetFormula) else lines([b]) for b in found)
    assert [unescape(latex) for latex in re.findall(r"<div class=math>([^<]*)</div>", html)] == [*chain(*parts)]
    options = [(option["data-latex"], option["data-python"]) for option in reader.all("option")]
    assert options == [(entry.latex, entry.python) for entry in ENTRIES]
    for _, python in options:
        ast.parse(python or "", mode="eval")


def test_the_page_is_the_same_each_time_its_texts_translated_and_the_figure_in_it(html: str) -> None:
    assert page(document(), Text("it")) == html
    assert "Copia LaTeX" in page(document(), Text("it", {"Copy LaTeX": "Copia LaTeX"}))
    viewer = Viewer("<div id=arm></div>", "#arm{color:red}", 'var arm = "</script>";')
    html = page(document(), Text(), viewer)
    assert "<div id=arm></div>" in html
    assert "#arm{color:red}" in html
    assert html.count("</script>") == 3


def test_fonts_of_the_formulas_are_inside_and_no_others_are_asked_for() -> None:
    css = formula_style()
    faces = re.findall(r"@font-face{[^}]*}", css)
    assert len(faces) == 13
    assert all("url(data:font/woff2;base64," in face for face in faces)
    assert not re.search(r"url\((?!data:)", css)


@pytest.mark.parametrize(
    ("latex", "name"),
    [
        ("b_{12}", "b₁₂"),
        (r"\dot{\vartheta}_{1}", "ϑ\u0307₁"),
        (r"\mathbf{T}_{4}^{0}", "T₄⁰"),
        (r"c_{ijk}", "cᵢⱼₖ"),
        (r"{}^{0}A_{1}", "⁰A₁"),
        (r"c_{1,23}", "c_1,23"),
    ],
)
def test_names_of_entries_in_plain_letters(latex: str, name: str) -> None:
    assert unicode_name(latex) == name
