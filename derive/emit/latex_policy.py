"""How much of a closed form the sheet prints; what is beyond is listed with its number of terms, never dropped silently."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class SheetPolicy:
    """Budgets of the sheet. Terms are those of the multiplied-out polynomial, lines those on paper.

    Attributes:
        entry_terms: Longest entry that is written at all: writing one costs time even where it is not printed.
        quantity_terms: Longest quantity that is written, shortest entries first.
        entry_lines: Longest entry that is printed: a third of a page is as much as anybody reads.
        quantity_lines: Longest quantity that is printed, shortest entries first: four pages.
        compact_terms: Longest quantity that is printed multiplied out where a form in named terms exists.
        factor_terms: Longest entry of a partial product of transforms, where T itself is too long.
        closed_form_joints: Most joints for which the closed form of the dynamics is derived for the sheet. Its size grows
            about fivefold with each joint, and of eight joints hardly an entry would be printed.
        named_products: Most velocity products per equation of motion written out in named terms.
    """

    entry_terms: int = 500
    quantity_terms: int = 5000
    entry_lines: int = 16
    quantity_lines: int = 190
    compact_terms: int = 60
    factor_terms: int = 24
    closed_form_joints: int = 7
    named_products: int = 60


POLICY = SheetPolicy()
