"""What fits is what pydantic accepts, for right files and for files with one thing changed."""

import random
from copy import deepcopy
from typing import Any

import pytest
import yaml
from pydantic import ValidationError

from derive.plans.catalogue import plan_bytes, plan_names
from derive.plans.schema import PlanFile
from derive.robot.load import catalogue_names, robot_file_bytes
from derive.robot.reading.schema import RobotFile
from derive.robot.reading.structure import Strict, fits, model_of

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
