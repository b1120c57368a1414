"""What users write is text and nothing else, in every language: escaped, and as titles, joints and parameters."""

import ast
import html
import json
import re
import string
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from derive.programs.build import build_program
from derive.programs.optimise.search_policy import Effort
from derive.robot.robot import Robot
from derive.targets import escape
from derive.targets.compiler import compile_shared, require_compiler
from derive.targets.javascript import render_javascript
from derive.targets.numpy import render_numpy
from derive.targets.octave import render_octave
from derive.targets.readme import render as render_readme
from derive.targets.target import joint_bounds
from tests.targets.generated_models import STRICT, needs_compiler, planar, program_of, source_of, write_c_model
from tests.targets.languages import languages, running, texts_of

texts = st.text(max_size=60) | st.text(
    alphabet="\\\"'`{}*/#%$&_^~<>[]|!?-+=.:@\n\r\t \u2028\u202e\u0416\u00e9x1", max_size=40
)
commands = st.sampled_from(["\\input{x}", '"""', "*/", "??/", "{{x}}", "<script>", "[a](b)", "http://a.b", "--", "$x$"])
hostile = st.builds(lambda parts: "".join(parts), st.lists(texts | commands, max_size=5))


@pytest.mark.parametrize(
    ("written", "read", "never"),
    [(escape.python_string, ast.literal_eval, "\n"), (escape.javascript_string, json.loads, "<>\n")],
)
@given(text=hostile)
def test_strings_read_back(written: Callable[[str], str], read: Callable[[str], object], never: str, text: str) -> None:
    literal = written(text)
    assert read(literal) == text
    assert literal.isascii()
    assert not set(literal) & set(never)


@given(hostile)
def test_docstrings_hold_one_line_of_text(text: str) -> None:
    source = f'"""{escape.python_docstring(text)}"""\nx = 1\n'
    tree = ast.parse(source)
    assert len(tree.body) == 2
    assert ast.literal_eval(tree.body[0].value) == escape.one_line(text)


@pytest.mark.parametrize(
    ("written", "ends"), [(escape.c_comment, ("*/", "/*", "??", "\\")), (escape.javascript_comment, ("*/", "</", "<!"))]
)
@given(text=hostile)
def test_comments_end_where_the_line_ends(written: Callable[[str], str], ends: tuple[str, ...], text: str) -> None:
    comment = written(text)
    assert not [end for end in ends if end in comment]
    assert len(comment.splitlines()) <= 1


@given(hostile)
def test_html_has_no_markup(text: str) -> None:
    escaped = escape.html_text(text)
    assert html.unescape(escaped).strip() == escape.one_line(text)
    assert not set(escaped) & set("<>\"'")


@given(hostile)
def test_latex_has_only_our_commands(text: str) -> None:
    latex = escape.latex_text(text)
    assert latex.isascii()
    rest = re.sub(r"\\ensuremath\{(\\[A-Za-z]+|\{\}\^\\circ)\}", "", latex)
    rest = re.sub(r"\\(textbackslash|textasciicircum|textasciitilde|textless|textgreater|textbar|char34)\{\}", "", rest)
    rest = re.sub(r"\\(ss|ae|AE|oe|OE|o|O|l|L|i|j)\{\}", "", rest)
    rest = re.sub(r"\\[`'^~\"=.uvHcr]\{[A-Za-z]?\}", "", rest)
    rest = re.sub(r"\\[{}$&#%_]", "", rest)
    assert not set(rest) & set('\\$&#%^~_<>|"')
    assert rest.count("{") == rest.count("}")


@given(hostile)
def test_markdown_has_no_markup(text: str) -> None:
    markdown = escape.markdown_text(text)
    assert len(markdown.splitlines()) <= 1
    plain = re.sub(r"\\[" + re.escape(string.punctuation) + "]", "x", markdown)
    assert not set(plain) & set("`*_[]<|~$#\\")
    assert not re.match(r"\s*([-+=>]|[0-9]+[.)])", plain)
    assert "://" not in plain


def test_common_letters_of_titles_stay_readable() -> None:
    assert escape.latex_text("Stäubli \N{GREEK SMALL LETTER ALPHA}-arm, Łódź 5 µm") == (
        r"St\"{a}ubli \ensuremath{\alpha}-{}arm, \L{}\'{o}d\'{z} 5 \ensuremath{\mu}m"
    )
    assert escape.markdown_text("PUMA 560 (symbolic), 2-link") == "PUMA 560 (symbolic), 2-link"
    assert escape.python_string("q1") == '"q1"'


@given(hostile)
def test_matlab_strings_and_comments_are_one_line(text: str) -> None:
    literal = escape.matlab_string(text)
    assert literal[0] == literal[-1] == "'"
    assert "'" not in literal[1:-1].replace("''", "")
    assert len(literal.splitlines()) == 1
    assert len(escape.one_line(text).splitlines()) <= 1


@pytest.mark.parametrize(
    ("name", "package"),
    [
        ("puma560-corke", "puma560_corke"),
        ("plot", "robot_plot"),
        ("end", "robot_end"),
        ("unwind-protect", "robot_unwind_protect"),
        ("3-arm", "robot_3_arm"),
        ("a-", "robot_a"),
        ("a-" + "b" * 62, "a_" + "b" * 61),
    ],
)
def test_packages_of_matlab_have_names_that_nothing_of_it_has(name: str, package: str) -> None:
    assert escape.matlab_package(name) == package


def test_symbols_of_matlab_are_no_longer_than_it_tells_apart() -> None:
    assert escape.matlab_symbol("m2", 3) == "m2"
    assert escape.matlab_symbol("m" * 64, 3) == "3"


TITLES = [
    'a """ b',
    '"""',
    "back\\slash\\",
    "{{ 7*7 }}{% raw %}",
    "*/ // # \\input{x}",
    "two\nlines\r\nthree",
    "\u202eevil \u0416 \u4e2d\u6587 \U0001f916",
    "\\N{BULLET} \\x41 \\",
    "'''\n\"\"\"\nimport os",
    "*/ throw 1; </script><!-- \\u2028 `${1}` ??/",
]


def code_of(file: str, text: str) -> str:
    """A file without its comments, or without the docstring at its top."""
    if file.endswith(".py"):
        return ast.dump(ast.Module(ast.parse(text).body[1:], []))
    if file.endswith(".m"):
        return re.sub(r"^ *%.*\n", "", text, flags=re.MULTILINE)
    return re.sub(r"/\*.*?\*/", "", text.replace("\\\n", ""), flags=re.DOTALL)


@pytest.mark.parametrize("language", languages())
def test_titles_stay_inert(language: str) -> None:
    program = program_of(planar())
    usual = {file: code_of(file, text) for file, text in texts_of(language, planar(), program).items()}
    for title in TITLES:
        texts = texts_of(language, replace(planar(), title=title), program)
        assert {file: code_of(file, text) for file, text in texts.items()} == usual
        forbidden = {"c": ("??",), "javascript": ("</script", "<!--")}.get(language, ())
        assert not any(word in text for text in texts.values() for word in forbidden)


RESERVED = "lambda t1 k1 double lanes result LANES sign int count sines restrict p k np math functions q c1 s1 print"
RESERVED += " class Math DOF constructor arguments model end function error z params index"


def heavy(names: list[str]) -> Robot:
    cells = zip(names[::3], names[1::3], names[2::3], strict=True)
    links = "".join(f"  - {{mass: {mass}, com: [{x}, {y}, 0]}}\n" for mass, x, y in cells)
    joints = "  - {type: revolute, a: 0.5}\n" * (len(names) // 3)
    return Robot.from_text(
        f"name: names\nconvention: standard\njoints:\n{joints}gravity: [0, -9.81, 0]\nlinks:\n{links}"
    )


@pytest.mark.parametrize("language", languages())
def test_names_of_users_never_collide_with_names_of_ours(language: str) -> None:
    names, found = RESERVED.split(), []
    for own in (names, [f"x{k}" for k in range(len(names))]):
        robot = heavy(own)
        program = build_program(robot, Effort.QUICK, names={"gravity_vector"})
        with running(language, robot, program) as model:
            values = {name: 1.0 + 0.1 * k for k, name in enumerate(own)}
            found.append(model.call("gravity_vector", [np.full(robot.n, 0.1)], values))
    np.testing.assert_allclose(*found, rtol=1e-13)


NAMES = ('shoulder "pan" \\', "*/ it's ''' \"\"\" <&> `x` --> {{ dof }} %{", "q3")

NAMED = """
name: named
convention: standard
joints:
  - {type: revolute, theta: q1, a: 0.5, limits: [-2, 2], speed: 3, torque: 80, name: "shoulder \\"pan\\" \\\\"}
  - {type: prismatic, d: q2, alpha: pi/2, torque: 9.5, name: "*/ it's ''' \\"\\"\\" <&> `x` --> {{ dof }} %{"}
  - {type: revolute, theta: q3, d: 0.1}
inverse: {task: [x, y, z], given: [q2]}
"""

SPEEDS, TORQUES = (3.0, None, None), (80.0, 9.5, None)


@pytest.fixture(scope="module")
def robot() -> Robot:
    return Robot.from_text(NAMED)


def test_a_joint_without_a_name_is_called_by_its_variable(robot: Robot) -> None:
    assert tuple(joint.label for joint in robot.joints) == NAMES
    assert [joint.name for joint in robot.joints] == [*NAMES[:2], ""]
    assert joint_bounds(robot) == {"SPEED_LIMITS": SPEEDS, "TORQUE_LIMITS": TORQUES}
    assert joint_bounds(planar()) == {}


@pytest.mark.parametrize("language", languages("numpy", "native", "casadi"))
def test_python_has_names_and_bounds_to_the_letter(robot: Robot, language: str) -> None:
    with running(language, robot) as model:
        constants = model.constants
        assert [constants[f"{of}S"] for of in ("JOINT_NAME", "SPEED_LIMIT", "TORQUE_LIMIT")] == [NAMES, SPEEDS, TORQUES]
        assert {"SPEED_LIMITS", "TORQUE_LIMITS"} <= {*constants["__all__"]}
        assert "shoulder" in constants["__doc__"]
    assert "SPEED_LIMITS" not in render_numpy(source_of(planar()))["model_numpy.py"]


@pytest.mark.parametrize("language", languages("javascript"))
def test_javascript_has_names_and_bounds_to_the_letter(robot: Robot, language: str) -> None:
    with running(language, robot) as model:
        assert model.value("model.JOINT_NAMES") == [*NAMES]
        assert model.value("[model.SPEED_LIMITS, model.TORQUE_LIMITS]") == [[*SPEEDS], [*TORQUES]]
    assert "</" not in render_javascript(source_of(robot))["model.mjs"]


@pytest.mark.parametrize("language", languages("octave"))
def test_octave_has_names_and_bounds_to_the_letter(robot: Robot, language: str) -> None:
    with running(language, robot) as model:
        assert model.constants["DOF"] == 3  # the package is read
    (text,) = (t for name, t in render_octave(source_of(robot)).items() if name.endswith("/model.m"))
    assert "'*/ it''s '''''' \"\"\" <&> `x` --> {{ dof }} %{'" in text
    assert "robot.speed_limits = [3.0; Inf; Inf];" in text


@needs_compiler
def test_names_end_no_comment_of_c(robot: Robot, tmp_path: Path) -> None:
    texts = write_c_model(tmp_path, robot)
    compile_shared(require_compiler(), [tmp_path / "model.c"], tmp_path / "x.so", STRICT)
    assert "shoulder" in texts["model.h"]


def test_the_page_names_them_outside_of_code(robot: Robot) -> None:
    page = render_readme(source_of(robot))["README.md"]
    assert "- `1: q1, revolute [rad]` shoulder" in page
    assert "- `3: q3, revolute [rad]`\n" in page
