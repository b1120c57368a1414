"""Torques that joints feel of a wrench on the end effector, and dynamics under it in NumPy and compiled."""

import re
from collections.abc import Iterator
from types import ModuleType
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from tests.targets.generated_models import PARAMETERS, arguments, numpy_model, planar
from tests.targets.languages import languages, running
from tests.targets.test_numpy import same

JACOBIANS = {"world": "jacobian", "end": "jacobian_end"}


@pytest.fixture(scope="module", params=languages("numpy", "native"))
def model(request: pytest.FixtureRequest) -> Iterator[ModuleType]:
    with running(request.param, planar()) as found:
        yield found.module


@pytest.mark.parametrize("frame", JACOBIANS)
@pytest.mark.parametrize("batch", [(), (3,), (40,), (0,)])
def test_forward_dynamics_undoes_the_torques_of_a_wrench(model: ModuleType, frame: str, batch: tuple[int, ...]) -> None:
    a, loaded = arguments(*batch), {"wrench_frame": frame, "params": PARAMETERS}
    felt = np.einsum("...ij,...i->...j", getattr(model, JACOBIANS[frame])(a["q"]), a["h"])
    tau = model.inverse_dynamics(a["q"], a["qd"], a["qdd"], wrench=a["h"], **loaded)
    same(tau, model.inverse_dynamics(a["q"], a["qd"], a["qdd"], params=PARAMETERS) - felt)
    same(model.forward_dynamics(a["q"], a["qd"], tau, wrench=a["h"], **loaded), a["qdd"], 1e-10)
    out = np.empty((4, *batch, 2))
    several = model.inverse_dynamics(a["q"], a["qd"], a["qdd"], wrench=np.stack(4 * [a["h"]]), out=out, **loaded)
    assert several is out
    same(out, np.stack(4 * [tau]))


@pytest.mark.parametrize("frame", JACOBIANS)
def test_derivatives_are_at_a_constant_wrench(model: ModuleType, frame: str) -> None:
    a, step = arguments(), 1e-6
    loaded = {"wrench": 1e3 * a["h"], "wrench_frame": frame, "params": PARAMETERS}
    moves = step * np.stack([np.eye(2), -np.eye(2)])
    forth, back = model.inverse_dynamics(a["q"] + moves, a["qd"], a["qdd"], **loaded)
    found = model.inverse_dynamics_dq(a["q"], a["qd"], a["qdd"], **loaded)
    same(found, (forth - back).T / (2 * step), 1e-5)


@pytest.mark.parametrize("frame", JACOBIANS)
def test_a_file_may_ask_for_dynamics_that_take_the_wrench_as_an_argument(model: ModuleType, frame: str) -> None:
    a, suffix = arguments(3), "_end" * (frame == "end")
    for name, order in (("inverse_dynamics", ""), ("forward_dynamics", ""), ("inverse_dynamics", "_dq")):
        motion = (a["q"], a["qd"], a["tau" if name == "forward_dynamics" else "qdd"])
        found = getattr(model, f"{name}_wrench{suffix}{order}")(*motion, a["h"], params=PARAMETERS)
        plain = getattr(model, f"{name}{order}")
        same(found, plain(*motion, params=PARAMETERS, wrench=a["h"], wrench_frame=frame), 1e-10)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"wrench": np.ones(5)}, "wrench must have shape (6,) or (..., 6); got (5,)"),
        ({"wrench": np.ones((4, 6))}, "batch shapes do not broadcast: q (3,), qd (3,), qdd (3,), wrench (4,)"),
        ({"wrench": np.ones(6), "wrench_frame": "tool"}, "wrench_frame must be one of ('world', 'end'); got 'tool'"),
        ({"wrench": np.ones(6), "out": np.ones(2)}, "out must be a NumPy array of float64 of shape (3, 2)"),
    ],
)
def test_what_is_no_wrench_is_refused(model: ModuleType, options: dict[str, Any], message: str) -> None:
    a = arguments(3)
    with pytest.raises(ValueError, match=re.escape(f"inverse_dynamics: {message}")):
        model.inverse_dynamics(a["q"], a["qd"], a["qdd"], params=PARAMETERS, **options)


def test_jax_compiles_dynamics_under_a_wrench() -> None:
    found, a = numpy_model(planar()), arguments(3)

    def tau(h: Any) -> Any:
        return found.inverse_dynamics(a["q"], a["qd"], a["qdd"], params=PARAMETERS, wrench=h)

    with jax.enable_x64(True):
        same(jax.jit(tau)(jnp.asarray(a["h"])), tau(a["h"]))
