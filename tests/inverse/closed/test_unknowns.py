"""Sums of the angles of parallel joints: which follow from those that are known, and how they are written then."""

from __future__ import annotations

from derive.inverse.closed.unknowns import InverseDomain, State
from derive.robot.robot import Robot

DOMAIN = InverseDomain(Robot.load("planar-3r"))
NOTHING = State(((0b0001, 0b0010, 0b0100, 0b1000),), frozenset())


def known(state: State) -> set[tuple[int, ...]]:
    return {u.joints for u in DOMAIN.unknowns() if all(DOMAIN.is_known(name, state) for name in u.generators)}


def test_of_two_sums_that_are_known_their_difference_is_known() -> None:
    whole = NOTHING.joined(0, 0b0001, 0b1000)
    assert known(NOTHING) == set()
    assert known(whole) == {(0, 1, 2)}
    assert known(whole.joined(0, 0b1001, 0b0100)) == {(0, 1), (2,), (0, 1, 2)}


def test_between_two_parts_there_are_all_sums_that_join_them() -> None:
    assert [u.joints for u in DOMAIN.between(0, (0b1001, 0b0010))] == [(0,), (1, 2)]


def test_an_equation_is_written_in_one_unknown_and_what_is_known() -> None:
    whole = NOTHING.joined(0, 0b0001, 0b1000)
    first, rest = DOMAIN.unknown(0), DOMAIN.unknown(1, 2)
    cosine, sine = map(DOMAIN.ring.generator, rest.generators)
    written = DOMAIN.rewritten(cosine * cosine + sine, whole, first)
    used = {name for name, degree in zip(DOMAIN.ring.names, written.degrees(), strict=True) if degree}
    assert used == {*first.generators, *DOMAIN.unknown(0, 1, 2).generators}
    (c, s), (e, f) = (map(DOMAIN.ring.generator, u.generators) for u in (first, DOMAIN.unknown(0, 1, 2)))
    assert written == (e * c + f * s) * (e * c + f * s) + f * c - e * s
