"""Templates hold text, loops and flags; every file on disk is used, and every one used is on disk."""

from __future__ import annotations

from pathlib import Path

import pytest
from jinja2 import nodes

from derive.errors import TargetError
from derive.handouts.latex_writer import latex_template
from derive.publish.targets import TARGETS, targets_named
from derive.targets.templating import environment, template_folder

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
    """No arithmetic, comparison, filter, test or assignment: values come finished."""
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
    """In the registry's order, each once; without a choice those that a build writes unasked."""
    assert [target.name for target in targets_named()] == ["numpy", "casadi", "c", "latex", "readme"]
    assert [target.name for target in targets_named(TARGETS)] == list(TARGETS)
    assert [target.name for target in targets_named(["latex", "numpy", "latex"])] == ["numpy", "latex"]
    with pytest.raises(TargetError, match="numpy, casadi, casadi-c, c, native, javascript, octave, latex, readme"):
        targets_named(["matlab"])
