"""Manifests: what is ours, and whether a folder is still what a build left."""

import json
from pathlib import Path

import pytest

from derive.publish import manifest

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
