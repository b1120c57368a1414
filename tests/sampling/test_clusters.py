"""Blocks on threads and a scheduler: in order, few at a time, and refusals within seconds."""

import time
from functools import partial

import pytest

from derive.errors import DeriveError
from derive.sampling import clusters
from derive.sampling.clusters import cluster


def times(block: int, factor: int) -> int:
    return block * factor


@pytest.mark.parametrize("workers", [None, 3])
def test_results_come_in_the_order_of_the_blocks(workers: int | None) -> None:
    told: list[str] = []
    with cluster(workers) as found:
        factor = found.shared(7)
        results = list(
            found.in_order(partial(times), range(50), factor, what="x", tell=lambda _, text: told.append(text))
        )
    assert results == [7 * k for k in range(50)]
    assert told[24].startswith("50 %")
    assert told[-1] == "100 %, 0 s left,"


@pytest.mark.parametrize("address", ["tcp://127.0.0.1:9", "nowhere", "tcp://127.0.0.1:x"])
def test_a_scheduler_that_does_not_answer_is_told_within_seconds_and_what_follows_is_computed_here(
    address: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    distributed, dask = pytest.importorskip("distributed"), pytest.importorskip("dask")
    monkeypatch.setattr(clusters, "PATIENCE", 1)
    since, said = time.monotonic(), f"no Dask scheduler answers at '{address}' within 1 s; allowed: an address such as"
    with pytest.raises(DeriveError, match=said) as held, cluster(scheduler=address):
        pass
    assert time.monotonic() - since < 4
    assert held.value.__cause__ is not None  # which keeps the client
    with pytest.raises(ValueError, match="No client"):
        distributed.default_client()
    assert dask.config.get("scheduler", None) is None
