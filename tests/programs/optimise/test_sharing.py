"""Sharing: what occurs twice is computed once, and the network stays what it computes."""

from derive.programs.optimise.convert import graph_of, network_of
from derive.programs.optimise.sharing import Extractor
from derive.programs.tape.build import cut
from derive.programs.tape.graph import Graph
from derive.programs.tape.value import Value


def inputs(count: int) -> tuple[Graph, list[Value]]:
    graph = Graph()
    return graph, [Value(graph, graph.input("q", i)) for i in range(count)]


def test_a_sum_in_two_products_is_shared_until_nothing_saves() -> None:
    graph, (a, b, c, d) = inputs(4)
    outputs = [value.ref for value in (a * c + b * c, a * d + b * d)]
    network = network_of(graph, outputs)
    before = network.cost
    Extractor(network).run()
    assert network.cost < before
    assert cut(*graph_of(network, graph)).operations.arithmetic == 3  # (a + b), times c, times d
    settled = network.cost
    Extractor(network).run()
    assert network.cost == settled


def test_what_occurs_once_is_left_alone() -> None:
    graph, (a, b) = inputs(2)
    network = network_of(graph, [(a * b).ref])
    before = network.cost
    Extractor(network).run()
    assert network.cost == before
