"""``derive.excite`` and what it refuses."""

import re
from pathlib import Path

import pytest

from derive.api.excite import excite
from derive.errors import DeriveError
from tests.cli.command import refused
from tests.identification.test_excitation import arm


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


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ((), "q1, q2, q3, q4, q5, q6 of puma560-corke without limits of speed; write speed: into the robot file"),
        (("--floor", "x"), "--floor: invalid height value: 'x'"),
    ],
)
def test_refusals_of_the_command(more: tuple[str, ...], message: str, tmp_path: Path) -> None:
    assert message in refused("excite", "puma560-corke", "-o", "out.yaml", *more, folder=tmp_path).stderr
    assert not [*tmp_path.iterdir()]
