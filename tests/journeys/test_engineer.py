"""A control engineer: from a data sheet to code in a loop, changed, extended and still verified."""

import json
import re
from pathlib import Path

import numpy as np

from tests.journeys.person import Person

SIMULATION = """\
import numpy as np
from generated.my_scara import model_numpy as scara

q, qd, step = np.array([0.1, -0.4, 0.3, 0.2]), np.array([1.0, -2.0, 0.1, 3.0]), 1e-4
energy = lambda: float(scara.kinetic_energy(q, qd) + scara.potential_energy(q))
before = energy()
for _ in range(500):
    half = qd + step / 2 * scara.forward_dynamics(q, qd, np.zeros(4))
    q = q + step * half
    qd = qd + step * scara.forward_dynamics(q + 0 * half, half, np.zeros(4))
print(abs(energy() - before))
"""

CONTROLLER = """\
import numpy as np
from generated.my_scara import model_numpy as scara

q, qd, wanted = np.full(4, 0.3), np.full(4, 0.1), np.ones(4)
tau = scara.inverse_dynamics(q, qd, wanted)
print(np.abs(scara.forward_dynamics(q, qd, tau) - wanted).max() < 1e-9)
"""


def test_from_a_known_robot_to_a_controller_of_its_own(tmp_path: Path) -> None:
    engineer = Person(tmp_path)
    engineer.types("derive new my-scara --from scara-matlab")
    text = (tmp_path / "my-scara.yaml").read_text(encoding="utf-8")
    engineer.writes("my-scara.yaml", re.sub(r"(B\d): [\d.]+", r"\1: 0", text))
    report = engineer.types("derive build my-scara.yaml --effort quick --target numpy --only --json").stdout
    (built,) = json.loads(report)
    assert built["verification"]["worst"] < 1e-9
    assert engineer.runs(CONTROLLER) == "True"
    assert float(engineer.runs(SIMULATION)) < 1e-2

    build = "derive build my-scara.yaml --effort quick --target numpy,c,javascript --only"
    engineer.types(build)
    folder = tmp_path / "generated" / "my_scara"
    assert {"model_numpy.py", "model.c", "model.h", "model.mjs"} <= {path.name for path in folder.iterdir()}
    engineer.types(f"{build} --check")
    engineer.types("derive verify my-scara.yaml")

    lines = (tmp_path / "my-scara.yaml").read_text(encoding="utf-8").replace("mass: 8", "mass: 8.5")
    engineer.writes("my-scara.yaml", lines)
    assert "stale" in engineer.types(f"{build} --check", status=1).stdout
    engineer.types(build)
    engineer.types(f"{build} --check")


def test_a_payload_that_changes_at_run_time(tmp_path: Path) -> None:
    engineer = Person(tmp_path)
    engineer.writes(
        "arm.yaml",
        "name: 2r-arm\nconvention: standard\njoints:\n  - {type: revolute, a: 0.5}\n  - {type: revolute, a: 0.4}\n"
        "gravity: [0, -9.81, 0]\nlinks:\n  - {mass: 3, com: [-0.25, 0, 0]}\n  - {mass: payload}\n",
    )
    engineer.types("derive build arm.yaml --target numpy --only")
    shown = engineer.types("derive show arm.yaml g --at '0, 0, payload=2'").stdout
    wanted = [9.81 * (3 * 0.25 + 2 * 0.9), 9.81 * 2 * 0.4]
    assert [float(line) for line in shown.splitlines()[-2:]] == np.round(wanted, 5).tolist()
    program = (
        "from generated.robot_2r_arm import model_numpy as m\nprint(*m.gravity_vector([0, 0], params={'payload': 2.0}))"
    )
    assert np.allclose([float(word) for word in engineer.runs(program).split()], wanted)
