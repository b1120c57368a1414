"""Tables of chains of URDFs, and those that makers and books print."""

from dataclasses import replace
from fractions import Fraction
from math import pi

import numpy as np
import pytest

from derive.errors import RobotFileError
from derive.exchange.arm import arm_of
from derive.exchange.certificate import certify
from derive.exchange.common_normals import place
from derive.exchange.formats import exported
from derive.exchange.from_urdf import Imported, ImportOptions, import_urdf, robot_name
from derive.exchange.reading.elements import Urdf
from derive.exchange.reading.urdf import read_urdf
from derive.mechanics.space import exactly
from derive.robot.description import Convention
from derive.robot.evaluate import evaluate
from derive.robot.expression import number
from derive.robot.robot import Robot
from derive.verification.oracle.functions import Oracle
from tests.exchange.arms import numeric, random_chain
from tests.exchange.urdfs import HALF, PI, J, Reading, body, imported, pose, urdf
from tests.random_robots import chains

SNAP = Fraction(1, 10**6)


def read(*joints: J) -> Urdf:
    return read_urdf(urdf(joints).encode(), "arm.urdf")


@pytest.mark.parametrize(
    ("joint", "found"),
    [
        (J(type="floating"), "is floating"),
        (J(type="planar"), "is planar"),
        (J(type="screw"), "arm.urdf:5.*of type 'screw'; allowed: revolute, continuous, prismatic, fixed"),
        (J(axis="0 0 0.0"), "arm.urdf:5.*an axis of length 0"),
        (J(more="<mimic/>"), "follows ''"),
        (J(more='<mimic joint="j0"/>'), "follows 'j0'"),
        (J(type="fixed"), "no joint moves"),
    ],
)
def test_joints_that_no_table_has_are_refused_by_name(joint: J, found: str) -> None:
    with exactly(), pytest.raises(RobotFileError, match=found):
        arm_of(read(joint), None, None, SNAP)


def test_a_slide_takes_the_place_that_costs_least() -> None:
    """The second axis of a cylindrical arm goes through the first wherever the file draws it."""
    text = urdf([J(), J("0.3 0.2 0.1", type="prismatic"), J("-0.3 -0.2 0", f"{HALF} 0 0")])
    with exactly():
        arm = arm_of(read_urdf(text.encode(), "arm.urdf"), None, None, Fraction(0))
        placement = place(arm, Convention.STANDARD, 1e-6)
    assert [float(row.a) for row in placement.rows] == [0, 0, 0]


@pytest.mark.parametrize("convention", Convention)
def test_a_slide_has_no_angle_where_a_base_that_is_slanted_anyway_can_have_it(convention: Convention) -> None:
    """Its x may point along the common normal of two parallel axes, as any other common normal."""
    base = J("0.1 0.2 0.3", "0.3 0.5 0.8", type="fixed")
    text = urdf([base, J("0 0 0.25", type="prismatic"), J("0.05 -0.02 0.1"), J("0.3 0 0", f"{HALF} 0 0")])
    with exactly():
        arm = arm_of(read_urdf(text.encode(), "arm.urdf"), None, None, Fraction(0))
        placement = place(arm, convention, 1e-6)
    assert placement.rows[0].theta == 0


@pytest.mark.parametrize("seed", [35, 45, 93, 128])
def test_a_wide_snap_leaves_every_pair_of_axes_a_common_normal(seed: int) -> None:
    """Closeness is not transitive: an axis that takes the direction of one axis may come near another by that."""
    text, names = random_chain(seed)
    with exactly():
        arm = arm_of(read_urdf(text.encode(), "arm.urdf"), None, None, Fraction(1, 10))
        assert len(place(arm, Convention.MODIFIED if seed % 2 == 0 else Convention.STANDARD, 0.1).rows) == len(names)


SLANTED = urdf([J("0 0 0.3", "1.5 0.3 0"), J("0.4 0 0.1", "1.57075 0 0"), J("0.3 0.1 0", "-1.2 0 0", axis="0 1 0")])


@pytest.mark.parametrize("convention", Convention)
def test_the_largest_difference_of_a_changed_table_stays_below_the_bound(convention: Convention) -> None:
    urdf_read = read_urdf(SLANTED.encode(), "arm.urdf")
    robot = import_urdf(urdf_read, None, None, ImportOptions(convention=convention, snap=Fraction(0))).robot
    changed = import_urdf(urdf_read, None, None, ImportOptions(convention=convention, snap=Fraction(1, 10000))).robot
    with exactly():
        arm = arm_of(urdf_read, None, None, Fraction(0))
    bound = certify(arm, changed)
    q = np.random.default_rng(2).uniform(-3, 3, (2000, 3))
    apart = pose(changed, q) - pose(robot, q)
    worst = np.linalg.norm(apart[:, :3, 3], axis=1).max()
    turned = np.linalg.norm(apart[:, :3, :3], ord=2, axis=(1, 2)).max()
    assert worst <= bound.position <= 20 * worst
    assert turned <= bound.rotation <= 20 * turned
    assert certify(arm, robot).position < 1e-14


def test_a_slide_whose_limits_leave_no_room_is_bound_for_a_metre() -> None:
    """They are taken as none, so the bound must not rest on them."""
    joints = [J("0 0 0.3"), J("0.1 0 0", "1.5705 0 0", type="prismatic", limit='lower="0" upper="0"'), J("0.2 0 0")]
    bound = imported(urdf(joints), snap=Fraction(1, 1000)).certificate
    assert 2.9e-4 < bound.position < 0.01


def test_a_base_that_is_no_rotation_counts_where_the_hand_goes() -> None:
    """At zero the hand is along x, where this base is right; a quarter turn on it is not."""
    read = read_urdf(urdf([J("0 0 0.3"), J("0.5 0 0", type="fixed")]).encode(), "arm.urdf")
    robot = import_urdf(read, None, None, ImportOptions(snap=Fraction(0))).robot
    columns = [list(row) for row in robot.base]
    columns[1][1] = number(Fraction(1001, 1000))
    skew = replace(robot, base=tuple(map(tuple, columns)))
    with exactly():
        arm = arm_of(read, None, None, Fraction(0))
    assert certify(arm, robot).position < 1e-15
    assert 0.5e-3 <= certify(arm, skew).position < 2e-3


ARM = urdf(
    [
        J("0 0 0.3", "0.1 -0.4 2", inertial=body("3", "0.1 0 0.2", "0.3 0.2 0.1", "0.2 0.3 0.4 0.01 0.02 -0.03")),
        J("0.4 0 0", f"{HALF} 0 0", "0 -2 0", inertial=body("2", "0 0.1 0.2", moments="0.1 0.1 0.05 0 0 0")),
        J("0.3 0 0", f"0 {HALF} 0", type="fixed", inertial=body("1", "0.1 0 0", moments="0.01 0.02 0.02 0 0 0")),
        J("0 0 0.2", f"0 0 {PI}", "1 0 0", type="prismatic", inertial=body("1.5", moments="0.03 0.02 0.02 0 0 0")),
        J("0 0.2 0", "0.4 0 0", type="continuous", limit="", inertial=body("0.5", "0 0 0.1")),
        J("0.1 0 0.1", "0 0.5 0", type="fixed"),
    ]
)


@pytest.mark.parametrize("convention", Convention)
def test_poses_and_dynamics_are_those_of_pinocchio(convention: Convention) -> None:
    made = imported(ARM, convention=convention).robot
    reading, oracle = Reading(ARM, ("j1", "j2", "j4", "j5")), Oracle.of(made)
    random = np.random.default_rng(4)
    for _ in range(5):
        q, qd, qdd = random.uniform(-2, 2, (3, 4))
        assert np.abs(pose(made, q) - reading.pose(q, "l6")).max() < 1e-12
        wanted = reading.torque(q, qd, qdd)
        assert np.abs(oracle.evaluate("inverse_dynamics", q, qd, qdd) - wanted).max() < 1e-10
        assert np.abs(oracle.evaluate("inertia_matrix", q) - reading.inertia(q)).max() < 1e-10


def test_limits_that_bound_nothing_are_none_and_named() -> None:
    limits = ('lower="-inf" upper="inf"', 'lower="0" upper="0"', 'lower="-1e9" upper="2"', 'lower="-2" upper="1"')
    found = imported(urdf([J("0 0 0.3", limit=limit) for limit in limits]))
    assert [joint.limits is None for joint in found.robot.joints] == [True, True, True, False]
    assert [note for note in found.notes if "taken as none" in note] == [
        "joint j1: limits -1e+60 to 1e+60 are taken as none",
        "joint j2: limits 0 to 0 are taken as none",
        "joint j3: limits -1e+09 to 2 are taken as none",
    ]


def test_lengths_a_nanometre_from_few_digits_have_these_and_others_all() -> None:
    """0.1 - 1.94e-11 of an exporter's rounding is 0.1, within the bound; with no snap it is what it is."""
    text = urdf(
        [J("0 0 0.10000000000194"), J("0.1 0 0.3", f"{HALF} 0 0"), J("0.2500001234 0 1e-11", type="fixed")]
    ).encode()
    snapped, exact = (import_urdf(read_urdf(text, "a"), None, None, ImportOptions(snap=s)) for s in ("1e-6", "0"))
    assert "d: 0.4," in snapped.text
    assert "a: 0.2500001234," in snapped.text
    assert 1e-11 <= snapped.certificate.position < 1e-9
    assert exact.certificate.position < 1e-15
    assert "d: 0.40000000000194," in exact.text


def test_a_name_of_robot_files_stays_and_any_other_text_becomes_one() -> None:
    named = {"a--b": "a--b", "x" * 40: "x" * 40, "UR5 (cb3)": "ur5-cb3", "import": "import-robot", "ü": "arm"}
    assert {text: robot_name(text) for text in named} == named


Rows = list[tuple[float, float, float, float]]
"""theta, d, a, alpha."""


def ur(d1: str, far: str, back: str, a2: str, a3: str, wrist: tuple[str, str, str]) -> str:
    """An arm of Universal Robots with the frames of its description for ROS; pi/2 has few digits there."""
    half = "1.570796325"
    return urdf(
        [
            J(f"0 0 {d1}"),
            J(f"0 {far} 0", f"0 {half} 0", "0 1 0"),
            J(f"0 -{back} {a2}", axis="0 1 0"),
            J(f"0 0 {a3}", f"0 {half} 0", "0 1 0"),
            J(f"0 {wrist[0]} 0"),
            J(f"0 0 {wrist[1]}", axis="0 1 0"),
            J(f"0 {wrist[2]} 0", f"-{half} 0 0", type="fixed", link="tool0"),
            J(rpy="0 0 -3.14159265359", type="fixed", link="base", parent="base_link"),
        ],
        base="base_link",
    )


def cells(robot: Robot) -> list[tuple[float, ...]]:
    """Rows of the table, base and tool in numbers."""
    rows = [tuple(evaluate(getattr(row, key), {}) for key in ("theta", "d", "a", "alpha")) for row in robot.joints]
    return rows + [tuple(evaluate(cell, {}) for cell in row) for frame in (robot.base, robot.tool) for row in frame]


def ur_rows(d1: float, a2: float, a3: float, d4: float, d5: float, d6: float) -> Rows:
    turned = [(0.0, d1, 0.0, pi / 2), (0.0, 0.0, -a2, 0.0), (0.0, 0.0, -a3, 0.0)]
    return [*turned, (0.0, d4, 0.0, pi / 2), (0.0, d5, 0.0, -pi / 2), (0.0, d6, 0.0, 0.0)]


ANGLES = {"up": f"{pi / 2} 0 0", "down": f"{-pi / 2} 0 0", "over": f"{pi / 2} 0 {pi}", "back": f"{-pi / 2} {pi} 0"}


def serial(text: str) -> str:
    """Places and turns of joints, the last one fixed."""
    *rows, last = (row.strip().rpartition(" ") for row in text.split(","))
    return urdf([*(J(place, ANGLES.get(turn, "0 0 0")) for place, _, turn in rows), J(last[0], type="fixed")])


IIWA = serial(
    "0 0 0.1575 -, 0 0 0.2025 over, 0 0.2045 0 over, 0 0 0.2155 up, 0 0.1845 0 back, 0 0 0.2155 up, 0 0.081 0 back, "
    "0 0 0.045 -"
)
PANDA = serial(
    "0 0 0.333 -, 0 0 0 down, 0 -0.316 0 up, 0.0825 0 0 up, -0.0825 0.384 0 down, 0 0 0 up, 0.088 0 0 up, 0 0 0.107 -"
)
IIWA_ROWS = zip((0.36, 0.0, 0.42, 0.0, 0.4, 0.0, 0.126), (-1, 1, 1, -1, -1, 1, 0), strict=True)

UR3 = ur("0.1519", "0.1198", "0.0925", "0.24365", "0.21325", ("0.08505", "0.08535", "0.0819"))
UR5 = ur("0.089159", "0.13585", "0.1197", "0.425", "0.39225", ("0.093", "0.09465", "0.0823"))
UR10 = ur("0.1273", "0.220941", "0.1719", "0.612", "0.5723", ("0.1149", "0.1157", "0.0922"))
MAKERS = {
    "UR3": (UR3, "base", "tool0", ur_rows(0.1519, 0.24365, 0.21325, 0.11235, 0.08535, 0.0819)),
    "UR5": (UR5, "base", "tool0", ur_rows(0.089159, 0.425, 0.39225, 0.10915, 0.09465, 0.0823)),
    "UR10": (UR10, "base", "tool0", ur_rows(0.1273, 0.612, 0.5723, 0.163941, 0.1157, 0.0922)),
    "iiwa 14": (IIWA, None, None, [(0.0, d, 0.0, alpha * pi / 2) for d, alpha in IIWA_ROWS]),
}


@pytest.mark.parametrize("name", MAKERS)
def test_the_standard_table_is_the_makers(name: str) -> None:
    text, base, tip, rows = MAKERS[name]
    robot = import_urdf(read_urdf(text.encode(), name), base, tip).robot
    got = cells(robot)
    assert got[: robot.n] == [pytest.approx(row, abs=1e-12) for row in rows]
    assert got[robot.n :] == [pytest.approx(row) for row in (*np.eye(4).tolist(), *np.eye(4).tolist())]


def test_the_modified_table_of_the_panda_is_the_makers() -> None:
    """Its flange stands 0.107 m along the last axis: in the last row."""
    options = ImportOptions(convention=Convention.MODIFIED)
    robot = import_urdf(read_urdf(PANDA.encode(), "panda"), None, None, options).robot
    got = [tuple(evaluate(cell, {}) for cell in (row.alpha, row.a, row.theta, row.d)) for row in robot.joints]
    turns = (0, -1, 1, 1, -1, 1, 1)
    lengths = ((0, 0.333), (0, 0), (0, 0.316), (0.0825, 0), (-0.0825, 0.384), (0, 0), (0.088, 0.107))
    wanted = [(turn * pi / 2, a, 0, d) for turn, (a, d) in zip(turns, lengths, strict=True)]
    assert got == [pytest.approx(row) for row in wanted]


def by_normals(robot: Robot, convention: Convention) -> Imported:
    """Read from the URDF that is written of it, without the table that this carries."""
    read = read_urdf(exported(robot, "urdf").text.encode(), robot.name)
    return import_urdf(replace(read, table=""), None, None, ImportOptions(convention=convention))


@pytest.mark.parametrize("name", ["puma560-corke", "stanford-deluca", "kuka-kr5", "kuka-lwr4"])
def test_tables_of_books_come_back(name: str) -> None:
    robot = numeric(name)
    assert cells(by_normals(robot, robot.convention).robot) == [pytest.approx(row, abs=1e-12) for row in cells(robot)]


@pytest.mark.sweep
@pytest.mark.parametrize("name", chains())
def test_every_built_in_arm_comes_back(name: str) -> None:
    """With the same poses, in both conventions."""
    robot = numeric(name)
    for convention in Convention:
        found = by_normals(robot, convention)
        q = np.random.default_rng(1).uniform(-1, 1, robot.n)
        assert np.abs(pose(found.robot, q) - pose(robot, q)).max() < 1e-12
        assert found.certificate.position < 1e-12
