"""The JSON Schema of a robot file, for editors."""

from typing import Any

from derive.robot.reading.schema import RobotFile
from derive.robot.reading.structure import model_of


def json_schema() -> dict[str, Any]:
    """JSON Schema of a robot file, for editors; a file with the robot in a block ``robot:`` is accepted too."""
    robot = without_null(model_of(RobotFile).model_json_schema(ref_template="#/$defs/{model}"))
    definitions = robot.pop("$defs", {})
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "derive robot file",
        "$defs": {**definitions, "RobotFile": robot},
        "anyOf": [
            {"$ref": "#/$defs/RobotFile"},
            {
                "type": "object",
                "description": "A lecture corpus file: the robot in its own block, anything else beside it.",
                "required": ["robot"],
                "not": {"anyOf": [{"required": [key]} for key in ("joints", "convention", "links")]},
                "properties": {"robot": {"$ref": "#/$defs/RobotFile"}},
            },
        ],
    }


def without_null(schema: Any) -> Any:
    """Keys that may be left out may not be null: in a robot file ``null`` is a text like any other."""
    if isinstance(schema, list):
        return [without_null(item) for item in schema]
    if not isinstance(schema, dict):
        return schema
    plain = {key: without_null(value) for key, value in schema.items() if not (key == "default" and value is None)}
    options = [option for option in plain.get("anyOf", []) if option != {"type": "null"}]
    if len(options) == 1:
        del plain["anyOf"]
        plain = {**options[0], **plain}
    return plain
