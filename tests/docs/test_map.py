"""The map of the code, `docs/architecture.md`, and the recipes of `CONTRIBUTING.md` name what is there."""

import ast
import re

import pytest

from tests.places import ROOT

MAP = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
RECIPES = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
ROW = re.compile(r"^\| ([^|]+?) \| `(derive/[a-z_/]+\.py)` \| `(\w+)` \|$", re.MULTILINE)
PLACE = re.compile(r"`((?:derive|templates|tests|docs|bench|generated)/[\w./-]*)`")
INNER = re.compile(r"`((?:[a-z_]+/)+[a-z_]+\.py)`")


def test_the_map_answers_at_least_thirty_questions() -> None:
    assert len(ROW.findall(MAP)) >= 30


@pytest.mark.parametrize(("question", "file", "name"), ROW.findall(MAP))
def test_every_answer_of_the_map_is_there(question: str, file: str, name: str) -> None:
    tree = ast.parse((ROOT / file).read_text(encoding="utf-8"))
    assert name in set(defined(tree)), question


@pytest.mark.parametrize("text", [MAP, RECIPES], ids=["architecture", "contributing"])
def test_every_place_that_is_named_exists(text: str) -> None:
    named = {place for place in PLACE.findall(text) if "<" not in place}
    inner = {
        f"derive/{place}" for place in INNER.findall(text) if place.split("/")[0] not in ("derive", "tests", "docs")
    }
    assert named
    assert not [place for place in sorted(named | inner) if not (ROOT / place).exists()]


def test_every_folder_of_the_package_is_on_the_map() -> None:
    folders = {path.name for path in (ROOT / "derive").iterdir() if (path / "__init__.py").exists()}
    assert not [folder for folder in sorted(folders) if f"`derive/{folder}/`" not in MAP]


def defined(tree: ast.Module) -> list[str]:
    found = [node.name for node in ast.walk(tree) if isinstance(node, ast.FunctionDef | ast.ClassDef)]
    for node in tree.body:
        targets = (
            node.targets if isinstance(node, ast.Assign) else [node.target] if isinstance(node, ast.AnnAssign) else []
        )
        found += [target.id for target in targets if isinstance(target, ast.Name)]
    return found


def test_every_decision_stands_in_the_index() -> None:
    folder = ROOT / "docs" / "decisions"
    index = (folder / "index.md").read_text(encoding="utf-8")
    assert [path.name for path in sorted(folder.glob("0*.md")) if f"({path.name})" not in index] == []
