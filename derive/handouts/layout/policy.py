"""How much of a closed form the sheet prints; what is beyond is listed with its number of terms, never dropped."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class SheetPolicy:
    """Budgets of the sheet. Terms are those of the multiplied-out polynomial, lines those on paper.

    Attributes:
        flat_terms: Longest entry of kinematics that is written at all: a line holds eight terms or so.
        grouped_terms: Longest entry of dynamics; grouped by inertial parameters a line holds some thirty.
        quantity_entries: So many of the longest entries make the longest quantity that is written, shortest first.
        entry_lines: Longest entry that is printed: a third of a page is as much as anybody reads.
        quantity_lines: Longest quantity that is printed, shortest entries first: four pages.
        landscape_lines: Longest entry that is printed on a page turned on its side.
        landscape_total: Longest such part of a quantity: two pages.
        matrix_terms: Longest quantity that can be a matrix: no page is wide enough for more.
        compact_terms: Longest quantity that is printed multiplied out where a form in named terms exists.
        factor_terms: Longest entry of a partial product of transforms, where T itself is too long.
        closed_form_joints: Most joints for which the closed form of the dynamics is derived for the sheet. It grows
            about fivefold with each joint, and of eight joints hardly an entry would be printed.
        named_products: Most velocity products per equation of motion written out in named terms.
    """

    flat_terms: int = 200
    grouped_terms: int = 500
    quantity_entries: int = 10
    entry_lines: int = 16
    quantity_lines: int = 190
    landscape_lines: int = 18
    landscape_total: int = 60
    matrix_terms: int = 300
    compact_terms: int = 60
    factor_terms: int = 8
    closed_form_joints: int = 7
    named_products: int = 60


POLICY = SheetPolicy()
