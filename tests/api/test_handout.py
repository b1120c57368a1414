"""`derive.handout` and `derive.fragment` do what the command does."""

from pathlib import Path

import pytest

from derive.api.handout import handout
from derive.api.robots import load
from derive.errors import DeriveError, QuantityError, TargetError
from derive.robot.presentation import with_options


def test_a_handout_says_what_it_wrote(tmp_path: Path) -> None:
    result = handout("thumb", tmp_path, parts=["jacobian", "table"], language="it", notation={"angle": "vartheta"})
    (file,) = result.files
    assert result.parts == ("table", "jacobian")
    assert file.path == tmp_path / "thumb.tex"
    assert file.path.stat().st_size == file.bytes
    assert "vartheta" in file.path.read_text()
    assert result.as_dict()["robot"] == "thumb"


def test_what_is_not_chosen_is_as_the_file_says() -> None:
    robot = load("scara-perugia")
    assert with_options(robot) == robot
    chosen = with_options(robot, parts=["table"], derivation="steps", q=[0.5, 0, 0.25, "pi"])
    assert chosen.handout.parts == ("table",)
    assert chosen.handout.language == robot.handout.language
    assert chosen.figure.q is not None


@pytest.mark.parametrize(
    ("options", "error", "message"),
    [
        ({"parts": []}, QuantityError, "no part"),
        ({"notation": {"angle": "phi"}}, QuantityError, "unknown value of angle 'phi'"),
        ({"formats": ["docx"]}, TargetError, "tex, pdf, html"),
        ({"plan": "skeleton-reach"}, DeriveError, "the plan moves skeleton-root, not thumb"),
        ({"plan": "skeleton-reach", "exercise": True}, DeriveError, "an exercise with a motion plan"),
    ],
)
def test_an_unknown_option_is_refused_before_anything_is_written(
    options: dict[str, object], error: type[Exception], message: str, tmp_path: Path
) -> None:
    with pytest.raises(error, match=message):
        handout("thumb", tmp_path / "out", **options)  # type: ignore[arg-type]
    assert not (tmp_path / "out").exists()


def test_a_plan_is_a_part_of_the_sheet_and_moves_the_arm_of_the_page(tmp_path: Path) -> None:
    options = {"formats": ["tex", "html"], "parts": ["table"], "language": "it", "plan": "skeleton-reach"}
    result = handout("skeleton-root", tmp_path, **options)  # type: ignore[arg-type]
    assert result.parts == ("table", "plan")
    tex, page = ((tmp_path / f"skeleton-root.{ending}").read_text() for ending in ("tex", "html"))
    assert "Piano di moto" in tex
    assert "Tabella di Denavit-Hartenberg" in page
    assert '"playback": {"tracks": ' in page
