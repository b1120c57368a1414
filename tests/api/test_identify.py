"""Identification and motions for it from Python: files, and what is refused before anything is written."""

import re
from pathlib import Path

import pytest

import derive
from derive.api.excite import excite
from derive.api.identify import identify
from derive.errors import DeriveError, OutputError
from tests.identification.logs import PUMA, REAL, simulated
from tests.identification.test_excitation import arm

pytest.importorskip("pyarrow")
LOG = simulated(REAL, 800)[0]


def test_the_robot_file_and_the_page_are_written(tmp_path: Path) -> None:
    path, page = tmp_path / "identified.yaml", tmp_path / "page.html"
    found = derive.identify("puma560-corke", LOG, path, report=page)
    assert path.read_text() == found.text
    assert derive.load(path).links == found.robot.links
    assert "<svg" in page.read_text()
    with pytest.raises(OutputError, match="exists already"):
        identify(PUMA, LOG, path)
    with pytest.raises(DeriveError, match="has the ending of another kind of file"):
        identify(PUMA, LOG, report=tmp_path / "page.pdf")


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"method": "wsl"}, "no method 'wsl'; allowed: ols, wls, possible; did you mean 'wls'"),
        ({"held_out": 1.5}, "1.5 of a log held out; allowed: a log, or a part such as 0.2"),
        ({"held_out": "0"}, "0 of a log held out"),
        ({"columns": {"tau": "-tau*"}}, "torques opposite to those"),
    ],
)
def test_wrong_options_are_refused(options: dict[str, object], message: str, tmp_path: Path) -> None:
    with pytest.raises(DeriveError, match=message):
        identify(PUMA, LOG, tmp_path / "identified.yaml", **options)  # type: ignore[arg-type]
    assert not list(tmp_path.iterdir())


def test_torques_are_taken_as_they_are_where_that_is_asked_for() -> None:
    found = identify(PUMA, LOG, columns={"tau": "-tau*"}, method="possible", trust_torques=True)
    assert (found.residuals > 0.3 * found.torques).any()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"speed": "1,2"}, "2 values of speed; allowed: one, or one for each of q1, q2, q3"),
        ({"speed": -1}, "speed -1 of q1; allowed: above zero"),
        ({"speed": "fast"}, "'fast'"),
        ({"harmonics": 1}, "1 harmonics; allowed: 2 to 20"),
        ({"period": 0}, "a period of 0 s; allowed: a time above zero"),
        ({"sample": 1}, "samples every 1 s; allowed: 0.0001 to 0.5 s"),
        ({"criterion": "best"}, "criterion best; allowed: determinant, condition"),
        ({"noise": "0%"}, "noise 0%; allowed: N m or N, or per cent such as 1%"),
        ({"position": "90,90,50"}, "no room for q3"),
        ({"floor": 2.0}, "no position of arm found with all frames above the floor, z = 2 m; give a lower --floor"),
        ({"torque": "9,3.5,99"}, "q2 of arm found too weak to hold it anywhere; give a larger --torque"),
    ],
)
def test_wrong_options(options: dict[str, object], message: str) -> None:
    with pytest.raises(DeriveError, match=re.escape(message)):
        excite(arm(), **options)  # type: ignore[arg-type]
