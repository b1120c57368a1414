"""What makes a configuration a solution of a pose: every threshold of closed forms, here and in generated code."""

from __future__ import annotations

from dataclasses import asdict, dataclass


@dataclass(frozen=True, slots=True)
class SolutionPolicy:
    """The thresholds; errors of a pose are those of its entries, lengths in parts of the reach.

    Attributes:
        orthogonal: Most by which R^T R of a pose differs from 1.
        far: No arm reaches so far [m], and powers of what is farther are no numbers.
        rounding: An error that no further step makes smaller.
        reproduced: Largest error of a solution that Newton's method has refined, of an arm with a joint for every
            coordinate of its task, or where joints are free.
        closed: Largest error of a branch that closes but for rounding; of an arm with fewer joints the pose itself may
            be so far off.
        same: Solutions nearer to each other than this are one [rad, or relative].
        double: Likewise where one of them merges with others, as double roots cost half of the digits.
        damping: Of a step of Newton's method that is all but undamped.
        elsewhere: Where free joints are tried, where the others have no solution with them where the caller has them.
        nudge: How far a solution is moved that is of a continuum, or double, if it does not come back.
        back: How near one that stands alone comes; double ones come no nearer than the root of what is rounding.
        stalled: Error below which Newton's method may have stalled beside a singular pose, in a valley of small errors.
        along: Damping of steps along such a valley.
        across: Of those that lead back to its bottom.
        valley: Most steps along it.
        turn: The others are turned, too, by multiples of it, after two times [rad].
    """

    orthogonal: float = 1e-6
    far: float = 1e30
    rounding: float = 1e-13
    reproduced: float = 3e-11
    closed: float = 1e-7
    same: float = 1e-7
    double: float = 3e-5
    damping: float = 1e-16
    nudge: float = 1e-5
    back: float = 1e-8
    stalled: float = 1e-4
    along: float = 1e-20
    across: float = 1e-6
    valley: int = 16
    elsewhere: tuple[float, ...] = (0.5, -0.5, 1.0, -1.0, 1.5, -1.5, 2.0, -2.0, 2.5, -2.5, 3.0, -3.0)
    turn: float = 1.3

    @property
    def texts(self) -> dict[str, str]:
        """Each threshold as generated code has it, in every language; several numbers with commas between them."""
        rows = {name: value if isinstance(value, tuple) else (value,) for name, value in asdict(self).items()}
        return {name: ", ".join(map(_text, row)) for name, row in rows.items()}


def _text(value: float) -> str:
    """``1e-6``, not ``1e-06``."""
    return repr(value).replace("e-0", "e-").replace("e+", "e")


POLICY = SolutionPolicy()
