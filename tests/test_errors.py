"""Messages: hints that name commands are commands that work where derive runs."""

import importlib.metadata
import re
import shlex
import sys
import tomllib
from pathlib import Path

import pytest

from derive import errors
from tests.places import ROOT

EXTRAS = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["optional-dependencies"]
HINTED = {
    extra
    for path in (ROOT / "derive").rglob("*.py")
    for extra in re.findall(r'(?:install_extra\(|needs? \w+", (?:extra=)?)"([^"]+)"', path.read_text(encoding="utf-8"))
}


def test_hints_name_extras_that_exist() -> None:
    assert {"data", "handout", "motion", "exchange"} == HINTED
    assert EXTRAS.keys() >= HINTED


@pytest.mark.parametrize("extra", sorted(HINTED))
def test_an_extra_is_installed_by_its_packages_and_by_the_python_that_runs(extra: str) -> None:
    """No index need know derive: only the packages that the extra stands for."""
    python, *pip, first = shlex.split(errors.install_extra(extra))[:4]
    assert (python, pip, first) == (sys.executable, ["-m", "pip"], "install")
    named = {re.split(r"[<>=]", text)[0] for text in shlex.split(errors.install_extra(extra))[4:]}
    assert named == {re.split(r"[<>=]", text)[0] for text in EXTRAS[extra]}


def test_a_checkout_that_is_not_installed_is_named_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    def unknown(name: str) -> list[str]:
        raise importlib.metadata.PackageNotFoundError(name)

    monkeypatch.setattr(importlib.metadata, "requires", unknown)
    what = shlex.split(errors.install_extra("motion"))[-1]
    assert (Path(what.removesuffix("[motion]")) / "pyproject.toml").is_file()


@pytest.mark.parametrize("folder", ["derive", "docs", "templates"])
def test_nothing_is_installed_from_an_index_that_has_no_derive(folder: str) -> None:
    pages = [*(ROOT / folder).rglob("*.py"), *(ROOT / folder).rglob("*.md"), *(ROOT / folder).rglob("*.jinja")]
    assert [str(page) for page in pages if re.search(r"install '?derive-robot", page.read_text(encoding="utf-8"))] == []
