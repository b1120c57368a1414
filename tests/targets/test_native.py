"""The native module, and the compiler that builds it."""

import inspect
import shutil
import signal
import sys
import threading
import time
from itertools import count
from pathlib import Path
from types import FrameType, ModuleType
from typing import Any, NamedTuple

import numpy as np
import pytest

from derive import interrupts
from derive.cli.main import main
from derive.errors import TargetError, VerificationError
from derive.programs.optimise.search_policy import Effort
from derive.publish import build
from derive.publish.build import build_robot, check_robot
from derive.robot.robot import Robot
from derive.targets.compiler import compile_shared, compiling_meanwhile, find_compiler, require_compiler
from derive.targets.native import CODE, LIBRARY, MODULE, TARGET
from derive.verification.generated import load_models
from derive.verification.verify import verify
from tests.robot.test_trees import TORSO
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


def test_both_modules_have_the_same_names_and_signatures_and_ufuncs_behind_them(models: Models) -> None:
    assert set(models.native.__all__) == {*models.numpy.__all__, "UFUNCS"}
    for name in ("DOF", "JOINT_NAMES", "JOINT_TYPES", "LIMITS", "OPERATIONS", "PARAMETERS"):
        assert getattr(models.native, name) == getattr(models.numpy, name)
    for name in (*FUNCTIONS, "precompute", "inverse_kinematics", "inverse_kinematics_nearest"):
        native, numpy = getattr(models.native, name), getattr(models.numpy, name)
        assert inspect.signature(native) == inspect.signature(numpy)
        assert native.__doc__ == numpy.__doc__
    ufuncs = models.native.UFUNCS
    assert set(ufuncs) == set(models.numpy.OPERATIONS)
    assert all(isinstance(ufunc, np.ufunc) for ufunc in ufuncs.values())
    assert ufuncs["link_transforms"].signature == "(2)->(2,4,4)"
    q = np.asfortranarray(np.random.default_rng(0).uniform(-1, 1, (2, 7)))
    found = ufuncs["forward_kinematics"](q, axes=[0, (0, 1)])
    assert np.allclose(np.moveaxis(found, -1, 0), models.native.forward_kinematics(q.T), rtol=1e-14)


def test_functions_of_the_ends_of_a_tree_take_the_name_of_an_end(tmp_path: Path) -> None:
    _, native, numpy = built(Robot.from_text(TORSO), tmp_path)
    q, numbers = np.linspace(0, 1, 5), dict.fromkeys(native.PARAMETERS, 0.7)
    for end in native.ENDS:
        pair = (module.jacobian(q, params=numbers, end=end) for module in (native, numpy))
        np.testing.assert_allclose(*pair, rtol=1e-14, atol=1e-14)
    with pytest.raises(ValueError, match=r"jacobian: end 'head'; allowed: left, right"):
        native.jacobian(q, params=numbers, end="head")
    own = {name for name in numpy.__all__ if name[0].islower() and "inverse_kinematics" not in name}
    assert own <= {*native.__all__}


def test_the_sources_compile_without_a_warning(models: Models, tmp_path: Path) -> None:
    for file in ("model.h", "model.c", CODE):
        shutil.copy(models.folder / file, tmp_path)
    options = [option for option in STRICT if option not in ("-Wconversion", "-Wmissing-prototypes")]
    compile_shared(require_compiler(), [tmp_path / CODE], tmp_path / "x.so", options)


def test_a_build_verifies_and_repeats_only_what_changed(tmp_path: Path) -> None:
    robot = Robot.from_text(ONE_JOINT)
    result = build_robot(robot, tmp_path, ["native"], only=True)
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


class Interrupt:
    """Raises an interrupt at the given event of the interpreter, wherever that is; but not where it is held back."""

    def __init__(self, moment: int) -> None:
        self.left = moment

    def __call__(self, frame: FrameType, _event: str, _value: Any) -> "Interrupt":
        frame.f_trace_lines = False  # signals arrive where functions begin and end
        if not interrupts._HELD_BACK.get():
            self.left -= 1
            if self.left == 0:
                raise KeyboardInterrupt
        return self


def interrupted_at(moment: int) -> bool:
    """Whether work of some milliseconds and waiting for it were over only after that many events."""
    before, interrupt = sys.gettrace(), Interrupt(moment)
    sys.settrace(interrupt)
    try:
        with compiling_meanwhile(time.sleep, 0.003) as slept:
            slept()
    except KeyboardInterrupt:
        return True
    finally:
        sys.settrace(before)
    return interrupt.left <= 0


@pytest.mark.skipif(sys.platform == "win32", reason="signals are held back on POSIX systems")
def test_an_interrupt_at_any_moment_lets_the_work_end() -> None:
    before, blocked = set(threading.enumerate()), signal.pthread_sigmask(signal.SIG_BLOCK, ())
    moments = next(moment for moment in count(1) if not interrupted_at(moment))
    assert moments > 20
    assert signal.pthread_sigmask(signal.SIG_BLOCK, ()) == blocked
    for thread in set(threading.enumerate()) - before:
        thread.join(10)
        assert not thread.is_alive()


def test_what_the_work_raises_is_raised_where_its_result_is_asked_for() -> None:
    with pytest.raises(ZeroDivisionError), compiling_meanwhile(lambda: 1 // 0) as quotient:
        quotient()


@pytest.fixture(params=["nowhere", "named"])
def without(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> str:
    if request.param == "named":
        monkeypatch.setenv("CC", "no-such-compiler -O2")
        return "no-such-compiler"
    monkeypatch.delenv("CC", raising=False)
    monkeypatch.setenv("PATH", str(tmp_path))
    return "no C compiler"


def test_native_is_refused_before_all_else(without: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(TargetError, match=without):
        build_robot(Robot.from_text(ONE_JOINT), tmp_path / "out", ["native"])
    file = tmp_path / "one.yaml"
    file.write_text(ONE_JOINT)
    assert main(["build", str(file), "--target", "native", "--out", str(tmp_path / "out")]) == 2
    error = capsys.readouterr().err
    assert without in error
    assert error.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_native_code_of_before_can_be_left_out(without: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A folder from a machine with a compiler: what to do is said, and works."""
    robot = Robot.from_text(ONE_JOINT)
    monkeypatch.setattr(build, "written_targets", lambda folder: ("numpy", "native"))
    with pytest.raises(TargetError, match=f"{without}.*native code of an earlier build.*--only"):
        build_robot(robot, tmp_path / "out", ["numpy"])
    with pytest.raises(TargetError, match=without) as asked:
        build_robot(robot, tmp_path / "out", ["native"])
    assert "--only" not in str(asked.value)
    assert "model_numpy.py" in build_robot(robot, tmp_path / "out", ["numpy"], only=True).files


def test_c_is_written_and_not_verified(without: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    robot = Robot.from_text(ONE_JOINT)
    result = build_robot(robot, tmp_path / "out", ["c", "numpy"], only=True)
    assert result.report.left_out == ("model.c",)
    assert {row.target for row in result.report.rows} == {"numpy"}
    assert verify(robot, result.folder).left_out == ("model.c",)
    file = tmp_path / "one.yaml"
    file.write_text(ONE_JOINT)
    assert main(["verify", str(file), "--out", str(tmp_path / "out")]) == 0
    assert "model.c: not verified, there is no C compiler" in capsys.readouterr().out


def test_the_compiler_may_have_options(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CC", "env -u NOTHING cc")
    found = find_compiler()
    assert found[1:] == ("-u", "NOTHING", "cc")
