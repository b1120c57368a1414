"""All chains of two packages of URDFs, as Pinocchio reads them: ``make test-robots`` installs the packages."""

from __future__ import annotations

import time
from collections.abc import Iterable, Iterator
from fractions import Fraction
from importlib.metadata import PackageNotFoundError, files
from pathlib import Path

import numpy as np
import pytest

from derive.errors import DeriveError
from derive.exchange.arm import arm_of, moving_tips
from derive.exchange.common_normals import FAR
from derive.exchange.from_urdf import Imported, ImportOptions, import_urdf
from derive.exchange.read_urdf import read_urdf
from derive.exchange.space import exactly
from derive.exchange.urdf import Urdf
from derive.robot.description import Convention
from derive.robot.evaluate import evaluate
from derive.verification.oracle.functions import Oracle
from tests.exchange.urdfs import Reading, pose

PACKAGES = ("example-robot-data", "rtb-data")

NO_TABLE = ("is floating", "is planar", "follows", "no joint moves", "joints move", "weigh")
"""Why a chain may be refused."""

BROKEN = ("without links", "no XML")
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


def read(text: str, name: str) -> tuple[Urdf | None, str]:
    """A URDF, or why there is none."""
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
            lost = sum_of((float(joint.damping) for joint in dynamics), qd)
            lost += sum_of((float(joint.friction) for joint in dynamics), np.sign(qd))
            torques(exact, reading, (q, qd, qdd, lost), said)
    return ""


def sum_of(factors: Iterable[float], values: np.ndarray) -> np.ndarray:
    """Each factor times its value."""
    return np.array(list(factors)) * values


def torques(exact: Imported, reading: Reading, state: tuple[np.ndarray, ...], said: str) -> None:
    """Newton-Euler, inertia matrix and Coriolis forces."""
    q, qd, qdd, lost = state
    oracle = Oracle.of(exact.robot)
    slack = 1e-10 + 1000 * (exact.certificate.position + exact.certificate.rotation)
    for got, wanted in (
        (oracle.evaluate("inverse_dynamics", q, qd, qdd), reading.torque(q, qd, qdd) + lost),
        (oracle.evaluate("inertia_matrix", q), reading.inertia(q)),
        (oracle.evaluate("coriolis_vector", q, qd), reading.coriolis(q, qd)),
    ):
        assert np.abs(got - wanted).max() <= slack * max(1.0, np.abs(wanted).max()), said
