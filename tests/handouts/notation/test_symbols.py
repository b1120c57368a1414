"""Named terms of different quantities on one sheet never share a letter with its index."""

from collections import Counter

import pytest

from derive.handouts.notation.symbols import Group


@pytest.mark.parametrize("n", [1, 6, 7, 20, 64])
def test_groups_are_all_different(n: int) -> None:
    found = [Group.T, Group.J, Group.B, Group.CHRISTOFFEL, Group.C, Group.N, Group.TORQUE, Group.POTENTIAL]
    found += [Group.KINETIC, Group.DERIVATIVE]
    found += [Group.row(i) for i in range(1, n + 2)]
    found += [Group.factor(start) for start in range(n)]
    found += [Group.product(i) for i in range(1, n + 1)]
    found += [Group.axis(n, frame, column) for frame in range(n + 1) for column in (3, 4)]
    found += [Group.body(place, quantity) for place in range(2 * n) for quantity in range(4)]
    if n <= 6:
        found += [Group.SINGULARITY_BLOCKS, Group.SINGULARITY_BLOCKS + 1, Group.DETERMINANT, Group.DETERMINANT + 1]
    assert max(Counter(found).values()) == 1
