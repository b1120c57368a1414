"""``--json`` is one JSON value on standard output, whatever the command found."""

import json
from pathlib import Path

import pytest

from derive.robot.load import catalogue_names
from derive.robot.reading.schema import json_schema
from tests.cli.command import PENDULUM, derive


def test_list_names_the_whole_catalogue(tmp_path: Path) -> None:
    rows = json.loads(derive("list", "--json", folder=tmp_path).stdout)
    assert tuple(row["name"] for row in rows) == catalogue_names()
    assert {row["convention"] for row in rows} == {"standard", "modified"}


def test_show_gives_rows_of_matrices_text_of_scalars_and_a_list_of_what_there_is(tmp_path: Path) -> None:
    (tmp_path / "arm.yaml").write_text(PENDULUM)
    found = json.loads(derive("show", "arm.yaml", "T", "potential", "--format", "json", folder=tmp_path).stdout)
    assert found["robot"] == "pendulum"
    assert found["quantities"]["T"][3] == ["0", "0", "0", "1"]
    assert isinstance(found["quantities"]["potential"], str)
    found = json.loads(derive("show", "thumb", "--format", "json", folder=tmp_path).stdout)
    assert "T" in found["quantities"]
    assert "B" not in found["quantities"]


def test_build_and_verify_report_the_worst_errors(tmp_path: Path) -> None:
    (tmp_path / "arm.yaml").write_text(PENDULUM)
    (built,) = json.loads(derive("build", "arm.yaml", "--json", folder=tmp_path).stdout)
    assert built["status"] == "built"
    assert built["verification"]["worst"] < 1e-9
    assert built["operations"]["inverse_dynamics"]["sin"] >= 0
    verified = json.loads(derive("verify", "arm.yaml", "--json", folder=tmp_path).stdout)
    assert {row["target"] for row in verified["rows"]} >= {"numpy", "casadi"}
    (checked,) = json.loads(derive("build", "arm.yaml", "--check", "--json", folder=tmp_path).stdout)
    assert checked["status"] == "current"


def test_the_schema_is_that_of_robot_files(tmp_path: Path) -> None:
    assert json.loads(derive("schema", folder=tmp_path).stdout) == json_schema()


ERRORS = {
    "place": ("show arm.yaml T", {"file": "arm.yaml", "line": 4, "column": 22, "kind": "RobotFileError"}),
    "remark": ("show arm.yaml T --strict", {"file": "arm.yaml", "line": 4, "kind": "RobotFileWarning"}),
    "name": ("show nemo T", {"kind": "UnknownRobotError", "found": "'nemo' is neither a file nor a built-in robot"}),
    "option": ("show arm.yaml --frob", {"kind": "DeriveError", "found": "no option '--frob'"}),
    "usage": ("export arm.yaml", {"kind": "DeriveError", "remedy": "see 'derive export --help'"}),
    "command": ("shwo", {"kind": "DeriveError"}),
    "failed": ("verify arm.yaml --out made", {"status": 2, "kind": "OutputError"}),
    "taken": ("convert arm.yaml -o arm.yaml", {"kind": "OutputError", "found": "arm.yaml exists already"}),
    "plan": ("move arm.yaml", {"kind": "RobotFileError", "file": "arm.yaml"}),
}


@pytest.mark.parametrize(("typed", "expected"), ERRORS.values(), ids=ERRORS)
def test_an_error_is_an_object_beside_its_message(typed: str, expected: dict[str, object], tmp_path: Path) -> None:
    wrong = "place" if expected.get("column") else "remark" if "strict" in typed else ""
    cell = {"place": "alfa: a1", "remark": "a: a1, alpha: 1.57"}.get(wrong, "a: a1")
    (tmp_path / "arm.yaml").write_text(PENDULUM.replace("a: a1}", f"{cell}}}", 1))
    plain = derive(*typed.split(), folder=tmp_path)
    done = derive(*typed.split(), "--json", folder=tmp_path)
    error = json.loads(done.stdout)["error"]
    assert done.status == plain.status == error["status"]
    assert done.stderr == plain.stderr
    assert done.stderr.splitlines()[-1] == f"derive: error: {error['message']}"
    assert {key: error.get(key) for key in expected} == expected


def test_both_ways_to_ask_for_json_give_errors_as_json(tmp_path: Path) -> None:
    asked = ("--json", "--format json", "--format=json")
    found = {derive("show", "nobody", *text.split(), folder=tmp_path).stdout for text in asked}
    assert len(found) == 1
    assert json.loads(found.pop())["error"]["status"] == 2


@pytest.mark.parametrize("typed", ["convert arm.yaml", "export kuka-kr5 --format csv"])
def test_what_would_be_printed_is_in_the_report(typed: str, tmp_path: Path) -> None:
    (tmp_path / "arm.yaml").write_text(PENDULUM)
    report = json.loads(derive(*typed.split(), "--json", folder=tmp_path).stdout)
    assert report["text"] == derive(*typed.split(), folder=tmp_path).stdout
