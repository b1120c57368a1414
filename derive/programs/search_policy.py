"""How long the fewest operations are looked for: the efforts that users choose from, every threshold and its reason.

Effort is counted in work, never in seconds, so that programs depend on the robot file alone.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from derive.errors import DeriveError


class Effort(StrEnum):
    """How long programs are improved; the values are equal either way, and so is what they are computed from."""

    FULL = "full"
    """Formulations, the free choices in them and shared parts are searched."""

    QUICK = "quick"
    """The formulation that is cheapest as traced is emitted: searched for in no time, up to a third more operations."""


def effort_named(name: str) -> Effort:
    """An effort as a user names it.

    Args:
        name: ``full`` or ``quick``.

    Returns:
        The effort.

    Raises:
        DeriveError: There is none of this name.
    """
    try:
        return Effort(name)
    except ValueError:
        allowed = f"one of {', '.join(Effort)}"
        raise DeriveError(f"unknown effort {name!r}", allowed=allowed, remedy="choose one of these") from None


@dataclass(frozen=True, slots=True)
class Policy:
    """All thresholds of the search.

    Attributes:
        kinematics_margin: Formulations of poses and Jacobians are improved if as traced they cost at most so many times
            the cheapest: they share nearly all they can from the beginning, so improvement hardly changes their order.
        dynamics_margin: The same for dynamics, where an expanded closed form improves by more than a recursion.
        draft_margin: After a short search the long one is spent on programs that cost at most so many times the best:
            it has never gained more than that beyond a draft.
        finalists: Programs on which the long search is spent at most.
        large_program: Cost of a draft from which no long search follows: it would find little for its time.
        search_work: Divisors that one search looks at; more than that found under 1 % on any arm of the tests.
        draft_work: The same for a draft.
        hoisted_work: The same for work on run-time parameters, which is done once and so worth less.
        search_rounds: Sweeps over all variables at most; most programs stand still after three.
        longest_expansion: Terms of a sum above which nothing is written out into it: the number of pairs of terms to be
            compared grows with the square.
        longest_paired: Terms of a sum above which it is not searched for pairs at all.
        frame_choice_work: Nodes that the search for frame choices of one function prices before it stops.
        frame_choice_joints: Joints above which the first frame choices are taken as they are: a sweep takes time with
            the square of their number.
        frame_choice_margin: Frame choices are improved beside the cheapest if as traced they cost at most so many times
            that: they trace nearly the same program, so improvement leaves their order but for a percent.
        frame_choice_finalists: How many of these are improved at most.
        closed_form_terms: Terms of all entries of a function above which its closed form is no candidate: no form
            longer than that has ever won.
        fewest_articulated: Joints from which articulated bodies may beat the factorised inertia matrix.
        most_factorised: Joints up to which the inertia matrix may win, whose factorisation grows with the cube.
        most_differentiated: Joints up to which torques are also differentiated operation by operation, which grows
            with the cube as well.
        most_stations: Runs of parallel axes up to which all ways of a vector to the world frame are tried; their number
            grows with the cube.
        most_joints_all_ways: Joints up to which they are.
        near_stations: How many runs away the ways of longer arms lead.
        cancellation: How much larger than a difference its operands may be: six bits are lost at most.
    """

    kinematics_margin: float = 1.05
    dynamics_margin: float = 1.3
    draft_margin: float = 1.03
    finalists: int = 2
    large_program: int = 20_000
    search_work: int = 16_000
    draft_work: int = 4_000
    hoisted_work: int = 4_000
    search_rounds: int = 6
    longest_expansion: int = 24
    longest_paired: int = 40
    frame_choice_work: int = 45_000
    frame_choice_joints: int = 24
    frame_choice_margin: float = 1.01
    frame_choice_finalists: int = 2
    closed_form_terms: int = 300
    fewest_articulated: int = 7
    most_factorised: int = 10
    most_differentiated: int = 7
    most_stations: int = 7
    most_joints_all_ways: int = 12
    near_stations: int = 3
    cancellation: float = 64.0


POLICY = Policy()
"""The one that is used."""
