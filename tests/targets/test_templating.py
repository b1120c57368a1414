"""Templates hold text, loops and flags; every file on disk is used, and every one used is on disk."""

import re
import sys
from pathlib import Path

import pytest
from jinja2 import nodes

from derive.errors import TargetError
from derive.handouts.sheet.latex_writer import latex_template
from derive.publish.targets import TARGETS, targets_named
from derive.targets import templating
from derive.targets.templating import environment, robot_argument, template_folder

FOLDER = Path(str(template_folder()))
TEMPLATES = sorted(path.relative_to(FOLDER).as_posix() for path in FOLDER.rglob("*") if path.is_file())

FORBIDDEN = (
    nodes.BinExpr,
    nodes.UnaryExpr,
    nodes.Filter,
    nodes.Test,
    nodes.Slice,
    nodes.Assign,
    nodes.AssignBlock,
    nodes.NSRef,
)
ALLOWED_OPERATORS = (nodes.And, nodes.Or, nodes.Not)


@pytest.mark.parametrize("name", TEMPLATES)
def test_templates_compute_nothing(name: str) -> None:
    source = (FOLDER / name).read_text(encoding="utf-8")
    reads = latex_template("blocks.tex.jinja").environment if name.endswith(".tex.jinja") else environment()
    tree = reads.parse(source)
    for kind in (*FORBIDDEN, nodes.Compare):
        found = [node for node in tree.find_all(kind) if not isinstance(node, ALLOWED_OPERATORS)]
        assert not found, f"{name}:{found[0].lineno}: {type(found[0]).__name__}"


def test_the_registry_and_the_templates_agree() -> None:
    """One folder for every target (the handout's is ``latex``); one each for exchange, page, motions, package."""
    targets = {"handout" if name == "latex" else name for name in TARGETS}
    assert {name.split("/")[0] for name in TEMPLATES} == {*targets, "exchange", "motion", "package", "page"}
    files = [file for target in TARGETS.values() for file in target.files]
    assert len(set(files)) == len(files)


def test_targets_are_chosen_by_name() -> None:
    assert [target.name for target in targets_named()] == ["numpy", "casadi", "c", "latex", "readme"]
    assert [target.name for target in targets_named(TARGETS)] == list(TARGETS)
    assert [target.name for target in targets_named(["native"])] == [
        "numpy",
        "casadi",
        "c",
        "native",
        "latex",
        "readme",
    ]
    assert [target.name for target in targets_named(["latex", "numpy", "latex"], only=True)] == ["numpy", "latex"]
    assert targets_named(only=True) == targets_named()
    with pytest.raises(TargetError, match="numpy, casadi, casadi-c, c, native, javascript, octave, latex, readme"):
        targets_named(["matlab"])


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
