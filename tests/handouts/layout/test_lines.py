"""Long expressions over several lines: nothing is lost, nothing is too wide."""

from hypothesis import given
from hypothesis import strategies as st

from derive.handouts.layout.lines import Equation, break_lines, equation_lines, matrix, matrix_rows, pack
from derive.handouts.notation.pieces import Box, Break, TexPiece, italic

HEAD = Box("b = ", 30.0)


@st.composite
def rows(draw: st.DrawFn) -> list[TexPiece]:
    count = draw(st.integers(1, 60))
    widths = draw(st.lists(st.floats(1.0, 150.0), min_size=count, max_size=count))
    kinds = draw(st.lists(st.sampled_from(list(Break)), min_size=count, max_size=count))
    depths = draw(st.lists(st.integers(0, 4), min_size=count, max_size=count))
    breaks = [Break.NEVER if not k or k % 3 == 1 else kind for k, kind in enumerate(kinds)]
    return [TexPiece(Box(f"<{k}>", widths[k]), breaks[k], depths[k]) for k in range(count)]


@given(rows())
def test_every_piece_appears_once_and_in_order(pieces: list[TexPiece]) -> None:
    text = "".join(break_lines(HEAD, pieces, 455.0))
    places = [text.index(piece.box.tex) for piece in pieces]
    assert places == sorted(places)
    assert all(text.count(piece.box.tex) == 1 for piece in pieces)


@given(st.lists(st.floats(1.0, 300.0), min_size=1, max_size=60), st.integers(0, 3))
def test_lines_fit_where_every_piece_may_start_one(widths: list[float], depth: int) -> None:
    pieces = [TexPiece(Box(f"<{k}>", width), Break.BINARY, depth) for k, width in enumerate(widths)]
    for number, line in enumerate(break_lines(HEAD, pieces, 455.0)):
        used = sum(piece.box.width for piece in pieces if piece.box.tex in line)
        indentation = 30.0 if number == 0 else (10.0, 20.0, 30.0, 30.0)[depth]
        assert used + indentation <= 455.0 + 1e-6


def test_lines_break_outside_of_brackets_if_they_can() -> None:
    """The sum outside is broken though the bracket would fill the line further."""
    terms = [TexPiece(Box("x", 110.0), Break.BINARY if k else Break.NEVER) for k in range(3)]
    bracket = [
        TexPiece(Box("(", 5.0), Break.BINARY),
        *(TexPiece(Box("y", 40.0), Break.BINARY, 1) for _ in range(6)),
    ]
    lines = break_lines(HEAD, [*terms, *bracket], 455.0)
    assert [line.count("x") for line in lines] == [3, 0]
    assert "(" in lines[1]


def test_short_equations_share_a_line() -> None:
    equations = [Equation(italic(letter), (TexPiece(italic("x")),)) for letter in "abcdefgh"]
    lines = equation_lines(equations)
    assert len(lines) == 1
    assert [lines[0].index(f"{letter} =") for letter in "abcdefgh"] == sorted(
        lines[0].index(f"{letter} =") for letter in "abcdefgh"
    )


def test_boxes_are_packed_within_the_width() -> None:
    assert pack([Box("a", 200.0), Box("b", 200.0), Box("c", 200.0)], 455.0) == ["a \\qquad b", "c"]
    assert pack([], 455.0) == []


def test_the_width_of_a_matrix_is_that_of_its_columns() -> None:
    cell = Box("x", 20.0)
    assert matrix([[cell, cell], [cell, Box("y", 50.0)]]).width >= 20.0 + 50.0 + 10.0


def test_rows_of_fractions_in_a_matrix_keep_off_each_other() -> None:
    rows = matrix_rows([["\\tfrac{1}{2}", "0"], ["x", "\\tfrac{1}{3}"], ["0", "1"]])
    assert rows == ["\\tfrac{1}{2} & 0 \\\\[0.6ex]", "x & \\tfrac{1}{3} \\\\", "0 & 1"]
    assert matrix_rows([["x"]]) == ["x"]
