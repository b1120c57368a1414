"""The transform of any row of a table, by letters."""

from dataclasses import replace

import pytest

from derive.checking.any_row import misprints
from derive.checking.latex.matrices import Entry, Table
from derive.lecture.sympy_conversion import expression_from_sympy
from derive.model.model import Model
from derive.robot.description import Convention
from derive.robot.expression import ZERO, Expression, Name, negate, substitute
from derive.robot.robot import Robot

CELLS = ("theta1", "d1", "a1", "alpha1")


def printed(convention: Convention, letters: dict[str, Expression]) -> Table:
    """The transform of a row as derived, with other letters."""
    text = f"name: row\nconvention: {convention}\njoints: [{{type: revolute, q: theta1, d: d1, a: a1, alpha: alpha1}}]"
    rows = Model(Robot.from_text(text)).quantity("A[1]").tolist()
    return Table(tuple(tuple(Entry(substitute(expression_from_sympy(e), letters)) for e in row) for row in rows))


@pytest.mark.parametrize("convention", Convention)
@pytest.mark.parametrize("letters", ["thetai di ai-1 alphai-1", "th d r alpha", "thetan rn dn alphan", "thetai bi ai"])
def test_a_derived_transform_is_that_of_any_row_and_one_other_sign_is_found(
    convention: Convention, letters: str
) -> None:
    names = letters.split()
    table = printed(
        convention, dict.fromkeys(CELLS, ZERO) | {c: Name(f"?{n}") for c, n in zip(CELLS, names, strict=False)}
    )
    assert misprints(table, names, convention) == []
    assert misprints(table, [*names, "beta"], convention) is None
    if len(names) == len(CELLS):
        other = next(each for each in Convention if each is not convention)
        assert misprints(table, names, other) is None
    (first, *others), *rows = table.rows
    slipped = Table(((replace(first, formula=negate(first.formula)), *others), *rows))
    assert misprints(slipped, names, convention) == [(1, 1)]
    turn = Table(tuple(tuple(row[:3]) for row in table.rows[:3]))
    angles = [name for name in names if name.startswith(("th", "alpha"))]
    assert misprints(turn, angles, convention) == []
    assert misprints(turn, names, convention) is None  # a transform of the plane
