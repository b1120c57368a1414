"""The page of errata is what the command finds today."""

from tests.docs.errata import PAGE, TITLES, page
from tests.docs.motion_errata import section


def test_the_page_is_current() -> None:
    assert PAGE.read_text(encoding="utf-8") == page(), "run: make errata"


def test_documents_are_named_in_words() -> None:
    text = PAGE.read_text(encoding="utf-8")
    assert ".txt" not in text
    found = [line.removeprefix("## ") for line in text.splitlines() if line.startswith("## Document")]
    assert found == [title for number, title in TITLES.items() if number != "003"]


def test_section_of_motions_proves_its_items_with_numbers() -> None:
    text = "\n".join(section())
    assert text.count("### ") == 5
    assert "drawn 0.00981719 and 0.00010076, right 5*pi/16 = 0.981748 rad/s" in text
    assert "15*pi/16 = 2.94524" in text
    assert "Ixx + Iyy - Izz = -0.08 kg m^2" in text
    assert "points `rest`, `C`, `D`" in text
    assert "`L{1}.m`, ..., `L{4}.B` and `fkine(SCARA,q)`" in text
    assert "rank of J: rest 3, A 4, B 4, C 3, D 3" in text
