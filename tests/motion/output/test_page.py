"""The page of a motion in Chromium: the same numbers as here; played, and set by slider, keys and plots."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from derive.motion.motion import Motion
from derive.motion.output.page import motion_page
from tests.handouts.page.test_browser_viewer import browser, serious, watched
from tests.motion.plans import FASTEST, LINE_AND_ARC, PICK_AND_PLACE

__all__ = ["browser"]

ARM = """{name: arm, convention: standard, gravity: [0, -9.81, 0],
  joints: [{type: revolute, a: 0.5, alpha: pi/2, limits: [-pi, pi]}, {type: prismatic, limits: [0, 1]}],
  links: [{mass: 3, com: [-0.2, 0, 0], inertia: {xx: 0.1, yy: 0.2, zz: 0.2}}, {mass: 1}]}"""
BARE = "{name: bare, convention: standard, joints: [{type: revolute, a: 1}]}"
PLANS = {
    "document-004": PICK_AND_PLACE.replace("{to: D, time: 3}", "{to: D, time: 3, payload: 0.5}"),
    "profiles": f"""robot: {ARM}
points: {{a: [0.2, 0.1], b: [1.5, 0.9]}}
path: [a, {{to: b, time: 1, profile: trapezoidal}}, {{to: a, time: 3/2, profile: harmonic}},
  {{to: b, time: 1, profile: cubic, payload: 2}}, {{to: a, time: 2, profile: septic}}]""",
    "curves": f"robot: {ARM}\ncurves: {{q1: pi/4*sin(2*t) + 4, q2: t**2/10 + sqrt(t + 1)/8}}\ntime: 3\n",
    "load on a base": f"""robot: {ARM}
points: {{a: [0.2, 0.1], b: [1.5, 0.9]}}
path: [a, {{to: b, time: 1}}, {{to: a, time: 1, payload: 2}}]
base: {{x: t/2, z: cos(t), rpy: [0, t/3, 1]}}""",
}
WIDE = {
    "lines and arcs": LINE_AND_ARC,
    "seven": """robot: kuka-lwr4
profile: spline
points: {a: [0, 0, 0, 0, 0, 0, 0], b: [30, -40, 20, 60, -10, 30, 80], c: [-50, 20, 60, -70, 40, -20, 10]}
path: [a, {to: b, time: 2}, {to: c, time: 3}, {to: a, time: 2}]""",
    "slides": """robot:
  name: gantry
  convention: modified
  joints: [{type: prismatic, theta: pi/2, alpha: -pi/2, limits: [0, 2], speed: 0.8}, {type: prismatic, theta: pi/2,
      alpha: pi/2}, {type: prismatic, alpha: pi/2}, {type: revolute, d: -0.2, torque: 3}]
  gravity: [0, 0, -9.81]
  links: [{mass: 30}, {mass: 20}, {mass: 8}, {mass: 2, com: [0.05, 0, 0], inertia: {xx: 0.01, yy: 0.02, zz: 0.02}}]
points: {home: [0.1, 0.1, 0.1, 0], pick: [1.7, 1.2, 0.9, pi/2], place: [0.3, 1.4, 0.4, -pi]}
path: [home, {to: pick, time: 2, profile: trapezoidal}, {to: place, time: 3, profile: harmonic,
  payload: {mass: 6, com: [0.2, 0, 0.1]}}, {to: home, time: 2, profile: septic}]""",
    "fastest": FASTEST,
    "long": """robot: stanford-deluca
curves: {q1: sin(t/3), q2: cos(t/5)*pi/3, q3: 1/2 + sin(t)/5, q4: t/10, q5: sin(2*t)/2, q6: sqrt((t - 30)**2 + 1)/10}
values: {d1: 0.4, d2: 0.15, d6: 0.2}
time: 60""",
    "recorded": "robot: puma560-corke\nrecorded: minute.csv",
    "passing": """robot: scara-matlab
profile: septic
via: pass
points: {a: [0, 0, 1, 0], b: [1, pi/2, 1.5, 0], c: [pi/3, 0, 2, 1], d: [0, 0, 1, 0]}
path: [a, {to: b, time: 1}, {to: c, time: 2, payload: 2}, {to: d, time: 1.5}]""",
}
SIZE = 3_000_000


class Shown:
    """A page of a motion, opened from disk; remembers what it should not do."""

    def __init__(self, browser: Any, folder: Path, text: str, *, simulate: bool = False, **context: Any) -> None:
        self.motion = Motion.from_text(text, str(folder / "plan.yaml"))
        self.run = self.motion.simulate() if simulate else None
        path = folder / "motion.html"
        path.write_text(motion_page(self.motion, self.run), encoding="utf-8")
        self.size = path.stat().st_size
        self.page = browser.new_context(viewport={"width": 1000, "height": 800}, **context).new_page()
        self.trouble = watched(self.page, path)

    def time(self) -> float:
        return float(self.page.evaluate("deriveViewer.player.time()"))

    def wait(self, condition: str) -> None:
        """Until something holds; the page allows no evaluation of strings, of which waiting in it is made."""
        for _ in range(400):
            if self.page.evaluate(condition):
                return
            self.page.wait_for_timeout(25)
        pytest.fail(condition)

    def close(self) -> None:
        self.page.context.close()
        assert self.trouble == []

    def is_playing(self) -> bool:
        return bool(self.page.evaluate("deriveViewer.player.isPlaying()"))


@pytest.fixture(
    scope="module",
    params=[
        "document-004",
        *(pytest.param(name, marks=pytest.mark.sweep) for name in ("profiles", "curves", "load on a base")),
    ],
)
def shown(request: pytest.FixtureRequest, browser: Any, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Shown]:
    made = Shown(browser, tmp_path_factory.mktemp("motion"), PLANS[request.param])
    yield made
    made.close()


def test_the_page_moves_as_the_motion_does(shown: Shown) -> None:
    times = np.append(
        np.random.default_rng(4).uniform(-0.1, 1.1, 197) * shown.motion.duration, [0, 3, shown.motion.duration]
    )
    script = "times => times.map((t) => deriveViewer.motion.at(t))"
    found = np.array(shown.page.evaluate(script, times.tolist())).transpose(1, 0, 2)
    has_torques = shown.motion.has_torques
    expected = [*shown.motion(times), *([shown.motion.torques(times)] if has_torques else [])]
    for ours, theirs in zip(expected, found, strict=True):
        assert np.abs(ours - theirs).max() <= 1e-12 * max(1.0, np.abs(ours).max())


@pytest.mark.sweep
@pytest.mark.parametrize("name", WIDE)
def test_the_page_moves_as_any_motion_does(name: str, browser: Any, tmp_path: Path) -> None:
    """At 200 times; small, silent, without a request, accessible, as wide as a phone."""
    t = np.arange(6001) / 100
    columns = [t, *(np.sin(t / j) * np.cos(t / 20) + 0.01 * np.sin(7 * t + j) for j in range(1, 7))]
    rows = [",".join(map(repr, row)) for row in np.stack(columns, axis=1).tolist()]
    (tmp_path / "minute.csv").write_text("\n".join(["t,q1,q2,q3,q4,q5,q6", *rows]))
    made = Shown(browser, tmp_path, WIDE[name])
    test_the_page_moves_as_the_motion_does(made)
    assert made.size <= SIZE
    test_on_a_phone_the_page_does_not_scroll_sideways(made)
    for scheme in ("light", "dark"):
        test_the_page_is_accessible(made, scheme)
    made.close()


def test_the_arm_of_the_page_is_where_the_motion_is(shown: Shown) -> None:
    t = 0.37 * shown.motion.duration
    shown.page.evaluate("t => deriveViewer.player.set(t)", t)
    assert shown.page.evaluate("deriveViewer.configuration()") == pytest.approx(shown.motion(t)[0], abs=1e-12)
    place = shown.motion.poses(t)[:3, 3]
    assert np.array(shown.page.evaluate("deriveViewer.pose()"))[:3, 3] == pytest.approx(place, abs=1e-12)
    said = shown.page.get_attribute(".player-time", "aria-valuetext") or ""
    assert float(said.split(" s, ")[0]) == pytest.approx(t, abs=0.005)
    assert said.split(" s, ")[1] == shown.page.locator(".player-segment option:checked").inner_text()


def test_the_page_is_small_and_every_formula_is_set(shown: Shown) -> None:
    assert shown.size <= SIZE
    shown.page.evaluate("window.dispatchEvent(new Event('beforeprint'))")
    assert shown.page.locator(".katex-error").count() == 0
    assert shown.page.locator("#plan .math.set").count() > 10
    shown.page.evaluate("window.dispatchEvent(new Event('afterprint'))")


def test_curves_are_as_high_as_the_motion(shown: Shown) -> None:
    """The cursor of every plot stands on its curve."""
    shown.page.evaluate("t => deriveViewer.player.set(t)", 0.6 * shown.motion.duration)
    off = shown.page.evaluate(
        """() => [...document.querySelectorAll(".player-plot")].flatMap((plot) => {
          const [curves, cursor] = plot.querySelectorAll("svg");
          const x = new DOMMatrix(getComputedStyle(cursor).transform).e + 5;
          return [...cursor.querySelectorAll("circle")].map((dot, k) => {
            const points = curves.querySelectorAll(".player-curve")[k].getAttribute("d").slice(1).split("L")
              .map((pair) => pair.split(" ").map(Number));
            const near = points.filter(([u]) => Math.abs(u - x) < 2).map(([, v]) => v);
            const y = Number(dot.getAttribute("cy"));
            return Math.max(0, Math.min(...near) - y, y - Math.max(...near));
          });
        })"""
    )
    assert len(off) == shown.motion.plan.robot.n * (4 if shown.motion.has_torques else 3)
    assert max(off) <= 1.5


def test_it_plays_and_waits_for_who_moves_a_joint(shown: Shown) -> None:
    shown.page.evaluate("deriveViewer.player.set(0)")
    shown.page.locator(".player-play").click()
    assert shown.page.locator(".player-play").inner_text() == "Pause"
    shown.wait("deriveViewer.player.time() > 0.05")
    shown.page.locator(".viewer-number").first.fill("11")
    shown.page.keyboard.press("Tab")
    assert not shown.is_playing()
    assert shown.page.locator(".player-play").inner_text() == "Play"


def test_it_stops_at_the_end_or_begins_again(shown: Shown) -> None:
    end = shown.motion.duration
    shown.page.evaluate("t => deriveViewer.player.set(t)", end - 0.01)
    shown.page.locator(".player-play").click()
    shown.wait("!deriveViewer.player.isPlaying()")
    assert shown.time() == end
    shown.page.locator(".player-repeat").check()
    shown.page.evaluate("t => deriveViewer.player.set(t)", end - 0.01)
    shown.page.locator(".player-play").click()
    shown.wait("deriveViewer.player.time() < 0.9 * deriveViewer.motion.duration")
    assert shown.is_playing()
    shown.page.locator(".player-play").click()
    shown.page.locator(".player-repeat").uncheck()


def test_keys_segments_and_plots_set_the_time(shown: Shown) -> None:
    corners = [float(segment.start) for segment in shown.motion.trajectory.segments] + [shown.motion.duration]
    slider = shown.page.locator(".player-time")
    slider.focus()
    slider.press("Home")
    assert shown.time() == 0
    slider.press("ArrowRight")
    assert shown.time() == pytest.approx(shown.motion.sample)
    slider.press("Shift+ArrowRight")
    assert shown.time() == pytest.approx(11 * shown.motion.sample)
    slider.press("PageDown")
    assert shown.time() == 0
    slider.press("PageUp")
    assert shown.time() == pytest.approx(corners[1])
    slider.press("End")
    assert shown.time() == pytest.approx(corners[-1])
    last = len(corners) - 2
    shown.page.locator(".player-segment").select_option(index=last)
    assert shown.time() == pytest.approx(corners[last])
    plot = shown.page.locator(".player-plot svg[role=img]").first
    plot.scroll_into_view_if_needed()
    box = plot.bounding_box()
    plot.click(position={"x": 48 + (box["width"] - 62) / 2, "y": 60})
    assert shown.time() == pytest.approx(corners[-1] / 2, abs=0.01 * corners[-1])


@pytest.mark.first(1)
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_the_page_is_accessible(shown: Shown, scheme: Any) -> None:
    shown.page.emulate_media(color_scheme=scheme)
    assert serious(shown.page) == []


def test_on_a_phone_the_page_does_not_scroll_sideways(shown: Shown) -> None:
    shown.page.set_viewport_size({"width": 360, "height": 740})
    shown.wait("document.documentElement.scrollWidth <= innerWidth")
    shown.page.set_viewport_size({"width": 1000, "height": 800})


def test_who_wants_less_motion_sees_a_picture_each_half_second(shown: Shown) -> None:
    shown.page.emulate_media(reduced_motion="reduce")
    shown.page.evaluate("deriveViewer.player.set(0.6)")
    shown.page.locator(".player-play").click()
    shown.wait("deriveViewer.player.time() > 0.65")
    shown_time = shown.page.evaluate("[deriveViewer.configuration(), deriveViewer.player.time()]")
    shown.page.locator(".player-play").click()
    shown.page.emulate_media(reduced_motion="no-preference")
    steps = np.floor(2 * shown_time[1]) / 2
    assert shown_time[0] == pytest.approx(shown.motion(steps)[0], abs=1e-12)


@pytest.mark.sweep
def test_of_a_simulation_that_diverges_its_rows_are_played(browser: Any, tmp_path: Path) -> None:
    plan = f"robot: {ARM}\npoints: {{a: [0, 0.1], b: [1, 0.5]}}\npath: [a, {{to: b, time: 1}}, {{to: a, time: 1}}]\n"
    law = "control: {law: pd, kp: 90000, kd: 900, period: 0.05}\n"
    made = Shown(browser, tmp_path, plan + law, simulate=True)
    assert not made.run.reached
    end = made.page.evaluate("deriveViewer.motion.duration")
    assert end == made.run.t[-1] < 1
    assert made.page.evaluate("Math.max(...deriveViewer.motion.times(10))") == end
    assert made.page.locator(".player-segment option").count() == 1
    assert "The simulation diverges after 0." in made.page.locator(".player-notes").inner_text()
    test_the_page_is_accessible(made, "light")
    test_the_page_is_accessible(made, "dark")
    made.close()


TIMED = """(() => {
  const ask = window.requestAnimationFrame.bind(window);
  window.frames_ = [];
  window.requestAnimationFrame = (work) => ask((now) => {
    const begun = performance.now();
    work(now);
    window.frames_.push([now, performance.now() - begun]);
  });
})()"""


@pytest.mark.sweep
def test_a_frame_takes_little_of_its_time_and_a_pause_none(browser: Any, tmp_path: Path) -> None:
    """Script of a PUMA with a payload: in the middle of all frames less than a sixtieth of a second."""
    points = "points: {a: [0, 45, -90, 0, 30, 0], b: [90, 90, -180, 40, -30, 90]}\n"
    path = "path: [a, {to: b, time: 3, payload: 1.5}]\n"
    made = Shown(browser, tmp_path, "robot: puma560-corke\n" + points + path)
    made.page.add_init_script(TIMED)
    made.page.reload()
    made.page.locator(".player-play").click()
    made.wait("deriveViewer.player.time() > 2")
    made.page.locator(".player-play").click()
    frames: dict[float, float] = {}
    for now, spent in made.page.evaluate("window.frames_"):
        frames[now] = frames.get(now, 0.0) + spent
    assert len(frames) > 10
    median = float(np.median(list(frames.values())))
    print(f"{median:.2f} ms a frame")
    assert median < 1000 / 60
    made.page.wait_for_timeout(300)
    made.page.evaluate("window.frames_.length = 0")
    made.page.wait_for_timeout(500)
    assert made.page.evaluate("window.frames_") == []
    made.close()


@pytest.mark.sweep
def test_without_webgl_plots_and_values_still_move(browser: Any, tmp_path: Path) -> None:
    made = Shown(browser, tmp_path, PLANS["curves"])
    made.page.add_init_script("HTMLCanvasElement.prototype.getContext = () => null;")
    made.page.reload()
    made.page.evaluate("deriveViewer.player.set(1)")
    assert made.page.locator(".player-values td span").first.inner_text() == "4.714"
    assert made.page.locator(".viewer-message").is_visible()
    made.close()


def test_a_simulation_is_played_beside_what_is_wanted(browser: Any, tmp_path: Path) -> None:
    """At its rows the arm is where the simulation is; plots have both, the limit, and where it is exceeded."""
    arm = ARM.replace("limits: [-pi, pi]", "limits: [-pi, pi], speed: 1.5")
    plan = f"robot: {arm}\npoints: {{a: [0, 0.1], b: [1, 0.5]}}\npath: [a, {{to: b, time: 1}}]\n"
    made = Shown(browser, tmp_path, plan + "control: {law: pd-gravity, kp: 300, kd: 30}\n", simulate=True)
    run, motion = made.run, made.motion
    found = made.page.evaluate("times => times.map((t) => deriveViewer.motion.at(t))", run.t.tolist())
    q, qd, tau, error = np.array(found).transpose(1, 0, 2)
    for ours, theirs in ((run.q, q), (run.qd, qd), (run.tau, tau), (motion(run.t)[0] - run.q, error)):
        assert np.abs(ours - theirs).max() <= 1e-10 * max(1.0, np.abs(ours).max())
    made.page.evaluate("deriveViewer.player.set(0.5)")
    at = np.searchsorted(run.t, 0.5)
    assert made.page.evaluate("deriveViewer.configuration()") == pytest.approx(run.q[at], abs=1e-10)
    assert made.page.locator(".player-wanted").count() == 6  # of two joints positions, velocities and torques
    assert made.page.locator(".player-warning").inner_text().startswith("q1 beyond its limit at 0.")
    assert made.page.locator(".player-ring").count() == 1
    spoken = made.page.locator(".player-plot svg[role=img]").nth(2).get_attribute("aria-label") or ""
    assert spoken.startswith("Velocity [rad/s]; q1 beyond its limit at 0.")
    assert made.page.locator(".player-notes").inner_text().startswith("Simulated: control law pd-gravity")
    assert found[0][0] == pytest.approx([0, 0.1])
    made.close()


@pytest.mark.parametrize(("language", "word"), [("it", "Piano di moto"), ("pt", "Plano de movimento")])
def test_the_page_speaks_three_languages(language: str, word: str) -> None:
    robot = BARE.replace("standard,", f"standard, handout: {{language: {language}}},")
    html = motion_page(Motion.from_text(f"robot: {robot}\ncurves: {{q1: t}}\ntime: 3\n"))
    assert f'<html lang="{language}">' in html
    assert word in html
    assert "Plots over time" not in html


def test_names_of_points_are_text() -> None:
    plan = f"""robot: {BARE}
title: </script><b>x</b>
points: {{"<b>": [0], "</script>": [1]}}
path: ["<b>", {{to: "</script>", time: 1}}]"""
    html = motion_page(Motion.from_text(plan))
    assert "<b>x" not in html
    assert "&lt;b&gt; \N{RIGHTWARDS ARROW} &lt;/script&gt;" in html
    assert html.count("</script>") == html.count("<script>")
