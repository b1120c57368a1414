"""What holds for all tests: two workers share two cores, and a busy machine is no fault; examples are the same for all.

With ``DERIVE_NEW_EXAMPLES=1`` in the environment every run draws others, and sweeps take the seeds after that number.
With ``DERIVE_SWEEP_SHARE=4`` a sweep takes of each test every fourth case, the first among them.
"""

import gc
import os
from collections import Counter
from importlib import import_module
from typing import Any

import pytest
from hypothesis import settings

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # two workers on two cores: threads would wait for each other
settings.register_profile("derive", deadline=None, derandomize="DERIVE_NEW_EXAMPLES" not in os.environ)
settings.load_profile("derive")


@pytest.fixture(scope="session")
def roboticstoolbox() -> Any:
    """The package, which ``make test-toolbox`` installs and then requires."""
    name = "roboticstoolbox"
    return import_module(name) if os.environ.get("DERIVE_REQUIRE_TOOLBOX") == "1" else pytest.importorskip(name)


def pytest_collection_finish() -> None:
    """Modules and tests live to the end: looking through them for cycles again and again took a seventh of the time."""
    gc.collect()
    gc.freeze()
    gc.set_threshold(5_000, 20, 20)


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Cases of a test marked `first(n)` behind the first n join the sweep, of which a share may be taken."""
    seen: Counter[str] = Counter()
    for item in items:
        mark, test = item.get_closest_marker("first"), item.nodeid.partition("[")[0]
        if mark and not (item.get_closest_marker("sweep") or item.get_closest_marker("release")):
            seen[test] += 1
            if seen[test] > mark.args[0]:
                item.add_marker(pytest.mark.sweep)
    share, seen, left_out = int(os.environ.get("DERIVE_SWEEP_SHARE", "1")), Counter[str](), []
    for item in [item for item in items if item.get_closest_marker("sweep")]:
        test = item.nodeid.partition("[")[0]
        left_out += [item] * (seen[test] % share > 0)
        seen[test] += 1
    config.hook.pytest_deselected(items=left_out)
    items[:] = [item for item in items if item not in set(left_out)]


def pytest_sessionfinish(session: pytest.Session, exitstatus: int) -> None:
    """A change whose reach holds no sweep has none to fail."""
    if exitstatus == pytest.ExitCode.NO_TESTS_COLLECTED and os.environ.get("DERIVE_REACHED"):
        session.exitstatus = pytest.ExitCode.OK
