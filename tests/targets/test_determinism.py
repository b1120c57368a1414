"""What is generated depends on nothing but the robot and the version."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import derive

SCRIPT = """
import hashlib
from derive.targets.casadi import render_casadi
from derive.targets.numpy import render_numpy
from derive.targets.target import Source
from derive.programs.functions import build_program
from derive.robot.robot import Robot
from tests.random_robots import random_robot
import random
digest = hashlib.sha256()
for seed in range(4):
    robot = Robot.from_text(random_robot(random.Random(seed), 1 + seed).text)
    source = Source(robot, build_program(robot), "0")
    for text in (*render_numpy(source).values(), *render_casadi(source).values()):
        digest.update(text.encode())
print(digest.hexdigest())
"""


def test_hash_seeds_change_nothing() -> None:
    root = Path(derive.__file__).parents[1]
    found = set()
    for seed in ("0", "4242"):
        environment = os.environ | {"PYTHONHASHSEED": seed, "PYTHONPATH": str(root)}
        run = subprocess.run(
            [sys.executable, "-c", SCRIPT], env=environment, capture_output=True, text=True, check=True, cwd=root
        )
        found.add(run.stdout)
    assert len(found) == 1
