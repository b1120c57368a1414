"""Curves of motions: formulas of time, recordings, extremes, limits and violations."""

from pathlib import Path

import numpy as np
import pytest
from sympy import Abs, DiracDelta, Float, Integer, Rational, cos, pi, sign, sin, sqrt, tan

from derive.errors import DeriveError
from derive.motion.curves.limits import Limits, Violation, exceeded, nearby, peak, proportions, rounded_up
from derive.motion.curves.trajectory import Segment, Trajectory, followed, read_recording
from derive.motion.motion import Motion
from derive.motion.output.printed import samples
from derive.plans.profile import CRUISE, TIME, Curve, Piece, joined, spline, via_velocities
from derive.plans.profile import TIME as t
from derive.robot.robot import Robot
from tests.motion.plans import PICK_AND_PLACE

ZERO = Integer(0)


def test_of_the_report_of_document_004_exactly() -> None:
    """Quintic, 3 s, by pi/2: 5 pi/16 rad/s at 1.5 s, and 5 pi/(9 sqrt 3) rad/s^2 at (3 -+ sqrt 3)/2 s."""
    rest = (ZERO, ZERO)
    pieces = (Piece(ZERO, Integer(3), ((ZERO, *rest), (pi / 2, *rest))),)
    speed, acceleration = peak(pieces, 1), peak(pieces, 2)
    assert (speed.value, speed.time) == (5 * pi / 16, Rational(3, 2))
    assert acceleration.value.equals(5 * pi / (9 * sqrt(3)))
    assert acceleration.time.equals((3 - sqrt(3)) / 2)


@pytest.mark.parametrize("seed", range(12))
def test_no_sample_is_larger_and_one_is_as_large(seed: int) -> None:
    random = np.random.default_rng(seed)
    k = int(random.integers(2, 5))
    values = tuple(tuple(Rational(int(c), 7) for c in random.integers(-9, 9, size=k)) for _ in range(2))
    piece = Piece(Integer(1), Rational(3, 2), values)
    t = np.linspace(1, 2.5, 20001)
    sampled = Trajectory((Segment("", Integer(1), piece.duration, ((piece,),)),))(t)
    for order in (1, 2):
        found = peak((piece,), order)
        largest = float(np.abs(sampled[order]).max())
        assert abs(float(found.value)) == pytest.approx(largest, rel=1e-6, abs=1e-12)
        assert abs(float(found.value)) >= largest * (1 - 1e-12)


def test_peaks_of_mixed_constants_and_of_formulas_are_found_in_numbers() -> None:
    values = ((ZERO, pi, Integer(1), ZERO), (sqrt(2), Integer(0), pi**2, Integer(1)))
    found = peak((Piece(ZERO, Integer(1), values),), 1)
    assert not found.is_exact
    formula = TIME**3
    curve = Curve(ZERO, Integer(2), (formula, formula.diff(TIME), formula.diff(TIME, 2)))
    found = peak((curve,), 1)
    assert not found.is_exact
    assert float(found.value) == pytest.approx(12)


def test_the_earliest_of_equal_peaks_is_told() -> None:
    times = [Integer(t) for t in range(3)]
    pieces = spline(times, [ZERO, Integer(1), ZERO])
    assert peak(pieces, 1).time < 1


def test_at_a_square_root_the_value_is_that_of_a_short_remainder() -> None:
    """Long fractions times pi at points that are passed, such as decimal degrees give."""
    times = [Integer(0), Rational(9, 4), Rational(314, 100)]
    positions = [Rational(k, 10**6) * pi / 180 for k in (-50709714, 228931046, 18581321)]
    ends = [(q, v, ZERO, ZERO) for q, v in zip(positions, via_velocities(times, positions), strict=True)]
    first, _ = joined(ends, times)
    derivative = first.in_unit_time().diff()
    found = peak((first,), 1)
    u = (found.time - first.start) / first.duration
    assert float(found.value) == pytest.approx(float(derivative(u).evalf(30)) / float(first.duration), rel=1e-14)


def test_of_a_piece_with_a_float_at_one_end_in_numbers() -> None:
    """From a point in joint variables to a pose."""
    piece = Piece(ZERO, Integer(2), ((pi / 2, ZERO, ZERO), (Float(1.0), ZERO, ZERO)))
    found = peak((piece,), 1)
    assert not found.is_exact
    assert float(found.value) == pytest.approx(15 / 16 * (1 - np.pi / 2), rel=1e-12)
    first = peak((piece,), 2)
    assert float(first.time) == pytest.approx(1 - 1 / np.sqrt(3), rel=1e-9), "the earlier of two that are alike"
    assert float(first.value) < 0


@pytest.mark.parametrize(
    ("formula", "duration", "expected"),
    [
        (sqrt(t**2), 2, t),
        (sqrt((t - 2) ** 2), 2, 2 - t),
        (Abs(t - 3) + Abs(sin(t)), 1, 3 - t + sin(t)),
        (sqrt(t**2 + 1) + tan(t / 2), 3, sqrt(t**2 + 1) + tan(t / 2)),
        (1 / (t + 1), 2, 1 / (t + 1)),
    ],
)
def test_magnitudes_that_keep_their_sign_are_written_without(formula, duration, expected) -> None:  # type: ignore[no-untyped-def]
    found = followed(formula, duration)
    assert found == expected
    assert not found.diff(t).diff(t).has(DiracDelta, sign)


@pytest.mark.parametrize(
    ("formula", "message"),
    [
        (sqrt((t - 1) ** 2), r"velocity jumps near t = 1 s"),
        (Abs(cos(t)), r"velocity jumps near t = 1.571 s"),
        (1 / (t - 0.7), r"division by zero near t = 0.7 s"),
        (1 / (1 - sin(t)), r"division by zero near t = 1.571 s"),
        (tan(t), r"tangent at its pole near t = 1.571 s"),
        (sqrt(t - 1), r"root of a negative number near t = 0 s"),
        (sqrt(t), r"its velocity is not finite: division by zero near t = 0 s"),
        (t * sqrt(t), r"its acceleration is not finite: division by zero near t = 0 s"),
    ],
)
def test_others_are_refused_with_the_time(formula, message: str) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(DeriveError, match=f"{message}.*allowed: formulas with a finite velocity"):
        followed(formula, 2)


def test_a_plan_names_the_formula_and_its_place() -> None:
    head = "robot: {name: p, convention: standard, joints: [{type: revolute, a: 1}]}\n"
    with pytest.raises(DeriveError, match=r"p.yaml:2:14: curves, q1: the velocity jumps near t = 0.5 s"):
        Motion.from_text(head + "curves: {q1: sqrt((t - 1/2)**2)}\ntime: 1\n", "p.yaml")
    with pytest.raises(DeriveError, match=r"p.yaml:4:11: base, x: division by zero near t = 0 s"):
        Motion.from_text(head + "curves: {q1: t}\ntime: 1\nbase: {x: 1/t}\n", "p.yaml")


def limits(*, speed: object = None, acceleration: object = None) -> Limits:
    return Limits((speed,), (acceleration,), (None,))  # type: ignore[arg-type]


def test_a_motion_is_stretched_by_the_joint_that_needs_most_where_anything_limits_it() -> None:
    both = Limits((Integer(2), None), (Integer(3), Integer(8)), (None, None))
    assert both.stretch([Integer(4), Integer(9)], [Integer(3), ZERO]) == 2
    assert both.stretch([Integer(4), Integer(9)], [Integer(3), Integer(72)]) == 3
    assert both.stretch([ZERO, ZERO], [ZERO, ZERO]) == 0
    assert Limits((Integer(1), None), (None, None), (None, None)).stretch([ZERO, Integer(1)], [ZERO, ZERO]) is None


def test_missing_limits_are_infinite_proportions_short_and_times_rounded_up() -> None:
    assert limits(acceleration=Integer(2)).cruise(0, Integer(1)) == 2
    assert limits(speed=Integer(2)).cruise(0, Integer(1)) == CRUISE
    speed, acceleration, torque = limits(speed=pi).numbers()
    assert (speed.tolist(), acceleration.tolist(), torque.tolist()) == ([float(pi)], [np.inf], [np.inf])
    assert proportions([1.0, 2.0, 0.0, 2 / 3]) == (Rational(1, 2), 1, Rational(1, 100), Rational(1, 3))
    assert proportions([0.0]) == (Rational(1, 100),)
    assert rounded_up(1.0) == 1 + Rational(1, 10**6)
    assert rounded_up(0.1234561) == Rational(123457, 10**6)


HEADING = "t, q1 [deg] ,other,q2"


def test_angles_in_degrees_become_the_cubic_spline_through_them(tmp_path: Path) -> None:
    """A cubic polynomial is its own spline."""
    t = np.linspace(0, 2, 9)
    q1, q2 = 30 * t**3 - 20 * t, t**2
    rows = [f"{a + 5},{b},walking,{c}" for a, b, c in zip(t.tolist(), q1.tolist(), q2.tolist(), strict=True)]
    (tmp_path / "walk.csv").write_text("\n".join([HEADING, *rows]) + "\n")
    (tmp_path / "plan.yaml").write_text("robot: planar-2r-perugia\nrecorded: walk.csv\nvalues: {a1: 1, a2: 1}\n")
    motion = Motion.load(tmp_path / "plan.yaml")
    assert motion.duration == 2
    at = np.linspace(0, 2, 101)
    q, qd, qdd = motion(at)
    assert q == pytest.approx(np.stack([np.deg2rad(30 * at**3 - 20 * at), at**2], axis=1), abs=1e-12)
    assert qd == pytest.approx(np.stack([np.deg2rad(90 * at**2 - 20), 2 * at], axis=1), abs=1e-11)
    assert qdd[1:-1] == pytest.approx(np.stack([np.deg2rad(180 * at), np.full(101, 2.0)], axis=1)[1:-1], abs=1e-10)


def test_what_is_written_is_read_back_with_its_rates(tmp_path: Path) -> None:
    motion = Motion.from_text(PICK_AND_PLACE.replace("sample: 0.01", "sample: 0.1"))
    names, rows = samples(motion)
    lines = [",".join(names), *(",".join(map(repr, map(float, row))) for row in rows)]
    (tmp_path / "samples.csv").write_text("\n".join(lines))
    again = read_recording(tmp_path / "samples.csv", Robot.load("scara-matlab"))
    for ours, theirs in zip(again(motion.times), motion(motion.times), strict=True):
        assert ours == pytest.approx(theirs, abs=1e-14)
    between = motion.times[:-1] + 0.05
    assert again(between)[0] == pytest.approx(motion(between)[0], abs=1e-7)


def test_long_files_are_read_to_their_end_or_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Longer than a robot file may be."""
    rows = "\n".join(f"{t},{t / 100 + 0.123456789:.25f},{t / 200:.25f}" for t in range(6000))
    (tmp_path / "walk.csv").write_text(f"t,q1,q2\n{rows}\n")
    assert (tmp_path / "walk.csv").stat().st_size > 262_144
    made = read_recording(tmp_path / "walk.csv", Robot.load("planar-2r-perugia"))
    assert float(made.duration) == 5999
    monkeypatch.setattr("derive.motion.curves.trajectory.BYTES", 1000)
    with pytest.raises(DeriveError, match="more than 1000 bytes"):
        read_recording(tmp_path / "walk.csv", Robot.load("planar-2r-perugia"))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("t,q1\n0,0\n1,1\n", r"file.csv:1:1: no column 'q2' among 't', 'q1'; allowed: t and q1, q2"),
        ("t,q1,q2\n0,0,0\n1,x,0\n", r"file.csv:3:3: found 'x'; allowed: a number"),
        ("t,q1,q2\n0,0,0\n1,0\n", r"file.csv:3:5: found ''; allowed: a number"),
        ("t,q1,q2\n0,0,0\n1,0,nan\n", r"file.csv:3:5: found 'nan'"),
        ("t,q1,q2\n0,0,0\n1,1,1\n1,1,1\n", r"file.csv:4:1: the time 1 after 1; allowed: times that ascend"),
        ("t,q1,q2\n0,0,0\n", r"file.csv:2:\d+: 1 rows?; allowed: 2 to 200000"),
        ("", r"no heading"),
        ("t,q1 [furlong],q2\n0,0,0\n1,0,0\n", r"no column 'q1'"),
    ],
)
def test_wrong_files_are_refused_with_their_place(tmp_path: Path, text: str, message: str) -> None:
    (tmp_path / "file.csv").write_text(text)
    with pytest.raises(DeriveError, match=message):
        read_recording(tmp_path / "file.csv", Robot.load("planar-2r-perugia"))


def test_a_file_that_is_not_there_is_told_at_its_name() -> None:
    with pytest.raises(DeriveError, match=r"<text>:2:11: no file 'nowhere.csv'"):
        Motion.from_text("robot: planar-2r-perugia\nrecorded: nowhere.csv\n")


TIMES = np.array([0.0, 1.0, 2.0, 3.0])
SPEEDS = np.array([[0.0, 1.0], [2.0, -3.0], [2.5, -2.0], [0.0, 0.5]])


def test_each_limit_is_told_where_it_is_exceeded_most_and_rounding_exceeds_nothing() -> None:
    bounds = {"speed": (np.array([-1.0, -1.5]), np.array([1.0, np.inf]))}
    assert exceeded(TIMES, {"speed": SPEEDS}, bounds) == (
        Violation(0, "speed", 2.0, 2.5, 1.0),
        Violation(1, "speed", 1.0, -3.0, -1.5),
    )
    bounds = {"speed": (np.array([-np.inf, -2.5]), np.array([np.inf, 0.2]))}
    (found,) = exceeded(TIMES, {"speed": SPEEDS}, bounds)
    assert (found.limit, found.value, found.excess) == (0.2, 1.0, 0.8)
    bounds = {"speed": (np.array([-9.0, -9.0]), np.array([2.5 * (1 - 1e-12), 1.0]))}
    assert exceeded(TIMES, {"speed": SPEEDS}, bounds) == ()


def test_limits_are_near_where_what_moves_is_close_to_them_and_they_fit_the_picture() -> None:
    """Two angles that go up to 2.5 and down to -3 rad/s, and a slide that hardly moves beside its limit."""
    rows = np.hstack([SPEEDS, [[2.0], [2.01], [2.0], [2.0]]])
    low, high = np.array([-4.0, -4.0, -9.0]), np.array([3.0, np.inf, 2.5])
    near = nearby({"speed": rows}, {"speed": (low, high)}, np.array([True, True, False]))
    assert [bound.tolist() for bound in near["speed"]] == [[-np.inf, -4, -np.inf], [3, np.inf, np.inf]]
