"""The errata of five lecture documents: all found by the command, nearly all with the change that repairs them."""

from __future__ import annotations

from functools import cache

from derive.checking.formulas.findings import Outcome, judge
from derive.checking.report import Item, errata_items, repaired_text
from tests.docs.errata import printouts

ERRATA = 26
WRONG = 35


@cache
def errors() -> tuple[Item, ...]:
    """Without what only differs by a convention of signs."""
    return tuple(item for item in errata_items(printouts()) if item.findings[0].remark.kind != "convention")


def test_every_erratum_is_found_and_nothing_else() -> None:
    found = [finding for item in errors() for finding in item.findings]
    assert (len(errors()), len(found)) == (ERRATA, WRONG)
    assert all(finding.erratum for finding in found)
    assert {judge(finding).outcome for finding in found} == {Outcome.WRONG}


def test_at_least_20_are_explained_by_single_changes() -> None:
    changes = {item.findings[0].entry: [judge(finding).repair for finding in item.findings] for item in errors()}
    single = [name for name, repairs in changes.items() if all(r is not None and len(r.kinds) == 1 for r in repairs)]
    double = [name for name, repairs in changes.items() if all(r is not None and len(r.kinds) == 2 for r in repairs)]
    assert len(single) == 24, single
    assert double == ["T[][1,2]", "Newton-Euler, link frame: vd (prismatic joint)"]


def test_the_change_is_the_one_that_the_corpus_gives_as_correction() -> None:
    """Where the correction is written in the document's own style, the repaired formula is that correction."""
    agree, differ = 0, []
    for item in errors():
        corrections = {f.entry: f.text for f in item.printout.report.findings if f.role.value == "correction"}
        for finding in item.findings:
            correct = corrections[finding.entry]
            same = repaired_text(finding).replace(" ", "") == correct.replace(" ", "")
            agree, differ = agree + same, [*differ, *([] if same else [(repaired_text(finding), correct)])]
    assert agree >= 31, differ


def test_corrections_are_right_and_abbreviated_forms_too() -> None:
    wrong = [f for p in printouts() for f in p.report.findings if not f.verdict.equal and not f.erratum]
    assert wrong == []
