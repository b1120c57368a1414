"""Printed formulas of textbook robots that are not in the lecture corpus, by robot and by book.

Every file is one robot of one book in the format of the corpus, its formulas grouped as the book prints them, to the
best of our knowledge: they are restated from memory, and what is tested is that each equals the derived one, and how
many come out in the same form. ``python -m tests.textbooks.collection`` prints the table; ``--robots`` by robot;
``--options`` what another value of one option of the default style gains and loses, here and in the lecture corpus.
"""

import sys
import time
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from derive.checking.style_finding import Example, StyleEvidence, printed_examples
from derive.errors import DeriveError
from derive.robot.options.style import STYLE_OPTIONS, Style
from tests.lectures.results import corpus_file, report
from tests.places import CORPUS

FILES = sorted(Path(__file__).parent.glob("*.yaml"))


@dataclass(frozen=True)
class Share:
    """How many formulas with a sum come out as printed."""

    formulas: int  # how many there are
    default: int  # how many in the default style
    found: int  # how many in the style that is found from all of them
    foretold: int  # how many in the style that is found from the others
    style: Style  # the style found from all of them


@cache
def by_robot() -> Mapping[str, Sequence[Example]]:
    return {path.stem: printed_examples(report(path).findings) for path in FILES}


@cache
def by_book() -> Mapping[str, Sequence[Example]]:
    found: dict[str, list[Example]] = {}
    for path in FILES:
        found.setdefault(corpus_file(path).document.title, []).extend(by_robot()[path.stem])
    return found


def share(examples: Sequence[Example], *, foretell: bool = True) -> Share:
    """What the styles make of some formulas; leaving each of them out once takes long."""
    evidence = StyleEvidence(examples)
    style = evidence.best_style()
    found, default = map(evidence.reproduced, (style, Style()))
    foretold = [evidence.fits(i, evidence.best_style(without=i)) for i in range(len(examples)) if foretell]
    return Share(len(examples), default, found, sum(foretold), style)


def table(groups: Mapping[str, Sequence[Example]]) -> str:
    """One line for each group, and the whole."""
    lines = [f"{'':60}  formulas  default  found  foretold  seconds  style"]
    shares = []
    for title, examples in groups.items():
        started = time.process_time()
        shares.append(s := share(examples))
        row = f"{s.formulas:8}  {s.default:7}  {s.found:5}  {s.foretold:8}  {time.process_time() - started:7.1f}"
        lines.append(f"{title[:60]:60}  {row}  {s.style}")
    count = sum(s.formulas for s in shares)
    default, found, foretold = (
        100 * sum(part) / count for part in zip(*((s.default, s.found, s.foretold) for s in shares), strict=True)
    )
    return "\n".join([*lines, f"{'all':60}  {count:8}  {default:6.1f}%  {found:4.1f}%  {foretold:7.1f}%"])


def evidence_of(path: Path) -> StyleEvidence:
    """The formulas of a file that name a quantity; definitions of an abbreviation do not."""
    good = []
    for example in printed_examples(report(path).findings):
        with suppress(DeriveError):
            StyleEvidence([example])
            good.append(example)
    return StyleEvidence(good)


def effects() -> str:
    """One line for each value of each option: formulas that more or fewer come out as printed."""
    corpora = [[evidence_of(path) for path in paths] for paths in (FILES, sorted(CORPUS.glob("[0-9]*.yaml")))]

    def _fitting(style: Style) -> list[int]:
        fitting = ((e.fits(i, style) for e in corpus for i in range(len(e.examples))) for corpus in corpora)
        return [sum(fits) for fits in fitting]

    default = _fitting(Style())
    lines = [f"{'default':32}  {default[0]:5}  {default[1]:8}", f"{'':32}  books  lectures"]
    for option, kind in STYLE_OPTIONS.items():
        for value in kind:
            if value != getattr(Style(), option):
                books, lectures = _fitting(Style().changed({option: value}))
                lines.append(f"{f'{option}: {value}':32}  {books - default[0]:+5}  {lectures - default[1]:+8}")
    return "\n".join(lines)


if __name__ == "__main__":
    print(effects() if "--options" in sys.argv else table(by_robot() if "--robots" in sys.argv else by_book()))
