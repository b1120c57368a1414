"""``derive show ROBOT inverse``: the task of the command line, every form of output, all configurations of a pose."""

import json

import pytest

from derive.cli.main import main

ARM = "planar-2r-perugia"


def shown(capsys: pytest.CaptureFixture[str], *arguments: str) -> str:
    assert main(["show", ARM, "inverse", *arguments]) == 0
    return capsys.readouterr().out


def test_the_task_of_the_command_line_is_solved(capsys: pytest.CaptureFixture[str]) -> None:
    assert shown(capsys).startswith("1 solution (complete)\n")
    text = shown(capsys, "--task", "x,y")
    assert text.startswith("2 solutions (complete)\n")
    assert "q1 = atan2(py, px) - atan2(a2*s2, a1 + a2*c2)" in text


def test_json_has_the_steps_and_the_branches(capsys: pytest.CaptureFixture[str]) -> None:
    found = json.loads(shown(capsys, "--task", "x,y", "--format", "json"))["quantities"]["inverse"]
    assert found["count"] == 2
    assert found["complete"] is True
    assert [step["unknown"] for step in found["steps"]] == ["q2", "q1"]
    assert [branch["name"] for branch in found["solutions"]] == ["elbow down", "elbow up"]
    assert found["steps"][1]["free_where_zero"] == ["px", "py"]


def test_at_a_configuration_all_that_reach_its_pose_are_printed(capsys: pytest.CaptureFixture[str]) -> None:
    text = shown(capsys, "--task", "x,y", "--at", "0.5, 1, a1=1, a2=1", "--format", "json")
    rows = json.loads(text)["quantities"]["inverse"]
    columns = sorted(zip(*([float(x) for x in row] for row in rows), strict=True))
    assert columns == [pytest.approx((0.5, 1.0)), pytest.approx((1.5, -1.0))]


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        (["inverse", "--task", "x,y,z"], "a task of 3 coordinates for 2 joints"),
        (["inverse", "--task", "x,w"], "unknown row of a task 'w'"),
        (["inverse", "--given", "q7"], "'q7' is not a joint variable"),
        (["inverse", "--task", "z"], "no joint changes the task z; allowed: x, y, phi, orientation"),
        (["workspace", "--at", "0, 0"], "--at with workspace; ask for workspace without --at"),
        (["aspects", "--abbreviate", "christoffel"], "--abbreviate with aspects"),
        (["aspects", "--format", "latex"], "--format latex with aspects; allowed: text and json"),
        (["T", "--task", "x,y"], "--task with T; allowed: with inverse, singularities, workspace and aspects"),
        (["B", "detJ", "--given", "q1"], "--given with B; allowed: with inverse, workspace and aspects"),
        (["workspase"], "quantity 'workspase'; did you mean 'workspace'?"),
        (["Aspects"], "quantity 'Aspects'; did you mean 'aspects'?"),
    ],
)
def test_what_cannot_be_described_is_refused_in_one_line(
    asked: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["show", ARM, *asked]) == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    assert printed.err.startswith(f"derive: error: {message}")
    assert printed.err.count("\n") == 1


def test_descriptions_stand_beside_quantities(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["show", ARM, "workspace", "p", "--format", "json"]) == 0
    found = json.loads(capsys.readouterr().out)["quantities"]
    assert found["workspace"]["bounds"][0]["shape"] == "between two circles"
    assert len(found["p"]) == 3
    assert main(["show", ARM]) == 0
    assert "aspects " in capsys.readouterr().out
