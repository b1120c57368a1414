"""Products of transforms are read by their names, and the frames that they join are known."""

import pytest

from derive.checking.chains import factors, frames_of
from derive.checking.latex.targets import Target
from tests.checking.test_pages import ANT, checked


def test_a_transform_has_two_frames() -> None:
    assert frames_of(Target("A[2]"), ANT) == (1, 2)
    assert frames_of(Target("T"), ANT) == (0, 3)
    assert frames_of(Target("T[1,3]", (1, 2, 3), (4,)), ANT) is None
    assert frames_of(Target("B"), ANT) is None


@pytest.mark.parametrize("product", ["^0_1T^1_2T^2_3T", "{}^0_1T {}^1_2T {}^2_3T", r"T_{01} \cdot T_{12} \cdot T_{23}"])
def test_a_product_is_the_transform_from_its_first_to_its_last_frame(product: str) -> None:
    assert len(factors(product)) == 3
    assert checked(ANT, f"$$T_3^0 = {product}$$").equal == 1
    swapped = product.replace("1", "x").replace("2", "1").replace("x", "2")
    assert checked(ANT, f"$$T_3^0 = {swapped}$$").wrong == ()
