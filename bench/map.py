"""The map of a UR5e beside its bar of two minutes on two cores: `python -m bench.map`.

``--every 10`` computes every tenth block alone, on one core, and says what the whole would take by its processor time,
which tells more than a clock where a machine is busy.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
from hashlib import sha256
from pathlib import Path
from time import perf_counter, process_time, sleep

from bench.robots import FOLDER
from bench.terminal import say
from derive.api.robots import load
from derive.sampling.clusters import cluster
from derive.sampling.maps import MapGrid, begin_store, fill_store

ROBOT = FOLDER / "ur5e-numeric.yaml"
CELL, TURNS, BAR = 0.025, (64, 12), 120.0
"""Side of a cell [m], directions and rolls, and the seconds that two cores may take."""


def part_of(grid: MapGrid, every: int) -> float:
    """Processor seconds of the whole map, writing included, by those of every so many-th block."""
    grid.solver  # noqa: B018 (compiled before the clock starts)
    cells = [int(grid.cells(block)[1].sum()) for block in grid.blocks]
    with tempfile.TemporaryDirectory() as folder, cluster(1) as workers:
        begin_store(path := Path(folder) / "map.zarr", grid)
        since = process_time()
        count, _ = fill_store(path, grid, workers, every=every)
        took = process_time() - since
    each = took / sum(cells[::every])
    per_pose = 1e6 * each / len(grid.rotations)
    say(f"{sum(cells)} cells within reach; {count} of {len(cells)} blocks: {per_pose:.3f} us of a core per pose")
    return each * sum(cells)


def whole_map(path: Path, blocks: int, kill_at: float = 0.0) -> float:
    """Seconds of the command on two cores; killed when a share of the blocks is there, and then resumed."""
    command = [sys.executable, "-m", "derive", "map", str(ROBOT), "--grid", str(CELL), "--workers", "2", "--resume"]
    command += ["--orientations", str(TURNS[0]), "--rolls", str(TURNS[1]), "-o", str(path)]
    since = perf_counter()
    running = subprocess.Popen(command)
    while kill_at and sum(file.is_file() for file in (path / "postures" / "c").rglob("*")) < kill_at * blocks:
        sleep(0.2)
    if kill_at:
        running.kill()
    if running.wait() and kill_at:
        subprocess.run(command, check=True)
    return perf_counter() - since


def digest_of(path: Path) -> str:
    """Of the names and bytes of all files of a store."""
    files = sorted(file for file in path.rglob("*") if file.is_file())
    return sha256(b"".join(str(file.relative_to(path)).encode() + file.read_bytes() for file in files)).hexdigest()


def main() -> int:
    """Measure, and say whether the bar is held."""
    parser = argparse.ArgumentParser(prog="python -m bench.map", description=__doc__)
    parser.add_argument("--every", type=int, default=1, help="which blocks are computed: every so many-th")
    every = parser.parse_args().every
    grid = MapGrid.of(load(ROBOT), CELL, *TURNS)
    if every > 1:
        seconds = part_of(grid, every) / 2.0
        say(f"on two cores {seconds:.0f} s; bar {BAR:.0f} s")
        return int(seconds > BAR)
    with tempfile.TemporaryDirectory() as folder:
        whole, killed = Path(folder) / "whole.zarr", Path(folder) / "killed.zarr"
        seconds = whole_map(whole, len(grid.blocks))
        whole_map(killed, len(grid.blocks), 1.0 / 3.0)
        same = digest_of(whole) == digest_of(killed)
    say(f"{seconds:.0f} s (bar {BAR:.0f} s); killed after a third and resumed: {'the same' if same else 'OTHER'} bytes")
    return int(seconds > BAR or not same)


if __name__ == "__main__":
    sys.exit(main())
