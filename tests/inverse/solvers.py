"""Solvers on trial, all under one interface: poses and given joints in, branches out."""

import tempfile
from dataclasses import replace
from functools import partial
from types import ModuleType

import derive
from derive.inverse.closed.branches import InverseSolver
from derive.inverse.closed.solve import solve as solve_symbolically
from derive.programs.build import build_program
from derive.programs.optimise.search_policy import Effort
from derive.publish.render import Source
from derive.robot.options.inverse import TASKS
from derive.targets.numpy import TARGET
from derive.verification.generated import load_models
from tests.inverse.arms import ArmCase


class Refused(Exception):
    """There is no closed form, with the reason."""


def solver_of(case: ArmCase, numeric: bool = False):
    """The closed form; its number of complex solutions is the attribute ``count``, 0 where that is not certain."""
    robot = case.robot(choice=False)
    graph = solve_symbolically(robot, TASKS[case.task], case.given)
    if not (numeric or graph.is_closed):
        raise Refused(graph.why_not)
    graph = replace(graph, why_not="by numbers" * numeric)
    solver = InverseSolver.of(robot, graph, case.values)

    def run(poses, given):
        found = solver.solve(poses, given)
        return found.q, found.status

    run.count = graph.count if graph.complete else 0
    return run


numeric_solver = partial(solver_of, numeric=True)


def generated_solver(case: ArmCase, target: str = "numpy"):
    """The function of the generated module, as a user gets it by ``derive build``; ``count`` as above."""
    with tempfile.TemporaryDirectory() as folder:
        return solver_of_module(built_modules(case.robot(), folder, target)[target], case)


def built_modules(robot, folder, *targets: str):
    built = derive.build(robot, folder, targets=["numpy", *targets], only=True, effort="quick")
    return {model.target: model.module for model in load_models(built.folder)}


def unbuilt_solver(case: ArmCase):
    """The function of the generated NumPy module, in half the time: nothing else is generated or verified."""
    robot = case.robot()
    program = build_program(robot, Effort.QUICK, names={"forward_kinematics"}, inverse=True)
    text = TARGET.render(Source(robot, program, derive.__version__, TARGET.files))["model_numpy.py"]
    module = ModuleType("generated_numpy")
    exec(compile(text, "model_numpy.py", "exec", dont_inherit=True), module.__dict__)
    return solver_of_module(module, case)


def solver_of_module(module, case):
    if not hasattr(module, "inverse_kinematics"):
        raise Refused("no inverse_kinematics is generated")
    params = {name: case.values[name] for name in getattr(module, "PARAMETERS", ()) if name in case.values} or None

    def run(poses, given):
        return module.inverse_kinematics(poses, params, given if given.shape[1] else None, status=True)

    graph = solve_symbolically(case.robot())
    run.count = graph.count if graph.complete else 0
    return run
