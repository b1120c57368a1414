"""The structure of plans, and its JSON Schema for editors."""

from __future__ import annotations

import json
from typing import Any

import pytest
import yaml

from derive.plans.catalogue import plan_bytes, plan_names
from derive.plans.schema import PlanFile, plan_json_schema
from derive.robot.reading.structure import model_of


@pytest.mark.parametrize("name", plan_names())
def test_built_in_plans_fit_the_schema(name: str) -> None:
    jsonschema = pytest.importorskip("jsonschema")
    jsonschema.validate(yaml.safe_load(plan_bytes(name)), plan_json_schema())


def test_the_schema_describes_every_key_and_has_no_null() -> None:
    schema: dict[str, Any] = plan_json_schema()
    assert set(schema["properties"]) == set(model_of(PlanFile).model_fields)
    assert all(value.get("description") for value in schema["properties"].values())
    assert '"null"' not in json.dumps(schema)
