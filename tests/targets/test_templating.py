"""Templates hold text, loops and flags; what stands in generated modules and on the page of their folder."""

import ast
import re
import sys
from pathlib import Path

import pytest
from jinja2 import nodes

from derive.handouts.sheet.latex_writer import latex_template
from derive.programs.optimise.search_policy import Effort
from derive.publish.build import build_robot
from derive.publish.render import render_robot
from derive.publish.targets import TARGETS, targets_named
from derive.robot.robot import Robot
from derive.targets import templating
from derive.targets.numpy import render_numpy
from derive.targets.readme import FILES
from derive.targets.templating import environment, robot_argument, template_folder
from tests.random_robots import sampled
from tests.rows import text_of_rows
from tests.targets.embedded import is_fresh, templates
from tests.targets.generated_models import source_of
from tests.targets.searched_arms import GENERAL, program_of, robot_of

FOLDER = Path(str(template_folder()))
TEMPLATES = sorted(path.relative_to(FOLDER).as_posix() for path in FOLDER.rglob("*") if path.is_file())

FORBIDDEN = (nodes.BinExpr, nodes.UnaryExpr, nodes.Filter, nodes.Test, nodes.Slice, nodes.Compare)
FORBIDDEN += (nodes.Assign, nodes.AssignBlock, nodes.NSRef)
ALLOWED_OPERATORS = (nodes.And, nodes.Or, nodes.Not)


@pytest.mark.parametrize("name", TEMPLATES)
def test_templates_compute_nothing(name: str) -> None:
    source = (FOLDER / name).read_text(encoding="utf-8")
    reads = latex_template("blocks.tex.jinja").environment if name.endswith(".tex.jinja") else environment()
    tree = reads.parse(source)
    for kind in FORBIDDEN:
        found = [node for node in tree.find_all(kind) if not isinstance(node, ALLOWED_OPERATORS)]
        found = [node for node in found if not (isinstance(node, nodes.Filter) and node.node is None)]  # blocks of text
        assert not found, f"{name}:{found[0].lineno}: {type(found[0]).__name__}"


def test_the_registry_and_the_templates_agree() -> None:
    """A folder for every target (the handout's is ``latex``); one each for other texts."""
    targets = {"handout" if name == "latex" else name for name in TARGETS}
    assert {name.split("/")[0] for name in TEMPLATES} == {*targets, "exchange", "motion", "new", "package", "page"}
    files = [file for target in TARGETS.values() for file in target.files]
    assert len(set(files)) == len(files)


def test_targets_are_chosen_by_name() -> None:
    assert [target.name for target in targets_named()] == ["numpy", "casadi", "c", "latex", "readme"]
    assert [target.name for target in targets_named(TARGETS)] == list(TARGETS)
    native = ["numpy", "casadi", "c", "native", "latex", "readme"]
    assert [target.name for target in targets_named(["native"])] == native
    assert [target.name for target in targets_named(["latex", "numpy", "latex"], only=True)] == ["numpy", "latex"]
    assert targets_named(only=True) == targets_named()
    assert targets_named(["all"]) == targets_named("all") == tuple(TARGETS.values())
    present = ["javascript", "of another version"]
    assert targets_named(["numpy"], present=present) == targets_named(["javascript", "numpy"])


@pytest.mark.parametrize(("name", "argument"), [("puma560-corke", "puma560-corke"), ("my-arm", "my-arm.yaml")])
def test_hints_name_built_in_robots_and_files_of_others(name: str, argument: str) -> None:
    """No template writes a name alone, which commands know of built-in robots only."""
    assert robot_argument(name) == argument
    assert not [place for place in TEMPLATES if re.search(r"derive [a-z]+ \{\{ name", (FOLDER / place).read_text())]


@pytest.mark.parametrize("writes", [True, False])
def test_templates_are_compiled_once_where_python_keeps_byte_code(
    writes: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys, "dont_write_bytecode", not writes)
    monkeypatch.setattr(templating, "cache_from_source", lambda file: str(tmp_path / "templating.pyc"))
    for _ in range(2):
        templating.environment.__wrapped__().get_template("package/__init__.py.jinja")
        assert len(list(tmp_path.iterdir())) == writes
    for kept in tmp_path.iterdir():
        kept.write_bytes(b"of another version")
    again = templating.environment.__wrapped__().get_template("package/__init__.py.jinja")
    assert "Two" in again.render(title="Two", name="two", version="0")


def test_it_is_that_of_the_model() -> None:
    """Where it is not: ``python -m tests.targets.embedded``."""
    assert [path.name for path, text in templates() if not is_fresh(path, text)] == []


def test_the_module_imports_numpy_and_the_standard_library_alone() -> None:
    text = render_numpy(source_of(robot_of(GENERAL), program_of(GENERAL)))["model_numpy.py"]
    imports = [node for node in ast.parse(text).body if isinstance(node, ast.Import | ast.ImportFrom)]
    modules = {getattr(node, "module", None) or node.names[0].name for node in imports}
    assert modules == {"math", "operator", "struct", "dataclasses", "enum", "functools", "numpy"}


def page(robot: Robot) -> str:
    return render_robot(robot, targets_named(), Effort.QUICK).files["README.md"].decode()


@pytest.mark.parametrize(
    "name", sampled(["scara-perugia", "thumb", "kuka-kr5", "puma560-corke"], ["scara-perugia", "thumb"])
)
def test_the_example_runs(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    build_robot(Robot.load(name), tmp_path, verified=False, effort=Effort.QUICK)
    text = (tmp_path / name.replace("-", "_") / "README.md").read_text()
    match = re.search(r"```python\n(.*?)```", text, re.DOTALL)
    monkeypatch.syspath_prepend(tmp_path)
    scope: dict[str, object] = {}
    exec(match.group(1), scope)
    assert getattr(scope["T"], "shape", None) == (4, 4)


def test_every_file_and_function_is_listed_with_a_word_and_no_tag_is_left() -> None:
    assert {name for target in TARGETS.values() for name in target.files} - {"README.md"} <= FILES.keys()
    rendered = render_robot(Robot.load("scara-perugia"), targets_named())
    text = rendered.files["README.md"].decode()
    for name in rendered.files:
        assert f"`{name}`" in text or name == "README.md"
    for name in rendered.operations:
        assert f"`{name}(" in text
    assert not re.search(r"\{\{|\{%|%\}|\}\}", text)


def test_titles_are_text() -> None:
    title = "# x [a](http://b) <script>1</script> `c` {{ 7*7 }} | **d**"
    robot = Robot.from_text(f"name: arm\ntitle: '{title}'\nconvention: standard\njoints: [{{type: revolute}}]\n")
    first = page(robot).splitlines()[0]
    assert first.startswith("# ")
    assert "<script>" not in first
    assert "[a]" not in first
    assert "49" not in first


ROD = text_of_rows(
    "R a: a1",
    """
links: [{mass: 1.23456, com: [-0.2159, 0, 0], inertia: {zz: 0.019}}]
gravity: [0, -g, 0]
parameters: {a1: 0.4318123456789, g: 9.80665}
""",
)


def test_numbers_are_shown_in_decimals_of_six_digits_and_the_page_says_so() -> None:
    text = page(Robot.from_text(ROD))
    assert "| `a1` | `0.4318123456789` |" in text
    assert "- `Izz1`: `1.23456*a1**2 - 0.533083*a1 + 0.0765463`" in text
    assert "rounded to 6 significant digits" in text
    assert "rounded" not in page(Robot.from_text(ROD.replace("1.23456", "1.2").replace("0.2159", "0.2")))
