"""What a recursion may choose at each joint without changing what it computes."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum


class Place(Enum):
    """Where on the joint's axis the origin of its frame stands."""

    AFTER = "after the joint's own offset"
    BEFORE = "before the joint's own offset"
    BEYOND = "after the offset of the next joint too, whose axis is parallel"


@dataclass(frozen=True, slots=True)
class JointForm:
    """Choices for one joint and its link; which are cheapest depends on the arm.

    Attributes:
        place: Where the origin stands.
        held: The link's vectors are written in axes that its joint does not turn, and its body is turned instead; for
            the last link, and before a parallel axis.
        second_moments: The parameter that vanishes by regrouping is P_zz = (I_xx + I_yy - I_zz)/2, and moments are
            written in second moments; else it is I_yy.
        column: The third column of U comes from the link before (for a slide all of U); else alpha does.
        squares: So does omega_x^2 + omega_y^2; else all three squares are made.
        grown: In held axes, where omega gains its z alone, the rest of U is that of the link before with what the joint
            adds; else it is made from omega and alpha.
    """

    place: Place = Place.AFTER
    held: bool = False
    second_moments: bool = False
    column: bool = True
    squares: bool = True
    grown: bool = True


PLAIN = JointForm()
"""DH frames on the joint axes, turning with the links."""
