"""Whether a difference is a slip, or only shows that a formula of a document is about something else.

A verdict "wrong" needs certainty of what is meant. Two things give it: the formula is near to ours, one small change
away, or it stands among formulas of its kind that are right.
"""

import re
from bisect import bisect_right
from collections import Counter
from collections.abc import Sequence
from itertools import groupby

from derive.checking.formulas.diagnosis import PAIRED
from derive.checking.formulas.edits import is_token, spots
from derive.checking.formulas.findings import Finding, Role, Skipped, judge
from derive.errors import Location
from derive.robot.expression import Expression, children, is_constant

NEAR = 0.5  # more than this part of its names and functions a near formula shares with ours, or with what repairs it
AMONG = 3  # right formulas of a kind for each one that is far from ours, which make these certain
_FAR = "as {} it would be wrong in more than one place, and so would most of its kind: it may mean something else"
_SIDES_DIFFER = "its sides differ in more than one place, as too many here do: a name may mean something else"


def certain(findings: Sequence[Finding], begins: Sequence[Location]) -> tuple[tuple[Finding, ...], tuple[Skipped, ...]]:
    """The findings without those that are far from ours, which are told as not compared.

    Of a matrix or of a kind most of which is right they are slips. `begins` are the places at which the equations of
    the text begin. One identity alone is certain: both of its sides are those of the text.
    """
    starts = [(at.line or 0, at.column or 0) for at in begins]

    def matrix(f: Finding) -> tuple[str, int]:
        return f.quantity, bisect_right(starts, (f.location.line or 0, f.location.column or 0))

    far = [f for f in findings if not (f.verdict.equal or f.some or f.unknown or f.cause) and not _is_near(f)]
    right = [f for f in findings if f.verdict.equal and not (f.question and is_constant(f.question.right))]
    matrices, kinds = Counter(map(matrix, right)), Counter(map(_kind, right))
    far_matrices, far_kinds = Counter(map(matrix, far)), Counter(map(_kind, far))
    doubted = [
        f
        for f in far
        if kinds[_kind(f)] < AMONG * far_kinds[_kind(f)]
        and not (f.row and matrices[matrix(f)] >= far_matrices[matrix(f)])
        and not (f.role is Role.IDENTITY and far_kinds[_kind(f)] == 1)
    ]
    firsts = [next(group) for _, group in groupby(doubted, key=matrix)]
    reasons = (_SIDES_DIFFER if f.role is Role.IDENTITY else _FAR.format(f.entry) for f in firsts)
    told = tuple(Skipped(f.location, reason, f.text) for f, reason in zip(firsts, reasons, strict=True))
    return tuple(f for f in findings if f not in doubted), told


def _kind(finding: Finding) -> str:
    """What a finding is about without its indices; all identities are of one kind."""
    return finding.role.value if finding.role is Role.IDENTITY else re.sub(r"\[.*", "", finding.quantity)


def _is_near(finding: Finding) -> bool:
    """Whether it shares most with ours, or is repaired by a sign, a function, an exponent, an index or little else."""
    repair, question = judge(finding).repair, finding.question
    if question is None or (repair and repair.kinds and set(repair.kinds) <= {*PAIRED}):
        return repair is not None
    # the sides of an identity are those of the text
    near = [question.right] if finding.role is not Role.IDENTITY else []
    printed = _tokens(question.printed)
    for other in map(_tokens, (*near, *([repair.formula] if repair else ()))):
        if (printed & other).total() > NEAR * max(printed.total(), other.total()):
            return True
    return False


def _tokens(e: Expression) -> Counter[Expression]:
    """The names, numbers and cosines and sines of a formula."""
    return Counter(spot.node for spot in spots(e) if is_token(spot.node) or not children(spot.node))
