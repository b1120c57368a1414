"""Whether a difference is a slip, or only shows that a formula of a document is about something else.

A verdict "wrong" needs certainty of what is meant. Two things give it: the formula is near to ours, one small change
away, or it stands among formulas of its kind that are right.
"""

import re
from collections import Counter
from collections.abc import Iterator, Sequence

from derive.checking.formulas.edits import is_token
from derive.checking.formulas.findings import Finding, Role, judge
from derive.robot.expression import Expression, children, is_constant

NEAR = 0.5  # part of the names and functions that a formula shares with ours, or with what repairs it
AMONG = 3  # right formulas of a kind for each one that is far from ours, which make these certain


def doubtful(findings: Sequence[Finding]) -> frozenset[Finding]:
    """The findings that are far from ours, in matrices most of which is, and of a kind most of which is not right.

    One identity alone is certain: both of its sides are those of the text.
    """
    far = [f for f in findings if not (f.verdict.equal or f.some or f.unknown or f.cause) and not _is_near(f)]
    right = [f for f in findings if f.verdict.equal and not (f.question and is_constant(f.question.right))]
    matrices, kinds = (Counter(map(of, right)) for of in (_matrix, _kind))
    far_matrices, far_kinds = (Counter(map(of, far)) for of in (_matrix, _kind))
    return frozenset(
        f
        for f in far
        if kinds[_kind(f)] < AMONG * far_kinds[_kind(f)]
        and not (f.row and matrices[_matrix(f)] >= far_matrices[_matrix(f)])
        and not (f.role is Role.IDENTITY and far_kinds[_kind(f)] == 1)
    )


def _kind(finding: Finding) -> str:
    """What a finding is about without its indices; all identities are of one kind."""
    return finding.role.value if finding.role is Role.IDENTITY else re.sub(r"\[.*", "", finding.quantity)


def _matrix(finding: Finding) -> str:
    return f"{finding.role.value} {finding.quantity}"


def _is_near(finding: Finding) -> bool:
    """Whether a formula shares most with ours, or the smallest change that repairs it keeps most of it."""
    repair, question = judge(finding).repair, finding.question
    if question is None:
        return repair is not None
    # the sides of an identity are those of the text
    near = [question.right] if finding.role is not Role.IDENTITY else []
    printed = Counter(_tokens(question.printed))
    for other in (Counter(_tokens(e)) for e in (*near, *([repair.formula] if repair else ()))):
        if (printed & other).total() >= NEAR * max(printed.total(), other.total()):
            return True
    return False


def _tokens(e: Expression) -> Iterator[Expression]:
    """The names, numbers and cosines and sines of a formula."""
    if is_token(e) or not children(e):
        yield e
    else:
        for child in children(e):
            yield from _tokens(child)
