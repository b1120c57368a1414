"""Solvers on trial, all under one interface: poses and given joints in, branches out."""

from __future__ import annotations

import numpy as np

from derive.model.inverse.numeric import POSE, POSITION, NumericChain, solve
from tests.inverse.arms import ArmCase


class Refused(Exception):
    """There is no closed form, with the reason."""


def numeric_solver(case: ArmCase):
    """Damped Newton from many starts."""
    chain = NumericChain.of(case.robot(choice=False), case.values)
    entries = {"pose": POSE, "position": POSITION}[case.task]

    def run(poses, given):
        found = [
            solve(chain, pose, entries=entries, given=dict(zip(case.given, values, strict=True)))
            for pose, values in zip(poses, given, strict=True)
        ]
        width = max((len(one.q) for one in found), default=0)
        branches = np.full((len(poses), width, chain.n), np.nan)
        status = np.zeros((len(poses), width), dtype=np.int8)
        for k, one in enumerate(found):
            branches[k, : len(one.q)], status[k, : len(one.q)] = one.q, one.status
        return branches, status

    return run


def solver_of(case: ArmCase):
    """The closed form."""
    raise Refused("not yet")
