"""Poses and Jacobians of a PUMA 560 reduced over many configurations, beside a loop over NumPy's threads.

`python -m bench.scale --number 1e9`. Bars: 1.2 times the time of the loop, 500 MB, the same bytes for any workers.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import multiprocessing
import os
import resource
from concurrent.futures import ThreadPoolExecutor
from time import perf_counter, process_time

import numpy as np

from derive.api.robots import load
from derive.publish.modules import imported, serving_sources
from derive.sampling.clusters import cluster
from derive.sampling.sample import BLOCK, KINDS, Sampling, bounds_of, program_for, sampled
from derive.targets.target import Source
from derive.version import __version__

ROBOT, FUNCTIONS = "puma560-corke", ("forward_kinematics", "jacobian")
CORES = os.cpu_count() or 1


def prepared(number: int) -> Sampling:
    """The work, compiled."""
    robot = load(ROBOT, remarks_on_bodies=False)
    program = program_for(robot, FUNCTIONS)
    functions = tuple((each.name, each.arguments, each.shape) for each in program)
    sources = serving_sources(Source(robot, program, __version__))
    return Sampling(sources, functions, {}, bounds_of(robot, program, {}), number, 0, 0, KINDS[:3])


def ours(work: Sampling, workers: int) -> str:
    """A digest of what ``derive sample`` finds."""
    with cluster(workers) as where:
        found = sampled(work, where, 100_000, "", None)
    values = [value.tobytes() for one in found.values() for value in one.reductions.values()]
    return hashlib.sha256(b"".join(values)).hexdigest()


def loop(work: Sampling, workers: int) -> str:
    """What somebody would write by hand, with the same compiled functions."""
    module, _folder = imported(work.sources)
    low, high = work.bounds["q"]
    streams = np.random.SeedSequence(0).spawn(workers)

    def run(stream: np.random.SeedSequence) -> list[np.ndarray]:
        generator, total = np.random.default_rng(stream), []
        for _ in range(work.number // BLOCK // workers):
            q = generator.uniform(low, high, (BLOCK, len(low)))
            for values in (module.forward_kinematics(q), module.jacobian(q)):
                total.append((values.min(axis=0), values.sum(axis=0), values.max(axis=0)))
            if len(total) == 2048:
                total = []
        return total

    with ThreadPoolExecutor(workers) as pool:
        list(pool.map(run, streams))
    return ""


def measured(what: str, number: int, workers: int) -> dict[str, object]:
    """Seconds without the compiler's, peak memory [MB] and digest, in this process."""
    work = prepared(number)
    since, spent = perf_counter(), process_time()
    digest = {"derive sample": ours, "loop": loop}[what](work, workers)
    seconds, work_seconds = perf_counter() - since, process_time() - spent
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    times = {"seconds": round(seconds, 2), "processor seconds": round(work_seconds, 2), "peak MB": round(peak)}
    return {"what": what, "workers": workers, **times, "digest": digest[:12]}


def main() -> None:
    """Each measurement in a process of its own."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--number", type=float, default=1e9)
    number = int(parser.parse_args().number)
    rows = [("loop", CORES), ("derive sample", CORES), ("loop", CORES), ("derive sample", 1), ("derive sample", 4)]
    for what, workers in rows:
        with multiprocessing.get_context("spawn").Pool(1) as pool:
            print(json.dumps(pool.apply(measured, (what, number, workers))), flush=True)


if __name__ == "__main__":
    main()
