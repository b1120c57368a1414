"""The code for arms without formulas that stands in generated modules."""

import ast

from derive.targets.numpy import render_numpy
from tests.targets.embedded import is_fresh, templates
from tests.targets.generated_models import source_of
from tests.targets.searched_arms import GENERAL, program_of, robot_of


def test_it_is_that_of_the_model() -> None:
    """Where it is not: ``python -m tests.targets.embedded``."""
    assert [path.name for path, text in templates() if not is_fresh(path, text)] == []


def test_the_module_imports_numpy_and_the_standard_library_alone() -> None:
    text = render_numpy(source_of(robot_of(GENERAL), program_of(GENERAL)))["model_numpy.py"]
    imports = [node for node in ast.parse(text).body if isinstance(node, ast.Import | ast.ImportFrom)]
    modules = {getattr(node, "module", None) or node.names[0].name for node in imports}
    assert modules == {"math", "operator", "struct", "dataclasses", "enum", "functools", "numpy"}
