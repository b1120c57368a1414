"""The C model: clean C99, one configuration and a batch, the same values as the NumPy model."""

import ctypes
import random
import re
import subprocess
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from derive.programs.tape.graph import Graph
from derive.programs.tape.value import Value
from derive.robot.robot import Robot
from derive.targets.c import render_c
from derive.targets.compiler import compile_shared, find_compiler
from derive.targets.escape import c_prefix
from derive.verification.c_model import CModel
from tests.random_robots import random_robot, seeds
from tests.targets.c_models import c_model, needs_compiler, write_c_model
from tests.targets.generated_models import PARAMETERS, numpy_model, planar, small_program, source_of
from tests.targets.test_numpy import TITLES

pytestmark = needs_compiler

STRICT = ("-std=c99", "-Wall", "-Wextra", "-pedantic", "-Wshadow", "-Wconversion", "-Wmissing-prototypes", "-Werror")
ONE_JOINT = "name: one\nconvention: standard\njoints: [{type: revolute, a: 0.5}]\n"


def compiled(folder: Path, *options: str) -> Path:
    compiler = find_compiler()
    assert compiler is not None
    library = folder / "model.so"
    compile_shared(compiler, [folder / "model.c"], library, options)
    return library


@pytest.mark.parametrize("options", [("-O0",), ("-O3", "-march=native"), ("-O2", "-ffast-math")])
def test_no_compiler_warns(tmp_path: Path, options: tuple[str, ...]) -> None:
    write_c_model(tmp_path, planar())
    compiled(tmp_path, *STRICT, *options)


@pytest.mark.slow
@pytest.mark.parametrize("seed", seeds(4, usual=1))
def test_no_compiler_warns_about_random_robots(tmp_path: Path, seed: int) -> None:
    write_c_model(tmp_path, Robot.from_text(random_robot(random.Random(seed), 2 + seed).text))
    compiled(tmp_path, *STRICT)


def test_robots_without_angles_or_without_anything_compile_cleanly(tmp_path: Path) -> None:
    slide = "name: slide\nconvention: standard\njoints: [{type: prismatic}]\ngravity: [0, 0, 1]\nlinks: [{mass: 1}]\n"
    write_c_model(tmp_path, Robot.from_text(slide))
    compiled(tmp_path, *STRICT)
    graph = Graph()
    write_c_model(tmp_path, Robot.from_text(ONE_JOINT), small_program(graph, [Value(graph, graph.number(Fraction(2)))]))
    compiled(tmp_path, *STRICT)


def test_there_is_nothing_global_and_nothing_is_allocated(tmp_path: Path) -> None:
    texts = write_c_model(tmp_path, planar())
    names = subprocess.run(["nm", compiled(tmp_path, "-c")], capture_output=True, text=True, check=True).stdout
    kinds = {line.split()[-1]: line.split()[-2] for line in names.splitlines()}
    assert {name for name, kind in kinds.items() if kind in "BbCDdGgSs"} <= set()
    assert {name for name, kind in kinds.items() if kind == "U"} <= {"sin", "cos", "sincos", "sqrt", "memcpy"} | {
        name for name in kinds if name.startswith(("_GLOBAL_", "__stack"))
    }
    assert not re.search(r"\b(malloc|calloc|free|static double|static int)\b", texts["model.c"])


def test_the_header_can_be_read_by_cpp(tmp_path: Path) -> None:
    write_c_model(tmp_path, planar())
    (tmp_path / "use.cpp").write_text(
        '#include "model.h"\nvoid f(const double *q, double *r) { planar_forward_kinematics(q, nullptr, r); }\n'
        if "forward_kinematics_constants" in (tmp_path / "model.h").read_text()
        else '#include "model.h"\nvoid f(const double *q, double *r) { planar_forward_kinematics(q, r); }\n'
    )
    done = subprocess.run(
        ["g++", "-Wall", "-Wextra", "-pedantic", "-Werror", "-c", "use.cpp", "-o", "use.o"],
        cwd=tmp_path, capture_output=True, text=True,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr


@pytest.mark.slow
@pytest.mark.parametrize("seed", seeds(4, usual=2))
def test_random_robots_give_what_the_numpy_model_gives(seed: int) -> None:
    robot = random_robot(random.Random(seed), 2 + seed)
    loaded = Robot.from_text(robot.text)
    model, wanted = c_model(loaded), numpy_model(loaded)
    rng = np.random.default_rng(seed)
    for function in source_of(loaded).program:
        arguments = [rng.uniform(-2, 2, (11, loaded.n)) for _ in function.arguments]
        expected = getattr(wanted, function.name)(*arguments, params=robot.values)
        batch = model.call(function.name, arguments, robot.values)
        single = [model.call(function.name, rows, robot.values) for rows in zip(*arguments, strict=True)]
        for found in (batch, single) if arguments else (batch,):
            assert np.abs(found - expected).max() <= 1e-12 * max(1, np.abs(expected).max())


@pytest.mark.parametrize("count", [0, 1, 31, 32, 33, 64, 1003])
def test_a_batch_of_any_length_gives_what_its_configurations_give(planar_model: CModel, count: int) -> None:
    q, qd, qdd = np.random.default_rng(count).uniform(-2, 2, (3, count, 2))
    batch = planar_model.call("inverse_dynamics", [q, qd, qdd], PARAMETERS)
    ones = [planar_model.call("inverse_dynamics", rows, PARAMETERS) for rows in zip(q, qd, qdd, strict=True)]
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
    compiler = find_compiler()
    assert compiler is not None
    version = subprocess.run([*compiler, "--version"], capture_output=True, text=True).stdout
    if "Free Software Foundation" not in version:
        pytest.skip("the report is that of gcc")
    texts = write_c_model(tmp_path, planar())
    command = [
        *compiler,
        "-std=c99",
        "-O3",
        "-march=native",
        "-fno-math-errno",
        "-fopt-info-vec",
        "-c",
        "model.c",
        "-o",
        "model.o",
    ]
    report = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True).stderr
    vectorised = {int(line) for line in re.findall(r"model\.c:(\d+):.*loop vectorized", report)}
    lines = texts["model.c"].splitlines()
    wanted = (
        "forward_kinematics",
        "jacobian",
        "inertia_matrix",
        "gravity_vector",
        "inverse_dynamics",
        "forward_dynamics",
    )
    calls = tuple(f"        {name}_lane(" for name in wanted)
    loops = [i for i, line in enumerate(lines) if line.startswith(calls)]
    assert len(loops) == len(wanted)
    assert set(loops) <= vectorised


@pytest.mark.parametrize("name", ["7r", "string-arm", "total", "is-it", "memory", "arm"])
def test_names_of_functions_are_the_robots_own(tmp_path: Path, name: str) -> None:
    prefix = c_prefix(name)
    assert re.fullmatch(r"[a-z][a-z0-9_]*_", prefix)
    assert not re.match(r"(str|mem|is|to|wcs)[a-z]", prefix)
    write_c_model(tmp_path, Robot.from_text(ONE_JOINT.replace("name: one", f"name: {name}")))
    compiled(tmp_path, *STRICT)


def test_names_of_users_never_collide_with_names_of_ours() -> None:
    names = ["lambda", "t1", "k1", "double", "lanes", "result", "LANES", "sign", "int", "count", "sines", "restrict"]
    cells = zip(names[::4], names[1::4], names[2::4], names[3::4], strict=True)
    links = "\n".join(f"  - {{mass: {a}, com: [{b}, {c}, 0], inertia: {{zz: {d}}}}}" for a, b, c, d in cells)
    joints = "\n".join("  - {type: revolute, a: 0.5}" for _ in range(3))
    text = f"name: names\nconvention: standard\njoints:\n{joints}\ngravity: [0, -9.81, 0]\nlinks:\n{links}\n"
    robot = Robot.from_text(text)
    values = {name: 1.0 for name in names}
    q = np.full(robot.n, 0.1)
    wanted = numpy_model(robot).gravity_vector(q, params=values)
    assert c_model(robot).call("gravity_vector", [q], values) == pytest.approx(wanted)


@pytest.mark.parametrize("title", TITLES)
def test_titles_stay_inert(title: str) -> None:
    plain = planar()
    texts = render_c(source_of(replace(plain, title=title)))
    usual = render_c(source_of(plain))
    for file, text in texts.items():
        assert without_comments(text) == without_comments(usual[file])
        assert "??" not in text


def without_comments(text: str) -> str:
    return re.sub(r"/\*.*?\*/", "", text.replace("\\\n", ""), flags=re.DOTALL)


@pytest.fixture(scope="module")
def planar_model() -> CModel:
    return c_model(planar())


@pytest.fixture(scope="module")
def sines() -> CModel:
    graph = Graph()
    x, y = (Value(graph, graph.input("q", i)) for i in range(2))
    two = Robot.from_text("name: two\nconvention: standard\njoints: [{type: revolute}, {type: revolute}]\n")
    return c_model(two, small_program(graph, [x.sin(), y.cos()]))
