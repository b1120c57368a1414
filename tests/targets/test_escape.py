"""Escaping: whatever the text, it is text in every language."""

import ast
import html
import json
import re
import string

import pytest
from hypothesis import given
from hypothesis import strategies as st

from derive.targets import escape

texts = st.text(max_size=60) | st.text(
    alphabet="\\\"'`{}*/#%$&_^~<>[]|!?-+=.:@\n\r\t \u2028\u202e\u0416\u00e9x1", max_size=40
)
commands = st.sampled_from(["\\input{x}", '"""', "*/", "??/", "{{x}}", "<script>", "[a](b)", "http://a.b", "--", "$x$"])
hostile = st.builds(lambda parts: "".join(parts), st.lists(texts | commands, max_size=5))


@given(hostile)
def test_python_strings_read_back(text: str) -> None:
    literal = escape.python_string(text)
    assert ast.literal_eval(literal) == text
    assert literal.isascii()
    assert "\n" not in literal


@given(hostile)
def test_docstrings_hold_one_line_of_text(text: str) -> None:
    source = f'"""{escape.python_docstring(text)}"""\nx = 1\n'
    tree = ast.parse(source)
    assert len(tree.body) == 2
    assert ast.literal_eval(tree.body[0].value) == escape.one_line(text)


@given(hostile)
def test_comments_end_where_the_line_ends(text: str) -> None:
    comment = escape.c_comment(text)
    assert "*/" not in comment
    assert "/*" not in comment
    assert "??" not in comment
    assert "\\" not in comment
    assert len(comment.splitlines()) <= 1


@given(hostile)
def test_javascript_strings_are_json_without_tags(text: str) -> None:
    literal = escape.javascript_string(text)
    assert json.loads(literal) == text
    assert literal.isascii()
    assert not set(literal) & set("<>\n")


@given(hostile)
def test_javascript_comments_end_where_they_should(text: str) -> None:
    comment = escape.javascript_comment(text)
    assert "*/" not in comment
    assert "</" not in comment
    assert "<!" not in comment
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
