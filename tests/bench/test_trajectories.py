"""Profiles are compared with roboticstoolbox where it is installed, and with its formulas everywhere."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from bench import trajectories
from bench.trajectories import MOST, differences, main
from derive.arrays import Array


def jtraj(q0: Any, q1: Any, t: Array, qd0: Any = 0.0, qd1: Any = 0.0) -> SimpleNamespace:
    """A t^5 + B t^4 + C t^3 + E t + F with t from 0 to 1."""
    tf, s = t.max(), (t / t.max())[:, None]
    way, v0, v1 = np.atleast_1d(q1 - q0), np.atleast_1d(qd0) * tf, np.atleast_1d(qd1) * tf
    a, b, c = 6 * way - 3 * (v1 + v0), -15 * way + 8 * v0 + 7 * v1, 10 * way - 6 * v0 - 4 * v1
    return SimpleNamespace(
        q=a * s**5 + b * s**4 + c * s**3 + v0 * s + q0,
        qd=(5 * a * s**4 + 4 * b * s**3 + 3 * c * s**2 + v0) / tf,
        qdd=(20 * a * s**3 + 12 * b * s**2 + 6 * c * s) / tf**2,
    )


def trapezoidal(q0: float, q1: float, t: Array) -> SimpleNamespace:
    """Parabola, line, parabola with V = 3/2 D/T."""
    tf = t.max()
    v = 1.5 * (q1 - q0) / tf
    blend = (q0 - q1 + v * tf) / v
    a, up, flat = v / blend, t <= blend, t <= tf - blend
    down = q1 - a / 2 * (tf - t) ** 2
    return SimpleNamespace(
        q=np.where(up, q0 + a / 2 * t**2, np.where(flat, (q1 + q0 - v * tf) / 2 + v * t, down)),
        qd=np.where(up, a * t, np.where(flat, v, a * (tf - t))),
        qdd=np.where(up, a, np.where(flat, 0.0, -a)),
    )


def mtraj(profile: Any, q0: Array, q1: Array, t: Array) -> SimpleNamespace:
    made = [profile(a, b, t) for a, b in zip(q0, q1, strict=True)]
    columns = {name: np.stack([getattr(one, name).ravel() for one in made], axis=1) for name in ("q", "qd", "qdd")}
    return SimpleNamespace(**columns)


TOOLBOX = SimpleNamespace(jtraj=jtraj, quintic=jtraj, trapezoidal=trapezoidal, mtraj=mtraj)


def test_profiles_are_those_of_its_formulas() -> None:
    found = differences(TOOLBOX)
    assert len(found) == 6
    assert max(found.values()) <= MOST


def test_velocities_by_unit_time_are_found() -> None:
    """What `jtraj(q0, q1, 301)` gives, as in the script of document 004."""

    def by_unit_time(q0: Any, q1: Any, t: Array, **rates: Any) -> SimpleNamespace:
        made = jtraj(q0, q1, t / t.max(), **rates)
        return SimpleNamespace(q=made.q, qd=made.qd, qdd=made.qdd)

    found = differences(SimpleNamespace(**{**vars(TOOLBOX), "jtraj": by_unit_time}))
    assert found["jtraj"] > 0.5
    assert found["quintic"] <= MOST


def test_a_toolbox_that_is_not_installed_is_named(monkeypatch: Any, capsys: Any) -> None:
    monkeypatch.setitem(trajectories.__dict__, "differences", lambda _: {"jtraj": 1.0})
    try:
        import roboticstoolbox  # type: ignore[import-not-found]
    except ImportError:
        assert main() == 0
        assert "is not installed" in capsys.readouterr().out
    else:
        assert roboticstoolbox.__name__
        assert main() == 1


@pytest.mark.toolbox
def test_profiles_are_those_of_the_package(roboticstoolbox: Any) -> None:
    assert max(differences(roboticstoolbox.tools.trajectory).values()) <= MOST
