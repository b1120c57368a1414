"""Reads what pdflatex wrote into its log: errors with their lines, overfull boxes, pages."""

from __future__ import annotations

import re
from dataclasses import dataclass

_FAULT = re.compile(r"^(?:! (?!\s*==>)(?P<plain>.+)|(?P<file>[^\s:][^:\n]*):(?P<line>\d+): (?P<message>.+))$", re.M)
_PLACE = re.compile(r"^l\.(\d+) ", re.M)
_OVERFULL = re.compile(
    r"^Overfull \\[hv]box \((?P<size>[0-9.]+)pt too (?:wide|high)\)(?:.*?lines? (?P<line>\d+))?", re.M
)
_PAGES = re.compile(r"Output written on [^(]*\((\d+) page")


@dataclass(frozen=True, slots=True)
class Fault:
    """An error of LaTeX.

    Attributes:
        message: What LaTeX says.
        line: Line of the input, counted from 1; 0 where LaTeX names none.
    """

    message: str
    line: int


@dataclass(frozen=True, slots=True)
class OverfullBox:
    """Something that is too large for its place.

    Attributes:
        points: By how much [pt].
        line: Line of the input where its paragraph begins; 0 where LaTeX names none.
    """

    points: float
    line: int


@dataclass(frozen=True, slots=True)
class LatexLog:
    """The log of a run of pdflatex, of the last one where there were several.

    Attributes:
        text: The whole log.
        status: Exit status of the program.
    """

    text: str
    status: int = 0

    @property
    def faults(self) -> list[Fault]:
        """All errors, in their order."""
        return [self._fault(match) for match in _FAULT.finditer(self.text)]

    @property
    def errors(self) -> list[str]:
        """What LaTeX says of each error."""
        return [fault.message for fault in self.faults]

    @property
    def overfull_boxes(self) -> list[OverfullBox]:
        """Everything that is too large for its place, in its order."""
        found = _OVERFULL.finditer(self.text)
        return [OverfullBox(float(match["size"]), int(match["line"] or 0)) for match in found]

    @property
    def overfull(self) -> float:
        """The worst overfull box [pt]; 0 if there is none."""
        return max((box.points for box in self.overfull_boxes), default=0.0)

    @property
    def pages(self) -> int:
        """Pages of the document; 0 if none was written."""
        match = _PAGES.search(self.text.replace("\n", ""))
        return int(match.group(1)) if match else 0

    def _fault(self, match: re.Match[str]) -> Fault:
        """An error in either form; the plain one has its line further down."""
        if match["message"]:
            return Fault(match["message"].strip(), int(match["line"]))
        following = _FAULT.search(self.text, match.end())
        place = _PLACE.search(self.text, match.end(), following.start() if following else len(self.text))
        return Fault(match["plain"].strip(), int(place[1]) if place else 0)
