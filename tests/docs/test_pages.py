"""What the README and the pages under docs/ show is what a reader gets."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest

from derive.model.quantities import REGISTRY
from tests.docs.console import ROOT, agrees, blocks, commands, environment, run

PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
CONSOLE_PAGES = [page for page in PAGES if any(block.language == "console" for block in blocks(page))]
LINK = re.compile(r"\[[^\]]*\]\(([^)#\s]+)(?:#[^)]*)?\)")


def name(page: Path) -> str:
    return str(page.relative_to(ROOT))


@pytest.mark.parametrize("page", CONSOLE_PAGES, ids=name)
def test_commands_print_what_the_page_shows(page: Path, tmp_path: Path) -> None:
    variables = environment(tmp_path / "path")
    folder = tmp_path / "work"
    folder.mkdir()
    for block in blocks(page):
        if block.file:
            (folder / block.file).write_text(block.body, encoding="utf-8")
        if block.language != "console":
            continue
        for command in commands(block):
            printed, status = run(command, folder, variables)
            shown = "\n".join(printed)
            assert status == command.status, f"{name(page)}:{block.line}: {command.text}\n{shown}"
            assert agrees(command.output, printed), f"{name(page)}:{block.line}: {command.text} prints\n{shown}"


@pytest.mark.parametrize("page", PAGES, ids=name)
def test_python_blocks_run(page: Path, tmp_path: Path) -> None:
    """One interpreter per page, in the folder that the page's commands have left."""
    python = [block for block in blocks(page) if block.language == "python"]
    if not python:
        return
    variables = environment(tmp_path / "path")
    folder = tmp_path / "work"
    folder.mkdir()
    for block in blocks(page):
        if block.file:
            (folder / block.file).write_text(block.body, encoding="utf-8")
        if block.language == "console":
            for command in commands(block):
                run(command, folder, variables)
    script = folder / "page.py"
    script.write_text("\n".join(block.body for block in python), encoding="utf-8")
    interpreter = ["python", script.name]
    done = subprocess.run(interpreter, cwd=folder, env=variables, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("page", PAGES, ids=name)
def test_links_between_pages_lead_somewhere(page: Path) -> None:
    targets = [target for target in LINK.findall(page.read_text(encoding="utf-8")) if "://" not in target]
    missing = [target for target in targets if not (page.parent / target).exists()]
    assert not missing


@pytest.mark.parametrize("page", PAGES, ids=name)
def test_make_targets_that_a_page_names_exist(page: Path) -> None:
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    phony = re.search(r"^\.PHONY: (.*)$", makefile, re.MULTILINE)
    assert phony
    shell = "\n".join(block.body for block in blocks(page) if block.language == "sh")
    named = set(re.findall(r"^make ([a-z-]+)", shell, re.MULTILINE))
    assert named <= set(phony[1].split())


def test_page_of_quantities_names_every_quantity() -> None:
    text = (ROOT / "docs" / "quantities.md").read_text(encoding="utf-8")
    assert not [name for name in REGISTRY if f"`{name}`" not in text and f"`{name}[" not in text]


def test_every_page_can_be_reached_from_another() -> None:
    linked = {
        (page.parent / target).resolve()
        for page in PAGES
        for target in LINK.findall(page.read_text(encoding="utf-8"))
        if "://" not in target
    }
    assert not [name(page) for page in PAGES if page.name != "README.md" and page.resolve() not in linked]
