"""How long the fewest operations are looked for: the efforts that users choose from, every threshold and its reason.

Effort is counted in work, never in seconds, so that programs depend on the robot file alone.
"""

from dataclasses import dataclass
from enum import StrEnum

from derive.errors import DeriveError


class Effort(StrEnum):
    """How long programs are improved; the values are equal either way, and so is what they are computed from."""

    FULL = "full"  # formulations, the free choices in them and shared parts are searched
    # The formulation that is cheapest as traced is emitted: searched for in no time, up to a third more operations.
    QUICK = "quick"


def effort_named(name: str) -> Effort:
    """An effort as a user names it."""
    try:
        return Effort(name)
    except ValueError:
        allowed = f"allowed: one of {', '.join(Effort)}"
        raise DeriveError(f"unknown effort {name!r}", allowed=allowed, remedy="choose one of these") from None


@dataclass(frozen=True, slots=True)
class Policy:
    """All thresholds of the search.

    What is said of half and twice a value was measured on the built-in robots, those of ``bench`` and arms of 8 to 28
    joints by ``python -m tests.programs.thresholds``, which shows it again.
    """

    # Formulations of poses and Jacobians are improved if as traced they cost at most so many times the cheapest: they
    # share nearly all they can from the beginning, so improvement hardly changes their order. Half and twice the
    # margin change nothing.
    kinematics_margin: float = 1.05
    # The same for dynamics, where an expanded closed form improves by more than a recursion: with half the margin two
    # gravity vectors cost two operations more. Twice changes nothing.
    dynamics_margin: float = 1.3
    # After a short search the long one is spent on programs that cost at most so many times the best. Beyond a draft
    # they gain little more than that: half of it costs one Coriolis matrix 7 operations, twice saves one analytic
    # Jacobian 5.
    draft_margin: float = 1.03
    # Programs on which the long search is spent at most. Of 460 functions 13 take the second one; a third and fourth
    # have never won.
    finalists: int = 2
    # Cost of a draft from which no long search follows: it would find little for its time. No arm of up to seven
    # joints comes near; torques and inertia matrices of 28 joints are smaller, too.
    large_program: int = 20_000
    # Divisors that one search looks at. Half costs one function in eight up to 24 operations; twice as many save as
    # many functions under 1 % for a sixth more time.
    search_work: int = 16_000
    # The same for a draft. Half costs one function in nine some operations; twice saves as many as it costs, for it
    # changes what the long search begins with.
    draft_work: int = 4_000
    # The same for work on run-time parameters, which is done once and so worth less. What is computed every time does
    # not depend on it.
    hoisted_work: int = 4_000
    search_rounds: int = 6  # sweeps over all variables at most; most programs stand still after three
    # Terms of a sum above which nothing is written out into it: the number of pairs of terms to be compared grows
    # with the square. Half costs some kinetic energies 7 operations; twice saves none.
    longest_expansion: int = 24
    # Terms of a sum above which it is not searched for pairs at all. Half costs kinetic energies 19 operations, twice
    # saves none.
    longest_paired: int = 40
    # Nodes that the search for frame choices of one function prices before it stops. Half and twice as many change
    # nothing on six joints.
    frame_choice_work: int = 45_000
    # Joints above which the first frame choices are taken as they are: a sweep takes time with the square of their
    # number. Half costs an arm of 20 joints 77 operations of its torques; twice saves 28 joints next to nothing for
    # 1.4 times the time.
    frame_choice_joints: int = 24
    # Frame choices are improved beside the cheapest if as traced they cost at most so many times that: they trace
    # nearly the same program, so improvement leaves their order but for a percent. Half and twice the margin change
    # nothing.
    frame_choice_margin: float = 1.01
    # How many of these are improved at most. Without the second, four functions in a hundred cost 3 to 8 operations
    # more; of a third and fourth one function had 6.
    frame_choice_finalists: int = 2
    # Terms of all entries of a function above which its closed form is no candidate: no form longer than that has
    # ever won, nor one of half that length.
    closed_form_terms: int = 300
    # Joints from which articulated bodies may beat the factorised inertia matrix. From fewer they never win; at eight
    # it depends on the arm. At most `most_factorised` + 1, or some arms have neither.
    fewest_articulated: int = 7
    # Joints up to which the inertia matrix may win, whose factorisation grows with the cube. At eleven and twelve it
    # never did.
    most_factorised: int = 10
    # Joints up to which torques are also differentiated operation by operation, which grows with the cube as well. At
    # nine it saved 123 of 3,655 operations of one arm; of ten and twelve it never won.
    most_differentiated: int = 9
    # Joints up to which the derivatives of J are generated, whose entries grow with the cube: at 21 they would take a
    # sixth of the time of a build.
    most_derivatives: int = 16
    # Nodes of an elimination above which it is emitted as traced: a draft saves 2 % of that of six joints for half of
    # its time, 12 % of a SCARA's.
    most_eliminated: int = 500
    # Runs of parallel axes up to which all ways of a vector to the world frame are tried; their number grows with the
    # cube. Twice as many would save up to 49 operations of the pose of 12 joints in six times the time.
    most_stations: int = 7
    most_joints_all_ways: int = 12  # joints up to which they are; more make no difference with so many stations
    # How many runs away the ways of longer arms lead. One costs an operation here and there, six save poses of 12 to
    # 20 joints 16 operations in three and a half times the time.
    near_stations: int = 3
    # How much larger than a difference its operands may be: six bits are lost at most. One bit less costs one
    # function 4 operations, one more saves none.
    cancellation: float = 64.0


POLICY = Policy()  # the one that is used
