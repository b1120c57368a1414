"""Generated functions on Dask's arrays: what they give at once, whatever the chunks, on threads and in processes."""

import importlib
import re
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from derive.programs.optimise.search_policy import Effort
from derive.publish.build import build_robot
from derive.robot.load import catalogue_names
from derive.robot.robot import Robot
from tests.targets.generated_models import needs_compiler, planar

da = pytest.importorskip("dask.array")

pytestmark = needs_compiler
BATCH = (6, 11)
CHUNKS = ((6, 11, -1), (1, 11, -1), (4, 5, -1), ((1, 5), (3, 8), -1), (6, 4, 1))


def modules(robot: Robot, out: Path, monkeypatch: pytest.MonkeyPatch, *targets: str) -> list[ModuleType]:
    """Modules that other processes can import, too."""
    folder = build_robot(robot, out, targets, verified=False, only=True, effort=Effort.QUICK).folder
    monkeypatch.syspath_prepend(str(out))
    return [importlib.import_module(f"{folder.name}.model_{target}") for target in targets]


def inputs(module: ModuleType, name: str) -> list[np.ndarray]:
    """Random arguments of a function, as its signature says; the first has the batch, others a part of it."""
    rng = np.random.default_rng(len(name))
    cores = re.findall(r"\(([\d,]*)\)", module.SIGNATURES[name].partition("->")[0])
    batches = (BATCH, BATCH[1:], (BATCH[0], 1), (1,))
    found = [
        rng.uniform(0.3, 1.3, (*batch, int(core))) for batch, core in zip(batches, cores, strict=False) if core != "4,4"
    ]
    if cores[:1] != ["4,4"]:
        return found
    end = name.removeprefix("inverse_kinematics").removeprefix("_nearest")
    places = list(module.JOINTS_OF[end[1:]]) if end else [*range(module.DOF)]
    q = np.zeros((*BATCH, module.DOF))
    q[..., places] = rng.uniform(0.3, 1.3, (*BATCH, len(places)))
    poses = getattr(module, f"forward_kinematics{end}")(q, numbers(module))
    return [poses, *found]


def numbers(module: ModuleType) -> dict[str, float] | None:
    return {name: 0.5 + 0.1 * place for place, name in enumerate(module.PARAMETERS)} or None


def compared(module: ModuleType, name: str, chunks: Any, tolerance: float, **where: Any) -> None:
    arguments = inputs(module, name)
    if not arguments:
        return
    options: dict[str, Any] = {"status": True} if re.match(r"inverse_kinematics(?!_nearest)", name) else {}
    if options and len(arguments) > 1:
        options["given"] = arguments.pop()
    function = partial(getattr(module, name), params=numbers(module), **options)
    eager = function(*arguments)
    first = da.from_array(arguments[0]).rechunk((*chunks[:2], *chunks[2:] * (arguments[0].ndim - 2)))
    lazy = function(first, *arguments[1:])
    if name == "task_inertia" and tolerance:  # the inverse of J B^-1 J^T, near singular configurations too
        tolerance *= np.nanmax(np.linalg.cond(np.nan_to_num(eager)))
    if match := re.fullmatch(r"analytic_jacobian_(rpy|zyz)(.*)", name):
        # Rates of the angles are those of the body times an inverse whose entries are as large as 1/cos theta (rpy) or
        # 1/sin theta (zyz); where products cancel, their rounding remains, as large as that of the products.
        rotation = getattr(module, f"forward_kinematics{match[2]}")(arguments[0], numbers(module))
        tolerance /= np.hypot(*np.moveaxis(rotation[..., :2, 0 if match[1] == "rpy" else 2], -1, 0)).min()
    pairs = zip(lazy, eager, strict=True) if options else [(lazy, eager)]
    for found, expected in pairs:
        assert (found.shape, found.dtype) == (expected.shape, expected.dtype)
        assert found.chunks[:2] == first.rechunk({2: -1}).chunks[:2] or -1 not in chunks
        values = found.compute(**where)
        assert tolerance or values.tobytes() == expected.tobytes(), name
        bound = tolerance * np.nanmax(np.abs(expected), initial=0.0)
        np.testing.assert_allclose(values, expected, rtol=0, atol=bound, err_msg=name)


@pytest.fixture(scope="module")
def planar_modules(tmp_path_factory: pytest.TempPathFactory) -> Iterator[list[ModuleType]]:
    with pytest.MonkeyPatch.context() as patch:
        yield modules(planar(), tmp_path_factory.mktemp("lazy"), patch, "numpy", "native")


def check(models: list[ModuleType], every: int = 1) -> None:
    """To the byte for compiled functions; NumPy rounds columns and single configurations differently."""
    for module, tolerance in zip(models, (1e-13, 0.0), strict=True):
        assert "import dask" not in Path(str(module.__file__)).read_text(encoding="utf-8")
        for k, name in enumerate(module.SIGNATURES):
            for chunks in CHUNKS[k % every :: every]:
                compared(module, name, chunks, tolerance, scheduler="threads")


def test_lazy_results_are_those_of_a_call_at_once(planar_modules: list[ModuleType]) -> None:
    check(planar_modules, every=len(CHUNKS))


@pytest.mark.sweep
@pytest.mark.parametrize("robot", catalogue_names())
def test_lazy_results_of_built_in_robots(robot: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    check(modules(Robot.load(robot), tmp_path, monkeypatch, "numpy", "native"))


@pytest.mark.sweep
def test_other_processes_give_the_same_bytes(planar_modules: list[ModuleType]) -> None:
    numpy, native = planar_modules
    compared(numpy, "inverse_kinematics_nearest", (1, 11, -1), 1e-13, scheduler="processes", num_workers=2)
    compared(native, "inverse_dynamics", (1, 11, -1), 0.0, scheduler="processes", num_workers=2)


def test_parameters_and_wrenches_go_along_in_blocks(planar_modules: list[ModuleType]) -> None:
    rng = np.random.default_rng(0)
    q, m1, h = rng.uniform(-1, 1, (100, 2)), rng.uniform(1, 2, 100), rng.uniform(-1, 1, (100, 6))
    lazy_q, lazy_m1 = da.from_array(q, chunks=(30, 1)), da.from_array(m1, chunks=7)
    for module in planar_modules:
        numbers = {"m1": m1, "m2": 1.5}
        lazy_numbers = {"m1": lazy_m1, "m2": 1.5}
        for params in (lazy_numbers, module.precompute(lazy_numbers), numbers, [lazy_m1, 1.5]):
            for place in (q, lazy_q):
                found = module.inertia_matrix(place, params)
                np.testing.assert_allclose(found, module.inertia_matrix(q, numbers), rtol=1e-13)
                assert hasattr(found, "dask") is not (place is q and params is numbers)
        found = module.inverse_dynamics(lazy_q, q, q[0], numbers, wrench=h, wrench_frame="end")
        expected = module.inverse_dynamics(q, q, q[0], numbers, wrench=h, wrench_frame="end")
        np.testing.assert_allclose(found, expected, rtol=1e-12)
        base = module.base_parameters([lazy_m1, 1.5])
        np.testing.assert_allclose(base, module.base_parameters([m1, 1.5]), rtol=1e-13)
        one = module.inertia_matrix(q[:1], {"m1": m1[:1], "m2": 1.5})  # a block of one
        np.testing.assert_allclose(one, module.inertia_matrix(q[0], {"m1": m1[0], "m2": 1.5})[None], rtol=1e-13)
        whole = np.arange(40).reshape(20, 2)
        np.testing.assert_allclose(module.jacobian(da.from_array(whole)), module.jacobian(whole), rtol=1e-13)
        assert module.manipulability(lazy_q[0]).compute() == module.manipulability(q[0])


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda m, q: m.jacobian(q, out=np.empty((20, 6, 2))), "jacobian: out is for NumPy's arrays; a lazy result"),
        (lambda m, q: m.jacobian(q[:, :1]), r"jacobian: q must have shape \(2,\) or \(..., 2\); got \(20, 1\)"),
        (lambda m, q: m.inertia_matrix(q), "inertia_matrix: missing in params: m1, m2"),
        (lambda m, q: m.jacobian_dot(q, q[:7]), r"jacobian_dot: batch shapes do not broadcast: q \(20,\), qd \(7,\)"),
        (lambda m, q: m.jacobian(q[q[:, 0] > 10]), "jacobian: blocks of unknown length; call compute_chunk_sizes"),
        (lambda m, q: m.inverse_kinematics(q), r"inverse_kinematics: T must have shape \(4, 4\)"),
        (
            lambda m, q: m.inverse_kinematics(m.forward_kinematics(q) * (q[:, 0] != 16)[:, None, None]).compute(),
            r"block \(1, 0, 0\) of T: inverse_kinematics: T\[1\] is not a valid pose",
        ),
        (
            lambda m, q: m.jacobian(q.map_blocks(lambda block: block[:, :1], dtype=float, chunks=q.chunks)).compute(),
            r"block \([012], 0\) of q: jacobian: q must have shape",
        ),
    ],
)
def test_what_is_wrong_is_refused_at_once_or_names_its_block(
    call: Any, said: str, planar_modules: list[ModuleType]
) -> None:
    q = da.from_array(np.arange(40.0).reshape(20, 2), chunks=(7, 2))
    for module in planar_modules:
        with pytest.raises((TypeError, ValueError), match=said):
            call(module, q)


def test_xarray_applies_them_to_labelled_arrays(planar_modules: list[ModuleType]) -> None:
    xarray = pytest.importorskip("xarray")
    q = np.random.default_rng(0).uniform(-1, 1, (50, 2))
    labelled = xarray.DataArray(q, dims=("time", "joint")).chunk(time=20)
    for module in planar_modules:
        size = {"row": 6, "column": 2}
        assert module.SIGNATURES["jacobian"] == "(2)->(6,2)"
        found = xarray.apply_ufunc(
            module.jacobian, labelled, input_core_dims=[["joint"]], output_core_dims=[[*size]],
            dask="parallelized", output_dtypes=[float], dask_gufunc_kwargs={"output_sizes": size},
        )  # fmt: skip
        assert found.chunks[0] == (20, 20, 10)
        np.testing.assert_allclose(found, module.jacobian(q), rtol=1e-13)
