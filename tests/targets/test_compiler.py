"""The C compiler at work beside the rest, where an interrupt ends both; what is done without one."""

import signal
import sys
import threading
import time
from itertools import count
from pathlib import Path
from types import FrameType
from typing import Any

import pytest

from derive import interrupts
from derive.cli.main import main
from derive.errors import TargetError
from derive.publish import build
from derive.publish.build import build_robot
from derive.robot.robot import Robot
from derive.targets.compiler import compiling_meanwhile, find_compiler
from derive.verification.verify import verify
from tests.targets.generated_models import ONE_JOINT


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
    with (
        pytest.raises(ZeroDivisionError),
        compiling_meanwhile(lambda: 1 // 0) as quotient,
    ):
        quotient()


@pytest.fixture(params=["nowhere", "named"])
def without(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> str:
    if request.param == "named":
        monkeypatch.setenv("CC", "no-such-compiler -O2")
        return "no-such-compiler"
    monkeypatch.delenv("CC", raising=False)
    monkeypatch.setenv("PATH", str(tmp_path))
    return "no C compiler"


def test_the_native_target_is_refused_before_anything_is_written(
    without: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(TargetError, match=without):
        build_robot(Robot.from_text(ONE_JOINT), tmp_path / "out", ["native"])
    file = tmp_path / "one.yaml"
    file.write_text(ONE_JOINT)
    assert main(["build", str(file), "--target", "native", "--out", str(tmp_path / "out")]) == 2
    error = capsys.readouterr().err
    assert without in error
    assert error.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_native_code_of_an_earlier_build_can_be_left_out(
    without: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A folder from a machine with a compiler: what to do is said, and works."""
    robot = Robot.from_text(ONE_JOINT)
    monkeypatch.setattr(build, "written_targets", lambda folder: ("numpy", "native"))
    with pytest.raises(TargetError, match=f"{without}.*native code of an earlier build.*--only"):
        build_robot(robot, tmp_path / "out", ["numpy"])
    with pytest.raises(TargetError, match=without) as asked:
        build_robot(robot, tmp_path / "out", ["native"])
    assert "--only" not in str(asked.value)
    assert "model_numpy.py" in build_robot(robot, tmp_path / "out", ["numpy"], only=True).files


def test_c_is_written_and_left_out_of_the_verification(
    without: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    robot = Robot.from_text(ONE_JOINT)
    result = build_robot(robot, tmp_path / "out", ["c", "numpy"], only=True)
    assert result.report is not None
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
    assert found is not None
    assert found[1:] == ("-u", "NOTHING", "cc")
