"""All chains of two packages of URDFs, as Pinocchio reads them: ``make test-robots`` installs the packages."""

import time
from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction
from importlib.metadata import PackageNotFoundError, files
from pathlib import Path

import numpy as np
import pytest

from derive.errors import DeriveError
from derive.exchange.arm import arm_of, moving_tips
from derive.exchange.common_normals import FAR
from derive.exchange.formats import exported
from derive.exchange.from_urdf import Imported, ImportOptions, import_urdf
from derive.exchange.reading.elements import Urdf
from derive.exchange.reading.urdf import read_urdf
from derive.exchange.to_xml import LEAST
from derive.mechanics.space import exactly
from derive.model.identification.possible import INERTIAS
from derive.model.identification.witness import NoSuchBodies, Witness
from derive.robot.description import Convention
from derive.robot.evaluate import evaluate
from derive.robot.expression import ZERO, add, number
from derive.robot.robot import Robot
from derive.verification.oracle.functions import Oracle
from tests.exchange.urdfs import Reading, pose

mujoco = pytest.importorskip("mujoco")

PACKAGES = ("example-robot-data", "rtb-data")

NO_TABLE = ("is floating", "is planar", "follows", "no joint moves", "joints move", "weigh")
"""Why a chain may be refused."""

BROKEN = ("without links", "not XML")
"""Why a file may be."""


def urdfs() -> Iterator[Path]:
    """The URDFs of the packages that are installed."""
    for package in PACKAGES:
        try:
            names = files(package) or []
        except PackageNotFoundError:
            continue
        yield from (Path(str(name.locate())) for name in names if name.suffix == ".urdf")


@pytest.mark.robots
def test_both_packages_are_installed() -> None:
    """Without this an empty list of cases would pass."""
    assert len(list(urdfs())) > 60


@pytest.mark.robots
@pytest.mark.parametrize("path", sorted(urdfs()), ids=lambda path: path.name)
def test_every_chain_has_both_tables(path: Path) -> None:
    text = path.read_text(encoding="utf-8", errors="replace")
    urdf, refused = read(text, path.name)
    assert urdf is not None or any(reason in refused for reason in BROKEN), refused
    for tip in moving_tips(urdf) if urdf is not None else ():
        for convention in Convention:
            refused = check(text, urdf, tip, convention) if urdf is not None else ""
            assert not refused or any(reason in refused for reason in NO_TABLE), refused


@pytest.mark.robots
@pytest.mark.parametrize("path", sorted(urdfs()), ids=lambda path: path.name)
def test_every_chain_with_bodies_accelerates_in_mujoco_as_ours(path: Path) -> None:
    urdf, _ = read(path.read_text(encoding="utf-8", errors="replace"), path.name)
    for robot in with_bodies(urdf) if urdf is not None else ():
        text = mjcf(robot)
        if not isinstance(text, str):
            assert text is not None, f"{path.name} {robot.name}: neither bodies nor a proof that there are none"
            assert text.value < 0
            continue
        state = np.random.default_rng(1)
        for _ in range(3):
            apart, bound = accelerations(robot, text, state)
            assert apart <= bound, f"{path.name} {robot.name}: {apart:.1e}, allowed: {bound:.1e}"


def with_bodies(urdf: Urdf) -> Iterator[Robot]:
    """Its chains whose links have bodies, each once, without dry friction, which MuJoCo has as a soft constraint."""
    seen = set()
    for tip in moving_tips(urdf):
        robot = imported(urdf, tip)
        if robot is None or not robot.links or (robot.joints, robot.links) in seen:
            continue
        seen.add((robot.joints, robot.links))
        yield replace(robot, links=tuple(replace(link, coulomb=ZERO) for link in robot.links))


def imported(urdf: Urdf, tip: str) -> Robot | None:
    """A chain, with possible bodies where masses are negative; None where it may be refused."""
    for inertia in INERTIAS:
        try:
            return import_urdf(urdf, None, tip, ImportOptions(inertia=inertia)).robot
        except DeriveError as error:
            refused = error
    assert any(reason in str(refused) for reason in NO_TABLE), refused
    return None


def mjcf(robot: Robot) -> str | Witness | None:
    """With the bodies of the URDF where MuJoCo takes them, else with possible ones, or why there are none."""
    made = exported(robot, "mjcf")
    if any("MuJoCo refuses" in remark for remark in made.remarks):
        try:
            made = exported(robot, "mjcf", "possible")
        except NoSuchBodies as error:
            return error.witness
    return made.text


def accelerations(robot: Robot, text: str, random: np.random.Generator) -> tuple[float, float]:
    """How far MuJoCo's accelerations are from ours, relative, and how far they may be, at a state within the limits.

    1e-12, the rounding of floats times the condition of B, and twice what 1e-15 kg m^2 in all directions moves where
    MuJoCo takes no body without. Where B is singular no accelerations follow from torques: B and the torques without
    any are compared.
    """
    model, oracle = mujoco.MjModel.from_xml_string(text), Oracle.of(robot)
    data = mujoco.MjData(model)
    lower, upper = np.where(model.jnt_limited, model.jnt_range.T, [[-3], [3]])
    q, tau = random.uniform(0.9 * lower + 0.1 * upper, 0.1 * lower + 0.9 * upper), random.uniform(-20, 20, robot.n)
    qd = random.choice([-1, 1], robot.n) * random.uniform(1, 2, robot.n)
    data.qpos[:], data.qvel[:], data.qfrc_applied[:] = q, qd, tau
    mujoco.mj_forward(model, data)
    inertia = oracle.evaluate("inertia_matrix", q)
    sizes = np.linalg.eigvalsh(inertia)
    if sizes[0] < 1e-12 * sizes[-1]:
        found = data.qfrc_bias - data.qfrc_passive
        wanted = oracle.evaluate("inverse_dynamics", q, qd, np.zeros(robot.n))
        return relative(inertia_of(model, data), inertia) + relative(found, wanted), 2e-12
    wanted = oracle.evaluate("forward_dynamics", q, qd, tau)
    moved = relative(Oracle.of(with_least(robot, model)).evaluate("forward_dynamics", q, qd, tau), wanted)
    bound = 1e-12 + 2 * moved + float(np.finfo(float).eps * sizes[-1] / sizes[0])
    return relative(data.qacc, wanted), bound


def with_least(robot: Robot, model: mujoco.MjModel) -> Robot:
    """With 1e-15 kg m^2 in the links that have no more in a principal moment in MuJoCo."""
    links = list(robot.links)
    for body in map(model.body, range(1, model.nbody)):
        if body.inertia.min() <= LEAST:
            i = int(body.name.removeprefix("link")) - 1
            given, more = links[i].inertia, number(Fraction(1, 10**15))
            heavier = replace(given, xx=add(given.xx, more), yy=add(given.yy, more), zz=add(given.zz, more))
            links[i] = replace(links[i], inertia=heavier)
    return replace(robot, links=tuple(links))


def inertia_of(model: mujoco.MjModel, data: mujoco.MjData) -> np.ndarray:
    rows = np.zeros((model.nv, model.nv))
    for row, unit in zip(rows, np.eye(model.nv), strict=True):
        mujoco.mj_mulM(model, data, row, unit)
    return rows


def relative(found: np.ndarray, wanted: np.ndarray) -> float:
    """Largest difference, by the largest of what is wanted, or one."""
    return float(np.abs(found - wanted).max() / max(1, np.abs(wanted).max()))


def read(text: str, name: str) -> tuple[Urdf | None, str]:
    try:
        return read_urdf(text.encode(), name), ""
    except DeriveError as error:
        return None, str(error)


def check(text: str, urdf: Urdf, tip: str, convention: Convention) -> str:
    """Time, poses, torques and lengths of one table, as it is and snapped; or why there is none."""
    said = f"{urdf.source} {tip} {convention.value}"
    before = time.process_time()
    try:
        exact, snapped = (
            import_urdf(urdf, None, tip, ImportOptions(convention=convention, snap=snap))
            for snap in (Fraction(0), Fraction(1, 10**6))
        )
    except DeriveError as error:
        return str(error)
    assert time.process_time() - before < 2, said
    with exactly():
        reach = arm_of(urdf, None, tip, Fraction(0)).reach
    for imported in (exact, snapped):
        cells = (abs(evaluate(cell, {})) for joint in imported.robot.joints for cell in (joint.d, joint.a))
        assert max(cells) <= FAR * reach + 1e-9, said
    reading = Reading(text, exact.joints)
    source = np.random.default_rng(5)
    for _ in range(3):
        q, qd, qdd = source.uniform(-0.5, 0.5, (3, exact.robot.n))
        wanted = reading.pose(q, tip)
        apart = np.linalg.norm((pose(exact.robot, q) - wanted)[:3, 3])
        assert apart <= 1e-12 or apart <= exact.certificate.position, said
        assert np.linalg.norm((pose(snapped.robot, q) - wanted)[:3, 3]) <= snapped.certificate.position + 1e-12, said
        if exact.robot.links:
            joints = {joint.name: joint for joint in urdf.joints}
            dynamics = [joints[name] for name in reading.names]
            lost = np.array([float(joint.damping) for joint in dynamics]) * qd
            lost += np.array([float(joint.friction) for joint in dynamics]) * np.sign(qd)
            torques(exact, reading, (q, qd, qdd, lost), said)
    return ""


def torques(exact: Imported, reading: Reading, state: tuple[np.ndarray, ...], said: str) -> None:
    q, qd, qdd, lost = state
    oracle = Oracle.of(exact.robot)
    slack = 1e-10 + 1000 * (exact.certificate.position + exact.certificate.rotation)
    for got, wanted in (
        (oracle.evaluate("inverse_dynamics", q, qd, qdd), reading.torque(q, qd, qdd) + lost),
        (oracle.evaluate("inertia_matrix", q), reading.inertia(q)),
        (oracle.evaluate("coriolis_vector", q, qd), reading.coriolis(q, qd)),
    ):
        assert np.abs(got - wanted).max() <= slack * max(1.0, np.abs(wanted).max()), said
