"""Cases and choices: signs pass through them, what is known leaves no trace, and improving keeps what they choose."""

from fractions import Fraction

from hypothesis import given, settings
from hypothesis import strategies as st

from derive.programs.optimise.improve import improve
from derive.programs.tape import cases
from derive.programs.tape.build import cut
from derive.programs.tape.graph import ONE, ZERO, Graph
from derive.programs.tape.tape import evaluate
from derive.programs.tape.value import Value
from tests.programs.tape_programs import RATIONAL, fractions, variables


def test_choices_between_opposites_are_opposite() -> None:
    graph = Graph()
    x, y, z = variables(graph)
    case = x.less(y)
    for a, b in ((x, z), (1, z), (0, z), (x, 1), (x, 0), (-x, z), (1, -1)):
        value, opposite = case.select(a, b), case.select(-a, -b)
        assert value.ref == (-opposite).ref


def test_cases_that_are_known_leave_no_trace() -> None:
    graph = Graph()
    x, y, z = variables(graph)
    one = Value(graph, ONE)
    assert (one.select(x, y).ref, (one - one).select(x, y).ref, z.select(x, x).ref) == (x.ref, y.ref, x.ref)
    assert x.less(x).ref == ZERO
    assert (x * x).sqrt().ref == abs((x * x).sqrt()).ref
    assert (-x).maximum(-y).ref == (-(x.minimum(y))).ref
    assert (1 - z).select(x, y).ref == z.select(y, x).ref


def test_constants_of_every_kind_are_compared() -> None:
    graph = Graph()
    half, root = Value(graph, graph.number(Fraction(1, 2))), Value(graph, graph.number(Fraction(2))).sqrt()
    assert (half.less(root).ref, root.less(half).ref, half.less(-root).ref) == (ONE, ZERO, ZERO)
    assert (half.maximum(root).ref, half.minimum(-root).ref) == (root.ref, (-root).ref)


def test_a_case_is_known_by_how_it_is_written() -> None:
    graph = Graph()
    x, y, z = variables(graph)
    case, other = x.less(y), y.less(z)
    for known in (case, case * other, case.maximum(other), case.opposite(), (case * other).opposite()):
        assert cases.is_case(graph, known.ref)
    for unknown in (x, -case, case + other, case * z, x.opposite()):
        assert not cases.is_case(graph, unknown.ref)
    assert case.opposite().opposite().ref == case.ref


def test_squares_roots_and_their_sums_are_nowhere_negative() -> None:
    graph = Graph()
    x, y, _ = variables(graph)
    for known in (x * x, x.sqrt() * abs(y), x * x + abs(y) + 2, x.less(y)):
        assert cases.is_nowhere_negative(graph, known.ref)
        assert known.maximum(0).ref == known.ref
    for unknown in (x, x * y, -(x * x), x * x - 1, x * x + y):
        assert not cases.is_nowhere_negative(graph, unknown.ref)


@given(point=st.lists(fractions(), min_size=3, max_size=3))
@settings(max_examples=100, deadline=None)
def test_improving_keeps_what_cases_choose(point: list[Fraction]) -> None:
    graph = Graph()
    x, y, z = variables(graph)
    case = (x * y + x * z).less(y * z)
    values = [case.select(x * y + x * z, -x) + z, (x - y).maximum(-z) * abs(z - x), (1 - case).minimum(x * -y)]
    functions = RATIONAL | {
        "less": lambda a, b: Fraction(a < b),
        "select": lambda case, a, b: a if case else b,
        "maximum": max,
        "minimum": min,
        "absolute": abs,
    }
    refs = [value.ref for value in values]
    plain, improved = (
        evaluate(cut(*stage), {"q": point}, functions) for stage in ((graph, refs), improve(graph, refs))
    )
    assert plain == improved
