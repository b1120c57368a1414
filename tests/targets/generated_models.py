"""Generated modules as namespaces, without writing them; C and packages of MATLAB and Octave, written to a folder."""

import inspect
import os
import tempfile
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from derive.programs.build import build_program
from derive.programs.functions import INTERFACES
from derive.programs.program import ARGUMENTS, WIDTHS, Function, Program
from derive.programs.tape.build import cut
from derive.programs.tape.graph import Graph
from derive.programs.tape.value import Value
from derive.robot.robot import Robot
from derive.targets.c import render_c
from derive.targets.casadi import render_casadi
from derive.targets.compiler import find_compiler, require_compiler
from derive.targets.numpy import render_numpy
from derive.targets.octave import render_octave
from derive.targets.target import Source
from derive.verification.generated import CModel, find_octave, load_c_model
from tests.rows import text_of_rows

PLANAR = """
name: planar
title: "two links"
convention: standard
joints: [{type: revolute, a: a1, limits: [-pi, 2]}, {type: prismatic, a: a2, alpha: pi/2}]
gravity: [0, -9.81, 0]
links:
  - {mass: m1, com: [-0.1, 0, 0], inertia: {zz: 0.02}, friction: {viscous: 0.5, coulomb: [0.2, 0.3]}}
  - {mass: m2, com: [-0.2, 0.1, 0], inertia: {zz: 0.03, xx: 0.01}, motor: {mass: 0.3, inertia: 0.001, ratio: 50}}
parameters: {a1: 0.5, a2: 0.4}
inverse: {task: [z, phi]}
wrench: [world, end]
"""
PARAMETERS = {"m1": 2.0, "m2": 1.5}
ONE_JOINT = text_of_rows("R a: 0.5", name="one")


@lru_cache(maxsize=64)
def program_of(robot: Robot) -> Program:
    return build_program(robot)


def source_of(robot: Robot, program: Program | None = None) -> Source:
    return Source(robot, program or program_of(robot), "0.0.0")


def load(text: str, name: str = "generated") -> ModuleType:
    module = ModuleType(name)
    exec(compile(text, name, "exec", dont_inherit=True), module.__dict__)
    return module


def numpy_model(robot: Robot, program: Program | None = None) -> ModuleType:
    return load(render_numpy(source_of(robot, program))["model_numpy.py"])


def casadi_model(robot: Robot, program: Program | None = None) -> ModuleType:
    return load(render_casadi(source_of(robot, program))["model_casadi.py"])


def planar() -> Robot:
    return Robot.from_text(PLANAR)


def small_program(graph: Graph, values: list[Value]) -> Program:
    """A program that returns some values as a gravity vector."""
    tape = cut(graph, [value.ref for value in values])
    return Program((Function(INTERFACES["gravity_vector"], (len(values),), tape, "by hand"),), ())


def call(module: ModuleType, name: str, values: Mapping[str, object], **options: object) -> object:
    function = getattr(module, name)
    taken = [kind for kind in inspect.signature(function).parameters if kind in ARGUMENTS]
    return function(*(values[kind] for kind in taken), **options)


def arguments(*batch: int, joints: int = 2, seed: int = 0) -> dict[str, np.ndarray]:
    rng = np.random.default_rng(seed)
    return {kind: rng.uniform(-2, 2, (*batch, WIDTHS.get(kind, joints))) for kind in ARGUMENTS}


IDENTIFICATION = ("regressor", "base_parameters")  # one like `base_regressor`, and one without arguments
OF_LOOPS = "passive_positions"  # which arms without loops have not
FUNCTIONS = tuple(name for name in INTERFACES if name not in (*IDENTIFICATION, OF_LOOPS))


REQUIRED_C = os.environ.get("DERIVE_REQUIRE_COMPILER") == "1"
STRICT = ("-std=c99", "-Wall", "-Wextra", "-pedantic", "-Wshadow", "-Wconversion", "-Wmissing-prototypes", "-Werror")
needs_compiler = pytest.mark.skipif(find_compiler() is None and not REQUIRED_C, reason="no C compiler")


def write_c_model(folder: Path, robot: Robot, program: Program | None = None) -> dict[str, str]:
    return written(folder, render_c(source_of(robot, program)))


def c_model(robot: Robot, program: Program | None = None) -> CModel:
    with tempfile.TemporaryDirectory() as folder:
        write_c_model(Path(folder), robot, program)
        return load_c_model(Path(folder, "model.c"), require_compiler())


REQUIRED_OCTAVE = os.environ.get("DERIVE_REQUIRE_OCTAVE") == "1"
needs_octave = pytest.mark.skipif(find_octave() is None and not REQUIRED_OCTAVE, reason="no Octave")


def write_package(folder: Path, robot: Robot, program: Program | None = None) -> dict[str, str]:
    return written(folder, render_octave(source_of(robot, program)))


def written(folder: Path, texts: dict[str, str]) -> dict[str, str]:
    for name, text in texts.items():
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(text, encoding="utf-8")
    return texts
