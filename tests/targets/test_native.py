"""The native model: whatever the NumPy model answers or refuses, in the same words; and generalised ufuncs besides."""

import inspect
import random
import shutil
import threading
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import NamedTuple

import numpy as np
import pytest

from derive.errors import TargetError, VerificationError
from derive.publish.build import build_robot, check_robot, library_names
from derive.publish.targets import targets_named
from derive.robot.robot import Robot
from derive.targets.compiler import compile_shared, find_compiler
from derive.targets.native import CODE, LIBRARY, MODULE, TARGET
from derive.verification.generated import NumpyModel, load_models
from tests.random_robots import random_robot, seeds
from tests.targets.c_models import needs_compiler
from tests.targets.generated_models import FUNCTIONS, PARAMETERS, planar

pytestmark = needs_compiler

TARGETS = (TARGET.name, "numpy")
ONE_JOINT = "name: one\nconvention: standard\njoints: [{type: revolute, a: 0.5}]\n"


class Models(NamedTuple):
    folder: Path
    native: ModuleType
    numpy: ModuleType


def built(robot: Robot, out: Path) -> Models:
    folder = build_robot(robot, out, TARGETS, verified=False, only=True).folder
    modules = {model.target: model.module for model in load_models(folder)}
    return Models(folder, modules["native"], modules["numpy"])


@pytest.fixture(scope="module")
def models(tmp_path_factory: pytest.TempPathFactory) -> Models:
    return built(planar(), tmp_path_factory.mktemp("native"))


def arguments_of(model: ModuleType, function: str) -> list[str]:
    names = list(inspect.signature(getattr(model, function)).parameters)
    return [name for name in names if name not in ("params", "out")]


def values(model: ModuleType, function: str, *batch: int, seed: int = 0) -> list[np.ndarray]:
    rng = np.random.default_rng(seed)
    return [rng.uniform(-2, 2, (*batch, model.DOF)) for _ in arguments_of(model, function)]


def assert_same(found: np.ndarray, wanted: np.ndarray) -> None:
    assert type(found) is (np.ndarray if wanted.ndim else np.float64)
    assert (found.shape, found.dtype, found.flags.c_contiguous) == (wanted.shape, wanted.dtype, True)
    assert np.allclose(found, wanted, rtol=1e-12, atol=1e-12, equal_nan=True)


@pytest.mark.parametrize("batch", [(), (1,), (7,), (32,), (2, 3), (0,), (3, 0, 2), (1001,)])
def test_both_models_agree_on_batches_of_every_shape(models: Models, batch: tuple[int, ...]) -> None:
    for name in FUNCTIONS:
        given = values(models.numpy, name, *batch)
        assert_same(
            getattr(models.native, name)(*given, params=PARAMETERS),
            getattr(models.numpy, name)(*given, params=PARAMETERS),
        )


def test_both_modules_have_the_same_names_and_signatures(models: Models) -> None:
    assert set(models.native.__all__) == {*models.numpy.__all__, "UFUNCS"}
    for name in ("DOF", "JOINT_NAMES", "JOINT_TYPES", "LIMITS", "OPERATIONS", "PARAMETERS"):
        assert getattr(models.native, name) == getattr(models.numpy, name)
    for name in (*FUNCTIONS, "precompute"):
        native, numpy = getattr(models.native, name), getattr(models.numpy, name)
        assert inspect.signature(native) == inspect.signature(numpy)
        assert native.__doc__ == numpy.__doc__


TABLE = np.array([[2.0, 1.5], [1.0, 3.0], [0.5, 2.5]])
Q = np.random.default_rng(1).uniform(-2, 2, (5, 2))
CALLS: dict[str, Callable[[ModuleType], object]] = {
    "lists": lambda m: m.forward_kinematics([1, 2]),
    "tuples of lists": lambda m: m.forward_kinematics(([1.0, 2.0], [3.0, 4.0])),
    "single precision": lambda m: m.jacobian(Q.astype(np.float32)),
    "long doubles": lambda m: m.jacobian(Q.astype(np.longdouble)),
    "integers": lambda m: m.jacobian(np.array([1, 2])),
    "truth values": lambda m: m.jacobian(np.array([True, False])),
    "other byte order": lambda m: m.jacobian(Q[0].astype(">f8")),
    "views": lambda m: m.jacobian(np.arange(24.0).reshape(3, 8)[::-1, 1:8:4]),
    "reversed": lambda m: m.jacobian(Q[0, ::-1]),
    "columns": lambda m: m.coriolis_matrix(np.asfortranarray(Q), Q, params=PARAMETERS),
    "a row like a matrix": lambda m: m.jacobian(Q[:1]),
    "broadcasting": lambda m: m.coriolis_matrix(Q[:, None], Q[0], params=PARAMETERS),
    "broadcast views": lambda m: m.inertia_matrix(np.broadcast_to(Q[0], (9, 2)), params=PARAMETERS),
    "not a number": lambda m: m.forward_kinematics([[np.nan, 1.0], [0.0, 1.0]]),
    "infinity": lambda m: m.forward_kinematics([np.inf, 1.0]),
    "far angles": lambda m: m.forward_kinematics([[1e8, 1.0]] * 3),
    "params by name": lambda m: m.gravity_vector(Q, params=PARAMETERS),
    "params in order": lambda m: m.gravity_vector(Q, params=[PARAMETERS[k] for k in m.PARAMETERS]),
    "params precomputed": lambda m: m.gravity_vector(Q[0], params=m.precompute(PARAMETERS)),
    "a table of params": lambda m: m.gravity_vector(Q[0], params=TABLE),
    "params and batch": lambda m: m.inertia_matrix(Q[:, None], params=TABLE),
    "a grid of params": lambda m: m.inertia_matrix(Q[0], params={"m1": TABLE[:, :1], "m2": TABLE[:, 1]}),
    "params for nothing": lambda m: m.forward_kinematics(Q[0], params=TABLE),
    "a column of params": lambda m: m.inverse_dynamics(Q, Q, Q, params={"m1": np.arange(5.0), "m2": 1}),
    "a given joint too many": lambda m: m.inverse_kinematics(np.eye(4), params=PARAMETERS, given=[0.1]),
    "a given word": lambda m: m.inverse_kinematics(np.eye(4), params=PARAMETERS, given="q1"),
    "near what is no number": lambda m: m.inverse_kinematics(np.eye(4), params=PARAMETERS, near=[0.0, np.nan]),
    "near one number": lambda m: m.inverse_kinematics(np.eye(4), params=PARAMETERS, near=[0.0]),
    "nearest to infinity": lambda m: m.inverse_kinematics_nearest(np.eye(4), [0.0, np.inf], params=PARAMETERS),
    "a pose far away": lambda m: m.inverse_kinematics(np.eye(4) + np.diag([1e200], 3), params=PARAMETERS),
    "a pose of no numbers": lambda m: m.inverse_kinematics(np.diag([1.0, 1.0, np.nan, 1.0]), params=PARAMETERS),
    "no rotation": lambda m: m.inverse_kinematics(np.diag([1.0, 1.0, 1.1, 1.0]), params=PARAMETERS),
    "three rows": lambda m: m.inverse_kinematics(np.eye(3), params=PARAMETERS),
    "three entries": lambda m: m.forward_kinematics([1.0, 2.0, 3.0]),
    "one number": lambda m: m.forward_kinematics(1.0),
    "five columns": lambda m: m.forward_kinematics(np.zeros((2, 5))),
    "unequal rows": lambda m: m.forward_kinematics([[1.0, 2.0], [1.0]]),
    "nothing": lambda m: m.forward_kinematics([]),
    "complex numbers": lambda m: m.forward_kinematics([1j, 2.0]),
    "words": lambda m: m.forward_kinematics(["a", "b"]),
    "objects": lambda m: m.forward_kinematics(np.array([1.0, 2.0], dtype=object)),
    "batches that do not fit": lambda m: m.coriolis_matrix(np.zeros((3, 2)), np.zeros((4, 2)), params=PARAMETERS),
    "params that do not fit": lambda m: m.gravity_vector(Q, params={"m1": np.ones(4), "m2": 1}),
    "no params": lambda m: m.gravity_vector(Q),
    "missing params": lambda m: m.gravity_vector(Q, params={"m1": 1.0}),
    "unknown params": lambda m: m.gravity_vector(Q, params={"m1": 1.0, "m2": 1.0, "m3": 1.0}),
    "params of words": lambda m: m.gravity_vector(Q, params={"m1": "heavy", "m2": 1.0}),
    "too few params": lambda m: m.gravity_vector(Q, params=[1.0]),
    "out is no array": lambda m: m.forward_kinematics(Q[0], out=[0.0] * 16),
    "out of another shape": lambda m: m.forward_kinematics(Q, out=np.empty((4, 4))),
    "out of another kind": lambda m: m.forward_kinematics(Q[0], out=np.empty((4, 4), np.float32)),
    "out read-only": lambda m: m.forward_kinematics(Q[0], out=np.broadcast_to(0.0, (4, 4))),
}


@pytest.mark.parametrize("case", list(CALLS))
def test_both_models_answer_or_refuse_alike(models: Models, case: str) -> None:
    answers = []
    for model in (models.native, models.numpy):
        try:
            with np.errstate(invalid="ignore"):
                answers.append(CALLS[case](model))
        except (ValueError, TypeError) as error:
            answers.append((type(error), str(error)))
    found, wanted = answers
    if isinstance(wanted, tuple):
        assert found == wanted
    else:
        assert_same(found, wanted)


@pytest.mark.parametrize("batch", [(), (1,), (0,), (2, 3)])
def test_both_models_solve_batches_of_every_shape(models: Models, batch: tuple[int, ...]) -> None:
    (q,) = values(models.numpy, "forward_kinematics", *batch)
    poses = models.numpy.forward_kinematics(q, params=PARAMETERS)
    near = np.zeros((*batch, models.numpy.DOF))
    for options in ({}, {"near": near}):
        found, status = models.native.inverse_kinematics(poses, params=PARAMETERS, status=True, **options)
        wanted, codes = models.numpy.inverse_kinematics(poses, params=PARAMETERS, status=True, **options)
        assert (found.shape, status.shape) == (wanted.shape, codes.shape)
        assert np.array_equal(status, codes)
        assert np.allclose(found, wanted, rtol=0, atol=1e-9, equal_nan=True)
    away = q + np.random.default_rng(1).uniform(-8, 8, q.shape)
    nearest = models.native.inverse_kinematics_nearest(poses, away, params=PARAMETERS)
    wanted = models.numpy.inverse_kinematics_nearest(poses, away, params=PARAMETERS)
    assert nearest.shape == q.shape
    assert np.allclose(nearest, wanted, rtol=0, atol=1e-9, equal_nan=True)


@pytest.mark.parametrize("name", ["puma560-corke", pytest.param("kuka-lwr4", marks=pytest.mark.sweep)])
def test_the_nearest_solutions_are_those_of_numpy_one_by_one_and_in_a_batch(name: str, tmp_path: Path) -> None:
    """Limits, full turns, singular poses, given joints, and ties between two turns that rounding must not decide."""
    models, rng = built(Robot.load(name), tmp_path), np.random.default_rng(2)
    q = rng.uniform(-3, 3, (300, models.numpy.DOF))
    q[::5, ::2] = 0.0
    poses = models.numpy.forward_kinematics(q)
    near = q + np.pi * rng.integers(-2, 3, q.shape) * rng.integers(0, 2, (300, 1))
    wanted = models.numpy.inverse_kinematics_nearest(poses, near)
    batch = models.native.inverse_kinematics_nearest(poses, near)
    single = np.array([models.native.inverse_kinematics_nearest(*each) for each in zip(poses, near, strict=True)])
    exists = np.isfinite(wanted)
    assert exists.any()
    assert not exists.all()
    for found in (batch, single):
        assert np.array_equal(np.isfinite(found), exists)
        distances = [np.square(each - near).sum(axis=1)[exists[:, 0]] for each in (found, wanted)]
        assert np.allclose(*distances, rtol=0, atol=1e-6)


@pytest.mark.parametrize("shape", [(16,), (2, 8), (8, 2)])
def test_both_models_refuse_what_has_the_numbers_of_a_pose_in_another_shape(
    models: Models, shape: tuple[int, ...]
) -> None:
    for model in (models.native, models.numpy):
        with pytest.raises(ValueError, match="T"):
            model.inverse_kinematics(np.eye(4).reshape(shape), params=PARAMETERS)


@pytest.mark.parametrize("batch", [(), (5,), (3, 11)])
def test_out_is_filled_and_returned_whatever_its_strides(models: Models, batch: tuple[int, ...]) -> None:
    for name in FUNCTIONS:
        given = values(models.native, name, *batch)
        wanted = getattr(models.native, name)(*given, params=PARAMETERS)
        packed = np.empty(wanted.shape)
        strided = np.empty((*wanted.shape[:-1], 2 * wanted.shape[-1]))[..., ::-2] if wanted.ndim else packed
        turned = np.empty(wanted.shape[::-1]).T
        for out in (packed, strided, turned):
            assert getattr(models.native, name)(*given, params=PARAMETERS, out=out) is out
            assert np.allclose(out, wanted, rtol=1e-13, atol=1e-13)


@pytest.mark.parametrize("batch", [(2,), (9, 2)])
def test_out_may_be_an_argument(models: Models, batch: tuple[int, ...]) -> None:
    q, qd, qdd = np.random.default_rng(3).uniform(-2, 2, (3, *batch))
    wanted = models.native.inverse_dynamics(q, qd, qdd, params=PARAMETERS)
    for place in range(3):
        given = [q.copy(), qd.copy(), qdd.copy()]
        models.native.inverse_dynamics(*given, params=PARAMETERS, out=given[place])
        assert np.allclose(given[place], wanted, rtol=1e-13, atol=1e-13)


def test_arguments_stay_as_they_are_even_when_read_only(models: Models) -> None:
    for batch in ((), (9,)):
        for name in FUNCTIONS:
            given = values(models.native, name, *batch)
            kept = [value.copy() for value in given]
            for value in given:
                value.flags.writeable = False
            getattr(models.native, name)(*given, params=PARAMETERS)
            assert all(map(np.array_equal, given, kept))


def test_finite_numbers_and_what_is_no_number_raise_no_warning(models: Models) -> None:
    with np.errstate(all="raise"):
        for name in FUNCTIONS:
            for batch in ((), (5,)):
                getattr(models.native, name)(*values(models.native, name, *batch), params=PARAMETERS)
        assert np.isnan(models.native.forward_kinematics([[np.nan, 1.0]] * 3)).any()


def test_there_is_a_generalised_ufunc_behind_every_function(models: Models) -> None:
    ufuncs = models.native.UFUNCS
    assert set(ufuncs) == set(models.numpy.OPERATIONS)
    assert all(isinstance(ufunc, np.ufunc) for ufunc in ufuncs.values())
    assert ufuncs["link_transforms"].signature == "(2)->(2,4,4)"
    q = np.asfortranarray(np.random.default_rng(0).uniform(-1, 1, (2, 7)))
    found = ufuncs["forward_kinematics"](q, axes=[0, (0, 1)])
    assert np.allclose(np.moveaxis(found, -1, 0), models.native.forward_kinematics(q.T), rtol=1e-14)


def test_threads_do_not_disturb_each_other(models: Models) -> None:
    given = [values(models.native, "inertia_matrix", 500, seed=seed) for seed in range(4)]
    wanted = [models.native.inertia_matrix(*value, params=PARAMETERS) for value in given]
    wrong: list[int] = []

    def work(k: int) -> None:
        for _ in range(20):
            if not np.array_equal(models.native.inertia_matrix(*given[k], params=PARAMETERS), wanted[k]):
                wrong.append(k)

    threads = [threading.Thread(target=work, args=(k,)) for k in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not wrong


@pytest.mark.slow
@pytest.mark.parametrize("seed", seeds(3, usual=1))
def test_random_robots_give_what_the_numpy_model_gives(tmp_path: Path, seed: int) -> None:
    robot = random_robot(random.Random(seed), 2 + seed)
    models = built(Robot.from_text(robot.text), tmp_path)
    for name in set(models.numpy.OPERATIONS) - {"inverse_kinematics"}:
        for batch in ((), (21,)):
            given = values(models.numpy, name, *batch)
            found = getattr(models.native, name)(*given, params=robot.values)
            wanted = getattr(models.numpy, name)(*given, params=robot.values)
            assert np.abs(found - wanted).max() <= 1e-11 * max(1, np.abs(wanted).max())
    if "inverse_kinematics" in models.numpy.OPERATIONS:
        assert_same_solutions(models, robot.values)


def assert_same_solutions(models: Models, parameters: dict[str, float]) -> None:
    """At poses that the arm has, so that there are solutions to compare."""
    (q,) = values(models.numpy, "forward_kinematics", 21)
    poses = models.numpy.forward_kinematics(q, params=parameters)
    given = q[:, [models.numpy.JOINT_NAMES.index(name) for name in models.numpy.GIVEN]]
    found, status = NumpyModel(models.native).inverse(poses, given, parameters)
    wanted, wanted_status = NumpyModel(models.numpy).inverse(poses, given, parameters)
    assert (status > 0).any(axis=1).all()
    assert np.array_equal(status, wanted_status)
    assert np.allclose(found, wanted, rtol=0, atol=1e-9, equal_nan=True)


def test_the_sources_compile_without_a_warning(models: Models, tmp_path: Path) -> None:
    for file in ("model.h", "model.c", CODE):
        shutil.copy(models.folder / file, tmp_path)
    compiler = find_compiler()
    assert compiler is not None
    strict = ("-std=c99", "-Wall", "-Wextra", "-pedantic", "-Wshadow", "-Wno-missing-prototypes", "-Werror")
    compile_shared(compiler, [tmp_path / CODE], tmp_path / "x.so", strict)


def test_a_build_verifies_and_repeats_only_what_changed(tmp_path: Path) -> None:
    robot = Robot.from_text(ONE_JOINT)
    result = build_robot(robot, tmp_path, ["native"], only=True)
    assert result.report is not None
    assert {row.target for row in result.report.rows} == {"native", "c"}
    library = result.folder / LIBRARY
    assert library.name in result.files
    assert check_robot(robot, tmp_path, ["native"], only=True).is_current
    assert build_robot(robot, tmp_path, ["native"], only=True).unchanged
    before = library.read_bytes(), library.stat().st_mtime_ns
    assert not build_robot(robot, tmp_path, ["native", "numpy"], verified=False, only=True).unchanged
    assert (library.read_bytes(), library.stat().st_mtime_ns) == before
    library.unlink()
    assert check_robot(robot, tmp_path, ["native", "numpy"], only=True).missing == (LIBRARY,)
    assert not build_robot(robot, tmp_path, ["native", "numpy"], verified=False, only=True).unchanged
    assert library.is_file()
    assert not check_robot(robot, tmp_path, ["numpy"], only=True).is_current
    assert check_robot(robot, tmp_path, ["numpy"], only=True).extra == (LIBRARY, "model.c", "model.h", CODE, MODULE)
    build_robot(robot, tmp_path, ["numpy"], only=True, verified=False)
    assert not library.exists()


def test_a_library_that_does_not_belong_to_the_module_is_refused(models: Models, tmp_path: Path) -> None:
    built = build_robot(Robot.from_text(ONE_JOINT), tmp_path, ["native"], verified=False, only=True).folder
    foreign, spoilt, empty = (Path(shutil.copytree(built, tmp_path / name)) for name in ("a", "b", "c"))
    shutil.copy(models.folder / LIBRARY, foreign)
    (spoilt / LIBRARY).write_bytes(b"no library")
    (empty / LIBRARY).unlink()
    with pytest.raises(VerificationError, match="not of this robot file"):
        load_models(foreign)
    with pytest.raises(VerificationError, match=r"cannot be loaded here.*derive build one\.yaml --target native"):
        load_models(spoilt)
    with pytest.raises(VerificationError, match="is missing"):
        load_models(empty)


def test_a_compiler_that_fails_leaves_the_old_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    robot = Robot.from_text(ONE_JOINT)
    folder = build_robot(robot, tmp_path, ["numpy"], only=True).folder
    before = {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}
    monkeypatch.setenv("CC", shutil.which("false") or "false")
    with pytest.raises((TargetError, VerificationError), match=r"the C compiler .* failed"):
        build_robot(robot, tmp_path, ["native"], only=True)
    assert {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()} == before
    assert [path.name for path in tmp_path.iterdir() if path.name.startswith(".derive-")] == []


def test_only_native_is_compiled() -> None:
    assert library_names(targets_named()) == ()
    assert library_names(targets_named(["native"])) == (LIBRARY,)
