"""The native model beside NumPy's: the same names and signatures; generalised ufuncs, and how it is built."""

import inspect
import shutil
from pathlib import Path
from types import ModuleType
from typing import NamedTuple

import numpy as np
import pytest

from derive.errors import TargetError, VerificationError
from derive.programs.optimise.search_policy import Effort
from derive.publish.build import build_robot, check_robot, library_names
from derive.publish.targets import targets_named
from derive.robot.robot import Robot
from derive.targets.compiler import compile_shared, require_compiler
from derive.targets.native import CODE, LIBRARY, MODULE, TARGET
from derive.verification.generated import load_models
from tests.targets.generated_models import FUNCTIONS, ONE_JOINT, STRICT, needs_compiler, planar

pytestmark = needs_compiler

TARGETS = (TARGET.name, "numpy")


class Models(NamedTuple):
    folder: Path
    native: ModuleType
    numpy: ModuleType


def built(robot: Robot, out: Path) -> Models:
    folder = build_robot(robot, out, TARGETS, verified=False, only=True, effort=Effort.QUICK).folder
    modules = {model.target: model.module for model in load_models(folder)}
    return Models(folder, modules["native"], modules["numpy"])


@pytest.fixture(scope="module")
def models(tmp_path_factory: pytest.TempPathFactory) -> Models:
    return built(planar(), tmp_path_factory.mktemp("native"))


def test_both_modules_have_the_same_names_and_signatures(models: Models) -> None:
    assert set(models.native.__all__) == {*models.numpy.__all__, "UFUNCS"}
    for name in ("DOF", "JOINT_NAMES", "JOINT_TYPES", "LIMITS", "OPERATIONS", "PARAMETERS"):
        assert getattr(models.native, name) == getattr(models.numpy, name)
    for name in (*FUNCTIONS, "precompute", "inverse_kinematics", "inverse_kinematics_nearest"):
        native, numpy = getattr(models.native, name), getattr(models.numpy, name)
        assert inspect.signature(native) == inspect.signature(numpy)
        assert native.__doc__ == numpy.__doc__


def test_there_is_a_generalised_ufunc_behind_every_function(models: Models) -> None:
    ufuncs = models.native.UFUNCS
    assert set(ufuncs) == set(models.numpy.OPERATIONS)
    assert all(isinstance(ufunc, np.ufunc) for ufunc in ufuncs.values())
    assert ufuncs["link_transforms"].signature == "(2)->(2,4,4)"
    q = np.asfortranarray(np.random.default_rng(0).uniform(-1, 1, (2, 7)))
    found = ufuncs["forward_kinematics"](q, axes=[0, (0, 1)])
    assert np.allclose(np.moveaxis(found, -1, 0), models.native.forward_kinematics(q.T), rtol=1e-14)


def test_the_sources_compile_without_a_warning(models: Models, tmp_path: Path) -> None:
    for file in ("model.h", "model.c", CODE):
        shutil.copy(models.folder / file, tmp_path)
    options = [option for option in STRICT if option not in ("-Wconversion", "-Wmissing-prototypes")]
    compile_shared(require_compiler(), [tmp_path / CODE], tmp_path / "x.so", options)


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
