"""Generated modules as namespaces, without writing them."""

import inspect
from collections.abc import Mapping
from functools import lru_cache
from importlib.abc import InspectLoader
from importlib.machinery import ModuleSpec
from types import ModuleType

from derive.programs.build import build_program
from derive.programs.functions import INTERFACES
from derive.programs.program import Function, Program
from derive.programs.tape.build import cut
from derive.programs.tape.graph import Graph
from derive.programs.tape.value import Value
from derive.robot.robot import Robot
from derive.targets.casadi import render_casadi
from derive.targets.numpy import render_numpy
from derive.targets.target import Source

PLANAR = """
name: planar
title: "two links"
convention: standard
joints:
  - {type: revolute, a: a1, limits: [-pi, 2]}
  - {type: prismatic, a: a2, alpha: pi/2}
gravity: [0, -9.81, 0]
links:
  - {mass: m1, com: [-0.1, 0, 0], inertia: {zz: 0.02}, friction: {viscous: 0.5, coulomb: 0.2}}
  - {mass: m2, com: [-0.2, 0.1, 0], inertia: {zz: 0.03, xx: 0.01}, motor: {mass: 0.3, inertia: 0.001, ratio: 50}}
parameters: {a1: 0.5, a2: 0.4}
"""
PARAMETERS = {"m1": 2.0, "m2": 1.5}
ONE_JOINT = "name: one\nconvention: standard\njoints: [{type: revolute, a: 0.5}]\n"


@lru_cache(maxsize=64)
def program_of(robot: Robot) -> Program:
    return build_program(robot)


def source_of(robot: Robot, program: Program | None = None) -> Source:
    return Source(robot, program or program_of(robot), "0.0.0")


def load(text: str, name: str = "generated") -> ModuleType:
    loader = TextLoader(name, text)
    module = ModuleType(name)
    loader.exec_module(module)
    return module


class TextLoader(InspectLoader):
    def __init__(self, name: str, text: str) -> None:
        self.name = name
        self.text = text

    def get_source(self, fullname: str) -> str:
        return self.text

    def is_package(self, fullname: str) -> bool:
        return False

    def exec_module(self, module: ModuleType) -> None:
        module.__spec__ = ModuleSpec(self.name, self)
        super().exec_module(module)


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


def call(module: ModuleType, name: str, arguments: Mapping[str, object], **options: object) -> object:
    function = getattr(module, name)
    taken = [kind for kind in inspect.signature(function).parameters if kind not in ("params", "out")]
    return function(*(arguments[kind] for kind in taken), **options)


IDENTIFICATION = ("regressor", "base_parameters")  # one like `base_regressor`, and one without arguments
FUNCTIONS = tuple(name for name in INTERFACES if name not in IDENTIFICATION)
