"""Functions of a robot at millions of configurations from Python: what ``derive sample`` prints."""

from collections.abc import Iterable, Mapping

from derive.api.robots import RobotLike, load
from derive.errors import DeriveError, QuantityError, listed, near_miss
from derive.publish.modules import serving_sources
from derive.robot.evaluate import parameter_values
from derive.sampling.clusters import Tell, cluster
from derive.sampling.sample import KINDS, Bound, Sampled, Sampling, bounds_of, program_for, sampled
from derive.targets.target import Source
from derive.version import __version__

OVER = ("limits", "grid")


def sample(
    robot: RobotLike,
    functions: str | Iterable[str],
    *,
    over: str = "limits",
    number: float = 1e6,
    reduce: Iterable[str] = ("min", "mean", "max"),
    bounds: Mapping[str, Bound] | None = None,
    parameters: Mapping[str, float] | None = None,
    seed: int = 0,
    chunk: int = 100_000,
    workers: int | None = None,
    scheduler: str | None = None,
    progress: Tell | None = None,
) -> dict[str, Sampled]:
    """Reduce generated functions over many configurations, in bounded memory, as ``derive sample`` does.

    Neither workers nor chunks change a bit of the result, on processors for which compilers make the same code.

    Args:
        robot: A robot, the path of a robot file, or a name of the catalogue.
        functions: Names of generated functions, or symbols such as ``tau`` and ``J``; of a tree for all its ends.
        over: ``limits``: uniformly random within the joint limits; ``grid``: a grid with the ends of every range.
            Angles without limits make a full turn.
        number: How many configurations; of a grid at most so many, with as many points along each variable.
        reduce: Of ``min``, ``mean``, ``max`` and ``quantiles`` (1, 5, 25, 50, 75, 95, 99 %, to 0.1 % of their values).
        bounds: Largest magnitudes of other arguments, one number or one for each entry [SI units]: ``speed`` (else
            the robot file's), ``qdd``, ``tau`` (likewise), ``wrench``.
        parameters: Numbers of symbols, instead of the robot file's.
        seed: Of the random numbers.
        chunk: Configurations of a piece of work, in whole blocks of 8192.
        workers: Threads; None for one for each processor.
        scheduler: Address of a Dask scheduler, whose workers have derive installed, too; needs the extra ``data``.
        progress: Called with the robot's name and how far it is.

    Returns:
        By the name of each function its reductions, entry by entry, and where the extremes are.

    Raises:
        QuantityError: No such function, the robot lacks it, or a symbol has no number.
        RobotFileError: The file does not describe a robot, or a joint slides without limits.
        DeriveError: A bound is missing, a word is unknown, or no scheduler answers.
        TargetError: Dask is not installed.
    """
    chosen, tell = load(robot), progress or (lambda name, stage: None)
    kinds = (reduce,) if isinstance(reduce, str) else tuple(reduce)
    for word, allowed in ((over, OVER), *((kind, KINDS) for kind in kinds)):
        if word not in allowed:
            raise DeriveError(f"no {word!r}", allowed=near_miss(word, allowed) or f"allowed: {listed(allowed)}")
    if not 1 <= number <= 1e15 or number != int(number) or not 0 <= seed < 2**64 or chunk < 1:
        found = f"number {number:g}, seed {seed}, chunk {chunk}"
        raise DeriveError(found, allowed="allowed: whole numbers up to 1e15, from 1 on, and a seed from 0 on")
    tell(chosen.name, "derive")
    program = program_for(chosen, (functions,) if isinstance(functions, str) else tuple(functions))
    limits = bounds_of(chosen, program, bounds or {})
    most = round(number ** (1 / chosen.dof))
    points = 0 if over == "limits" else most - (most**chosen.dof > number)
    numbers = {name: float(value) for name, value in parameter_values(chosen, parameters).items()}
    taken = tuple((each.name, each.arguments, each.shape) for each in program)
    with cluster(workers, scheduler) as where:
        tell(chosen.name, "compile")
        needed = {program.parameters[k]: None for function in program for k in function.tape.parameters}
        if missing := [name for name in needed if name not in numbers]:
            remedy = f"write parameters: {{{missing[0]}: ...}} in the robot file"
            raise QuantityError(f"no number for {listed(missing)} of {chosen.name}", remedy=remedy)
        sources = serving_sources(Source(chosen, program, __version__))
        count = points**chosen.dof if points else int(number)
        numbers = {name: numbers[name] for name in program.parameters if name in numbers}
        work = Sampling(sources, taken, numbers, limits, count, seed, points, kinds)
        return sampled(work, where, chunk, chosen.name, progress)
