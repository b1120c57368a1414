"""The C model: clean C99, one configuration and a batch, sines and cosines of its own."""

import ctypes
import random
import re
import subprocess
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from derive.programs.program import Program
from derive.programs.tape.graph import Graph
from derive.programs.tape.value import Value
from derive.robot.robot import Robot
from derive.targets.compiler import compile_shared, require_compiler
from derive.targets.escape import c_prefix
from derive.verification.generated import CModel
from tests.random_robots import random_robot, seeds
from tests.rows import robot_of_rows
from tests.targets import generated_models as models
from tests.targets.searched_arms import GENERAL, program_of, robot_of

pytestmark = models.needs_compiler

SLIDE = "name: slide\nconvention: standard\njoints: [{type: prismatic}]\ngravity: [0, 0, 1]\nlinks: [{mass: 1}]\n"
TORQUES = ("inverse_dynamics", "forward_dynamics")


def number() -> Program:
    graph = Graph()
    return models.small_program(graph, [Value(graph, graph.number(Fraction(2)))])


CASES: dict[str, tuple[Callable[[], tuple[Robot, Program | None]], str]] = {
    "plain": (lambda: (models.planar(), None), "-O0"),
    "optimised": (lambda: (models.planar(), None), "-O3 -march=native"),
    "fast": (lambda: (models.planar(), None), "-O2 -ffast-math"),
    "without angles": (lambda: (Robot.from_text(SLIDE), None), "-O0"),
    "without inputs": (lambda: (Robot.from_text(models.ONE_JOINT), number()), "-O0"),
    "without formulas": (lambda: (robot_of(GENERAL), program_of(GENERAL)), "-O2"),
}


def compiled(folder: Path, *options: str) -> Path:
    library = folder / "model.so"
    compile_shared(require_compiler(), [folder / "model.c"], library, options)
    return library


@pytest.mark.first(3)
@pytest.mark.parametrize("case", CASES)
def test_no_compiler_warns_and_nothing_is_allocated(tmp_path: Path, case: str) -> None:
    made, options = CASES[case]
    text = models.write_c_model(tmp_path, *made())["model.c"]
    assert not re.search(r"\b(malloc|calloc|free)\(|\bstatic (double|int) \w+[^\w(]", text)
    compiled(tmp_path, *models.STRICT, *options.split())


@pytest.mark.slow
@pytest.mark.parametrize("seed", seeds(4, usual=1))
def test_no_compiler_warns_about_random_robots(tmp_path: Path, seed: int) -> None:
    models.write_c_model(tmp_path, Robot.from_text(random_robot(random.Random(seed), 2 + seed).text))
    compiled(tmp_path, *models.STRICT)


def test_there_is_nothing_global(tmp_path: Path) -> None:
    models.write_c_model(tmp_path, models.planar())
    names = subprocess.run(["nm", compiled(tmp_path, "-c")], capture_output=True, text=True, check=True).stdout
    kinds = {line.split()[-1]: line.split()[-2] for line in names.splitlines()}
    assert {name for name, kind in kinds.items() if kind in "BbCDdGgSs"} <= set()
    assert {name for name, kind in kinds.items() if kind == "U"} <= {"sin", "cos", "sincos", "sqrt", "memcpy"} | {
        name for name in kinds if name.startswith(("_GLOBAL_", "__stack"))
    }


def test_the_header_can_be_read_by_cpp(tmp_path: Path) -> None:
    header = models.write_c_model(tmp_path, models.planar())["model.h"]
    inputs = "q, nullptr, r" if "forward_kinematics_constants" in header else "q, r"
    call = f"void f(const double *q, double *r) {{ planar_forward_kinematics({inputs}); }}"
    (tmp_path / "use.cpp").write_text(f'#include "model.h"\n{call}\n')
    command = ["g++", "-Wall", "-Wextra", "-pedantic", "-Werror", "-c", "use.cpp", "-o", "use.o"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("count", [0, 1, 31, 32, 33, 64, 1003])
def test_a_batch_of_any_length_gives_what_its_configurations_give(planar_model: CModel, count: int) -> None:
    q, qd, qdd = np.random.default_rng(count).uniform(-2, 2, (3, count, 2))
    batch = planar_model.call("inverse_dynamics", [q, qd, qdd], models.PARAMETERS)
    ones = [planar_model.call("inverse_dynamics", rows, models.PARAMETERS) for rows in zip(q, qd, qdd, strict=True)]
    assert batch.shape == (count, 2)
    assert np.allclose(batch, np.reshape(ones, (count, 2)), rtol=1e-13, atol=1e-13)


def test_a_batch_writes_no_further_than_its_result(planar_model: CModel) -> None:
    for count in (1, 8, 32, 77):
        q = np.ones((count, 2))
        guarded = np.full((count + 1) * 16, -7.0)
        pointers = [a.ctypes.data_as(ctypes.c_void_p) for a in (q, guarded)]
        planar_model.shared.planar_forward_kinematics_batch(ctypes.c_size_t(count), *pointers)
        assert (guarded[count * 16 :] == -7.0).all()
        assert (guarded[: count * 16] != -7.0).all()


def ulps(found: np.ndarray, exact: np.ndarray) -> float:
    """The greatest distance in units in the last place."""
    error = np.abs(found.astype(np.longdouble) - exact)
    return float((error / np.spacing(np.abs(exact).astype(float))).max())


@pytest.mark.parametrize("reach", [0.8, 10.0, 1e3, 1e6])
def test_sines_and_cosines_of_batches_are_right_to_two_units_in_the_last_place(sines: CModel, reach: float) -> None:
    rng = np.random.default_rng(0)
    x = np.concatenate([rng.uniform(-reach, reach, 200_000), np.round(rng.uniform(-reach, reach, 5000)) * (np.pi / 4)])
    x = x[np.abs(x) <= 1e6]
    found = sines.call("gravity_vector", [np.stack([x, x], axis=-1)], {})
    wide = x.astype(np.longdouble)
    assert ulps(found[:, 0], np.sin(wide)) < 2
    assert ulps(found[:, 1], np.cos(wide)) < 2


def test_far_angles_and_what_is_no_number_are_as_in_the_library(sines: CModel) -> None:
    x = np.array([[1e6 + 1, 0.5], [1e22, -1e300], [np.inf, 1.0], [-np.inf, 1.0], [np.nan, 2.0], [0.0, -0.0]])
    with np.errstate(invalid="ignore"):
        wanted = np.stack([np.sin(x[:, 0]), np.cos(x[:, 1])], axis=-1)
    found = sines.call("gravity_vector", [x], {})
    assert np.allclose(found, wanted, rtol=1e-15, atol=0, equal_nan=True)


def test_batches_are_vectorised(tmp_path: Path) -> None:
    compiler = require_compiler()
    version = subprocess.run([*compiler, "--version"], capture_output=True, text=True).stdout
    if "Free Software Foundation" not in version:
        pytest.skip("the report is that of gcc")
    texts = models.write_c_model(tmp_path, models.planar())
    options = [*("-std=c99", "-O3", "-march=native", "-fno-math-errno", "-fopt-info-vec"), "-c", "model.c"]
    report = subprocess.run([*compiler, *options], cwd=tmp_path, capture_output=True, text=True).stderr
    vectorised = {int(line) for line in re.findall(r"model\.c:(\d+):.*loop vectorized", report)}
    lines = texts["model.c"].splitlines()
    wanted = ("forward_kinematics", "jacobian", "inertia_matrix", "gravity_vector", *TORQUES)
    calls = tuple(f"        {name}_lane(" for name in wanted)
    loops = [i for i, line in enumerate(lines) if line.startswith(calls)]
    assert len(loops) == len(wanted)
    assert set(loops) <= vectorised


@pytest.mark.parametrize("name", ["7r", "string-arm", "is-it"])
def test_names_of_functions_are_the_robots_own(tmp_path: Path, name: str) -> None:
    prefix = c_prefix(name)
    assert re.fullmatch(r"[a-z][a-z0-9_]*_", prefix)
    assert not re.match(r"(str|mem|is|to|wcs)[a-z]", prefix)
    models.write_c_model(tmp_path, Robot.from_text(models.ONE_JOINT.replace("name: one", f"name: {name}")))
    compiled(tmp_path, *models.STRICT)


@pytest.fixture(scope="module")
def planar_model() -> CModel:
    return models.c_model(models.planar())


@pytest.fixture(scope="module")
def sines() -> CModel:
    graph = Graph()
    x, y = (Value(graph, graph.input("q", i)) for i in range(2))
    return models.c_model(robot_of_rows("R | R"), models.small_program(graph, [x.sin(), y.cos()]))
