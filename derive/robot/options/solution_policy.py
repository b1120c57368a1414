"""What makes a configuration a solution of a pose: every threshold of closed forms, here and in generated code."""

from dataclasses import asdict, dataclass


@dataclass(frozen=True, slots=True)
class SolutionPolicy:
    """The thresholds; errors of a pose are those of its entries, lengths in parts of the reach."""

    orthogonal: float = 1e-6  # most by which R^T R of a pose differs from 1
    far: float = 1e30  # no arm reaches so far [m], and powers of what is farther are no numbers
    rounding: float = 1e-13  # an error that no further step makes smaller
    # Largest error of a solution that Newton's method has refined, of an arm with a joint for every coordinate of its
    # task, or where joints are free.
    reproduced: float = 3e-11
    # Largest error of a branch that closes but for rounding; of an arm with fewer joints the pose itself may be so far
    # off.
    closed: float = 1e-7
    same: float = 1e-7  # solutions nearer to each other than this are one [rad, or relative]
    double: float = 3e-5  # likewise where one of them merges with others, as double roots cost half of the digits
    damping: float = 1e-16  # of a step of Newton's method that is all but undamped
    nudge: float = 1e-5  # how far a solution is moved that is of a continuum, or double, if it does not come back
    # How near one that stands alone comes; double ones come no nearer than the root of what is rounding.
    back: float = 1e-8
    # Error below which Newton's method may have stalled beside a singular pose, in a valley of small errors.
    stalled: float = 1e-4
    along: float = 1e-20  # damping of steps along such a valley
    across: float = 1e-6  # of those that lead back to its bottom
    valley: int = 16  # most steps along it
    # Where free joints are tried, where the others have no solution with them where the caller has them.
    elsewhere: tuple[float, ...] = (0.5, -0.5, 1.0, -1.0, 1.5, -1.5, 2.0, -2.0, 2.5, -2.5, 3.0, -3.0)
    turn: float = 1.3  # the others are turned, too, by multiples of it, after two times [rad]

    @property
    def texts(self) -> dict[str, str]:
        """Each threshold as generated code has it, in every language; several numbers with commas between them."""
        rows = {name: value if isinstance(value, tuple) else (value,) for name, value in asdict(self).items()}
        plain = {name: ", ".join(map(repr, row)) for name, row in rows.items()}
        return {name: text.replace("e-0", "e-").replace("e+", "e") for name, text in plain.items()}  # 1e-6, not 1e-06


POLICY = SolutionPolicy()
