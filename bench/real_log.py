"""A log of a real arm: `python -m bench.real_log figaroh-1.0.2.tar.gz`; status 1 if a joint's URDF does better.

The archive comes by `pip download --no-deps --no-binary :all: figaroh==1.0.2` (Apache-2.0). It has a URDF of a TIAGo
and 80 s of its positions and motor currents at 100 Hz. Torques are currents times the gear ratios and the constants
that FIGAROH's example takes; the wrist's currents are zero in nine rows of ten, its sensors do not resolve them. The
arm moves from 9.2 to 67.9 s, while the torso hardly does. The last fifth of that is held out.
"""

import io
import sys
import tarfile

import numpy as np

import derive

LOG, URDF = "tiago/data/identification/tiago_{}.csv", "tiago/tiago_48_hey5.urdf"
FACTORS = 100 * np.array([0.136, 0.136, -0.087, -0.087, *[-0.0613 * 3.36] * 3])  # [N m/A] of joints 1 to 7
MOVING = slice(921, 6791)


def main() -> int:
    """Read, identify, print the residuals."""
    with tarfile.open(sys.argv[1]) as archive:
        root = archive.getnames()[0].partition("/")[0] + "/tests/fixtures/"

        def _read(name: str) -> bytes:
            return archive.extractfile(root + name).read()  # type: ignore[union-attr]

        urdf = _read(URDF)
        tables = [
            np.genfromtxt(io.BytesIO(_read(LOG.format(what))), delimiter=",", skip_header=1)[MOVING]
            for what in ("position", "effort")
        ]
    time, q, tau = tables[0][:, 0], tables[0][:, 2:], FACTORS * tables[1][:, 2:]
    log = {"time": time} | {f"{name}{j + 1}": x[:, j] for name, x in (("q", q), ("tau", tau)) for j in range(7)}
    arm = derive.import_urdf(urdf, base="torso_lift_link", tip="arm_tool_link").robot
    found = derive.identify(arm, log, method="possible", cutoff=2.0, decimate=10, held_out=0.2)
    for row in found.joint_rows():
        print("  ".join(f"{cell:>11}" for cell in row))
    return int(not (found.held_out < found.before).all())


if __name__ == "__main__":
    sys.exit(main())
