"""``derive move``: what it prints and writes; wrong plans are tested in `tests/plans`."""

import json
import re
from pathlib import Path

import pytest

from derive.plans.catalogue import plan_names
from derive.robot.load import catalogue_names
from tests.cli.command import accepted, derive, is_one_message

PENDULUM = """\
robot: {name: p, convention: standard, gravity: [0, -9.81, 0], links: [{mass: 1}],
  joints: [{type: revolute, a: 1, limits: [-3, 3]}]}
points: {a: [0], b: [1]}
path: [a, {to: b, time: 1/5}]
"""


def written(text: str, folder: Path) -> str:
    (folder / "plan.yaml").write_text(text)
    return "plan.yaml"


def test_no_move_is_accepted_and_a_limit_that_is_exceeded_is_a_line_and_status_1(tmp_path: Path) -> None:
    done = derive("move", written(PENDULUM.replace("to: b", "to: a"), tmp_path), folder=tmp_path)
    assert done.status == 0
    assert "a -> a   1/5 = 0.2 s  none        none" in done.stdout
    text = PENDULUM.replace("limits: [-3, 3]", "speed: 2")
    done = derive("move", written(text, tmp_path), folder=tmp_path)
    assert done.status == 1
    assert "q1: speed 9.375 rad/s at 0.1 s exceeds the limit 2 by 7.38 rad/s" in done.stdout


def test_a_diverging_simulation_keeps_its_rows_and_says_time_and_state(tmp_path: Path) -> None:
    text = PENDULUM.replace("1/5", "2") + "control: {law: pd, kp: 1, kd: 1000, period: 0.1}\n"
    done = derive("move", written(text, tmp_path), "--simulate", "--csv", "run.csv", folder=tmp_path)
    assert done.status == 1
    assert is_one_message(done.stderr)
    found = re.search(r"the simulation diverges after ([\d.]+) s of 2 s, where q1 = (\S+) rad, qd1 = ", done.stderr)
    assert found
    rows = (tmp_path / "run.csv").read_text().splitlines()
    assert 1 < len(rows) < 202
    assert 0 <= float(found[1]) - float(rows[-1].split(",")[0]) <= 0.01


def test_formulas_as_text_and_as_latex(tmp_path: Path) -> None:
    plan = written(PENDULUM.replace("1/5", "2"), tmp_path)
    text = derive("move", plan, "--show", folder=tmp_path).stdout
    assert text == "a -> b, 0 <= t <= 2 s\n  q1 = 5*t**3/4 - 15*t**4/16 + 3*t**5/16\n"
    latex = derive("move", plan, "--show", "--format", "latex", folder=tmp_path).stdout
    assert latex.splitlines()[2] == r"  q_{1}(t) &= \frac{5 t^{3}}{4} - \frac{15 t^{4}}{16} + \frac{3 t^{5}}{16}"


def test_rows_go_to_a_pipe(tmp_path: Path) -> None:
    plan = written(PENDULUM, tmp_path)
    printed = derive("move", plan, "--csv", "-", folder=tmp_path).stdout
    derive("move", plan, "--csv", "run.csv", folder=tmp_path)
    assert printed == (tmp_path / "run.csv").read_text()
    assert not (tmp_path / "-").exists()


def test_the_part_of_the_handout_is_a_sheet_in_a_language(tmp_path: Path) -> None:
    plan = written(PENDULUM, tmp_path)
    done = accepted("move", plan, "--part", "sheet.tex", "--lang", "it", "--joints", folder=tmp_path)
    assert "RMS" in done.stdout.splitlines()[0]
    text = (tmp_path / "sheet.tex").read_text()
    assert "valore efficace" in text
    assert r"a \ensuremath{\rightarrow} b" in text
    assert text.count(r"\begin{picture}") == 1


def test_json_names_the_files_that_were_written(tmp_path: Path) -> None:
    plan = written(PENDULUM, tmp_path)
    done = derive("move", plan, "--json", "--simulate", "--csv", "run.csv", folder=tmp_path)
    found = json.loads(done.stdout)
    assert found["files"] == ["run.csv"]
    assert found["simulation"]["law"] == "none"
    assert found["segments"][0]["joints"]["q1"]["speed"]["exact"] == "75/8"


def test_list_names_the_built_in_plans(tmp_path: Path) -> None:
    done = derive("list", "--plans", folder=tmp_path)
    names = [line.split()[0] for line in done.stdout.splitlines()]
    assert tuple(names[1:]) == plan_names()
    rows = json.loads(derive("list", "--plans", "--json", folder=tmp_path).stdout)
    assert {row["name"]: row["robot"] for row in rows}["scara-pick-and-place"] == "scara-matlab"


def test_schema_of_plans_accepts_the_built_in_ones_and_refuses_others(tmp_path: Path) -> None:
    jsonschema = pytest.importorskip("jsonschema")
    schema = json.loads(derive("schema", "--plan", folder=tmp_path).stdout)
    jsonschema.Draft202012Validator.check_schema(schema)
    plan = {"robot": "thumb", "points": {"a": [0, "pi/2"]}, "path": ["a", {"to": "a", "time": 1, "payload": 0.5}]}
    jsonschema.validate(plan, schema)
    for wrong in ({"profile": "quintc"}, {"pts": {}}, {"path": [{"time": 1}]}):
        with pytest.raises(jsonschema.ValidationError):
            jsonschema.validate({**plan, **wrong}, schema)


@pytest.mark.parametrize("robot", [name for name in catalogue_names() if name.startswith(("scara-p", "thumb"))])
def test_new_writes_a_plan_that_moves(robot: str, tmp_path: Path) -> None:
    made = derive("new", "mine", "--plan", robot, folder=tmp_path)
    assert (made.status, made.stdout) == (0, "mine.yaml\n")
    done = accepted("move", "mine.yaml", folder=tmp_path)
    assert "home -> A  2 s" in done.stdout


def test_new_copies_a_built_in_plan_and_overwrites_nothing(tmp_path: Path) -> None:
    assert derive("new", "mine", "--from", "skeleton-reach", folder=tmp_path).status == 0
    assert "robot: skeleton-root" in (tmp_path / "mine.yaml").read_text()
    assert derive("new", "mine", "--from", "skeleton-reach", folder=tmp_path).status == 2
