"""Quantities of a model by name, entry by entry, under assumptions."""

import pytest
import sympy

import derive
from derive.errors import QuantityError
from derive.model.model import Model
from derive.model.quantities import DESCRIBED, REGISTRY, Quantity
from derive.model.quantity_names import evaluate, parse
from derive.notebook import Assumptions, plain
from derive.robot.options.style import Style
from derive.robot.robot import Robot
from tests.rows import robot_of_rows


@pytest.fixture(scope="module")
def model() -> Model:
    """Four joints with axes in all directions, and links."""
    rows = "R a: a1, alpha: pi/2 | R a: a2 | R d: d3, alpha: -pi/2 | R alpha: pi/2"
    links = "links:\n" + "  - {mass: m, com: [0, 0, l], inertia: {zz: I}}\n" * 4
    return Model(robot_of_rows(rows, f"gravity: [0, 0, -g]\n{links}"))


@pytest.mark.parametrize("quantity", REGISTRY.values(), ids=REGISTRY.keys())
def test_a_quantity_has_the_shape_of_its_row(quantity: Quantity, model: Model) -> None:
    # a block of four columns has four rows, and four general joints have no task whose determinant it would be
    if quantity.is_of(model.robot) and quantity.name not in ("detJ", "detJ_rows", "singularities"):
        value = quantity.value(model, *[1] * min(quantity.indices))
        sizes = {"k": 1, "p": len(model.standard_parameter_names), "b": len(model.base_parameter_names)}
        sizes["s"] = len(model.inverse.solutions)
        shape = quantity.shape_of(model.robot)
        assert getattr(value, "shape", ()) == tuple(sizes.get(size) or int(size) for size in shape.split("x") if shape)


def test_two_indices_of_T_are_frames_where_the_arm_has_them_and_else_an_entry(model: Model) -> None:
    assert evaluate(model, "T[1,4]") == model.transform(1, 4)
    assert evaluate(model, "T[1,4][2,3]") == model.transform(1, 4)[1, 2]
    assert evaluate(model, "T[][1,4]") == evaluate(model, "T(1,4)") == model.T[0, 3]
    assert parse(Model(Robot.load("planar-2r-perugia")), "T[1,4]")[2] == (1, 4)


BOOKS = {
    "B": ["M", "D", "mass matrix", "mass_matrix", "inertia", "Inertia Matrix"],
    "B[1,2]": ["M_12", "b_12", "B12", "b_{12}", "M(1,2)", "mass matrix[1,2]"],
    "C": ["coriolis", "Coriolis matrix"],
    "Cqd": ["C qd", "C*qd", "coriolis_vector", "tau_velocity"],
    "B_qdd": ["B qdd", "M*qdd", "tau_inertia"],
    "g": ["gravity", "G", "tau_gravity", "gravload"],
    "friction": ["F", "tau_friction"],
    "tau": ["torque", "torques", "inverse dynamics", "rne"],
    "tau[2]": ["tau_2", "tau2", "torque 2"],
    "T": ["fkine", "forward kinematics", "pose"],
    "T[0,4]": ["T04", "T_04", "T0_4", "T_4^0", "T^0_4", "{}^0T_4", "^0_4T", "T_{4}^{0}"],
    "T[3]": ["T3", "T_3"],
    "T[0,2]": ["A_2^0", "A02"],
    "A[2]": ["A2", "A_2", "A_2^1", "A12"],
    "p[1]": ["p_x", "px", "p1"],
    "J": ["jacobian", "Jacobian", "jacob0"],
    "J_dot": ["Jdot", "dJ/dt", "\\dot{J}"],
    "J_11": ["J11", "J_{11}"],
    "J[6,4]": ["J(6,4)", "J64"],
    "detJ_11": ["det(J_11)", "det J11"],
    "christoffel[1,2,3]": ["c_123", "c123", "c_{123}"],
    "N": ["Bdot - 2C", "Mdot-2C"],
    "inverse": ["inverse kinematics", "ik", "IK", "ikine", "Inverse_Kinematics"],
    "kinetic": ["kinetic energy", "K"],
    "potential": ["U", "potential energy"],
    "base_parameters": ["beta", "base parameters"],
}


@pytest.mark.parametrize(("ours", "theirs"), [(ours, theirs) for ours, list_ in BOOKS.items() for theirs in list_])
def test_names_of_books_are_understood(ours: str, theirs: str, model: Model) -> None:
    assert parse(model, theirs) == parse(model, ours)


def test_every_name_that_python_can_spell_is_an_attribute(model: Model) -> None:
    """And every attribute that is a quantity is a name."""
    public = derive.Model(model.robot)
    rows = (name for name, row in REGISTRY.items() if row.indices == (0,) and row.is_of(model.robot))
    for ours, theirs in [*BOOKS.items(), *((name, [name]) for name in rows)]:
        for name in filter(str.isidentifier, theirs):
            if parse(model, ours)[0].is_of(model.robot) and ours not in ("detJ", "singularities", "tau"):
                found = getattr(public, name)
                assert found is public.inverse if ours == "inverse" else found == public.quantity(ours), name
    assert public.J_rows(1, 2) == public.quantity("J_rows[1,2]")
    assert {"detJ", "Cqd", "kinetic", "J_rows"} <= set(dir(public))
    assert [public.quantity(name) for name in DESCRIBED] == [public.workspace, public.aspects, public.decoupling]
    words = {"frame": "T", "transform": "T", "det_J": "detJ", "coriolis_vector": "Cqd"}
    assert {name: parse(model, name)[0].name for name in words} == words
    refused = {"_private": "no attribute", "jacobain": "did you mean J", "h": "has several meanings"}
    for name, message in refused.items():
        with pytest.raises(AttributeError, match=message):
            getattr(public, name)


@pytest.mark.parametrize(
    ("text", "meanings"),
    [
        ("V", ["potential", "Cqd"]), ("H", ["T", "B"]), ("P", ["p", "potential"]), ("T_0^4", ["T[0,4]", "T[4,0]"]),
        ("J_A", ["J_rpy", "J_zyz"]), ("J_analytic", ["J_rpy", "J_zyz"]), ("energy", ["kinetic", "potential"]),
        ("Jacobean", ["J"]), ("torqe", ["tau"]), ("t", ["T"]), ("foo", ["christoffel"]),
        *((text, []) for text in ("T09", "T[1,2,3,4,5]", "A[x]", "A", "A[1,2][1,1]", "B[9,1]", "kinetic[1,1]")),
        *((text, []) for text in ("J_rows[1,7]", "J_rows[2,2]", "detJv", "", "[1]")),
    ],
)  # fmt: skip
def test_what_is_not_there_or_unclear_is_refused_with_a_hint(text: str, meanings: list[str], model: Model) -> None:
    with pytest.raises(QuantityError) as refused:
        evaluate(model, text)
    assert all(meaning in str(refused.value) for meaning in meanings)


def test_a_letter_with_two_meanings_has_one_where_the_robot_has_one() -> None:
    thumb = Model(Robot.load("thumb"))
    assert parse(thumb, "H") == parse(thumb, "T")
    assert parse(thumb, "P") == parse(thumb, "p")


def test_the_torque_is_the_sum_of_its_parts() -> None:
    """With friction and rotors; and C qd is C times qd, B qdd is B times qdd."""
    found = Model(Robot.load("scara-matlab"))
    parts = [found.quantity(name) for name in ("B_qdd", "Cqd", "g", "friction")]
    assert all(any(part) for part in parts)
    assert sympy.expand(found.tau - sum(parts[1:], parts[0])) == sympy.zeros(4, 1)
    assert sympy.expand(found.B * sympy.Matrix(found.qdd) - parts[0]) == sympy.zeros(4, 1)
    assert sympy.expand(found.C * sympy.Matrix(found.qd) - parts[1]) == sympy.zeros(4, 1)


@pytest.mark.parametrize(
    ("name", "quantity", "rows", "columns"),
    [
        ("planar-2r-perugia", "detJxy", (0, 1), (0, 1)),
        ("anthropomorphic-arm", "detJv", (0, 1, 2), (0, 1, 2)),
        ("planar-3r", "detJ_rows[1,2,6]", (0, 1, 5), (0, 1, 2)),
        ("planar-3r", "detJ", (0, 1, 5), (0, 1, 2)),
        ("scara-perugia", "detJ", (0, 1, 2, 5), (0, 1, 2, 3)),
        ("anthropomorphic-arm", "detJ", (0, 1, 2), (0, 1, 2)),
        ("kuka-kr5", "detJ_11", (0, 1, 2), (0, 1, 2)),
        ("kuka-kr5", "detJ_22", (3, 4, 5), (3, 4, 5)),
    ],
)
def test_determinants_of_blocks_are_those_of_J_in_numbers(
    name: str, quantity: str, rows: tuple[int, ...], columns: tuple[int, ...]
) -> None:
    found = Model(Robot.load(name))
    symbols = found.J.free_symbols
    values = {symbol: 0.3 + 0.37 * k for k, symbol in enumerate(sorted(symbols, key=str))}
    block = sympy.Matrix(found.J.extract(list(rows), list(columns)).subs(values))
    assert float(found.quantity(quantity).subs(values)) == pytest.approx(float(block.det()), rel=1e-9, abs=1e-12)


def test_singularities_are_the_determinant_in_factors() -> None:
    found = Model(Robot.load("puma560-corke"))
    assert found.quantity("singularities") == found.singularities.determinant
    with pytest.raises(QuantityError, match=r"6x7 Jacobian of kuka-lwr4; allowed: arms of six"):
        Model(Robot.load("kuka-lwr4")).quantity("singularities")
    with pytest.raises(QuantityError, match=r"det J of thumb, which moves in 6 coordinates by 5 joints"):
        Model(Robot.load("thumb")).quantity("detJ")


@pytest.mark.parametrize("name", ["J_11_reduced", "detJ_rows[1,2]", "detJ_11", "singularities"])
def test_an_arm_that_is_too_long_for_it_is_refused_at_once(name: str) -> None:
    """Multiplied out, J of 21 joints would fill the memory."""
    with pytest.raises(QuantityError):
        Model(Robot.load("human-body")).quantity(name)


def test_a_list_holds_what_the_robot_has() -> None:
    planar, thumb = Robot.load("planar-2r-perugia"), Robot.load("thumb")
    assert REGISTRY["detJxy"].is_of(planar)
    assert not REGISTRY["J_12"].is_of(planar)
    assert not REGISTRY["B"].is_of(thumb)
    assert REGISTRY["J_rows"].call == "J_rows[i,...]"
    assert REGISTRY["J_12"].shape_of(thumb) == "3x2"


@pytest.mark.parametrize(("option", "allowed"), [("style", "compact, by-geometry"), ("contraction", "opposed")])
def test_an_unknown_style_or_contraction_is_refused_with_the_known_ones(option: str, allowed: str) -> None:
    with pytest.raises(QuantityError, match=allowed):
        Model(Robot.load("planar-3r"), **{option: "roman"})


BODIES = """
gravity: [0, 0, -g]
links:
  - {mass: m1, com: [l1, 0, 0], inertia: {yy: I1}, motor: {mass: mm1, inertia: 1e-4, ratio: k}}
  - {mass: m2 + m3, com: [l2, 0, 0], motor: {mass: mm2}, friction: {viscous: b, coulomb: f}}
parameters: {mm2: 0}
runtime: [mm2]
inverse: {task: [x, y]}
"""


@pytest.fixture(scope="module")
def models() -> tuple[derive.Model, derive.Model]:
    robot = robot_of_rows("R a: a1, alpha: pi/2 | P a: a2, d: q2 + d2", BODIES)
    return derive.Model(robot), derive.Model(robot, assumptions=True)


def test_quantities_are_the_same_in_real_symbols_and_masses_positive(models: tuple[derive.Model, derive.Model]) -> None:
    """A mass that is a sum of symbols, or may be zero, says nothing of the sign of any."""
    usual, assumed = models
    seen: set[sympy.Symbol] = set()
    for row in REGISTRY.values():
        if not row.is_of(usual.robot) or row.name in ("detJ_rows", "inverse", "J_zyz"):
            continue
        indices = f"[{','.join('1' * row.indices[0])}]" if row.indices[0] else ""
        ours, theirs = (model.quantity(row.name + indices) for model in models)
        assert sympy.srepr(plain(theirs)) == sympy.srepr(ours), row.name
        assert str(theirs) == str(ours), row.name  # brackets and order too
        seen |= theirs.free_symbols
    assert all(symbol.is_real for symbol in seen)
    assert {str(symbol) for symbol in seen if symbol.is_positive} == {"m1", "mm1"}
    assert all(symbol.is_positive is None for symbol in usual.B.free_symbols)
    assert all(q.is_real for q in (*assumed.q, *assumed.qd, *assumed.qdd))


def test_whatever_the_model_has_or_does_speaks_of_these_symbols_and_sympy_simplifies_with_them(
    models: tuple[derive.Model, derive.Model],
) -> None:
    usual, assumed = models
    assert sympy.sqrt(assumed.p[0] ** 2) == sympy.Abs(assumed.p[0])
    assert sympy.sqrt(usual.p[0] ** 2) != sympy.Abs(usual.p[0])
    mass = next(symbol for symbol in assumed.B.free_symbols if symbol.name == "m1")
    assert sympy.sqrt(mass**2) == mass
    assert isinstance(assumed, derive.Model)
    assert assumed.robot == usual.robot
    assert assumed.M == assumed.B == assumed.with_style(Style.of("expanded")).with_style(Style()).B
    slope = usual.christoffel(1, 1, 2).diff(usual.q[1])
    assert assumed.christoffel(1, 1, 2).diff(assumed.q[1]) == Assumptions(usual.robot)(slope)
    assert assumed.equal("T[1,4]", assumed.T[0, 3])
    assert assumed.equal("T[1,4]", str(usual.T[0, 3]))
    assert all(symbol.is_real for symbol in assumed.at("T", [0.3, 0.5]).free_symbols)
    (definition,) = {name for _, names in [assumed.abbreviated("C")] for name in names}
    assert definition.is_real
    assert all(symbol.is_real for line in assumed.inverse.lines for symbol in line.value.free_symbols)
    assert all(q.is_real for q in assumed.inverse.solutions[0].joints)
    assert all(symbol.is_real for symbol in assumed.inverse[0, 0].free_symbols)
    assert all(name in dir(assumed) for name in ("B", "inverse"))
    assert all(getattr(assumed, name) is not None for name in DESCRIBED)
