"""The wheel and the source archive hold what a user needs, and nothing else."""

import re
import tarfile
import tomllib
import zipfile
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path

import pytest

from derive import __version__
from tests.places import ROOT

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def build_wheel(source: Path, folder: Path) -> Path:
    builder = pytest.importorskip("hatchling.builders.wheel").WheelBuilder(str(source))
    return Path(next(builder.build(directory=str(folder), versions=["standard"])))


def content(wheel: Path) -> set[str]:
    with zipfile.ZipFile(wheel) as archive:
        return set(archive.namelist())


def sources(folder: Path) -> set[str]:
    """Files of ``folder`` that belong to the product, by their paths from the root."""
    found = (path for path in folder.rglob("*") if path.is_file() and "__pycache__" not in path.parts)
    return {path.relative_to(ROOT).as_posix() for path in found}


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return build_wheel(ROOT, tmp_path_factory.mktemp("wheel"))


@pytest.fixture(scope="module")
def sdist(tmp_path_factory: pytest.TempPathFactory) -> Path:
    builder = pytest.importorskip("hatchling.builders.sdist").SdistBuilder(str(ROOT))
    return Path(next(builder.build(directory=str(tmp_path_factory.mktemp("sdist")))))


def test_wheel_holds_the_package_its_templates_command_and_licence_and_nothing_else(wheel: Path) -> None:
    expected = sources(ROOT / "derive") | {f"derive/{name}" for name in sources(ROOT / "templates")}
    assert {name for name in content(wheel) if ".dist-info/" not in name} == expected
    assert {"derive/robot/catalogue/scara-perugia.yaml", "derive/py.typed"} <= expected
    with zipfile.ZipFile(wheel) as archive:
        (entry_points,) = (archive.read(name) for name in archive.namelist() if name.endswith("/entry_points.txt"))
        (licence,) = (archive.read(name) for name in archive.namelist() if name.endswith("/licenses/LICENSE"))
    assert b"derive = derive.cli.main:main" in entry_points
    assert b"MIT License" in licence


def test_wheel_from_the_source_archive_is_the_wheel_from_the_checkout(wheel: Path, sdist: Path, tmp_path: Path) -> None:
    with tarfile.open(sdist) as archive:
        safely = {"filter": "data"} if hasattr(tarfile, "data_filter") else {}  # not in Python 3.11.2, Debian 12's
        archive.extractall(tmp_path, **safely)
    (unpacked,) = tmp_path.iterdir()
    assert content(build_wheel(unpacked, tmp_path / "dist")) == content(wheel)


def test_source_archive_can_be_tested(sdist: Path) -> None:
    with tarfile.open(sdist) as archive:
        names = {name.split("/", 1)[1] for name in archive.getnames()}
    assert {"Makefile", "constraints.txt", "CHANGELOG.md", "README.md", "tests/packaging/test_distribution.py"} <= names


def test_versions_agree(wheel: Path) -> None:
    changelog = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    released = re.findall(r"^## \[(\d[^\]]*)\]", changelog, re.MULTILINE)
    assert released[0] == __version__
    assert wheel.name.split("-")[1] == __version__
    assert "version" not in PROJECT
    try:
        installed = distribution(PROJECT["name"]).version
    except PackageNotFoundError:
        return
    assert installed == __version__
