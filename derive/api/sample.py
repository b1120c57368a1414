"""Functions of a robot at millions of configurations from Python: what ``derive sample`` prints."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from derive.api.robots import RobotLike, load
from derive.errors import DeriveError, listed, near_miss
from derive.sampling.clusters import Tell, cluster
from derive.sampling.configurations import Configurations, grid, ranges
from derive.sampling.reductions import KINDS
from derive.sampling.sample import Sampled, program_for, sampled, sampling

OVER = ("limits", "grid")
"""Where configurations are: at random within the limits, or on a grid within them."""


@dataclass(frozen=True, slots=True)
class Sample:
    """What was found.

    Attributes:
        robot: Name of the robot.
        number: How many configurations there were.
        over: Where they were.
        functions: What was found of each function, by its name.
        remarks: What was assumed, for instance for joints without limits.
    """

    robot: str
    number: int
    over: str
    functions: Mapping[str, Sampled]
    remarks: tuple[str, ...]


def sample(
    robot: RobotLike,
    functions: str | Iterable[str],
    *,
    over: str = "limits",
    number: float = 1e6,
    reduce: str | Iterable[str] = ("min", "mean", "max"),
    speed: float | Sequence[float] | None = None,
    qdd: float | Sequence[float] | None = None,
    tau: float | Sequence[float] | None = None,
    wrench: float | Sequence[float] | None = None,
    parameters: Mapping[str, float] | None = None,
    seed: int = 0,
    chunk: int = 100_000,
    workers: int | None = None,
    scheduler: str | None = None,
    progress: Tell | None = None,
) -> Sample:
    """Reduce generated functions over many configurations, in bounded memory, as ``derive sample`` does.

    Configuration k is the same whoever asks for it, and sums are added in one order: neither workers nor chunks change
    a bit of the result, on processors that compile to the same code.

    Args:
        robot: A robot, the path of a robot file, or a name of the catalogue.
        functions: Names of generated functions, or symbols such as ``tau`` and ``J``.
        over: ``limits``, uniformly random configurations within the joint limits; ``grid``, a grid within them that
            has the ends of every range. Joints without limits make a full turn.
        number: How many configurations; of a grid at most so many.
        reduce: Of ``min``, ``mean``, ``max`` and ``quantiles`` (1, 5, 25, 50, 75, 95, 99 %, to 0.1 %).
        speed: Largest magnitude of qd, for all joints or for each [rad/s, m/s]; None for that of the robot file.
        qdd: That of joint accelerations [rad/s^2, m/s^2].
        tau: That of joint torques [N m, N], where a function takes them; None for that of the robot file.
        wrench: That of the entries of a wrench on the end effector [N, N m].
        parameters: Numbers of symbols, instead of the robot file's.
        seed: Of the random numbers.
        chunk: Configurations of one piece of work, in whole blocks of 8192.
        workers: Threads; None for one for each processor.
        scheduler: Address of a Dask scheduler, whose workers have derive installed; needs the extra ``data``.
        progress: Called with the robot's name and how far it is.

    Returns:
        The reductions of every entry of every function, and where its extremes are.

    Raises:
        QuantityError: No such function, or the robot has none, or a symbol has no number.
        RobotFileError: The file does not describe a robot, or a joint slides without limits.
        DeriveError: A bound is missing, a word is unknown, or no scheduler answers.
        TargetError: Dask is not installed.
    """
    chosen, tell = load(robot), progress or (lambda name, stage: None)
    names = (functions,) if isinstance(functions, str) else tuple(functions)
    kinds = (reduce,) if isinstance(reduce, str) else tuple(reduce)
    for word, allowed in ((over, OVER), *((kind, KINDS) for kind in kinds)):
        if word not in allowed:
            raise DeriveError(f"no {word!r}", allowed=near_miss(word, allowed) or f"allowed: {listed(allowed)}")
    if not (1 <= number <= 1e15 and number == int(number)) or not 0 <= seed < 2**64 or chunk < 1:
        raise DeriveError(f"number {number:g}, seed {seed}, chunk {chunk}", allowed="allowed: whole numbers from 1 on")
    tell(chosen.name, "derive")
    program = program_for(chosen, names)
    arguments = {name for function in program for name in function.arguments}
    bounds = {"speed": speed, "qdd": qdd, "tau": tau, "wrench": wrench}
    low, high, remarks = ranges(chosen, arguments, bounds)
    points = grid(int(number), chosen.dof) if over == "grid" else ()
    count = points[0] ** len(points) if points else int(number)
    configurations = Configurations(low, high, count, seed, points)
    with cluster(workers, scheduler) as where:
        tell(chosen.name, "compile")
        work = sampling(chosen, program, configurations, kinds, parameters or {})
        found = sampled(work, where, chunk, chosen.name, progress)
    return Sample(chosen.name, count, over, found, remarks)
