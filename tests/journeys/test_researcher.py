"""A researcher: symbols left free, closed forms compared with a paper, identification, functions of (q, parameters)."""

import json
from pathlib import Path

import sympy

import derive as package
from derive.notebook import Model
from tests.journeys.person import Person

ARM = """\
name: elbow
convention: standard
joints:
  - {type: revolute, alpha: pi/2}
  - {type: revolute, a: a2}
  - {type: revolute, a: a3}
links:
  - {mass: m1, inertia: {yy: I1}}
  - {mass: m2, com: [l2 - a2, 0, 0], inertia: {yy: I2, zz: I2}}
  - {mass: m3, com: [l3 - a3, 0, 0], inertia: {yy: I3, zz: I3}}
"""


def test_closed_forms_of_an_arm_with_free_symbols(tmp_path: Path) -> None:
    researcher = Person(tmp_path)
    researcher.writes("elbow.yaml", ARM)
    shown = researcher.types("derive show elbow.yaml singularities 'det(J)' 'M[1,1]' coriolis").stdout
    assert all(name in shown for name in ("singularities = -a2*a3*s3*(a2*c2 + a3*c23)", "(elbow)", "M[1,1] = I1 + "))
    parts = json.loads(researcher.types("derive show elbow.yaml tau B_qdd Cqd g --format json").stdout)["quantities"]
    for k in range(3):
        tau, *others = (sympy.sympify(parts[name][k][0]) for name in ("tau", "B_qdd", "Cqd", "g"))
        assert sympy.expand(tau - sum(others)) == 0
    paper = "m_2 l_2^2 c_2^2 + m_3 (a_2 c_2 + l_3 c_{23})^2 + I_1 + I_2 c_2^2 + I_3 c_{23}^2"
    verdict = researcher.types(f"derive check elbow.yaml --quantity 'B[1,1]' --latex '{paper}'").stdout
    assert verdict.startswith("B[1,1]: ")
    assert "wrong" not in verdict


def test_what_can_be_identified_and_generated_functions_of_the_parameters(tmp_path: Path) -> None:
    researcher = Person(tmp_path)
    researcher.writes("elbow.yaml", ARM)
    robot = package.load(tmp_path / "elbow.yaml")
    model = Model(robot)
    assert len(model.base_parameters) < 3 * 10
    built = package.build(robot, tmp_path / "generated", targets=["numpy"], only=True, effort="quick")
    assert built.report.worst < 1e-9
    names = ("g", "a2", "a3", "m1", "m2", "m3", "l2", "l3", "I1", "I2", "I3")
    program = (
        "import numpy as np\nfrom generated.elbow import model_numpy as m\n"
        f"p = dict(zip({names}, np.linspace(0.5, 1.5, {len(names)})))\n"
        "q, qd, qdd = np.random.default_rng(1).uniform(-1, 1, (3, 50, 3))\n"
        "Y = m.base_regressor(q, qd, qdd, params=p)\n"
        "tau = m.inverse_dynamics(q, qd, qdd, params=p)\n"
        "found = np.linalg.lstsq(Y.reshape(-1, Y.shape[-1]), tau.reshape(-1), rcond=None)[0]\n"
        "print(np.abs(found - m.base_parameters(params=p)).max())\n"
    )
    assert float(researcher.runs(program)) < 1e-8
