"""No command overwrites a file without ``--force``: a property over all commands, and all options that write."""

import importlib
import shlex
from pathlib import Path

import pytest

from derive.cli.main import COMMANDS, whole_parser
from derive.cli.terminal import file_or_stdout
from derive.motion.motion import Motion
from tests.cli.command import PENDULUM, accepted, contents, derive, refused

URDF = """\
<robot name="arm"><link name="a"/><link name="b"/>
<joint name="j" type="continuous"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/></joint></robot>
"""
NOTES = """\
robot: {name: p, convention: standard, joints: [{type: revolute, a: a1}]}
expected:
  - {quantity: p, entries: {"1": a1*c1}, status: ok}
"""
HANDOUT = "derive.api.handout.handout_files"
MOVE = "derive.motion.motion.Motion.load"
PRINTOUT = "derive.checking.files.formula_printout"
FORMULA = "--quantity 'p[1]' --expression 'a1*c1'"

WRITING = {
    ("plot", "out"): ("plot arm.yaml -o a.svg", "a.svg", "derive.api.plot.load"),
    ("plot --workspace", "out"): ("plot arm.yaml --workspace -o w.png", "w.png", "derive.api.plot.find_workspace"),
    ("move", "csv"): ("move scara-pick-and-place --csv a.csv", "a.csv", MOVE),
    ("move", "plot"): ("move scara-pick-and-place --plot a.pdf", "a.pdf", MOVE),
    ("move", "html"): ("move scara-pick-and-place --html a.html", "a.html", MOVE),
    ("move", "part"): ("move scara-pick-and-place --part a.tex", "a.tex", MOVE),
    ("move", "gif"): ("move scara-pick-and-place --gif a.gif", "a.gif", MOVE),
    ("move", "mp4"): ("move scara-pick-and-place --mp4 a.mp4", "a.mp4", ""),
    ("move", "out"): ("move scara-pick-and-place --out code", "code/motion.c", MOVE),
    ("handout", "out"): ("handout arm.yaml -o sheets", "sheets/pendulum.tex", HANDOUT),
    ("handout --pdf", "out"): ("handout arm.yaml --pdf", "pendulum.pdf", HANDOUT),
    ("handout --exercise", "out"): ("handout arm.yaml --exercise", "pendulum-solutions.tex", HANDOUT),
    ("handout --fragment", "out"): ("handout arm.yaml --fragment B -o b.tex", "b.tex", "derive.api.handout.fragment"),
    ("check", "out"): ("check notes.yaml -o r.md", "r.md", "derive.checking.files.file_printout"),
    ("check FORMULA", "out"): (f"check arm.yaml {FORMULA} -o r.md", "r.md", PRINTOUT),
    ("check --report", "out"): ("check notes.yaml --report r.md", "r.md", "derive.checking.files.file_printout"),
    ("import", "out"): ("import arm.urdf -o b.yaml", "b.yaml", "derive.api.importing.import_urdf"),
    ("import --all", "out"): ("import arm.urdf --all -o arms", "arms/arm-b.yaml", ""),
    ("excite", "out"): ("excite arm.yaml -o e.yaml", "e.yaml", "derive.api.excite.load"),
    ("map", "plot"): ("map arm.yaml -o reach.zarr --plot a.png", "a.png", "derive.api.map.load"),
    ("identify", "out"): ("identify arm.yaml log.csv -o b.yaml", "b.yaml", "derive.api.identify.load"),
    ("identify", "report"): ("identify arm.yaml log.csv --report a.html", "a.html", "derive.api.identify.load"),
    ("export", "out"): ("export kuka-kr5 --format csv -o a.csv", "a.csv", "derive.api.convert.exported"),
    ("convert", "out"): ("convert arm.yaml -o m.yaml", "m.yaml", "derive.api.convert.converted"),
    ("new", "name"): ("new arm", "arm.yaml", ""),
}
"""By command and destination: what is typed, a file that it writes, and what must not run when the file is there."""

NOT_OVERWRITTEN = {("build", "out"), ("verify", "out"), ("handout", "style_from"), ("map", "out")}
"""A build's folder is the manifest's matter (tests/publish), a store goes on (tests/sampling), the rest is read."""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name, text in {"arm.yaml": PENDULUM, "arm.urdf": URDF, "notes.yaml": NOTES}.items():
        (tmp_path / name).write_text(text)
    return tmp_path


def test_every_option_that_takes_a_path_is_tried_here() -> None:
    parsers = dict(zip(COMMANDS, whole_parser()[1], strict=True))
    taking = {(n, a.dest) for n, p in parsers.items() for a in p._actions if a.type in (Path, file_or_stdout)}
    assert taking - NOT_OVERWRITTEN == {(name.split()[0], dest) for name, dest in WRITING} - {("new", "name")}


@pytest.mark.parametrize("option", [(), ("--json",)], ids=["text", "json"])
@pytest.mark.parametrize(("typed", "file", "work"), WRITING.values(), ids=map(" ".join, WRITING))
def test_a_file_that_exists_stays_and_nothing_is_computed_or_written(
    typed: str, file: str, work: str, option: tuple[str, ...], folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    if "json" in "".join(option) and "--fragment" in typed:
        pytest.skip("a fragment has no report")
    (folder / file).parent.mkdir(exist_ok=True)
    (folder / file).write_text("mine")
    before = contents(folder)
    if work:
        place, _, name = work.rpartition(".")
        owner = Motion if place.endswith("Motion") else importlib.import_module(place)
        monkeypatch.setattr(owner, name, lambda *_, **__: pytest.fail("computed first"))
    if "--mp4" in typed:
        monkeypatch.setattr("derive.motion.output.film.ffmpeg", lambda: "ffmpeg")
    done = refused(*shlex.split(typed), *option, folder=folder)
    assert f"{file} exists already" in done.stderr
    assert "--force" in done.stderr
    assert contents(folder) == before


@pytest.mark.parametrize(("typed", "file", "work"), WRITING.values(), ids=map(" ".join, WRITING))
def test_a_link_and_a_folder_in_the_way_are_refused_even_with_force(
    typed: str, file: str, work: str, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("derive.motion.output.film.ffmpeg", lambda: "ffmpeg")
    path = folder / file
    path.parent.mkdir(exist_ok=True)
    for remark, place in (("is a folder", path.mkdir), ("is a symbolic link", lambda: path.symlink_to("elsewhere"))):
        if path.exists():
            path.rmdir() if path.is_dir() else path.unlink()
        place()
        assert remark in refused(*shlex.split(typed), "--force", folder=folder).stderr
        assert not (folder / "elsewhere").exists()


CHEAP = ["move csv", "handout out", "handout --fragment out", "check out", "import out", "export out", "convert out"]


@pytest.mark.parametrize("case", [*CHEAP, "import --all out", "new name", "move out"])
def test_force_overwrites(case: str, folder: Path) -> None:
    typed, file, _ = {" ".join(key): value for key, value in WRITING.items()}[case]
    (folder / file).parent.mkdir(exist_ok=True)
    (folder / file).write_text("mine")
    accepted(*shlex.split(typed), "--force", folder=folder)
    assert (folder / file).read_text() != "mine"


def test_where_one_of_several_files_is_there_none_is_written(folder: Path) -> None:
    (folder / "code").mkdir()
    (folder / "code" / "motion.h").write_text("mine")
    typed = "move scara-pick-and-place --csv a.csv --html a.html --out code"
    before = contents(folder)
    assert "code/motion.h exists already" in refused(*typed.split(), folder=folder).stderr
    assert contents(folder) == before


STREAMS = [
    "export arm.yaml --format csv --values a1=1,m1=1,l1=1,I1=1,g=9.81",
    "convert arm.yaml",
    "import arm.urdf",
    "handout arm.yaml --fragment B",
]


FIGURES = ["plot arm.yaml -o", "move scara-pick-and-place --plot", "move scara-pick-and-place --html"]


@pytest.mark.parametrize("typed", FIGURES)
@pytest.mark.first(1)
def test_the_null_device_is_free_for_figures_too(typed: str, folder: Path) -> None:
    pytest.importorskip("matplotlib")
    before = contents(folder)
    for _ in range(2):
        assert derive(*typed.split(), "/dev/null", folder=folder).status == 0
    assert contents(folder) == before


@pytest.mark.parametrize("typed", [*STREAMS, "check notes.yaml"])
def test_standard_output_and_the_null_device_are_always_free(typed: str, folder: Path) -> None:
    before = contents(folder)
    printed = accepted(*typed.split(), "-o", "-", folder=folder)
    assert printed.stdout
    if typed in STREAMS:
        assert printed.stdout == derive(*typed.split(), folder=folder).stdout
    for _ in range(2):
        assert derive(*typed.split(), "-o", "/dev/null", folder=folder).status == 0
    assert contents(folder) == before


def test_nothing_is_derived_for_a_folder_of_somebody_else(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (folder / "out" / "pendulum").mkdir(parents=True)
    (folder / "out" / "pendulum" / "notes.txt").write_text("mine")
    before = contents(folder)
    monkeypatch.setattr("derive.publish.build.render_robot", lambda *_: pytest.fail("derived first"))
    for out, remark in (("out", "no MANIFEST.json of derive"), ("arm.yaml", "arm.yaml is not a folder")):
        assert remark in refused("build", "arm.yaml", "-o", out, "--force", folder=folder).stderr
    assert contents(folder) == before
