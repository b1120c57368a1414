"""All files of a robot in memory, and the libraries that a compiler makes of them."""

import json
import shutil
from pathlib import Path

import pytest

from derive.errors import TargetError
from derive.programs.optimise.search_policy import Effort
from derive.publish import manifest, render
from derive.publish.manifest import MANIFEST
from derive.publish.render import library_names
from derive.publish.targets import TARGETS, targets_named
from derive.robot.robot import Robot
from derive.targets.compiler import find_compiler

ARM = "name: two-bars\nconvention: standard\njoints: [{type: revolute, a: a1}, {type: revolute, a: 1/3}]\n"


def test_libraries_are_compiled_while_the_rest_is_rendered_and_the_sheet_comes_last() -> None:
    robot, targets, begun = Robot.from_text(ARM), targets_named(["native", "latex"]), list[dict[str, bytes]]()
    with render.rendering(robot, targets, Effort.QUICK, lambda sources: begun.append(dict(sources))) as (first, whole):
        assert [set(sources) for sources in begun] == [{"model_native.c", "model.c", "model.h"}]
        assert set(json.loads(first.files[MANIFEST])["files"]) == first.files.keys() - {MANIFEST}
        files = whole().files
    assert files.keys() - first.files.keys() == {"sheet.tex"}
    assert begun[0].items() <= first.files.items()
    assert list(files.items()) == list(render.render_robot(robot, targets, Effort.QUICK).files.items())


def test_sources_name_the_files_of_the_whole_build_and_libraries_are_those_of_the_targets() -> None:
    source = render.source_of(Robot.from_text(ARM), targets_named(["c", "readme"], only=True), Effort.QUICK)
    assert source.files == ("MANIFEST.json", "README.md", "__init__.py", "model.c", "model.h")
    assert library_names(TARGETS.values()) == tuple(name for t in TARGETS.values() for name in t.compiled)
    assert library_names(targets_named()) == ()


@pytest.mark.skipif(find_compiler() is None, reason="no C compiler")
def test_a_library_of_the_same_sources_is_not_compiled_again(tmp_path: Path) -> None:
    robot, targets = Robot.from_text(ARM), targets_named(["native"], only=True)
    former, folder, changed = (tmp_path / name for name in ("former", "folder", "changed"))
    former.mkdir()
    for name, data in render.render_robot(robot, targets, Effort.QUICK).files.items():
        (former / name).write_bytes(data)
    shutil.copytree(former, folder)
    shutil.copytree(former, changed)
    (library,) = library_names(targets)
    (former / library).write_bytes(b"compiled before")
    compiler = find_compiler()
    assert compiler is not None
    render.compile_libraries(folder, targets, compiler, former)
    assert (folder / library).read_bytes() == b"compiled before"
    (changed / "model.c").write_text("this is no C\n", encoding="utf-8")
    with pytest.raises(TargetError, match="error"):
        render.compile_libraries(changed, targets, compiler, former)


BROKEN = ("", "[]", "{}", '{"generator": "other", "files": {}}', '{"generator": "derive", "files": []}', "[" * 99999)


@pytest.mark.parametrize("content", BROKEN, ids=range(len(BROKEN)))
def test_foreign_and_broken_manifests_are_none(content: str, tmp_path: Path) -> None:
    (tmp_path / MANIFEST).write_text(content, encoding="utf-8")
    assert manifest.read_manifest(tmp_path) is None


def test_links_and_missing_files_are_no_manifest_and_compiled_files_are_names(tmp_path: Path) -> None:
    assert manifest.read_manifest(tmp_path) is None
    (tmp_path / "elsewhere").write_text(json.dumps({"generator": "derive", "files": {}}), encoding="utf-8")
    (tmp_path / MANIFEST).symlink_to("elsewhere")
    assert manifest.read_manifest(tmp_path) is None
    assert manifest.compiled_files({}) == ()
    assert manifest.compiled_files({"compiled": "libm.so"}) == ()
    assert manifest.compiled_files({"compiled": ["libm.so", 3]}) == ("libm.so",)
