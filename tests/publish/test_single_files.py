"""Single files: nobody's is overwritten unasked, all are written or none, and devices are written to."""

import errno
import os
from collections.abc import Callable, Sequence
from itertools import product
from pathlib import Path

import pytest

from derive.errors import DeriveError, OutputError
from derive.publish import atomic_folder
from derive.publish.atomic_folder import ending_of, refuse_taken, write_files

NEW = b"new"


def no_links(*_: object) -> None:
    raise OSError(errno.EPERM, "no links here")


def _put(path: Path, data: bytes) -> None:
    path.write_bytes(data)


STATES: dict[str, tuple[Callable[[Path], None], bool, bool]] = {
    "nothing": (lambda path: None, True, True),
    "file": (lambda path: _put(path, b"mine"), False, True),
    "empty": (lambda path: _put(path, b""), False, True),
    "folder": (Path.mkdir, False, False),
    "link": (lambda path: _put(path.with_name("elsewhere"), b"theirs") or path.symlink_to("elsewhere"), False, False),
    "dangling link": (lambda path: path.symlink_to("nowhere"), False, False),
}
"""What stands there, and whether it may be written without and with force."""


def contents(folder: Path) -> dict[str, object]:
    def of(path: Path) -> object:
        return os.readlink(path) if path.is_symlink() else path.is_file() and path.read_bytes()

    return {str(path.relative_to(folder)): of(path) for path in folder.rglob("*")}


@pytest.mark.parametrize(("first", "second"), [*product(STATES, STATES)])
@pytest.mark.parametrize("force", [False, True])
def test_all_are_written_or_nothing_is_touched(first: str, second: str, force: bool, tmp_path: Path) -> None:
    paths = [tmp_path / "one.txt", tmp_path / "deep" / "two.txt"]
    paths[1].parent.mkdir()
    for path, state in zip(paths, (first, second), strict=True):
        STATES[state][0](path)
    before = contents(tmp_path)
    if all(STATES[state][1 + force] for state in (first, second)):
        assert write_files(dict.fromkeys(paths, NEW), force=force) == paths
        assert contents(tmp_path) == {**before, "one.txt": NEW, "deep/two.txt": NEW}
        return
    for refused in (
        lambda: refuse_taken(paths, force=force),
        lambda: write_files(dict.fromkeys(paths, NEW), force=force),
    ):
        with pytest.raises(OutputError) as error:
            refused()
        assert ("--force" in str(error.value)) == ("exists already" in str(error.value))
        assert contents(tmp_path) == before


@pytest.mark.parametrize("links", [True, False], ids=["links", "no links"])
def test_a_name_that_is_taken_meanwhile_stays_with_who_took_it(
    links: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The other one is quicker between the check and the writing; what was placed before is taken back."""
    one, two = tmp_path / "one", tmp_path / "two"
    usual = atomic_folder._write_new

    def slow(path: Path, data: bytes) -> None:
        usual(path, data)
        two.write_bytes(b"theirs")

    monkeypatch.setattr(atomic_folder, "_write_new", slow)
    if not links:
        monkeypatch.setattr(os, "link", no_links)
    with pytest.raises(OutputError, match="two exists already"):
        write_files({one: NEW, two: NEW})
    assert contents(tmp_path) == {"two": b"theirs"}


def test_where_files_have_one_name_they_are_written_too(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "link", no_links)
    write_files({tmp_path / "one": NEW})
    assert contents(tmp_path) == {"one": NEW}


def test_devices_and_pipes_are_written_to_and_stay_what_they_are(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    try:
        write_files({pipe: NEW, Path("/dev/null"): NEW, tmp_path / "file": NEW})
        assert os.read(reader, 9) == NEW
    finally:
        os.close(reader)
    assert pipe.is_fifo()
    assert Path("/dev/null").is_char_device()
    assert (tmp_path / "file").read_bytes() == NEW


def test_a_device_that_refuses_leaves_no_file(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="cannot write /dev/full: "):
        write_files({tmp_path / "file": NEW, Path("/dev/full"): NEW})
    assert contents(tmp_path) == {}


def test_folders_are_made_and_a_file_is_none(tmp_path: Path) -> None:
    write_files({tmp_path / "a" / "b" / "file": NEW})
    with pytest.raises(OutputError, match="file is not a folder"):
        refuse_taken([tmp_path / "a" / "b" / "file" / "c" / "d"], force=True)
    assert contents(tmp_path)["a/b/file"] == NEW


@pytest.mark.parametrize(
    ("path", "allowed", "ending"),
    [
        ("a.SVG", (".pdf", ".svg"), ".svg"),
        ("/dev/null", (".pdf", ".svg"), ".pdf"),
        ("a.b", (), ".b"),
        ("/dev/null", (), ""),
    ],
)
def test_the_form_is_the_ending_and_of_a_device_the_first(path: str, allowed: Sequence[str], ending: str) -> None:
    assert ending_of(Path(path), allowed) == ending


@pytest.mark.parametrize("name", ["a.png", "svg", "-", "a.svg.gz"])
def test_another_ending_is_refused(name: str) -> None:
    with pytest.raises(DeriveError, match=r"ending of another kind of file; allowed: \.pdf, \.svg"):
        ending_of(Path(name), (".pdf", ".svg"))
