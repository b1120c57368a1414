"""The JSON Schema and the loader agree on the structure of robot files."""

import json

import jsonschema
import pytest
import yaml

from derive.cli.new import new_robot_text
from derive.errors import DeriveError
from derive.robot.load import catalogue_names, robot_file_bytes
from derive.robot.reading.schema import json_schema
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
@pytest.mark.first(15)
def test_the_catalogue_satisfies_the_schema(name: str) -> None:
    validator().validate(yaml.safe_load(robot_file_bytes(name)))


def test_a_robot_in_its_own_block_and_a_new_robot_satisfy_the_schema() -> None:
    validator().validate({"robot": yaml.safe_load(GOOD), "expected": []})
    validator().validate(yaml.safe_load(new_robot_text("my-arm")))


@pytest.mark.parametrize("name", STRUCTURAL.split())
@pytest.mark.first(15)
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
