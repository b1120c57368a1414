"""The energies of generated code along a simulated motion: what they gain is what the drives do and friction takes."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest

from derive.robot.robot import Robot
from tests.targets.generated_models import numpy_model

Array = npt.NDArray[np.float64]
SECONDS, STEPS = 0.5, 250

SPATIAL = """
name: spatial
convention: modified
joints:
  - {type: revolute, d: 0.3}
  - {type: revolute, alpha: pi/2, a: 0.1}
  - {type: revolute, a: 0.5, d: 0.1}
base: [[1, 0, 0, 0.2], [0, cos(pi/6), -sin(pi/6), 0], [0, sin(pi/6), cos(pi/6), 1], [0, 0, 0, 1]]
gravity: [0, 0, -9.81]
links:
  - {mass: 4, com: [0, 0.1, -0.1], inertia: {xx: 0.1, yy: 0.1, zz: 0.05}, motor: {mass: 1, inertia: 0.001, ratio: 50}}
  - {mass: 3, com: [0.2, 0, 0], inertia: {xx: 0.1, yy: 0.1, zz: 0.1, xy: 0.01}, armature: 0.1, friction: {viscous: 1}}
  - {mass: m3, com: [0.2, 0, 0.1], inertia: {yy: 0.05, zz: 0.06}, motor: {mass: 0.5, inertia: 0.0002, ratio: 80}}
parameters: {m3: 2}
runtime: [m3]
"""
SLIDING = """
name: sliding
convention: standard
joints:
  - {type: prismatic, alpha: pi/2}
  - {type: revolute, a: 0.4, theta: -q2}
  - {type: prismatic, alpha: -pi/3, theta: 0.3}
gravity: [1, 2, -9]
links:
  - {mass: 4, com: [0, 0.1, -0.1], friction: {viscous: 2}}
  - {mass: 3, com: [0.2, 0, 0], inertia: {xx: 0.01, yy: 0.1, zz: 0.1}, motor: {mass: 1, inertia: 0.001, ratio: 50}}
  - {mass: 1, com: [0.2, 0, 0.1], inertia: {zz: 0.06}, motor: {mass: 0.5, inertia: 0.0002, ratio: 80}}
"""


@pytest.mark.parametrize(("text", "options"), [(SPATIAL, {"params": {"m3": 1.4}}), (SLIDING, {})])
def test_the_energies_gain_the_work_of_the_drives_less_that_of_friction(text: str, options: dict[str, object]) -> None:
    """Classic Runge-Kutta of order four, with the work as one more state."""
    robot = Robot.from_text(text)
    model = numpy_model(robot)
    n, amplitude = robot.n, 5.0

    def slope(time: float, state: Array) -> Array:
        q, qd = state[:n], state[n : 2 * n]
        tau = amplitude * np.sin(3.0 * time + np.arange(n))
        smooth = model.coriolis_vector(q, qd, **options) + model.gravity_vector(q, **options)
        friction = model.inverse_dynamics(q, qd, np.zeros(n), **options) - smooth
        return np.array([*qd, *model.forward_dynamics(q, qd, tau, **options), qd @ (tau - friction)])

    def energy(state: Array) -> float:
        q, qd = state[:n], state[n : 2 * n]
        return float(model.kinetic_energy(q, qd, **options) + model.potential_energy(q, **options))

    state, h = np.append(np.linspace(0.3, 0.9, 2 * n), 0.0), SECONDS / STEPS
    before = energy(state)
    exchanged = 0.0
    for k in range(STEPS):
        a = slope(k * h, state)
        b = slope((k + 0.5) * h, state + h / 2 * a)
        c = slope((k + 0.5) * h, state + h / 2 * b)
        state = state + h / 6 * (a + 2 * b + 2 * c + slope((k + 1) * h, state + h * c))
        exchanged = max(exchanged, abs(state[-1]))
    assert exchanged > 0.1
    assert abs(energy(state) - before - state[-1]) < 1e-6 * exchanged
