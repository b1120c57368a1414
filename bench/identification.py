"""A long log of a PUMA 560, Parquet to robot file: `python -m bench.identification [ROWS]`; status 1 beyond the bars.

Ten million rows of six joints (positions, speeds, accelerations, torques with 1 % noise) shall take at most 60 s and
500 MB. The log is written first, to a temporary folder, by a process of its own, whose memory does not count.
"""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # as the command has it

import multiprocessing
import resource
import sys
import tempfile
from pathlib import Path
from time import perf_counter, process_time

import numpy as np

SECONDS, MEGABYTES, GROUP = 60.0, 500.0, 500_000  # the bars, and rows of Parquet in a group


def write_log(path: Path, rows: int) -> None:
    """Sums of five sines of all joints, and the model's torques with noise."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    from generated.puma560_corke import model_numpy as puma

    random, k = np.random.default_rng(0), np.arange(1, 6)[:, None, None]
    names = ["time", *(f"{name}{j}" for name in ("q", "qd", "qdd", "tau") for j in range(1, 7))]
    with pq.ParquetWriter(path, pa.schema([(name, pa.float64()) for name in names])) as writer:
        for start in range(0, rows, GROUP):
            t = np.arange(start, min(start + GROUP, rows))[:, None] * 1e-3
            speed, size, phase = 0.2 * np.pi * k, random.normal(1, 0.3, (5, 1, 6)) / k, random.uniform(0, 6, (5, 1, 6))
            angle = speed * t + phase
            state = [size * np.sin(angle), size * speed * np.cos(angle), -size * speed**2 * np.sin(angle)]
            q, qd, qdd = (each.sum(axis=0) for each in state)
            tau = puma.inverse_dynamics(q, qd, qdd)
            tau += 0.01 * np.abs(tau).max(axis=0) * random.normal(size=tau.shape)
            writer.write_table(pa.table(dict(zip(names, np.hstack([t, q, qd, qdd, tau]).T, strict=True))))


def main() -> int:
    """Write, identify, compare with the bars."""
    rows = int(float(sys.argv[1])) if len(sys.argv) > 1 else 10_000_000
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "log.parquet"
        writer = multiprocessing.get_context("spawn").Process(target=write_log, args=(path, rows))
        writer.start()
        writer.join()
        from derive.api.identify import identify

        since, before = perf_counter(), process_time()
        found = identify("puma560-corke", path)
        seconds, busy = perf_counter() - since, process_time() - before
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    worst = float((np.abs(found.values - found.prior) / found.deviations).max())
    print(f"{found.rows} rows: {seconds:.1f} s ({busy:.1f} s of one core), {memory:.0f} MB")
    print(f"largest error of a base parameter: {worst:.1f} standard deviations")
    return int(seconds > SECONDS or memory > MEGABYTES)


if __name__ == "__main__":
    sys.exit(main())
