"""The JSON Schema and the loader agree on the structure of files, and what fits is what pydantic accepts."""

import json
import random
from copy import deepcopy
from typing import Any

import jsonschema
import pytest
import yaml
from pydantic import ValidationError

from derive.cli.new import new_robot_text
from derive.errors import DeriveError
from derive.plans.catalogue import plan_bytes, plan_names
from derive.plans.schema import PlanFile
from derive.robot.load import catalogue_names, robot_file_bytes
from derive.robot.reading.schema import RobotFile, json_schema
from derive.robot.reading.structure import Strict, fits, model_of
from derive.robot.robot import Robot
from tests.interpreters import another_hash_seed, printed_by
from tests.robot.hostile import GOOD, HOSTILE

STRUCTURAL = """
unknown-key unknown-cell unknown-link-key unknown-inertia-key missing-convention missing-name missing-type
missing-joints wrong-convention wrong-type wrong-unit joints-mapping joints-empty joint-text cell-list cell-mapping
com-two com-four com-text limits-three gravity-two tool-three-rows tool-short-row name-path name-capital title-list
coulomb-one coulomb-three thousand-joints robot-is-text list text null
"""


def validator() -> jsonschema.Draft202012Validator:
    schema = json_schema()
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema)


@pytest.mark.parametrize("name", catalogue_names())
@pytest.mark.first(5)
def test_the_catalogue_satisfies_the_schema(name: str) -> None:
    validator().validate(yaml.safe_load(robot_file_bytes(name)))


def test_a_robot_in_its_own_block_and_a_new_robot_satisfy_the_schema() -> None:
    validator().validate({"robot": yaml.safe_load(GOOD), "expected": []})
    validator().validate(yaml.safe_load(new_robot_text("my-arm")))


@pytest.mark.parametrize("name", STRUCTURAL.split())
@pytest.mark.first(5)
def test_what_the_loader_refuses_for_its_structure_the_schema_refuses_too(name: str) -> None:
    data = HOSTILE[name][0]
    assert not validator().is_valid(yaml.safe_load(data))
    with pytest.raises(DeriveError):
        Robot.from_text(data.decode())


def test_every_key_of_the_schema_is_described_alike_under_any_hash_seed() -> None:
    robot = json_schema()["$defs"]["RobotFile"]
    assert all("description" in value for value in robot["properties"].values())
    code = "import json; from derive.robot.reading.schema import json_schema; print(json.dumps(json_schema()))"
    assert printed_by(code, PYTHONHASHSEED=another_hash_seed()) == json.dumps(json_schema())


ALL = [(RobotFile, robot_file_bytes(n)) for n in catalogue_names()] + [(PlanFile, plan_bytes(n)) for n in plan_names()]
OTHERS: tuple[Any, ...] = ("", "yes", "modified", "q1", [], ["1"], ["1", "2", "3"], [["1"] * 4] * 4, {}, {"xx": "1"})


def is_accepted(block: type[Strict], value: Any) -> bool:
    try:
        model_of(block).model_validate(value)
    except ValidationError:
        return False
    return True


def places(value: Any) -> list[tuple[Any, Any]]:
    """Every container in a tree with each of its keys or positions."""
    items = list(value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ())
    return [pair for key, item in items for pair in ((value, key), *places(item))]


@pytest.mark.parametrize(("block", "text"), ALL)
@pytest.mark.first(16)
def test_what_fits_is_what_pydantic_accepts(block: type[Strict], text: bytes) -> None:
    tree = yaml.load(text, yaml.BaseLoader)
    assert fits(block, tree)
    rng, seen = random.Random(3), set[bool]()
    for _ in range(150):
        changed = deepcopy(tree)
        where, key = rng.choice(places(changed))
        match rng.randrange(4):
            case 0:
                where.pop(key)
            case 1 if isinstance(where, dict):
                where[rng.choice(("name", "z", "motor"))] = where.pop(key)
            case 2 if isinstance(where, list):
                where.append(rng.choice(OTHERS))
            case _:
                where[key] = rng.choice(OTHERS)
        seen.add(fits(block, changed))
        assert fits(block, changed) == is_accepted(block, changed), changed
    assert seen == {True, False}
