"""Generated code of motions, and its polynomials."""

import re
import subprocess
from pathlib import Path

import casadi
import numpy as np
import pytest
from sympy import Integer, Symbol, exp, lambdify, sympify

from derive.api.move import move
from derive.errors import QuantityError, VerificationError
from derive.motion.motion import Motion
from derive.motion.output import code
from derive.motion.output.code import MODULE, MotionCode, VerifiedCode, kernel_of
from derive.motion.output.printed import printed
from derive.plans.profile import TIME, Curve
from derive.publish.modules import module_of
from derive.targets.compiler import find_compiler
from tests.cli.command import derive
from tests.motion.plans import FASTEST, LINE_AND_ARC, PICK_AND_PLACE
from tests.places import ROOT
from tests.targets.generated_models import needs_compiler

HEAD = "robot: scara-matlab\n"
POINTS = HEAD + "points: {a: [0, 0, 1, 0], b: [1, pi/2, 1.5, 0], c: [pi/3, 0, 2, 1]}\n"
PLANS = {
    "base": "robot: planar-3r\nbase: {x: t/4}\ntime: 1\ncurves: {q1: t}\n",
    "pick and place": PICK_AND_PLACE,
    "every profile": POINTS + "path: [a, {to: b, time: 1, profile: trapezoidal}, {to: c, time: 0.7, profile: harmonic},"
    " {to: a, time: 2, profile: cubic}, {to: b, time: 1.3, profile: septic}]\n",
    "spline": POINTS + "profile: spline\npath: [a, {to: b, time: 1.1}, {to: c, time: 2}, {to: a, time: 3}]\n",
    "passing": POINTS + "via: pass\npath: [a, {to: b, time: 1.1}, {to: c, time: 2}, {to: a, time: 3}]\n",
    "curves": HEAD + "time: 5\ncurves: {q1: pi/4*sin(2*t) + tan(t/9)*sqrt(2), q2: t**2/10 - cos(t),"
    " q3: sqrt(1 + t**2)/(2 + sin(t))**3}\n",
    "line": """robot: {name: arm, convention: standard, inverse: {task: [x, y]},
  joints: [{type: revolute, a: 1}, {type: revolute, a: 0.8}]}
points: {a: [0.3, 0.5], b: [0.3001, 0.5002]}\npath: [a, {to: b, time: 1.5, line: yes}]\n""",
    "standing": POINTS + "path: [a, {to: a, time: 1}]\n",
}

LONG = {"fastest": FASTEST, "arc": LINE_AND_ARC, "recorded": "robot: planar-3r\nrecorded: minute.csv\n"}


@pytest.mark.sweep
@needs_compiler
@pytest.mark.parametrize("name", LONG)
def test_code_of_many_pieces_is_right_strict_and_not_large(name: str, tmp_path: Path) -> None:
    """At most 200 bytes for each polynomial beside what every file has."""
    t = np.arange(2001) / 100
    rows = np.stack([t, np.sin(t), np.cos(t / 2), np.sin(t / 9)], axis=1).tolist()
    (tmp_path / "minute.csv").write_text("\n".join(["t,q1,q2,q3", *(",".join(map(repr, row)) for row in rows)]))
    motion = Motion.from_text(LONG[name], str(tmp_path / "plan.yaml"))
    assert write_code(motion, tmp_path / "code").worst < 1e-11
    count = sum(len(pieces) for segment in motion.trajectory.segments for pieces in segment.joints)
    assert (tmp_path / "code/motion.c").stat().st_size < 4000 + 200 * count
    compile_strictly(tmp_path / "code", "-Wconversion")


@needs_compiler
@pytest.mark.parametrize("name", PLANS)
def test_generated_code_is_as_python_computes_and_compiles_without_warnings(name: str, tmp_path: Path) -> None:
    assert write_code(Motion.from_text(PLANS[name]), tmp_path).worst < 1e-13
    compile_strictly(tmp_path)


def test_casadi_differentiates_it_and_takes_many_times_side_by_side(tmp_path: Path) -> None:
    """d q/dt is qd and d qd/dt is qdd, by CasADi's own differentiation; nothing moves outside."""
    motion = Motion.from_text(PLANS["every profile"])
    module = loaded(motion, tmp_path)
    t = casadi.SX.sym("t")
    q, qd, _ = module.motion(t)
    rates = casadi.Function("rates", [t], [casadi.jacobian(q, t), casadi.jacobian(qd, t)])
    for time in (0.1, 0.45, 1.2, 1.6, 3.1, 4.4):
        _, velocity, acceleration = motion(time)
        found = [np.array(value).ravel() for value in rates(time)]
        assert found[0] == pytest.approx(velocity, abs=1e-12)
        assert found[1] == pytest.approx(acceleration, abs=1e-11)
    assert not np.array(rates(-1)[0]).any()
    assert not np.array(rates(99)[0]).any()
    motion = Motion.from_text(PICK_AND_PLACE)
    module = loaded(motion, tmp_path / "pick")
    times = np.linspace(0, 15, 31)
    assert pytest.approx(motion(times)[0], abs=1e-14) == np.array(module.motion(times[None, :])[0]).T
    assert (module.START, module.END, module.JOINT_NAMES) == (0.0, 15.0, ("q1", "q2", "q3", "q4"))


def write_code(motion: Motion, folder: Path) -> VerifiedCode:
    made = move(motion, code=folder).code
    assert made is not None
    return made


def compile_strictly(folder: Path, *more: str) -> None:
    options = ["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Wshadow", "-Werror", *more, "-c", "motion.c"]
    subprocess.run([*(find_compiler() or ()), *options], cwd=folder, check=True)


def loaded(motion: Motion, folder: Path):
    write_code(motion, folder)
    return module_of(folder / MODULE, "motion_casadi")


@pytest.mark.parametrize(
    ("file", "right", "wrong"), [("motion_casadi.py", "1.5707963267948966", "1.57079"), ("motion.c", "< 0.0", "< 1.0")]
)
@needs_compiler
def test_wrong_code_is_not_written(
    file: str, right: str, wrong: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    motion = Motion.from_text(PICK_AND_PLACE)
    texts = MotionCode(motion, "scara_matlab_").texts
    assert right in texts[file]
    monkeypatch.setattr(MotionCode, "texts", {**texts, file: texts[file].replace(right, wrong)})
    with pytest.raises(VerificationError, match=file.replace(".", r"\.")):
        write_code(motion, tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_without_a_compiler_c_is_written_and_called_unverified(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(code, "find_compiler", lambda: None)
    assert write_code(Motion.from_text(PLANS["standing"]), tmp_path).left_out == ("motion.c",)


@needs_compiler
def test_long_motions_are_looked_up_in_a_table(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """On MX, with the same values; kinds of pieces may be mixed there, too."""
    monkeypatch.setattr(code, "LONG", 3)
    motion = Motion.from_text(PLANS["every profile"])
    assert write_code(motion, tmp_path).worst < 1e-13
    module = module_of(tmp_path / MODULE, "motion_casadi")
    assert "casadi.low(" in (tmp_path / "motion_casadi.py").read_text()
    t = casadi.MX.sym("t")
    q, qd, _ = module.motion(t)
    rate = casadi.Function("rate", [t], [casadi.jacobian(q, t) - qd])
    assert [float(casadi.norm_inf(rate(time))) for time in (0.3, 1.2, 2.5, 4.4)] == pytest.approx([0] * 4, abs=1e-11)


def test_too_many_pieces_are_refused_with_their_number(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(code, "MOST", 10)
    with pytest.raises(QuantityError, match="a motion of 20 pieces; allowed in code: 10"):
        write_code(Motion.from_text(PICK_AND_PLACE), tmp_path)
    assert not list(tmp_path.iterdir())


def test_the_same_plan_gives_the_same_bytes_and_titles_cannot_leave_their_comments(tmp_path: Path) -> None:
    one, other = (MotionCode(Motion.from_text(PLANS["every profile"]), "arm_").texts for _ in range(2))
    assert one == other
    title = 'title: "*/ \\"\\"\\" \\\\ ??/"\n'
    assert write_code(Motion.from_text(title + PLANS["standing"]), tmp_path).worst == 0


@needs_compiler
def test_the_program_of_the_page_about_c_prints_the_motion(tmp_path: Path) -> None:
    page = (ROOT / "docs/native.md").read_text()
    plan = re.search(r"```yaml file=lift.yaml\n(.*?)```", page, re.DOTALL)
    program = re.search(r"```c\n(/\* main.c; cc (.*?) \*/.*?)```", page, re.DOTALL)
    motion = Motion.from_text(plan[1])
    write_code(motion, tmp_path / "lifting")
    (tmp_path / "main.c").write_text(program[1])
    subprocess.run([*(find_compiler() or ()), *program[2].split(), "-o", "main"], cwd=tmp_path, check=True)
    printed = subprocess.run([tmp_path / "main"], capture_output=True, text=True, check=True).stdout
    t, *q = np.array([[float(cell) for cell in line.split()] for line in printed.splitlines()]).T
    assert t.size == 51
    assert pytest.approx(motion(t)[0].T, abs=1e-14) == np.array(q)


@needs_compiler
def test_the_command_writes_three_files(tmp_path: Path) -> None:
    plan = tmp_path / "plan.yaml"
    plan.write_text(PICK_AND_PLACE)
    said = derive("move", "plan.yaml", "--out", "code", "--name", "pick-1", folder=tmp_path).stdout
    assert "code: motion.h, motion.c, motion_casadi.py, verified to" in said
    header = (tmp_path / "code/motion.h").read_text()
    assert "void pick_1_motion(double t, double *q, double *qd, double *qdd);" in header


ZERO = Integer(0)


def test_a_formula_that_no_language_has_is_refused() -> None:
    formula = exp(TIME)
    with pytest.raises(QuantityError, match="has no place in generated code"):
        kernel_of(Curve(ZERO, Integer(1), (formula,) * 3), "q1")


@pytest.mark.parametrize("profile", ["cubic", "quintic", "septic", "trapezoidal", "harmonic", "spline"])
def test_what_is_printed_is_what_moves(profile: str) -> None:
    motion = Motion.from_text(PICK_AND_PLACE.replace("quintic", profile))
    starts = {segment.name: float(segment.start) for segment in motion.trajectory.segments}
    start, checked, symbol = 0.0, 0, Symbol("t")
    names = [joint.variable for joint in motion.plan.robot.joints]
    for line in printed(motion):
        if not line.startswith("  "):
            start = starts[line.split(",")[0]]
            continue
        name, rest = line.strip().split(" = ")
        text, _, span = rest.partition("  for ")
        low, high = (float(sympify(part)) for part in (span or "0 <= t <= 3").split(" <= t <= "))
        t = np.linspace(low, high, 5)
        value = lambdify(symbol, sympify(text), "numpy")(t)
        assert motion(start + t)[0][:, names.index(name)] == pytest.approx(np.broadcast_to(value, 5), abs=1e-12)
        checked += 1
    assert checked >= 20


def test_latex_has_a_display_for_every_segment_and_curves_are_printed_as_they_were_given() -> None:
    lines = list(printed(Motion.from_text(PICK_AND_PLACE), as_latex=True))
    assert lines[:2] == ["% rest -> A, 0 <= t <= 3 s", r"\begin{align*}"]
    assert lines[2] == r"  q_{1}(t) &= \frac{5 \pi t^{3}}{27} - \frac{5 \pi t^{4}}{54} + \frac{\pi t^{5}}{81} \\"
    assert lines[5:7] == [r"  q_{4}(t) &= 0", r"\end{align*}"]
    motion = Motion.from_text("robot: planar-2r-perugia\ncurves: {q1: sin(2*t)}\ntime: 1\n")
    assert list(printed(motion))[1:] == ["  q1 = sin(2*t)", "  q2 = 0"]


def test_what_is_not_exact_is_printed_in_decimals_alone() -> None:
    """A pose is reached by floats, and no polynomial has them beside powers of pi."""
    text = PICK_AND_PLACE.replace("A: [pi/2, pi/2, 1, 0]", "A: {pose: {p: [-1.9, 2.1, -1], rpy: [pi, 0, 0]}}")
    first, *lines = list(printed(Motion.from_text(text)))[:4]
    assert first == "rest -> A, 0 <= t <= 3 s"
    assert all(re.fullmatch(r"  q\d = [-+*t. e\d]+", line) for line in lines)
