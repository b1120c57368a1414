"""``derive plot``: figures of arms and workspaces."""

import sys
from pathlib import Path

import pytest

from derive.cli.main import main
from derive.errors import install_extra
from tests.cli.command import PENDULUM, accepted, derive_process, refused
from tests.interpreters import another_hash_seed

pytest.importorskip("matplotlib")


@pytest.mark.parametrize("suffix", ["pdf", "svg", "png"])
def test_figure_is_written_and_the_same_again(suffix: str, tmp_path: Path) -> None:
    out = tmp_path / f"arm.{suffix}"
    contents = []
    for _ in range(2):
        assert main(["plot", "planar-2r-perugia", "-q", "0.5,pi/4", "-o", str(out), "--force"]) == 0
        contents.append(out.read_bytes())
    assert contents[0] == contents[1]
    assert list(tmp_path.iterdir()) == [out]


@pytest.mark.parametrize("option", [(), pytest.param(("--workspace",), marks=pytest.mark.sweep)])
def test_svg_does_not_depend_on_the_process(option: tuple[str, ...], tmp_path: Path) -> None:
    arguments = ("plot", "scara-perugia", *option, "-o")
    accepted(*arguments, "0.svg", folder=tmp_path)
    assert derive_process(*arguments, "1.svg", folder=tmp_path, PYTHONHASHSEED=another_hash_seed()).status == 0
    assert (tmp_path / "0.svg").read_bytes() == (tmp_path / "1.svg").read_bytes()


def test_the_report_states_the_configuration_and_assumed_lengths(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["plot", "scara-perugia", "-o", str(tmp_path / "a.svg")]) == 0
    text = capsys.readouterr().out
    assert "zero configuration" in text
    assert "a1 = 1 m" in text
    (tmp_path / "arm.yaml").write_text(PENDULUM + "units: {angle: deg}\n")
    assert main(["plot", str(tmp_path / "arm.yaml"), "-q=-90", "-o", str(tmp_path / "b.svg")]) == 0
    assert "q1 = -1.571 rad" in capsys.readouterr().out


@pytest.mark.parametrize("without", ["matplotlib", "matplotlib --workspace", "shapely --workspace"])
def test_a_figure_without_its_packages_says_how_to_install_them(
    without: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    package, *option = without.split()
    monkeypatch.setitem(sys.modules, package, None)
    done = refused("plot", "planar-2r-perugia", *option, "-o", "a.svg", folder=tmp_path)
    assert install_extra("handout") in done.stderr
    assert list(tmp_path.iterdir()) == []
