"""Formulas as they are printed: read, compared, and diagnosed; slips are put in independently of what repairs them."""

import random
import re
from collections.abc import Callable, Iterator
from functools import cache

import numpy as np
import pytest

from derive.checking.formulas import reading
from derive.checking.formulas.branches import ARCS, ONLY_AT_POINTS, branches, has_branches
from derive.checking.formulas.diagnosis import Question, diagnose
from derive.checking.formulas.edits import SlipKind, ordinal
from derive.checking.formulas.printed import Citation
from derive.checking.methods_file import Vector, names_in, read_vector, value_of
from derive.errors import Location
from derive.lecture.shorthand import notation_text, read_formula
from derive.lecture.sympy_conversion import expression_from_sympy
from derive.model.equality import compare, scalar_quantity
from derive.model.model import Model
from derive.robot.evaluate import to_float
from derive.robot.expression import (
    Call,
    Expression,
    Name,
    Number,
    Power,
    Product,
    Sum,
    add,
    children,
    multiply,
    names,
    negate,
    number,
    power,
)
from derive.robot.names import robot_symbols
from derive.robot.reading.document import YamlMapping, read_tree
from derive.robot.robot import Robot
from tests.lectures.results import ROBOT_FILES, corpus_file
from tests.random_robots import swept

Mutator = Callable[[Expression, random.Random, Robot], Expression | None]


def paths(e: Expression, path: tuple[int, ...] = ()) -> Iterator[tuple[int, ...]]:
    yield path
    if not isinstance(e, Call):
        for i, child in enumerate(children(e)):
            yield from paths(child, (*path, i))


def at(e: Expression, path: tuple[int, ...]) -> Expression:
    for i in path:
        e = children(e)[i]
    return e


def put(e: Expression, path: tuple[int, ...], new: Expression) -> Expression:
    if not path:
        return new
    parts = list(children(e))
    parts[path[0]] = put(parts[path[0]], path[1:], new)
    match e:
        case Sum():
            return add(*parts)
        case Product():
            return multiply(*parts)
        case Power(_, exponent):
            return power(parts[0], exponent)
    raise TypeError(e)


def sign(e: Expression, rng: random.Random, robot: Robot) -> Expression | None:
    if isinstance(e, Sum):
        i = rng.randrange(len(e.terms))
        return add(*e.terms[:i], negate(e.terms[i]), *e.terms[i + 1 :])
    return None


def function(e: Expression, rng: random.Random, robot: Robot) -> Expression | None:
    swapped = {"cos": "sin", "sin": "cos"}
    return Call(swapped[e.function], e.arguments) if isinstance(e, Call) and e.function in swapped else None


def index(e: Expression, rng: random.Random, robot: Robot) -> Expression | None:
    if isinstance(e, Name):
        stem = re.sub("[0-9]+$", "", e.name)
        others = [n for n in robot_symbols(robot) if n != e.name and re.sub("[0-9]+$", "", n) == stem]
        return Name(rng.choice(others)) if others else None
    if isinstance(e, Call) and e.function in ("cos", "sin"):
        angles = [joint.variable for joint in robot.joints if joint.is_revolute]
        own = {n.name for n in (*children(e.arguments[0]), e.arguments[0]) if isinstance(n, Name)}
        kept = rng.choice([sorted(own)[:-1], sorted(own)[1:], sorted(own)])
        other = [a for a in angles if a not in own]
        label = [*kept, rng.choice(other)] if other and (not kept or rng.random() < 0.5) else kept
        return Call(e.function, (add(*map(Name, label)),)) if label and set(label) != own else None
    return None


def exponent(e: Expression, rng: random.Random, robot: Robot) -> Expression | None:
    if isinstance(e, Power):
        return e.base if e.exponent == 2 else None
    return power(e, 2) if isinstance(e, Name | Call) else None


def dropped(e: Expression, rng: random.Random, robot: Robot) -> Expression | None:
    if isinstance(e, Sum):
        i = rng.randrange(len(e.terms))
        return add(*e.terms[:i], *e.terms[i + 1 :])
    return None


MUTATORS: tuple[Mutator, ...] = (sign, function, index, exponent, dropped)


def mutant(e: Expression, rng: random.Random, robot: Robot, mutate: Mutator) -> Expression | None:
    """The formula with one slip of a kind; None where it offers no place."""
    places = list(paths(e))
    rng.shuffle(places)
    for path in places:
        inside_power = path and isinstance(at(e, path[:-1]), Power)
        changed = None if inside_power and mutate is exponent else mutate(at(e, path), rng, robot)
        if changed is not None and not isinstance(at(e, path), Number):
            return put(e, path, changed)
    return None


SWAPPED = "sine or cosine:"


@cache
def model(name: str) -> Model:
    return Model(Robot.load(name))


def question(robot: str, quantity: str, printed: str) -> Question:
    arm = model(robot)
    right = expression_from_sympy(scalar_quantity(arm, quantity))
    return Question(arm.robot, read_formula(printed, arm.robot), right)


@pytest.mark.parametrize(
    ("quantity", "printed", "text"),
    [
        ("p[1]", "a1*c1 - a2*c12", "sign of the 2nd term, -a2*c12"),
        ("p[1]", "-a1*c1 - a2*c12", "sign of the whole"),
        ("p[1]", "a1*c1 + a2*s12", "sine or cosine: c12 instead of s12 in a2*s12"),
        ("p[2]", "a1*s2 + a2*s12", "index: s1 instead of s2 in a1*s2"),
        ("p[2]", "a1*s1 + a2*s1", "index: s12 instead of s1 in a2*s1"),
        ("p[2]", "a1*s1 + a1*s12", "index: a2 instead of a1 in a1*s12"),
        ("p[2]", "a2*s12", "missing term: a1*s1"),
        ("p[2]", "a1*s1 + a2*s12 + a1*a2", "extra term: a1*a2"),
        ("p[2]", "a1*s1 + a2", "missing factor: s12 of a2"),
        ("p[2]", "a1*s1 + a2*s12*c1", "extra factor: c1 in a2*s12*c1"),
        ("p[2]", "2*a1*s1 + a2*s12", "number: 1 instead of 2 in 2*a1*s1"),
        ("p[2]", "-a1*s1 - a2*s12 + d4", None),
        ("p[3]", "q3 + d4", "sign of the whole"),
        ("J[6,4]", "1", "sign: -1 instead of 1"),
        ("B[2,2]", "Il2 + ml2*l2**2 + kr2*Im2 + ml3*a2**2 + Il4", "exponent: kr2**2 instead of kr2 in kr2*Im2"),
        (
            "T[1,1]",
            "c12*s4 + s12*c4",
            f"2 changes: {SWAPPED} c4 instead of s4 in c12*s4; {SWAPPED} s4 instead of c4 in s12*c4",
        ),
    ],
)
def test_the_change_is_named(quantity: str, printed: str, text: str | None) -> None:
    found = diagnose(question("scara-perugia", quantity, printed))
    assert (found.text if found else None) == text


def test_two_changes_of_one_kind_are_found_where_one_is_not_enough() -> None:
    asked = question("puma560-usp", "T[][1,2]", "c1*(-c23*(c4*c5*s6 - s4*c6) - s23*s5*s6) - s1*(-s4*c5*s6 + c4*c6)")
    found = diagnose(asked)
    assert found.kinds == (SlipKind.SIGN, SlipKind.SIGN)
    assert found.text.startswith("2 changes: sign of the 2nd term of ")
    right = "c1*(-c23*(c4*c5*s6 + s4*c6) + s23*s5*s6) - s1*(-s4*c5*s6 + c4*c6)"
    assert notation_text(found.formula, asked.robot) == right


def test_the_repaired_formula_is_equal_and_ordinals_are_english() -> None:
    printed = "Il2 + kr2*Im2 + ml2*(l2**2 + a1*l2*c2) + ml3*(a2**2 - a1*a2*c2) + Il4"
    asked = question("scara-perugia", "B[1,2]", printed)
    found = diagnose(asked)
    assert compare(asked.robot, asked.right, found.formula).equal
    assert [ordinal(i) for i in (1, 2, 3, 4, 11, 12, 13, 21, 22, 101, 111)] == (
        ["1st", "2nd", "3rd", "4th", "11th", "12th", "13th", "21st", "22nd", "101st", "111th"]
    )


@cache
def right_entries() -> tuple[tuple[Robot, Expression, Expression], ...]:
    """(robot, derived, printed) of every right entry of the corpus that is more than a number or a name."""
    found = []
    for file in ROBOT_FILES:
        corpus = corpus_file(file)
        arm = Model(corpus.robot)
        for item in corpus.expected:
            value = arm.quantity(item.quantity) if item.status == "ok" else None
            for entry in item.entries if hasattr(value, "shape") else ():
                if not isinstance(entry.formula, Number | Name) and value.shape >= (entry.row, entry.column):
                    derived = expression_from_sympy(value[entry.row - 1, entry.column - 1])
                    found.append((corpus.robot, derived, entry.formula))
    return tuple(found)


def mutants(count: int) -> list[tuple[Question, Mutator]]:
    """Formulas with one slip each, all of them really wrong."""
    rng = random.Random(2026)
    found: list[tuple[Question, Mutator]] = []
    while len(found) < count:
        robot, derived, printed = rng.choice(right_entries())
        mutate = MUTATORS[len(found) % len(MUTATORS)]
        changed = mutant(printed, rng, robot, mutate)
        if changed is not None and not same_values(robot, derived, changed):
            found.append((Question(robot, changed, derived), mutate))
    return found


def same_values(robot: Robot, a: Expression, b: Expression) -> bool:
    """Whether two formulas agree at three points: they are no mutants then."""
    rng = random.Random(5)
    points = [{n: rng.uniform(0.2, 1.4) for n in {*names(a), *names(b)}} for _ in range(3)]
    return all(abs(to_float(a, point) - to_float(b, point)) < 1e-9 for point in points)


@pytest.mark.slow
@pytest.mark.parametrize("count", [100, *swept(200, 500)])
def test_every_mutant_is_found_and_nine_of_ten_are_repaired(count: int) -> None:
    missed, unexplained = [], []
    for asked, mutate in mutants(count):
        text = f"{mutate.__name__}: {notation_text(asked.printed, asked.robot)}"
        if asked.is_answer(asked.printed):
            missed.append(text)
        repair = diagnose(asked)
        if repair is None or len(repair.kinds) > 1 or not compare(asked.robot, asked.right, repair.formula).equal:
            unexplained.append(text)
    assert not missed
    assert len(unexplained) <= count // 10, unexplained


def item(text: str) -> YamlMapping:
    node = read_tree(text.encode(), "notes.yaml")
    return reading.mapping(node, "an item")


def test_a_remark_says_why_and_where_and_those_on_two_items_are_two() -> None:
    text = "{note: 'two  lines', kind: notation, duplicate: true, source: {document: D, section: 3}}"
    said = reading.remark(item(text))
    assert (said.note, said.kind, said.duplicate, said.document) == ("two lines", "notation", True, Citation("D", "3"))
    assert reading.printed_in(item("{source: a book}")) == Citation("a book")
    assert reading.remark(item("{note: a}")) != reading.remark(item("{note: a}"))


HERE = Location("notes.yaml", 3, 5)
RNG = np.random.default_rng(1)
VALUES = {name: RNG.normal(size=3) for name in ("w", "wd", "p", "w_prev")} | {"I": RNG.normal(size=(3, 3)), "m": 2.5}
EQUATIONS = ["cross(wd, p) + cross(w, cross(w, p))", "-m*(w - 2*wd)", "I @ wd + cross(w, I @ w)", "w", "-w - (p - wd)"]


def read(text: str) -> Vector:
    return read_vector(text, HERE)


@pytest.mark.parametrize("text", EQUATIONS)
def test_what_is_written_reads_as_the_same_equation(text: str) -> None:
    assert read(str(read(text))) == read(text)


def test_the_value_is_that_of_numpy_and_names_come_in_order() -> None:
    w, wd, inertia = (VALUES[name] for name in ("w", "wd", "I"))
    expected = inertia @ wd + np.cross(w, inertia @ w) - 2.5 * w
    assert value_of(read("I @ wd + cross(w, I @ w) - m*w"), VALUES) == pytest.approx(expected)
    assert list(names_in(read("I @ wd + cross(w, I @ w)"))) == ["I", "wd", "w", "I", "w"]


@pytest.mark.parametrize("text", ["w + m", "cross(m, w)", "cross(I, w)"])
def test_shapes_that_do_not_fit_are_refused(text: str) -> None:
    with pytest.raises(ValueError, match="vectors"):
        value_of(read(text), VALUES)


PLANAR = Robot.load("planar-2r-perugia")
ANGLE = Name(PLANAR.joints[1].variable)
COSINE, SINE = Call("cos", (ANGLE,)), Call("sin", (ANGLE,))
SIGN = Name("±1")
ROOT = Call("sqrt", (add(number(1), negate(power(COSINE, 2))),))


@pytest.mark.parametrize(
    ("printed", "all_of_them", "some"),
    [
        (multiply(SIGN, Call("acos", (COSINE,))), True, False),
        (Call("acos", (COSINE,)), False, True),
        (Call("atan2", (multiply(SIGN, ROOT), COSINE)), True, False),
        (Call("Atan2", (COSINE, SINE)), True, False),  # with the cosine first
        (Call("asin", (SINE,)), False, True),
        (Call("atan", (multiply(SINE, power(COSINE, -1)),)), False, True),
        (Call("acos", (SINE,)), False, False),
        (multiply(SIGN, Call("acos", (negate(COSINE),))), False, False),
    ],
)
def test_an_angle_is_compared_for_every_choice_of_signs(printed: Call, all_of_them: bool, some: bool) -> None:
    points, alike = branches(PLANAR, ANGLE, printed)
    assert (0 < alike == points, 0 < alike < points) == (all_of_them, some)
    assert has_branches(printed, ARCS)


def test_a_root_has_two_signs_only_where_that_is_asked() -> None:
    assert has_branches(ROOT, (*ARCS, "sqrt"))
    assert not has_branches(ROOT, ARCS)
    assert not has_branches(Call("atan2", (SINE, COSINE)), ONLY_AT_POINTS)
    assert has_branches(multiply(SIGN, ROOT), ONLY_AT_POINTS)
    points, alike = branches(PLANAR, SINE, multiply(SIGN, ROOT))
    assert alike == points
    points, alike = branches(PLANAR, SINE, ROOT)
    assert 0 < alike < points
