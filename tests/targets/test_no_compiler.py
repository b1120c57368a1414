"""Without a C compiler: C is written but not verified, the native model is refused in one line, nothing is written."""

from pathlib import Path

import pytest

from derive.cli.main import main
from derive.errors import TargetError
from derive.publish import build
from derive.publish.build import build_robot
from derive.robot.robot import Robot
from derive.targets.compiler import find_compiler
from derive.verification.verify import verify

ONE_JOINT = "name: one\nconvention: standard\njoints: [{type: revolute, a: 0.5}]\n"


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
