"""Building a robot: what is written, when nothing is, and what a check finds."""

import hashlib
import json
import os
from contextlib import AbstractContextManager
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import pytest

import derive
from derive.errors import OutputError, TargetError, VerificationError
from derive.programs.optimise.search_policy import Effort
from derive.publish import build
from derive.publish.build import (
    BuildFailure,
    BuildResult,
    CheckResult,
    build_robot,
    check_robot,
    folder_of,
    for_each,
    require_distinct,
)
from derive.publish.targets import targets_named
from derive.robot.robot import Robot
from derive.targets.compiler import find_compiler
from derive.targets.target import Target
from tests.cli.command import contents

ALL_FILES = {name for target in targets_named() for name in target.files} | {"MANIFEST.json", "__init__.py"}
quickly = partial(build_robot, verified=False, effort=Effort.QUICK)
ARM = """\
name: two-bars
title: Two bars
convention: standard
joints: [{type: revolute, a: a1, limits: [-pi, pi]}, {type: prismatic, alpha: pi/2}]
gravity: [0, -g, 0]
links:
  - {mass: m1, com: [l1, 0, 0], inertia: {zz: I1}, friction: {viscous: b1, coulomb: f1}}
  - {mass: 2.5, motor: {mass: 0.1, inertia: Im2, ratio: 50}}
parameters: {a1: 0.5, Im2: 1e-4}
"""


@pytest.fixture
def arm() -> Robot:
    return Robot.from_text(ARM)


def test_a_build_writes_every_target_verified(arm: Robot, tmp_path: Path) -> None:
    result = build_robot(arm, tmp_path)
    found = contents(tmp_path / "two_bars")
    assert result.folder == folder_of(arm, tmp_path) == tmp_path / "two_bars"
    assert set(found) == set(result.files)
    assert set(found) == ALL_FILES
    assert result.report.worst < 1e-9
    assert {row.target for row in result.report.rows} == {"numpy", "casadi"} | ({"c"} if find_compiler() else set())


def test_the_manifest_tells_what_the_folder_is(arm: Robot, tmp_path: Path) -> None:
    found = contents(quickly(arm, tmp_path).folder)
    text = found.pop("MANIFEST.json").decode()
    manifest = json.loads(text)
    assert text == json.dumps(manifest, indent=2, sort_keys=True) + "\n"
    assert manifest["robot"] == "two-bars"
    assert manifest["robot_file_sha256"] == hashlib.sha256(ARM.encode()).hexdigest()
    assert manifest["version"] == derive.__version__
    assert manifest["targets"] == [target.name for target in targets_named()]
    assert manifest["dof"] == 2
    assert manifest["parameters"]["free"] == ["g", "m1", "l1", "I1", "b1", "f1"]
    assert manifest["files"] == {name: hashlib.sha256(data).hexdigest() for name, data in found.items()}
    assert set(manifest["operations"]["inverse_dynamics"]) == {"mul", "add", "div", "sin", "cos", "sqrt"}


def test_what_has_not_changed_is_not_built_again(arm: Robot, tmp_path: Path) -> None:
    assert not quickly(arm, tmp_path).unchanged
    again = quickly(arm, tmp_path)
    assert again.unchanged
    assert set(again.files) == set(contents(again.folder))
    assert not quickly(arm, tmp_path, force=True).unchanged
    assert not quickly(replace(arm, digest="0" * 64), tmp_path).unchanged
    assert not quickly(arm, tmp_path, effort=Effort.FULL).unchanged
    assert not quickly(arm, tmp_path, ["javascript"]).unchanged
    assert quickly(arm, tmp_path, ["javascript"]).unchanged
    assert not quickly(arm, tmp_path, ["numpy"], only=True).unchanged
    assert set(contents(again.folder)) == {"MANIFEST.json", "__init__.py", "model_numpy.py"}
    assert not quickly(arm, tmp_path).unchanged
    (again.folder / "sheet.tex").write_text("edited")
    assert not quickly(arm, tmp_path).unchanged
    (again.folder / "sheet.tex").unlink()
    assert not quickly(arm, tmp_path).unchanged
    assert check_robot(arm, tmp_path, effort=Effort.QUICK).is_current


def test_a_folder_of_another_version_is_stale_and_renewed(arm: Robot, tmp_path: Path) -> None:
    manifest = quickly(arm, tmp_path, ["numpy"], only=True).folder / "MANIFEST.json"
    written = manifest.read_text()
    manifest.write_text(written.replace(f'"version": "{derive.__version__}"', '"version": "0.0.1"'))
    assert check_robot(arm, tmp_path, ["numpy"], Effort.QUICK, only=True).stale == ("MANIFEST.json",)
    assert not quickly(arm, tmp_path, ["numpy"], only=True).unchanged
    assert manifest.read_text() == written
    assert quickly(arm, tmp_path, ["numpy"], only=True).unchanged


def test_one_build_adds_to_another_and_renews_what_it_finds(arm: Robot, tmp_path: Path) -> None:
    """Whatever is built in whatever order, the folder is that of one build of everything."""
    checked = partial(check_robot, effort=Effort.QUICK)
    quickly(arm, tmp_path, ["numpy"], only=True)
    assert "model.h" in checked(arm, tmp_path).missing
    added = quickly(arm, tmp_path, ["javascript"])
    assert set(added.files) == {*ALL_FILES, "model.mjs"}
    assert set(added.files) == set(contents(added.folder))
    assert checked(arm, tmp_path, ["numpy"]).is_current
    assert checked(arm, tmp_path, ["numpy", "javascript"], only=True).extra
    assert checked(arm, tmp_path, [t.name for t in targets_named()], only=True).extra == ("model.mjs",)
    changed = replace(arm, title="Another title", digest="1" * 64)
    assert "model.mjs" in checked(changed, tmp_path, ["readme"]).stale
    quickly(changed, tmp_path)
    at_once = quickly(changed, tmp_path / "at once", ["javascript"])
    assert contents(added.folder) == contents(at_once.folder)


def test_a_package_is_a_folder_of_the_build_and_keeps_what_is_the_users(arm: Robot, tmp_path: Path) -> None:
    """Its files come and go as all others do; a file of the user's in it stays, and is never replaced."""
    folder = quickly(arm, tmp_path, ["octave"], only=True).folder
    package = folder / "+two_bars"
    assert (package / "jacobian.m").is_file()
    assert quickly(arm, tmp_path, ["octave"], only=True).unchanged
    (package / "mine.m").write_text("% mine")
    (package / "jacobian.m").write_text("% edited")
    assert check_robot(arm, tmp_path, ["octave"], Effort.QUICK, only=True).stale == ("+two_bars/jacobian.m",)
    assert (
        "% edited"
        not in (quickly(arm, tmp_path, ["octave"], only=True).folder / "+two_bars" / "jacobian.m").read_text()
    )
    quickly(arm, tmp_path, ["numpy"], only=True)
    assert [path.name for path in package.iterdir()] == ["mine.m"]
    (package / "jacobian.m").write_text("% mine")
    with pytest.raises(OutputError, match=r"\+two_bars"):
        quickly(arm, tmp_path, ["octave"])
    assert (package / "jacobian.m").read_text() == "% mine"


def test_a_build_that_is_overtaken_by_one_of_other_targets_keeps_what_that_has_added(
    arm: Robot, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    render, seen = build.rendering, list[tuple[str, ...]]()

    def slow(robot: Robot, targets: tuple[Target, ...], *further: Any) -> AbstractContextManager[Any]:
        seen.append(tuple(target.name for target in targets))
        if len(seen) == 1:
            quickly(arm, tmp_path, ["javascript"])
        return render(robot, targets, *further)

    monkeypatch.setattr(build, "rendering", slow)
    result = quickly(arm, tmp_path, ["casadi-c"])
    asked = (["casadi-c"], ["javascript"], ["casadi-c", "javascript"])
    assert seen == [tuple(target.name for target in targets_named(names)) for names in asked]
    assert set(contents(result.folder)) == {*ALL_FILES, "model.mjs", "model_casadi.c", "model_casadi.h"}
    assert os.listdir(tmp_path) == ["two_bars"]


def test_a_check_lists_every_difference_and_writes_nothing(arm: Robot, tmp_path: Path) -> None:
    checked = partial(check_robot, arm, tmp_path, effort=Effort.QUICK)
    empty = checked()
    assert set(empty.missing) == ALL_FILES
    assert not list(tmp_path.iterdir())
    quickly(arm, tmp_path)
    assert checked().is_current
    folder = tmp_path / "two_bars"
    (folder / "model_numpy.py").write_text("edited")
    (folder / "README.md").unlink()
    (folder / "mine.txt").write_text("")
    before = contents(folder)
    found = checked(["numpy", "readme"], only=True)
    assert found.stale == ("MANIFEST.json", "model_numpy.py")
    assert found.missing == ("README.md",)
    assert found.extra == ("model.c", "model.h", "model_casadi.py", "sheet.tex")
    assert contents(folder) == before


def test_a_failed_verification_keeps_the_old_folder(
    arm: Robot, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    quickly(arm, tmp_path)
    before = contents(tmp_path / "two_bars")

    def wrong(robot: Robot, folder: Path, **options: object) -> None:
        assert (folder / "model_numpy.py").is_file()
        raise VerificationError("wrong by 1e-3")

    monkeypatch.setattr(build, "verify", wrong)
    with pytest.raises(VerificationError):
        build_robot(replace(arm, title="Another title"), tmp_path, force=True, effort=Effort.QUICK)
    assert contents(tmp_path / "two_bars") == before
    assert os.listdir(tmp_path) == ["two_bars"]


def test_unknown_targets_are_refused_before_anything_is_written(arm: Robot, tmp_path: Path) -> None:
    with pytest.raises(TargetError, match="numpy, casadi, casadi-c, c, native, javascript, octave, latex, readme"):
        build_robot(arm, tmp_path / "out", ["fortran"])
    with pytest.raises(TargetError):
        build_robot(arm, tmp_path / "out", [])
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("jobs", [pytest.param(1, marks=pytest.mark.sweep), 2])
def test_one_failure_does_not_stop_the_rest_and_order_is_kept(arm: Robot, tmp_path: Path, jobs: int) -> None:
    names = ["arm-a", "arm-b", "arm-c"]
    robots = [replace(arm, name=name) for name in names]
    (tmp_path / "arm_b").mkdir()
    (tmp_path / "arm_b" / "thesis.txt").write_text("")
    told: list[tuple[str, str]] = []
    options: dict[str, Any] = {"out": tmp_path, "targets": ["numpy"], "only": True, "effort": Effort.QUICK}
    results = for_each(partial(build_robot, **options), robots, jobs, lambda *event: told.append(event))
    assert [result.robot for result in results] == names
    assert [type(result) for result in results] == [BuildResult, BuildFailure, BuildResult]
    failure = results[1]
    assert isinstance(failure.error, OutputError)
    assert "arm_b" in str(failure.error)
    assert ("arm-b", "failed") in told
    assert {("arm-a", "done"), ("arm-c", "done")} <= set(told)
    checks = for_each(partial(check_robot, **options), robots, 1)
    assert [isinstance(check, CheckResult) and check.is_current for check in checks] == [True, False, True]


def test_two_robots_of_one_name_are_refused(arm: Robot) -> None:
    with pytest.raises(OutputError, match="same name"):
        require_distinct([arm, replace(arm, digest="0" * 64)])
