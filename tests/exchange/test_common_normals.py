"""Tables by common normals."""

from __future__ import annotations

from fractions import Fraction

import pytest

from derive.exchange.arm import arm_of
from derive.exchange.common_normals import place
from derive.exchange.read_urdf import read_urdf
from derive.mechanics.space import exactly
from derive.robot.description import Convention
from tests.exchange.chains import random_chain
from tests.exchange.urdfs import HALF, J, urdf


@pytest.mark.parametrize("convention", Convention)
def test_parallel_axes_have_a_table_with_two_lengths(convention: Convention) -> None:
    text = urdf([J(), J("0.5 0 0"), J("0.4 0 0", type="fixed")])
    with exactly():
        arm = arm_of(read_urdf(text.encode(), "arm.urdf"), None, None, Fraction(0))
        placement = place(arm, convention, 1e-6)
    lengths = sorted(abs(float(cell)) for row in placement.rows for cell in (row.d, row.a, row.theta, row.alpha))
    assert [cell for cell in lengths if cell] == pytest.approx(
        [0.4, 0.5] if convention is Convention.STANDARD else [0.5]
    )


def test_a_slide_takes_the_place_that_costs_least() -> None:
    """The second axis of a cylindrical arm goes through the first wherever the file draws it."""
    text = urdf([J(), J("0.3 0.2 0.1", type="prismatic"), J("-0.3 -0.2 0", f"{HALF} 0 0")])
    with exactly():
        arm = arm_of(read_urdf(text.encode(), "arm.urdf"), None, None, Fraction(0))
        placement = place(arm, Convention.STANDARD, 1e-6)
    assert [float(row.a) for row in placement.rows] == [0, 0, 0]


@pytest.mark.parametrize("convention", Convention)
def test_a_slide_has_no_angle_where_a_base_that_is_slanted_anyway_can_have_it(convention: Convention) -> None:
    """Its x may point along the common normal of two parallel axes, as any other common normal."""
    base = J("0.1 0.2 0.3", "0.3 0.5 0.8", type="fixed")
    text = urdf([base, J("0 0 0.25", type="prismatic"), J("0.05 -0.02 0.1"), J("0.3 0 0", f"{HALF} 0 0")])
    with exactly():
        arm = arm_of(read_urdf(text.encode(), "arm.urdf"), None, None, Fraction(0))
        placement = place(arm, convention, 1e-6)
    assert placement.rows[0].theta == 0


@pytest.mark.parametrize("seed", [35, 45, 93, 128])
def test_a_wide_snap_leaves_every_pair_of_axes_a_common_normal(seed: int) -> None:
    """Closeness is not transitive: an axis that takes the direction of one axis may come near another by that."""
    text, names = random_chain(seed)
    with exactly():
        arm = arm_of(read_urdf(text.encode(), "arm.urdf"), None, None, Fraction(1, 10))
        assert len(place(arm, Convention.MODIFIED if seed % 2 == 0 else Convention.STANDARD, 0.1).rows) == len(names)
