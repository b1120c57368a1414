"""Publishing: what is replaced, what is kept, what is refused, and what is left behind when something fails."""

import errno
import json
import multiprocessing
import os
from contextlib import suppress
from pathlib import Path

import pytest

from derive.errors import DeriveError, OutputError
from derive.publish import atomic_folder
from derive.publish.atomic_folder import heal, locked, publish
from tests.cli.command import contents


def files(mark: str, *extra: str) -> dict[str, bytes]:
    names = ("a.py", *extra)
    manifest = {"generator": "derive", "robot": "arm", "files": dict.fromkeys(names, "")}
    return {**{name: mark.encode() for name in names}, "MANIFEST.json": json.dumps(manifest).encode()}


def put(target: Path, mark: str, *extra: str) -> None:
    publish(files(mark, *extra), target, "arm", lambda folder: None)


@pytest.fixture
def target(tmp_path: Path) -> Path:
    return tmp_path / "generated" / "arm"


@pytest.fixture(params=["exchange", "two renames"], autouse=True)
def way(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> str:
    """Every test with and without an atomic exchange of folders."""
    if request.param == "two renames":
        monkeypatch.setattr(atomic_folder, "exchange", lambda one, other: False)
    return str(request.param)


def alone(target: Path) -> bool:
    return os.listdir(target.parent) == [target.name]


def test_an_empty_folder_is_taken_and_files_of_the_old_build_go_with_their_caches(target: Path) -> None:
    """A cache could outlive the module it was made from."""
    target.mkdir(parents=True)
    put(target, "1", "b.py")
    assert contents(target) == files("1", "b.py")
    (target / "__pycache__").mkdir()
    (target / "__pycache__" / "a.pyc").write_bytes(b"")
    put(target, "2")
    assert contents(target) == files("2")
    assert not (target / "__pycache__").exists()
    assert alone(target)


def test_files_of_the_user_stay(target: Path) -> None:
    put(target, "1")
    (target / "sheet.pdf").write_bytes(b"mine")
    (target / "plots" / "deep").mkdir(parents=True)
    (target / "plots" / "deep" / "p.svg").write_text("mine")
    (target / "link").symlink_to("nowhere")
    put(target, "2")
    assert (target / "a.py").read_bytes() == b"2"
    assert (target / "sheet.pdf").read_bytes() == b"mine"
    assert (target / "plots" / "deep" / "p.svg").read_text() == "mine"
    assert os.readlink(target / "link") == "nowhere"
    assert alone(target)


def test_the_check_sees_the_finished_folder_and_may_stop_the_build(target: Path) -> None:
    put(target, "1")

    def check(folder: Path) -> None:
        assert contents(folder) == files("2")
        raise DeriveError("wrong")

    with pytest.raises(DeriveError, match="wrong"):
        publish(files("2"), target, "arm", check)
    assert contents(target) == files("1")
    assert alone(target)


@pytest.mark.parametrize("error", [errno.ENOSPC, errno.EIO, errno.EDQUOT])
@pytest.mark.parametrize("nth", range(3))
def test_a_full_disk_leaves_the_old_folder(target: Path, monkeypatch: pytest.MonkeyPatch, error: int, nth: int) -> None:
    """Whichever file it is that has no room, and be it half written."""
    put(target, "1")
    real, count = atomic_folder._write_new, iter(range(1000))

    def full(path: Path, data: bytes) -> None:
        if next(count) == nth:
            real(path, data[: len(data) // 2])
            raise OSError(error, os.strerror(error))
        real(path, data)

    monkeypatch.setattr(atomic_folder, "_write_new", full)
    with suppress(OutputError):
        put(target, "2")
    monkeypatch.undo()
    assert contents(target) == files("1" if nth < len(files("2")) else "2")
    assert alone(target)


def test_folders_of_others_are_refused(target: Path) -> None:
    target.mkdir(parents=True)
    (target / "thesis.txt").write_text("two years of work")
    for manifest in (None, "[]", "{", '{"files": {}}', '{"generator": "derive", "files": {}, "robot": "leg"}'):
        if manifest is not None:
            (target / "MANIFEST.json").write_text(manifest)
        with pytest.raises(OutputError):
            put(target, "1")
        assert (target / "thesis.txt").read_text() == "two years of work"
    assert alone(target)


def test_links_and_files_in_the_place_of_the_folder_or_of_its_parent_are_refused(target: Path, tmp_path: Path) -> None:
    elsewhere = tmp_path / "elsewhere"
    put(elsewhere, "1")
    target.parent.mkdir()
    target.symlink_to(elsewhere)
    with pytest.raises(OutputError, match="symbolic link"):
        put(target, "2")
    assert contents(elsewhere) == files("1")
    target.unlink()
    target.write_text("a file")
    with pytest.raises(OutputError, match="not a folder"):
        put(target, "2")
    with pytest.raises(OutputError):
        put(target / "arm", "2")
    assert target.read_text() == "a file"


def test_a_file_of_the_user_under_a_name_to_be_written_is_refused(target: Path) -> None:
    put(target, "1")
    (target / "b.py").write_text("mine")
    with pytest.raises(OutputError, match=r"b\.py"):
        put(target, "2", "b.py")
    assert (target / "b.py").read_text() == "mine"
    assert alone(target)


def test_temporary_folders_of_the_dead_are_removed_and_those_of_the_living_stay(target: Path) -> None:
    """A lock tells them apart; only our own kind of name is touched."""
    put(target, "1")
    dead, living, other = (
        target.parent / name for name in (".derive-arm-00000000", ".derive-arm-11111111", ".derived-arm-00000000")
    )
    for folder in (dead, living, other):
        folder.mkdir()
        (folder / "a.py").write_text("")
    link = target.parent / ".derive-arm-22222222"
    link.symlink_to(other)
    with locked(living):
        put(target, "2")
    assert not dead.exists()
    assert living.exists()
    assert other.exists()
    assert link.is_symlink()
    assert (other / "a.py").exists()


def test_a_folder_left_between_two_renames_is_put_back(target: Path) -> None:
    put(target, "1")
    backup = target.with_name(".derive-arm.old")
    target.rename(backup)
    heal(target.parent)
    assert contents(target) == files("1")
    put(backup, "0")
    heal(target.parent)
    assert contents(target) == files("1")
    assert alone(target)


def _publish_often(target: Path, mark: str) -> None:
    for _ in range(20):
        put(target, mark, f"{mark}.py")


def test_builds_at_once_leave_one_whole_folder(target: Path) -> None:
    context = multiprocessing.get_context("spawn")
    processes = [context.Process(target=_publish_often, args=(target, mark)) for mark in "123"]
    whole = [files(mark, f"{mark}.py") for mark in "123"]
    for process in processes:
        process.start()
    while any(process.is_alive() for process in processes):
        if target.parent.exists():  # before that nothing can be locked, and so nothing be looked at
            with locked(target.parent):
                assert not target.exists() or contents(target) in whole
    for process in processes:
        process.join()
        assert process.exitcode == 0
    assert contents(target) in whole
    assert alone(target)
