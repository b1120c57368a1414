"""CI runs the sweeps that a change can reach, and a share of their cases."""

from pathlib import Path

import pytest

from tests.reach import importers, reached

FILES = {
    "derive/a.py": "",
    "derive/b.py": "def late():\n    from derive.a import name\n",
    "derive/p/__init__.py": "",
    "derive/p/c.py": "import derive.b\n",
    "derive/__main__.py": "from derive import b\n",
    "bench/apart.py": "",
    "tests/helper.py": "from derive.p import c\n",
    "tests/x/test_c.py": "from tests.helper import something\n",
    "tests/x/test_command.py": "run([executable, '-m', 'derive'])\n",
    "tests/x/test_apart.py": "from bench import apart\n",
}


@pytest.fixture(scope="module")
def ours() -> dict[str, set[str]]:
    return importers()


@pytest.fixture
def graph(tmp_path: Path) -> dict[str, set[str]]:
    for name, text in FILES.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text, encoding="utf-8")
    return importers(tmp_path)


@pytest.mark.parametrize(
    ("changed", "tests"),
    [
        ("derive/a.py", ["c", "command"]),
        ("derive/p/c.py", ["c"]),
        ("bench/apart.py", ["apart"]),
        ("tests/helper.py", ["c"]),
        ("tests/x/test_c.py", ["c"]),
        ("README.md", []),
        ("docs/motion.md", []),
    ],
)
def test_a_change_reaches_the_tests_that_import_it_over_others(
    graph: dict[str, set[str]], changed: str, tests: list[str]
) -> None:
    assert reached([changed], graph) == [f"tests/x/test_{name}.py" for name in tests]


UNSEEN = (
    "templates/c/model.c.jinja", "pyproject.toml", "derive/robot/catalogue/thumb.yaml", "derive/p/__init__.py",
    "tests/conftest.py",
)  # fmt: skip


@pytest.mark.parametrize("changed", UNSEEN)
def test_what_imports_do_not_show_reaches_all_tests(graph: dict[str, set[str]], changed: str) -> None:
    assert reached(["derive/a.py", changed], graph) is None


def test_a_file_that_is_gone_reaches_no_more_than_what_imported_it(graph: dict[str, set[str]]) -> None:
    assert reached(["derive/gone.py", "tests/x/test_gone.py"], graph) == []


@pytest.mark.parametrize(
    ("changed", "test"),
    [
        ("derive/motion/paths/segments.py", "tests/motion/paths/test_segments.py"),
        # over the commands, imported by name
        ("derive/motion/simulation/stepping.py", "tests/cli/test_plot_command.py"),
        ("derive/exchange/formats.py", "tests/exchange/test_rotors.py"),
        ("derive/robot/robot.py", "tests/handouts/test_paper.py"),
    ],
)
def test_a_module_reaches_the_sweep_that_proves_it(ours: dict[str, set[str]], changed: str, test: str) -> None:
    assert test in (reached([changed], ours) or [])


def test_one_module_of_motion_reaches_no_sweep_of_other_folders(ours: dict[str, set[str]]) -> None:
    found = set(reached(["derive/motion/paths/segments.py"], ours) or [])
    assert not found & {"tests/handouts/test_paper.py", "tests/targets/test_octave.py"}
