"""The notebook of examples/ runs, shows formulas, and stores what it shows."""

import json
from pathlib import Path
from typing import Any

import nbclient
import nbformat
import pytest

from derive import Model, Robot
from derive.notebook import MOST_LINES
from derive.robot.load import catalogue_names
from tests.docs.console import ROOT

TOUR = ROOT / "examples" / "tour.ipynb"


@pytest.fixture(scope="module")
def executed() -> Any:
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("PYTHONPATH", str(ROOT))
        notebook = nbformat.read(TOUR, as_version=4)
        nbclient.NotebookClient(notebook, timeout=600, kernel_name="python3", record_timing=False).execute()
    return notebook


def outputs(notebook: Any) -> list[dict[str, Any]]:
    """What each cell displays; a printed text, which reaches us in as many pieces as the machine likes, as one."""
    shown: list[dict[str, Any]] = []
    for cell in notebook.cells:
        results = cell.get("outputs", ())
        shown += [{"printed": "".join(result["text"] for result in results if result.get("name") == "stdout")}]
        shown += [result["data"] for result in results if "data" in result]
    return shown


def test_the_tour_shows_what_it_stores(executed: Any) -> None:
    assert outputs(executed) == outputs(nbformat.read(TOUR, as_version=4))


def test_every_result_of_the_tour_is_set_as_a_formula_or_a_table(executed: Any) -> None:
    shown = outputs(executed)
    assert sum("text/latex" in data for data in shown) >= 9
    assert sum("text/html" in data for data in shown) == 2


def test_the_tour_is_a_valid_notebook_without_traces_of_a_machine() -> None:
    nbformat.validate(nbformat.read(TOUR, as_version=4))
    text = TOUR.read_text(encoding="utf-8")
    assert "0x" not in text
    assert str(Path.home()) not in json.dumps(text)


@pytest.mark.parametrize("name", catalogue_names())
def test_every_robot_and_model_shows_itself(name: str) -> None:
    robot = Robot.load(name)
    table = robot._repr_html_()
    assert table.count("<tr>") == robot.n + 1
    model: Any = Model(robot)
    latex = model._repr_latex_()
    assert latex.startswith("$")
    assert latex.count("\\begin") == latex.count("\\end")
    assert latex.count("\\\\\n") <= 4 * MOST_LINES
    assert model.singularities._repr_latex_().startswith("$")


def test_texts_of_the_user_are_escaped() -> None:
    text = "name: arm\ntitle: <script>alert(1)</script>\nconvention: modified\njoints:\n  - {type: revolute, a: a0}\n"
    assert "<script>" not in Robot.from_text(text)._repr_html_()
