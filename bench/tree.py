"""Torques of a whole URDF, derive's beside a loop of Pinocchio's ``rnea`` in C++: `python -m bench.tree [URDF]`.

Without a file it takes a humanoid of 29 joints from the package example-robot-data. Torques are compared before they
are timed; friction is left out. All rows take turns on the same configurations.
"""

from __future__ import annotations

import ctypes
import sys
from functools import partial
from importlib.metadata import files
from pathlib import Path

import numpy as np
import pinocchio

from bench.built import imported
from bench.compilers import BUILD
from bench.environment import environment
from bench.peers.passes import filled
from bench.peers.pinocchio_cpp import LABEL, handle, load, pointer
from bench.robots import Array
from bench.stopwatch import Effort, measure
from derive import build
from derive.api.importing import import_tree

HUMANOID = "g1_29dof_rev_1_0.urdf"
COUNTS = (2_000, 20_000)  # that stay in a cache, and that do not
EFFORT = Effort(100, 0.005)  # turns so short and many that some are not disturbed on a machine with other work


def humanoid() -> Path:
    """The file of the package."""
    return next(Path(str(file.locate())) for file in files("example-robot-data") or () if file.name == HUMANOID)


def arm_of(model: pinocchio.Model) -> ctypes.c_void_p:
    """Pinocchio's own model of the file, for the loop."""
    places = [place.homogeneous for place in model.jointPlacements[1:]]
    bodies = [(body.mass, body.lever, body.inertia) for body in model.inertias[1:]]
    kinds = [joint.shortname().removeprefix("JointModel") for joint in model.joints[1:]]
    columns = [np.array(column, dtype=float) for column in (places, *zip(*bodies, strict=True))]
    return handle(kinds, model.parents[1:], columns, np.eye(4), np.array(model.gravity.linear))


def main() -> None:
    """Build, compare, measure."""
    urdf = Path(sys.argv[1]) if len(sys.argv) > 1 else humanoid()
    tree, model = import_tree(urdf, folder=BUILD), pinocchio.buildModelFromUrdf(str(urdf))
    folder = build(tree.robot, BUILD / "tree", targets=("numpy", "native"), only=True).folder
    models = {name: imported(folder / f"model_{name}.py") for name in ("numpy", "native")}
    # Both take the joints in an order of their own.
    order, arm = [model.joints[model.getJointId(name)].idx_v for name in tree.joints], arm_of(model)
    print(f"{urdf.name}: {model.nv} joints, {environment()['processor']}")
    for count in COUNTS:
        q, qd, qdd = np.random.default_rng(560).uniform(-2, 2, (3, count, model.nv))
        out: dict[str, Array] = {label: np.empty(q.shape) for label in (LABEL, *models)}
        ours = [np.ascontiguousarray(values[:, order]) for values in (q, qd, qdd)]
        theirs = [ctypes.c_long(count), *map(pointer, (q, qd, qdd, out[LABEL]))]
        calls = {name: partial(of.inverse_dynamics, *ours, out=out[name]) for name, of in models.items()}
        calls[LABEL] = partial(load().loop_tau, arm, *theirs)
        for call in calls.values():
            call()
        for name in models:
            error = np.abs(out[name] - out[LABEL][:, order]).max() / np.abs(out[LABEL]).max()
            assert error < 1e-9, f"{name}: torques differ by {error:.1e} of the largest"
        times = measure({name: filled(call, out[name]) for name, call in calls.items()}, EFFORT)
        for label, found in times.items():
            ratio = times[LABEL]["min"] / found["min"]
            cells = f"{found['min']:8.1f} ns, median {found['median']:8.1f} ns {ratio:7.2f} times as fast"
            print(f"{count:8} {label:20} {cells}")


if __name__ == "__main__":
    main()
