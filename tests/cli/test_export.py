"""``derive export``: the file or its text, remarks, one message for what is wrong."""

import json
from pathlib import Path

import pytest

from derive.cli import export
from derive.exchange.formats import FORMS
from tests.cli.command import PENDULUM, accepted, derive, refused


def test_the_file_is_written_remarks_are_told_and_every_format_is_offered(tmp_path: Path) -> None:
    done = derive("export", "puma560-corke", "--to", "urdf", "-o", "puma.urdf", folder=tmp_path)
    assert (done.status, done.stdout) == (0, "puma.urdf\n")
    assert "derive: warning: puma560-corke: URDF cannot say the armature of q1, q2, q3, q4, q5, q6" in done.stderr
    assert (tmp_path / "puma.urdf").read_text().startswith("<?xml")
    assert tuple(FORMS) == export.FORMATS


@pytest.mark.parametrize("to", export.FORMATS)
def test_the_text_goes_to_standard_output(to: str, tmp_path: Path) -> None:
    (tmp_path / "pendulum.yaml").write_text(PENDULUM)
    values = ("--values", "a1=0.5,l1=1/4", "--values", "g=9.81, m1=2, I1=0.1")
    done = accepted("export", "pendulum.yaml", "--to", to, *values, folder=tmp_path)
    assert "pendulum" in done.stdout
    assert "0.5" in done.stdout


def test_the_report_for_scripts_holds_what_the_format_cannot_say(tmp_path: Path) -> None:
    done = derive("export", "puma560-corke", "--to", "urdf", "-o", "puma.urdf", "--json", folder=tmp_path)
    report = json.loads(done.stdout)
    assert (report["file"], report["format"]) == ("puma.urdf", "urdf")
    assert [remark["line"] for remark in report["remarks"]] == [31]  # of the robot file: a link that no body can be
    assert report["report"]
    assert all(f"derive: warning: puma560-corke: {line}" in done.stderr for line in report["report"])


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("planar-2r-perugia", "--to", "urdf"), "symbols without a number: a1, a2, g, ml1, l1, Il1, mm1, Im1, ...; "),
        (("kuka-kr5", "--to", "sdf"), "'sdf' as --format; allowed: urdf, mjcf, rtb, corke, rigidbodytree, csv"),
        (("kuka-kr5",), "required: --format"),
        (("anthropomorphic-arm", "--to", "csv", "--values", "a2"), "'a2' in --values; allowed: name=value,name=value"),
        (("anthropomorphic-arm", "--to", "csv", "--values", "a2=1,a2=2"), "a2 twice in --values"),
        (("anthropomorphic-arm", "--to", "csv", "--values", "a2=x"), "value 'x' of a2 holds a name"),
        (("anthropomorphic-arm", "--to", "csv", "--values", "b=1"), "no 'b' in anthropomorphic-arm; allowed: a2, a3"),
        (("nobody", "--to", "csv"), "nobody"),
        (("kuka-kr5", "--to", "csv", "-o", "."), "'.' is a folder; write the name of a file in it"),
        (("kuka-kr5", "--to", "csv", "-o", ".", "--force"), "'.' is a folder; write the name of a file in it"),
    ],
)
def test_wrong_arguments_get_one_message(arguments: tuple[str, ...], message: str, tmp_path: Path) -> None:
    assert message in refused("export", *arguments, folder=tmp_path).stderr
