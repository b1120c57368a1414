"""What inverse kinematics is asked for: the key ``inverse`` of a robot file, and the same words on the command line."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from derive.errors import Location, QuantityError, listed, near_miss, quoted

Task = tuple[str, ...]  # rows of a task, in the words of `ROWS`

ROWS: Mapping[str, tuple[tuple[int, int], ...]] = {
    "x": ((1, 4),),
    "y": ((2, 4),),
    "z": ((3, 4),),
    "phi": ((1, 1), (2, 1)),
    "approach": ((1, 3), (2, 3), (3, 3)),
    "orientation": tuple((i, j) for j in (1, 2, 3) for i in (1, 2, 3)),
}
"""What may be asked of an end effector, and the entries of T that say it (row and column from 1): its position, the
angle of its x axis about the world's z axis, the direction of its z axis, and its whole orientation."""

FREEDOMS: Mapping[str, int] = {"phi": 1, "approach": 2, "orientation": 3}
"""How many numbers a row asks for, where it is not one coordinate."""

TASKS: Mapping[str, Task] = {"pose": ("x", "y", "z", "orientation"), "position": ("x", "y", "z")}  # by name
POSE: Task = TASKS["pose"]


@dataclass(frozen=True, slots=True)
class InverseOptions:
    """What inverse kinematics is asked for."""

    task: Task = POSE  # rows of the task
    # Names of the joint variables that are arguments; None where the derivation chooses them.
    given: tuple[str, ...] | None = None
    # Where the file says so, for messages; None where it does not.
    location: Location | None = field(default=None, compare=False, repr=False)


def chosen_task(words: Sequence[str], joints: int) -> Task:
    """A task by its name or its rows."""
    if len(words) == 1 and words[0] in TASKS:
        return TASKS[words[0]]
    allowed = f"allowed: {listed(tuple(TASKS))}, or a list of {listed(tuple(ROWS))}"
    if not words:
        raise QuantityError("a task without rows", allowed=allowed)
    for k, word in enumerate(words):
        if word not in ROWS:
            remedy = near_miss(word, (*TASKS, *ROWS))
            raise QuantityError(f"unknown row of a task {quoted(word)}", allowed=allowed, remedy=remedy)
        if word in words[:k] or (word in ("phi", "approach") and "orientation" in words):
            raise QuantityError(f"{quoted(word)} is in the task already", allowed=allowed, remedy="remove one")
    wanted = sum(FREEDOMS.get(word, 1) for word in words)
    if wanted > joints:
        found = f"a task of {wanted} coordinates for {joints} joint{'s' if joints > 1 else ''}"
        raise QuantityError(found, allowed=f"allowed: at most {joints}", remedy="leave rows out, or write task: pose")
    return tuple(row for row in ROWS if row in words)


def chosen_given(names: Sequence[str], variables: Sequence[str]) -> tuple[str, ...]:
    """Joints that are given, by name."""
    allowed = f"allowed: {listed(tuple(variables))}"
    for k, name in enumerate(names):
        if name not in variables:
            remedy = near_miss(name, variables)
            raise QuantityError(f"{quoted(name)} is not a joint variable", allowed=allowed, remedy=remedy)
        if name in names[:k]:
            raise QuantityError(f"{quoted(name)} is given twice", allowed=allowed, remedy="remove one")
    if len(names) == len(variables):
        raise QuantityError("all joints are given", allowed="allowed: fewer than all", remedy="leave some out")
    return tuple(name for name in variables if name in names)
