"""Remarks reach whoever runs a command: on standard error, in JSON, as errors with ``--strict``, as warnings."""

import json
from pathlib import Path
from textwrap import indent

import pytest

import derive as package
from tests.cli.command import accepted, derive

SLIP = "name: slip\nconvention: standard\njoints:\n  - {type: revolute, a: 1, alpha: 90}\n"
WORDS = "slip.yaml:4:35: joints row 1, alpha: 90 rad is more than a turn"
COMMANDS = [
    ("show", "slip.yaml", "T"),
    ("show", "slip.yaml"),
    ("plot", "slip.yaml", "-o", "slip.svg"),
    ("handout", "slip.yaml", "--tex"),
    ("handout", "slip.yaml", "--fragment", "T"),
    ("build", "slip.yaml", "--target", "numpy", "--effort", "quick"),
    ("check", "slip.yaml", "--quantity", "p[1]", "--expression", "c1"),
    ("new", "copy", "--from", "slip.yaml"),
]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "slip.yaml").write_text(SLIP)
    return tmp_path


@pytest.mark.parametrize("command", COMMANDS, ids=" ".join)
def test_a_remark_is_told_once_and_with_strict_an_error_before_all_else(command: tuple[str, ...], folder: Path) -> None:
    strict = derive(*command, "--strict", folder=folder)
    assert (strict.status, strict.stdout) == (2, "")
    assert strict.stderr.startswith(f"derive: error: {WORDS}")
    assert [path.name for path in folder.iterdir()] == ["slip.yaml"]
    done = accepted(*command, folder=folder)
    assert done.stderr.count(f"derive: warning: {WORDS}") == 1
    assert "remark" not in done.stdout


def test_a_plan_tells_the_remarks_of_its_robot_and_strict_writes_nothing(folder: Path) -> None:
    (folder / "plan.yaml").write_text("robot: slip.yaml\npoints: {a: [0], b: [1]}\npath: [a, {to: b, time: 1}]\n")
    refused = derive("move", "plan.yaml", "--csv", "run.csv", "--strict", folder=folder)
    assert (refused.status, refused.stdout, (folder / "run.csv").exists()) == (2, "", False)
    done = derive("move", "plan.yaml", "--csv", "run.csv", folder=folder)
    assert (done.status, (folder / "run.csv").exists()) == (0, True)
    assert done.stderr.count(f"derive: warning: {WORDS}") == done.stderr.count("\n") == 1
    assert "remark" not in done.stdout


def test_a_plan_is_told_of_bodies_that_do_not_exist_as_its_robot_is_and_a_built_in_one_not(tmp_path: Path) -> None:
    done = derive("move", "scara-pick-and-place", "--strict", folder=tmp_path)
    assert (done.status, done.stderr) == (0, "")
    path = "[a, {to: a, time: 1, payload: {mass: 1, inertia: [1, 1, 3]}}]"
    (tmp_path / "plan.yaml").write_text(f"robot: scara-matlab\npoints: {{a: [0, 0, 1, 0]}}\npath: {path}\n")
    done = derive("move", "plan.yaml", folder=tmp_path)
    assert (done.status, done.stderr.count("physically inconsistent")) == (0, 2)
    assert "path entry 2, payload, inertia: physically inconsistent: one principal moment exceeds" in done.stderr
    assert derive("move", "plan.yaml", "--strict", folder=tmp_path).status == 2


def test_json_carries_it(folder: Path) -> None:
    (folder / "notes.yaml").write_text(f"robot:\n{indent(SLIP, '  ')}expected: []\n")
    shown = json.loads(derive("show", "slip.yaml", "T", "--format", "json", folder=folder).stdout)
    (built,) = json.loads(derive("build", "slip.yaml", "--target", "numpy", "--json", folder=folder).stdout)
    verified = json.loads(derive("verify", "slip.yaml", "--json", folder=folder).stdout)
    sheet = json.loads(derive("handout", "slip.yaml", "--json", folder=folder).stdout)
    (checked,) = json.loads(derive("check", "notes.yaml", "--json", folder=folder).stdout)
    for report in (shown, built, verified, sheet, checked):
        (remark,) = report["remarks"]
        assert remark["found"] == "joints row 1, alpha: 90 rad is more than a turn"
    assert json.loads(derive("show", "thumb", "T", "--format", "json", folder=folder).stdout)["remarks"] == []


def test_python_warns_and_keeps_it(folder: Path) -> None:
    with pytest.warns(package.RobotFileWarning, match="90 rad is more than a turn"):
        robot = package.load(folder / "slip.yaml")
    assert len(robot.remarks) == 1


def test_degrees_that_are_typed_are_remarked_on_like_those_of_a_file(tmp_path: Path) -> None:
    words = "derive: warning: value '90' of q1 is more than two turns in radians; if degrees are meant write pi/2\n"
    for typed in ("show scara-perugia p --at 90,0,0,0", "plot scara-perugia -q 90,0,0,0 -o a.svg"):
        done = derive(*typed.split(), folder=tmp_path)
        assert (done.status, done.stderr) == (0, words)
        assert derive(*typed.split(), "--strict", folder=tmp_path).status == 2
    assert derive("show", "puma560-corke", "p", "--at", "90,0,0,0,0,0", folder=tmp_path).stderr == ""


@pytest.mark.first(1)
@pytest.mark.parametrize("name", ["scara-matlab", "my-scara.yaml"])
def test_bodies_that_do_not_exist_are_told_where_dynamics_are_made(name: str, tmp_path: Path) -> None:
    assert derive("new", "my-scara", "--from", "scara-matlab", folder=tmp_path).stderr == ""
    build = ("build", name, "--target", "numpy", "--effort", "quick")
    for command in (("show", name, "B[4,4]"), ("export", name, "--to", "csv"), ("convert", name), build):
        done = derive(*command, folder=tmp_path)
        assert (done.status, done.stderr.count(f"derive: warning: {name}:")) == (0, 1)
        assert "one principal moment exceeds the sum of the other two by 0.08 kg m^2" in done.stderr
        assert derive(*command, "--strict", folder=tmp_path).status == 2


def test_bodies_that_do_not_exist_are_not_told_where_they_do_not_matter(tmp_path: Path) -> None:
    for command in (
        ("list",),
        ("show", "scara-matlab"),
        ("show", "scara-matlab", "T", "det(J)"),
        ("check", "scara-matlab", "--quantity", "p[3]", "--expression", "q3"),
        ("plot", "scara-matlab", "-o", "scara.svg"),
    ):
        assert "physically inconsistent" not in derive(*command, folder=tmp_path).stderr
    repaired = derive("export", "puma560-corke", "--to", "csv", "--inertia", "possible", folder=tmp_path)
    assert "2 of 6 links changed" in repaired.stderr
    assert "physically inconsistent" not in repaired.stderr


def test_values_of_options_may_begin_with_a_minus_sign(tmp_path: Path) -> None:
    scara = ("check", "scara-perugia", "--quantity", "T[1,2]")
    assert derive(*scara, "--expression", "-c12*s4 + s12*c4", folder=tmp_path).status == 0
    assert derive(*scara, "--latex", r"-c_{12} s_4 + s_{12} c_4", folder=tmp_path).status == 0
    assert derive(*scara, "--expression", "-c12*s4 - s12*c4", folder=tmp_path).status == 1
    missing = derive(*scara, "--expression", "--json", folder=tmp_path)
    assert (missing.status, "expected one argument" in missing.stderr) == (2, True)
