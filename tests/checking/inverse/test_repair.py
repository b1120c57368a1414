"""The smallest change that makes lines right."""

from __future__ import annotations

import pytest

from derive.checking.formulas.edits import SlipKind
from derive.checking.inverse.poses import places
from derive.checking.inverse.repair import Repairer
from derive.robot.expression import to_text
from tests.checking.inverse.test_printed import solution

KNOWN = ("a1", "a2", "q1", "q2", "x", "y")


@pytest.mark.parametrize(
    ("printed", "kind", "right"),
    [
        ("atan2(y + a2*s12, x - a2*c12)", SlipKind.SIGN, "atan2(y - a2*sin(q1 + q2), x - a2*cos(q1 + q2))"),
        ("atan2(x - a2*c12, y - a2*s12)", SlipKind.ORDER, "atan2(y - a2*sin(q1 + q2), x - a2*cos(q1 + q2))"),
        ("atan((y - a2*s12)/(x - a2*c12))", SlipKind.ATAN2, "atan2(y - a2*sin(q1 + q2), x - a2*cos(q1 + q2))"),
        ("atan2(y - a2*s12, x - a2*c1)", SlipKind.INDEX, "atan2(y - a2*sin(q1 + q2), x - a2*cos(q1 + q2))"),
    ],
)
def test_one_change_repairs(printed: str, kind: SlipKind, right: str) -> None:
    found, vocabulary = solution("planar-2r-perugia", f"theta1 = {printed}")
    (line,) = found.given
    tried = sorted(places(vocabulary.pose, vocabulary.sums), key=lambda place: found.hits(line, place))
    repair = Repairer(found, [line], tried, KNOWN).first((kind,), [(line, line.formulas[0])])
    assert repair is not None
    assert repair.edits[0].kind is kind
    assert to_text(repair.expression) == right


def test_nothing_repairs_what_is_wrong_in_many_ways() -> None:
    found, vocabulary = solution("planar-2r-perugia", "theta1 = atan2(a1*s2, x*y - 7)")
    (line,) = found.given
    tried = places(vocabulary.pose, vocabulary.sums)
    assert (
        Repairer(found, [line], tried, KNOWN).first((SlipKind.SIGN, SlipKind.INDEX), [(line, line.formulas[0])]) is None
    )
