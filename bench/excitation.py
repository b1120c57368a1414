"""Exciting motions beside the best of 500 random ones: `python -m bench.excitation`; status 1 beyond the bars.

A PUMA 560 and a UR5e, base parameters with friction, both criteria. The condition number (of regressors at 100 Hz,
columns of unit length) and the determinant shall be better than those of the best random motion within the same limits,
in at most a minute of processor time each.
"""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # as the command has it

import sys
from time import process_time

import numpy as np

from derive.api.excite import _noise, _of_joints, _room, excite
from derive.identification.excitation import Criterion, Design, FourierSeries, condition
from derive.identification.standard import Unknowns
from derive.robot.load import catalogue_names
from derive.robot.robot import Robot

SECONDS, RANDOM = 60.0, 500
# The maker's table, masses and centres of mass (Universal Robots, DH parameters for kinematics and dynamics).
UR5E = """\
name: ur5e
convention: standard
joints:
  - {type: revolute, d: 0.1625, alpha: pi/2, limits: [-pi, pi], speed: pi, torque: 150}
  - {type: revolute, a: -0.425, limits: [-pi, pi], speed: pi, torque: 150}
  - {type: revolute, a: -0.3922, limits: [-pi, pi], speed: pi, torque: 150}
  - {type: revolute, d: 0.1333, alpha: pi/2, limits: [-pi, pi], speed: pi, torque: 28}
  - {type: revolute, d: 0.0997, alpha: -pi/2, limits: [-pi, pi], speed: pi, torque: 28}
  - {type: revolute, d: 0.0996, limits: [-pi, pi], speed: pi, torque: 28}
gravity: [0, 0, -9.81]
links:
  - {mass: 3.761, com: [0, -0.02561, 0.00193]}
  - {mass: 8.058, com: [0.2125, 0, 0.11336]}
  - {mass: 2.846, com: [0.15, 0, 0.0265]}
  - {mass: 1.37, com: [0, -0.0018, 0.01634]}
  - {mass: 1.3, com: [0, 0.0018, 0.01634]}
  - {mass: 0.365, com: [0, 0, -0.001159]}
"""
# Of the PUMA the torques of Armstrong, Khatib and Burdick (1986), and 100 degrees a second.
LIMITS = {
    "puma560-corke": {"speed": 100, "torque": "97.6,186.4,89.4,24.2,20.1,21.3", "floor": -0.66},
    "ur5e": {"floor": 0.0, "noise": "1,1,1,0.2,0.2,0.2"},  # without tensors its last joint has no torque
}


def robot_of(name: str) -> Robot:
    """A robot of `LIMITS`."""
    return Robot.load(name) if name in catalogue_names() else Robot.from_text(UR5E)


def design_of(robot: Robot, limits: dict[str, object]) -> Design:
    """The search within the limits."""
    options = {name: _of_joints(robot, limits[name], name) for name in ("speed", "torque") if name in limits}
    unknowns, series = Unknowns.of(robot, ("viscous", "coulomb")), FourierSeries(10.0, 5)
    room = _room(robot, options, limits["floor"])
    return Design(unknowns, series, room, Criterion.CONDITION, _noise(robot, "1%"))


def random_best(robot: Robot, limits: dict[str, object]) -> float:
    """The least condition number of random series within the limits."""
    design = design_of(robot, limits)
    rng, times = np.random.default_rng(2), np.arange(0, 10, 0.01)
    centres = design.centres(rng)
    return min(condition(design.samples(design.drawn(rng, centres), times)[0]) for _ in range(RANDOM))


def main() -> int:
    """Find, measure, compare with the bars."""
    failed = False
    for name, limits in LIMITS.items():
        robot = robot_of(name)
        least = random_best(robot, limits)
        for criterion in Criterion:
            since = process_time()
            found = excite(robot, criterion=criterion, **limits)
            seconds = process_time() - since
            print(f"{name}, {criterion}: condition number {found.condition:.2f} in {seconds:.1f} s; "
                  f"best of {RANDOM} random motions {least:.2f}", flush=True)  # fmt: skip
            failed |= seconds > SECONDS or (criterion is Criterion.CONDITION and found.condition > least)
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())
