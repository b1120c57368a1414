"""Random expression trees in the form that the parser yields."""

from fractions import Fraction

from hypothesis import strategies as st

from derive.robot.expression import Call, Expression, Name, Number, Pi, add, multiply, power

NAMES = ("q1", "a2", "alpha1", "I", "E", "S", "N", "Q", "lambda", "beta", "gamma", "x_1", "no", "def", "e1")


def numbers() -> st.SearchStrategy[Expression]:
    return st.builds(lambda p, q: Number(Fraction(p, q)), st.integers(-99, 99), st.integers(1, 40))


def leaves() -> st.SearchStrategy[Expression]:
    return st.one_of(numbers(), st.sampled_from(NAMES).map(Name), st.just(Pi()))


def _grown(children: st.SearchStrategy[Expression]) -> st.SearchStrategy[Expression]:
    parts = st.lists(children, min_size=2, max_size=4)
    bases = children.filter(lambda base: base != Number(Fraction(0)))
    return st.one_of(
        parts.map(lambda terms: add(*terms)),
        parts.map(lambda factors: multiply(*factors)),
        st.builds(power, bases, st.integers(-2, 3)),
        st.builds(lambda f, x: Call(f, (x,)), st.sampled_from(["sin", "cos", "tan", "sqrt"]), children),
    )


def trees() -> st.SearchStrategy[Expression]:
    return st.recursive(leaves(), _grown, max_leaves=12)
