"""Manifests: what is ours, and whether a folder is still what a build left."""

import json
from pathlib import Path

import pytest

from derive.programs.optimise.search_policy import Effort
from derive.publish import manifest
from derive.publish.build import build_robot
from derive.publish.targets import targets_named
from derive.robot.robot import Robot
from derive.version import __version__

ARM = "name: bar\nconvention: standard\njoints: [{type: revolute, a: a1}]\n"


BROKEN = ("", "[]", "{}", '{"generator": "other", "files": {}}', '{"generator": "derive", "files": []}', "[" * 99999)


@pytest.mark.parametrize("content", BROKEN, ids=range(len(BROKEN)))
def test_foreign_and_broken_manifests_are_none(content: str, tmp_path: Path) -> None:
    (tmp_path / manifest.FILE).write_text(content, encoding="utf-8")
    assert manifest.read_manifest(tmp_path) is None


def test_links_and_missing_files_are_no_manifest(tmp_path: Path) -> None:
    assert manifest.read_manifest(tmp_path) is None
    (tmp_path / "elsewhere").write_text(json.dumps({"generator": "derive", "files": {}}), encoding="utf-8")
    (tmp_path / manifest.FILE).symlink_to("elsewhere")
    assert manifest.read_manifest(tmp_path) is None


def test_compiled_files_are_names_whatever_the_manifest_holds() -> None:
    assert manifest.compiled_files({}) == ()
    assert manifest.compiled_files({"compiled": "libm.so"}) == ()
    assert manifest.compiled_files({"compiled": ["libm.so", 3]}) == ("libm.so",)


def test_a_folder_is_current_until_anything_differs(tmp_path: Path) -> None:
    robot, targets = Robot.from_text(ARM), targets_named(["c"], only=True)
    folder = build_robot(robot, tmp_path, ["c"], only=True, verified=False, effort=Effort.QUICK).folder
    right = (robot.digest, __version__, targets, Effort.QUICK)
    assert manifest.is_current(folder, *right)
    assert not manifest.is_current(folder, "0" * 64, *right[1:])
    assert not manifest.is_current(folder, right[0], "0", *right[2:])
    assert not manifest.is_current(folder, *right[:2], targets_named(["numpy"], only=True), Effort.QUICK)
    assert not manifest.is_current(folder, *right[:3], Effort.FULL)
    (folder / "model.c").write_text("touched", encoding="utf-8")
    assert not manifest.is_current(folder, *right)
