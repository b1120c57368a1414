"""Named terms of different quantities on one sheet never share a letter with its index."""

from __future__ import annotations

from collections import Counter

import pytest

from derive.handouts import groups


@pytest.mark.parametrize("n", [1, 6, 7, 20, 64])
def test_groups_are_all_different(n: int) -> None:
    found = [groups.T, groups.J, groups.B, groups.CHRISTOFFEL, groups.C, groups.N, groups.TORQUE, groups.POTENTIAL]
    found += [groups.KINETIC, groups.DERIVATIVE]
    found += [groups.row(i) for i in range(1, n + 2)]
    found += [groups.factor(start) for start in range(n)]
    found += [groups.product(i) for i in range(1, n + 1)]
    found += [groups.axis(n, frame, column) for frame in range(n + 1) for column in (3, 4)]
    found += [groups.body(place, quantity) for place in range(2 * n) for quantity in range(4)]
    if n <= 6:
        found += [groups.SINGULARITY_BLOCKS, groups.SINGULARITY_BLOCKS + 1, groups.DETERMINANT, groups.DETERMINANT + 1]
    assert max(Counter(found).values()) == 1
