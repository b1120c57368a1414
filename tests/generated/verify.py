"""Verifies the committed models as they lie in `generated/`, without rendering them anew: `make verify-generated`.

What was committed is compared with the independent recursion, so that a folder that was edited by hand, or that another
processor or NumPy evaluates differently, is found even where a fresh build is right. Prints the worst relative error of
each robot; the exit status is 1 if a model is wrong, is missing or belongs to no robot of the catalogue.
"""

import multiprocessing
import os
import sys
from concurrent.futures import ProcessPoolExecutor

from derive.errors import DeriveError
from derive.publish.build import folder_of
from derive.robot.load import catalogue_names
from derive.robot.robot import Robot
from derive.verification.verify import verify
from tests.places import GENERATED


def verified(name: str) -> tuple[str, bool]:
    """One robot: a line that says what was found, and whether it is right."""
    robot = Robot.load(name)
    try:
        report = verify(robot, folder_of(robot, GENERATED))
    except (DeriveError, OSError) as error:
        return f"{name}: {error}", False
    targets = ", ".join(dict.fromkeys(row.target for row in report.rows))
    left_out = "".join(f"; {reason}" for reason in report.reasons)
    return f"{name}: {len(report.rows)} functions of {targets}, worst error {report.worst:.1e}{left_out}", True


def main() -> int:
    names = catalogue_names()
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(min(len(names), os.cpu_count() or 1), mp_context=context) as pool:
        results = list(pool.map(verified, names))
    folders = {folder_of(Robot.load(name), GENERATED) for name in names}
    found = (path for path in GENERATED.iterdir() if path.is_dir() and path.name != "__pycache__")
    unknown = sorted(path.name for path in found if path not in folders)
    for line, _ in results:
        print(line)
    for name in unknown:
        print(f"{name}: no robot of the catalogue")
    return int(bool(unknown) or not all(right for _, right in results))


if __name__ == "__main__":
    sys.exit(main())
