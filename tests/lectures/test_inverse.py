"""The inverse kinematics that the documents print is derived in its form, and the two errata of 004 are found."""

from pathlib import Path
from typing import Any

import pytest
import sympy
import yaml

from derive.api.robots import load
from derive.checking.formulas.findings import Role, judge
from derive.checking.formulas.printed import InverseText, PrintedText
from derive.checking.inverse.check import check_inverse
from derive.errors import Location
from derive.inverse.words.solutions import InverseKinematics
from derive.lecture.shorthand import read_formula
from derive.lecture.sympy_conversion import Expr, expression_to_sympy
from derive.model.model import Model
from derive.robot.expression import Name
from tests.lectures.results import corpus_file, document

FILE = "004-scara-perugia.yaml"
POSE = {"ox": "px", "oy": "py", "oz": "pz", "r11": "r11", "r12": "r21", "sgn": "epsilon_2"}
"""Our names of what is printed; of the admissible orientation r12 = r21."""

FORMULAS = {item["unknown"]: item for item in document(FILE)["inverse_kinematics"]["formulas"]}


@pytest.fixture(scope="module")
def model() -> Model:
    return Model(corpus_file(FILE).robot)


@pytest.fixture(scope="module")
def found(model: Model) -> InverseKinematics:
    return model.inverse


def read(model: Model, text: str) -> Expr:
    names = {printed: Name(ours) for printed, ours in POSE.items()}
    return expression_to_sympy(read_formula(text, model.robot, Location("inverse kinematics"), names))


def derived(found: InverseKinematics, unknown: str) -> Expr:
    """A line of ours, with what it names besides joint variables put in and c2 for the cosine that is called D."""
    known: dict[Expr, Expr] = {}
    for line in found.lines:
        value = line.value.xreplace(known | {sign: sympy.Symbol(sign.name) for sign in line.signs})
        if str(line.symbol) == unknown:
            return value
        if str(line.symbol) == "D":
            known[line.symbol] = sympy.cos(sympy.Symbol("q2"))
        elif str(line.symbol) not in ("q1", "q2", "q3", "q4"):
            known[line.symbol] = value
    raise KeyError(unknown)


OURS = {"alpha": "alpha", "cos_theta2": "D", "theta2": "q2", "theta1": "q1", "theta4": "q4", "d3": "q3"}


@pytest.mark.parametrize("unknown", FORMULAS)
def test_every_printed_formula_is_derived_as_it_is_printed_or_corrected(
    unknown: str, model: Model, found: InverseKinematics
) -> None:
    item = FORMULAS[unknown]
    ours = derived(found, OURS[unknown])
    printed = read(model, item["printed"])
    if item["status"] == "ok":
        assert sympy.expand(ours - printed) == 0
    else:
        assert sympy.expand(ours - read(model, item["correct"])) == 0
        assert sympy.expand(ours - printed) != 0


def test_the_pose_has_a_condition_and_the_elbow_tells_solutions_apart(model: Model, found: InverseKinematics) -> None:
    conditions = {str(condition.left): str(condition.right) for condition in found.conditions}
    assert conditions.items() >= {"r13": "0", "r23": "0", "r33": "-1"}.items()
    assert model.T[0, 1] == model.T[1, 0]
    assert found.count == len(found.solutions) == 2
    assert found.complete
    assert {solution.name for solution in found.solutions} == {"elbow left", "elbow right"}


ROWS: list[dict[str, Any]] = yaml.safe_load(Path(__file__).with_name("inverse.yaml").read_text("utf-8"))


@pytest.mark.parametrize("row", ROWS, ids=[row["document"] for row in ROWS])
def test_every_printed_solution_has_its_verdicts_and_its_errata_their_repair(row: dict[str, Any]) -> None:
    where = Location("document")
    solution = InverseText((PrintedText(row["latex"], where),), where, latex=True)
    findings, _ = check_inverse(Model(load(row["robot"])), solution)
    lines = [finding for finding in findings if finding.role is Role.SOLUTION]
    assert [(f.quantity, judge(f).outcome.value) for f in lines] == [(v["of"], v["is"]) for v in row["verdicts"]]
    for finding, verdict in zip(lines, row["verdicts"], strict=True):
        if "change" in verdict:
            repair = judge(finding).repair
            assert verdict["change"] in repair.text
