"""Numbers of operations. A change of sign is free, a square is one multiplication."""

from __future__ import annotations

from dataclasses import asdict, dataclass


@dataclass(frozen=True, slots=True)
class Counts:
    """Operations of one evaluation.

    Attributes:
        mul: Multiplications.
        add: Additions and subtractions.
        div: Divisions.
        trig: Sines and cosines.
        other: Roots, signs and whatever else there is.
    """

    mul: int = 0
    add: int = 0
    div: int = 0
    trig: int = 0
    other: int = 0

    @property
    def arithmetic(self) -> int:
        """Multiplications, additions and divisions: the figure of the tables."""
        return self.mul + self.add + self.div

    def as_dict(self) -> dict[str, int]:
        """Counts by name, for the results file."""
        return {"arithmetic": self.arithmetic, **asdict(self)}
