"""FIGAROH's exciting motions beside derive's: `python -m bench.peers.figaroh_motion`; status 1 if one is better.

Needs figaroh 1.0 and cyipopt, which are in no extra: the latter has no wheels and builds where IPOPT is installed. The
robots and limits are those of `bench.excitation`, 10 s, but for the floor, which FIGAROH does not have. It searches as
its examples do: waypoints every 2 s at rest, quintics between them, regressors at 20 Hz, 100 steps of IPOPT, here from
several seeds, and makes the condition number of the regressor small without scaling its columns. All motions are
measured alike at 100 Hz: condition numbers of derive's base regressor, columns of unit length.
"""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import sys
import tempfile
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np
import yaml
from figaroh.optimal.base_optimal_trajectory import BaseOptimalTrajectory, BaseTrajectoryIPOPTProblem
from figaroh.tools.robot import load_robot

import derive
from bench.excitation import LIMITS, design_of, robot_of
from derive.identification.excitation import Design, Room, condition
from derive.robot.expression import ZERO
from derive.robot.robot import Robot

SEEDS, RATE = 3, 100
SEARCH = {
    "problem": {"soft_lim": 0.0, "max_attempts": 300, "max_iterations": 100, "segment_attempts": 3},
    "trajectory": {"waypoints": 6, "frequency": 20, "segment_duration": 2.0},
}


class Search(BaseOptimalTrajectory):  # type: ignore[misc]
    """FIGAROH's own, with the method that it leaves to its users as its examples have it."""

    def create_ipopt_problem(self, *arguments: Any) -> Any:
        """Of waypoints, what IPOPT solves."""
        return BaseTrajectoryIPOPTProblem(self, *arguments)


def config_of(robot: Robot, joints: list[str]) -> str:
    """What FIGAROH reads of a robot: all that derive identifies, nothing of it known."""
    driven = any(link.armature != ZERO for link in robot.links)
    parts = {"friction": True, "joint_offset": False, "actuator_inertia": driven}
    zeros = [0.0] * robot.dof
    mechanics = {"friction_coefficients": {"viscous": zeros, "static": zeros}, "actuator_inertias": zeros}
    coupling = {"has_coupled_wrist": False}
    properties = {"joints": {"active_joints": joints}, "mechanics": mechanics, "coupling": coupling}
    identification = {"problem": {"model_components": parts}, "signal_processing": {"cutoff_frequency": 10.0}}
    tasks = {"identification": identification, "optimal_trajectory": SEARCH}
    return yaml.safe_dump({"robot": {"name": robot.name, "properties": properties}, "tasks": tasks})


def search_of(robot: Robot, room: Room, folder: Path) -> Search:
    """FIGAROH's search for a motion of a robot within derive's limits."""
    derive.export(robot, "urdf", folder / "arm.urdf")
    arm = load_robot(str(folder / "arm.urdf"), package_dirs=str(folder), load_by_urdf=True)
    model = arm.model
    model.lowerPositionLimit[:], model.upperPositionLimit[:] = room.low, room.high
    model.velocityLimit[:], model.effortLimit[:] = room.speed, room.torque
    joints = list(model.names)[1:]
    (folder / "arm.yaml").write_text(config_of(robot, joints))
    search = Search(arm, joints, str(folder / "arm.yaml"))
    numbers = [model.getJointId(name) for name in joints]
    own = [model.joints[number] for number in numbers]
    search.identif_config |= {"active_joints": joints, "act_Jid": numbers, "act_J": own}
    search.identif_config |= {"act_idxq": [joint.idx_q for joint in own], "act_idxv": [joint.idx_v for joint in own]}
    search.initialize()
    return search


def measured(design: Design, curve: Any) -> tuple[float, float]:
    """The condition number of a motion, and the largest part of a limit that it uses."""
    times = np.arange(curve.min(), curve.max(), 1 / RATE)
    q, qd, qdd = (np.array([curve.derivate(t, order) for t in times]) for order in range(3))
    signs = np.sign(qd.round(9))
    regressor, torque, _ = (part.full() for part in design._function.map(len(q))(q.T, qd.T, qdd.T, signs.T))
    blocks, room = np.moveaxis(regressor.reshape(q.shape[1], len(q), -1), 1, 0), design.room
    used = [np.abs(q - room.middle) / room.half, np.abs(qd) / room.speed, (np.abs(torque.T) + design.dry) / room.torque]
    return condition(blocks), float(np.max(used))


def main() -> int:
    """Search from every seed, print what is found, compare with derive."""
    failed = False
    for name, limits in LIMITS.items():
        robot = robot_of(name)
        design = design_of(robot, limits)
        ours = derive.excite(robot, criterion="condition", **limits)
        print(f"{name}: derive {ours.condition:.2f}", flush=True)
        for seed in range(SEEDS):
            np.random.seed(seed)
            since = process_time()
            with tempfile.TemporaryDirectory() as folder:
                search = search_of(robot, design.room, Path(folder))
                ends = search.solve(stack_reps=1)["iteration_data"]
            seconds = process_time() - since
            if not ends:
                print(f"  seed {seed}: FIGAROH found no motion within the limits in {seconds:.0f} s", flush=True)
                continue
            found, used = measured(design, search.CB.pc)
            print(f"  seed {seed}: FIGAROH {found:.2f} in {seconds:.0f} s, {used:.1%} of a limit used", flush=True)
            failed |= found < ours.condition
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())
