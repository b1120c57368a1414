"""The pages and the notebook show what a reader gets, the errata what is found, the map of the code what is there."""

import json
import re
import subprocess
from pathlib import Path
from typing import Any

import nbclient
import nbformat
import pytest

from derive import Model, Robot
from derive.api.build import build
from derive.api.robots import load
from derive.model.quantities import REGISTRY
from derive.notebook import MOST_LINES
from derive.verification.generated import OCTAVE_OPTIONS, find_octave
from tests.docs.console import Command, agrees, blocks, commands, environment, run
from tests.docs.errata import PAGE, TITLES, page, section
from tests.places import ROOT
from tests.random_robots import chains
from tests.targets.generated_models import needs_octave

PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md")), *sorted((ROOT / "docs" / "decisions").glob("*.md"))]
PAGES = [page for page in PAGES if page.name != "contributing.md"]  # a copy that `make docs` makes
RUNNABLE_PAGES = [page for page in PAGES if any(block.language in ("console", "python") for block in blocks(page))]
LINK = re.compile(r"\[[^\]]*\]\(([^)#\s]+)(?:#[^)]*)?\)")


def name(page: Path) -> str:
    return str(page.relative_to(ROOT))


@pytest.mark.pages
@pytest.mark.parametrize("page", RUNNABLE_PAGES, ids=name)
def test_a_page_shows_what_a_reader_gets(page: Path, tmp_path: Path) -> None:
    """Commands print what stands under them; then the Python blocks run, in one interpreter, where the commands ran."""
    variables = environment(tmp_path / "path")
    folder = tmp_path / "work"
    folder.mkdir()
    for block in blocks(page):
        if block.file:
            (folder / block.file).write_text(block.body, encoding="utf-8")
        for command in commands(block) if block.language == "console" else ():
            printed, status = run(command, folder, variables)
            shown = "\n".join(printed)
            assert status == command.status, f"{name(page)}:{block.line}: {command.text}\n{shown}"
            assert agrees(command.output, printed), f"{name(page)}:{block.line}: {command.text} prints\n{shown}"
    script = folder / "page.py"
    script.write_text("\n".join(block.body for block in blocks(page) if block.language == "python"), encoding="utf-8")
    printed, status = run(Command(f"python {script.name}", (), 0), folder, variables)
    assert status == 0, "\n".join(printed)


@pytest.mark.parametrize(
    ("shown", "printed", "expected"),
    [
        ("tau  72  1.4e-12", "tau  72  8.8e-16", True),
        ("tau  72  1.4e-12", "tau  72  0", True),
        ("tau  72  1.4e-12", "tau  72  1.4e-09", False),
        ("tau  72  1.4e-12", "tau  71  1.4e-12", False),
        ("p = a1*c1", "p = a1*c2", False),
        ("built ... files", "built elbow, 8 files", True),
    ],
)
def test_rounding_errors_alone_may_differ_from_those_of_a_page(shown: str, printed: str, expected: bool) -> None:
    assert agrees((shown,), [printed]) is expected


@pytest.mark.parametrize("page", PAGES, ids=name)
def test_links_between_pages_lead_somewhere(page: Path) -> None:
    targets = [target for target in LINK.findall(page.read_text(encoding="utf-8")) if "://" not in target]
    missing = [target for target in targets if not (page.parent / target).exists()]
    assert not missing


@pytest.mark.parametrize("page", PAGES, ids=name)
def test_make_targets_that_a_page_names_exist(page: Path) -> None:
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    phony = re.search(r"^\.PHONY: (.*)$", makefile, re.MULTILINE)
    shell = "\n".join(block.body for block in blocks(page) if block.language == "sh")
    named = set(re.findall(r"^make ([a-z-]+)", shell, re.MULTILINE))
    assert named <= set(phony[1].split())


def test_page_of_quantities_has_a_row_for_every_quantity_in_their_order() -> None:
    text = (ROOT / "docs" / "quantities.md").read_text(encoding="utf-8")
    rows = [[cell.strip() for cell in line.split("|")] for line in text.splitlines() if line.startswith("| `")]
    shown = {row[1].strip("`"): row[3:6] for row in rows if len(row) == 8}
    registry = {row.call: [f"${row.symbol}$", row.shape or "scalar", row.unit] for row in REGISTRY.values()}
    assert {call: shown.get(call) for call in registry} == registry
    assert [call for call in shown if call in registry] == list(registry)


def test_every_page_can_be_reached_from_another() -> None:
    linked = {
        (page.parent / target).resolve()
        for page in PAGES
        for target in [*LINK.findall(page.read_text(encoding="utf-8")), *contents(page)]
        if "://" not in target
    }
    starts = (ROOT / "README.md", ROOT / "docs" / "index.md")
    assert not [name(page) for page in PAGES if page not in starts and page.resolve() not in linked]


def contents(page: Path) -> list[str]:
    lines = [line for block in blocks(page) if block.language == "{toctree}" for line in block.body.splitlines()]
    names = [f"{line}.md" for line in lines if line and not line.startswith(":")]
    return [str(path.relative_to(page.parent)) for name in names for path in page.parent.glob(name)]


@needs_octave
def test_the_example_runs(tmp_path: Path) -> None:
    script = []
    for block in blocks(ROOT / "docs" / "octave.md"):
        if block.file:
            (tmp_path / block.file).write_text(block.body, encoding="utf-8")
        script += [block.body] if block.language == "matlab" else []
    build(load(str(tmp_path / "arm.yaml")), tmp_path / "generated", targets=["octave"], effort="quick")
    (tmp_path / "arm_example.m").write_text("".join(script), encoding="utf-8")
    command = [*(find_octave() or ()), *OCTAVE_OPTIONS, "arm_example.m"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False, timeout=300)
    assert (done.returncode, done.stderr) == (0, "")
    assert script


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


MAP = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
RECIPES = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
ROW = re.compile(r"^\| ([^|]+?) \| `(derive/[a-z_/]+\.py)` \| `(\w+)` \|$", re.MULTILINE)
PLACE = re.compile(r"`((?:derive|templates|tests|docs|bench|generated)/[\w./-]*)`")
INNER = re.compile(r"`((?:[a-z_]+/)+[a-z_]+\.py)`")


def test_the_map_answers_at_least_thirty_questions() -> None:
    assert len(ROW.findall(MAP)) >= 30


@pytest.mark.parametrize(("question", "file", "name"), ROW.findall(MAP))
def test_every_answer_of_the_map_is_there(question: str, file: str, name: str) -> None:
    defined = re.compile(rf"^ *(?:def|class) {name}\b|^{name}(?::| =)", re.MULTILINE)
    assert defined.search((ROOT / file).read_text(encoding="utf-8")), question


@pytest.mark.parametrize("text", [MAP, RECIPES], ids=["architecture", "contributing"])
def test_every_place_that_is_named_exists(text: str) -> None:
    named = {place for place in PLACE.findall(text) if "<" not in place}
    inner = {
        f"derive/{place}" for place in INNER.findall(text) if place.split("/")[0] not in ("derive", "tests", "docs")
    }
    assert named
    assert not [place for place in sorted(named | inner) if not (ROOT / place).exists()]


def test_every_folder_of_the_package_is_on_the_map_and_every_decision_in_the_index() -> None:
    folders = {path.name for path in (ROOT / "derive").iterdir() if (path / "__init__.py").exists()}
    assert not [folder for folder in sorted(folders) if f"`derive/{folder}/`" not in MAP]
    folder = ROOT / "docs" / "decisions"
    index = (folder / "index.md").read_text(encoding="utf-8")
    assert [path.name for path in sorted(folder.glob("0*.md")) if f"({path.name})" not in index] == []


TOUR, LOG_TO_MODEL = (ROOT / "examples" / f"{name}.ipynb" for name in ("tour", "log_to_model"))


def execution(path: Path, folder: Path) -> Any:
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("PYTHONPATH", str(ROOT))
        notebook, place = nbformat.read(path, as_version=4), {"metadata": {"path": str(folder)}}
        options = {"kernel_name": "python3", "record_timing": False, "resources": place}
        nbclient.NotebookClient(notebook, timeout=600, **options).execute()
    return notebook


@pytest.fixture(scope="module")
def executed(tmp_path_factory: pytest.TempPathFactory) -> Any:
    return execution(TOUR, tmp_path_factory.mktemp("tour"))


@pytest.mark.sweep
def test_the_tour_and_the_log_show_what_they_store_as_formulas_or_tables(tmp_path: Path, executed: Any) -> None:
    assert outputs(execution(LOG_TO_MODEL, tmp_path)) == outputs(nbformat.read(LOG_TO_MODEL, as_version=4))
    assert (tmp_path / "identified.yaml").exists()
    assert outputs(executed) == outputs(nbformat.read(TOUR, as_version=4))
    shown = outputs(executed)
    assert sum("text/latex" in data for data in shown) >= 9
    assert sum("text/html" in data for data in shown) == 2


def outputs(notebook: Any) -> list[dict[str, Any]]:
    """What each cell displays; a printed text, which reaches us in as many pieces as the machine likes, as one."""
    shown: list[dict[str, Any]] = []
    for cell in notebook.cells:
        results = cell.get("outputs", ())
        shown += [{"printed": "".join(result["text"] for result in results if result.get("name") == "stdout")}]
        shown += [result["data"] for result in results if "data" in result]
    return shown


@pytest.mark.parametrize("path", [TOUR, LOG_TO_MODEL], ids=name)
def test_a_notebook_is_valid_and_without_traces_of_a_machine(path: Path) -> None:
    nbformat.validate(nbformat.read(path, as_version=4))
    text = path.read_text(encoding="utf-8")
    assert "0x" not in text
    assert str(Path.home()) not in json.dumps(text)


@pytest.mark.parametrize("name", chains())
@pytest.mark.first(6)
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
