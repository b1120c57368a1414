"""What is generated depends on nothing but the robot and the version."""

import hashlib
import os
import random
import subprocess
import sys

import pytest

from derive.programs.build import build_program
from derive.robot.robot import Robot
from derive.targets.casadi import render_casadi
from derive.targets.numpy import render_numpy
from derive.targets.target import Source
from tests.hash_seeds import another_hash_seed
from tests.places import ROOT
from tests.random_robots import random_robot

SCRIPT = "from tests.targets.test_determinism import digest; print(digest({0}))"


def digest(seeds: tuple[int, ...]) -> str:
    found = hashlib.sha256()
    for seed in seeds:
        robot = Robot.from_text(random_robot(random.Random(seed), 1 + seed).text)
        source = Source(robot, build_program(robot), "0")
        for text in (*render_numpy(source).values(), *render_casadi(source).values()):
            found.update(text.encode())
    return found.hexdigest()


@pytest.mark.parametrize("seeds", [(0, 1, 2), pytest.param((3,), marks=pytest.mark.sweep)])
def test_hash_seeds_change_nothing(seeds: tuple[int, ...]) -> None:
    """What this process makes, whose seed is another in every run, is what one with a given seed makes."""
    environment = os.environ | {"PYTHONHASHSEED": another_hash_seed(), "PYTHONPATH": str(ROOT)}
    command = [sys.executable, "-c", SCRIPT.format(seeds)]
    other = subprocess.run(command, env=environment, capture_output=True, text=True, check=True, cwd=ROOT)
    assert other.stdout.strip() == digest(seeds)
