"""Combinations of ways that share work."""

import random
from itertools import product

import pytest

from derive.programs.formulations.choice import choose
from derive.programs.tape.cost import program_cost
from derive.programs.tape.graph import Graph, Ref

Groups = list[list[list[Ref]]]


def random_groups(seed: int) -> tuple[Graph, Groups]:
    rng, graph = random.Random(seed), Graph()
    pool = [graph.input("q", i) for i in range(4)]
    for _ in range(25):
        pool.append(rng.choice([graph.add, graph.multiply])(*rng.sample(pool, 2)))
    return graph, [[rng.sample(pool, 2) for _ in range(rng.randint(1, 4))] for _ in range(4)]


def spent(graph: Graph, groups: Groups, places: tuple[int, ...]) -> int:
    return program_cost(
        graph, [ref for options, place in zip(groups, places, strict=True) for ref in options[place]]
    ).body


@pytest.mark.parametrize("seed", range(15))
def test_no_combination_with_one_change_is_cheaper(seed: int) -> None:
    graph, groups = random_groups(seed)
    places = choose(graph, groups)
    for group, options in enumerate(groups):
        for place in range(len(options)):
            assert spent(graph, groups, places) <= spent(graph, groups, (*places[:group], place, *places[group + 1 :]))


def test_the_cheapest_combination_is_nearly_always_found() -> None:
    cases = [random_groups(seed) for seed in range(15)]
    best = [
        min(spent(graph, groups, places) for places in product(*(range(len(options)) for options in groups)))
        for graph, groups in cases
    ]
    found = [spent(graph, groups, choose(graph, groups)) for graph, groups in cases]
    assert sum(found) <= 1.02 * sum(best)


def test_a_sine_is_worth_many_products() -> None:
    graph = Graph()
    x, y = graph.input("q", 0), graph.input("q", 1)
    products = x
    for _ in range(20):
        products = graph.multiply(products, y)
    assert choose(graph, [[[graph.sine(x)], [products]]]) == (1,)
