"""The eliminations that an arm has, and those that serve it best."""

import math
import os
import subprocess
import sys
import warnings

import numpy as np
import pytest

from derive.inverse.general.choice import eliminations, find_general
from derive.inverse.numeric.chain import NumericChain
from tests.inverse.arms import PUBLISHED, random_arm
from tests.inverse.general.test_closure import pose_of, random_loop
from tests.places import ROOT


@pytest.mark.parametrize("types", ["RRRRRR", "RRPRRR"])
def test_a_general_arm_has_sixteen_eigenvalues(types):
    loop = random_loop(types)
    pose = pose_of(loop, np.random.default_rng(1).uniform(-2, 2, 6))
    assert min(each.eigenvalues for each in eliminations(loop, pose)) == 16


def test_the_best_elimination_is_first_and_no_two_hide_the_same_joint():
    arm = next(case for case in PUBLISHED if case.name == "jaco")
    found = find_general(NumericChain.of(arm.robot(choice=False), arm.values))
    places = [(each.start, each.hidden) for each in found]
    assert len(set(places)) == len(places) > 1
    assert found[0].eigenvalues == 16
    for each in found:
        assert sum(each.rows) == math.prod(
            (2 if joint in each.straight else 3) + (joint == each.multiplied)
            for joint in each.unknowns
            if joint != each.hidden
        )


def test_an_arm_of_two_joints_has_no_elimination():
    loop = random_loop("RR")
    chain = NumericChain(
        np.array([True, True]), np.ones(2), np.array(loop.gaps[:2]), loop.gaps[2], np.full((2, 2), (-math.pi, math.pi))
    )
    assert find_general(chain) == ()


CHOICE = """
from derive.inverse.general.choice import find_general
from derive.inverse.numeric.chain import NumericChain
from tests.inverse.arms import PUBLISHED
from tests.places import ROOT
for case in PUBLISHED:
    if case.name in ("crx-10ia", "jaco"):
        print(find_general(NumericChain.of(case.robot())))
"""


@pytest.mark.sweep
def test_no_rounding_of_a_processor_decides_which_elimination_is_taken() -> None:
    """Kernels of OpenBLAS for other processors round otherwise; where the variable means nothing all are the same."""
    found = set()
    for processor in ("Haswell", "Prescott", "SkylakeX"):
        environment = os.environ | {
            "OPENBLAS_CORETYPE": processor,
            "OPENBLAS_NUM_THREADS": "1",
            "PYTHONPATH": str(ROOT),
        }
        command = [sys.executable, "-c", CHOICE]
        found.add(subprocess.run(command, env=environment, capture_output=True, text=True, check=True, cwd=ROOT).stdout)
    assert len(found) == 1


@pytest.mark.sweep
def test_joints_that_are_nowhere_near_a_solution_are_tried_in_silence() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert find_general(NumericChain.of(random_arm("6DOF-P-other", 1505).robot()))
