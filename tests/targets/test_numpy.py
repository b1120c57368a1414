"""The NumPy module as users meet it: shapes, batches, parameters, refusals."""

import ast
import math
import random
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from fractions import Fraction
from itertools import product

import numpy as np
import pytest

from derive.programs.build import build_program
from derive.programs.functions import INTERFACES
from derive.programs.optimise.search_policy import Effort
from derive.programs.program import Function, Program
from derive.programs.tape.build import cut
from derive.programs.tape.graph import Graph
from derive.programs.tape.tape import PARAMETER
from derive.programs.tape.value import Value
from derive.robot.robot import Robot
from derive.targets.numpy import render_numpy
from tests.random_robots import random_robot, seeds
from tests.targets.generated_models import (
    FUNCTIONS,
    IDENTIFICATION,
    PARAMETERS,
    call,
    casadi_model,
    load,
    numpy_model,
    planar,
    source_of,
)

MODEL = numpy_model(planar())
SHAPES = {
    "forward_kinematics": (4, 4),
    "link_transforms": (2, 4, 4),
    "jacobian": (6, 2),
    "jacobian_end": (6, 2),
    "jacobian_dot": (6, 2),
    "analytic_jacobian_rpy": (6, 2),
    "analytic_jacobian_zyz": (6, 2),
    "inertia_matrix": (2, 2),
    "coriolis_matrix": (2, 2),
    "gravity_vector": (2,),
    "kinetic_energy": (),
    "potential_energy": (),
    "inverse_dynamics": (2,),
    "forward_dynamics": (2,),
    "coriolis_vector": (2,),
    "inverse_dynamics_dq": (2, 2),
    "inverse_dynamics_dqd": (2, 2),
    "base_regressor": (2, 7),
}

CONSTANT = replace(INTERFACES["gravity_vector"], arguments=())
"""A function of the parameters alone."""


def arguments(*batch: int, seed: int = 0) -> dict[str, np.ndarray]:
    rng = np.random.default_rng(seed)
    return {kind: rng.uniform(-2, 2, (*batch, 2)) for kind in ("q", "qd", "qdd", "tau")}


@pytest.mark.parametrize("name", FUNCTIONS)
@pytest.mark.parametrize("batch", [(), (1,), (7,), (2, 3), (0,), (3, 0, 2), (5001,)])
def test_results_have_the_shape_of_the_batch(name: str, batch: tuple[int, ...]) -> None:
    result = call(MODEL, name, arguments(*batch), params=PARAMETERS)
    assert result.shape == (*batch, *SHAPES[name])
    assert result.dtype == np.float64
    assert result.flags.c_contiguous


@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_batch_gives_what_its_configurations_give(name: str) -> None:
    many = arguments(9000)
    batch = call(MODEL, name, many, params=PARAMETERS)
    for k in (0, 1, 4095, 4096, 8191, 8192, 8999):
        one = call(MODEL, name, {kind: values[k] for kind, values in many.items()}, params=PARAMETERS)
        assert batch[k] == pytest.approx(one, rel=1e-12, abs=1e-12)


@pytest.mark.parametrize("seed", seeds(12, usual=3))
def test_random_robots_give_the_same_one_by_one_and_in_batches(seed: int) -> None:
    robot = random_robot(random.Random(seed), 1 + seed % 4)
    model = numpy_model(Robot.from_text(robot.text))
    rng = np.random.default_rng(seed)
    many = {kind: rng.uniform(-2, 2, (20, robot.n)) for kind in ("q", "qd", "qdd", "tau")}
    for name in model.OPERATIONS:
        batch = call(model, name, many, params=robot.values)
        ones = [call(model, name, {k: v[i] for k, v in many.items()}, params=robot.values) for i in range(20)]
        assert np.abs(batch - ones).max() <= 1e-12 * max(1, np.abs(batch).max())


def test_arguments_broadcast_against_each_other() -> None:
    a = arguments(4, 3)
    q, qd, qdd = a["q"][0, 0], a["qd"][:, :1], a["qdd"][0]
    found = MODEL.inverse_dynamics(q, qd, qdd, params=PARAMETERS)
    full = MODEL.inverse_dynamics(*(np.broadcast_to(x, (4, 3, 2)) for x in (q, qd, qdd)), params=PARAMETERS)
    assert np.array_equal(found, full)


def test_parameters_broadcast_against_the_batch() -> None:
    a = arguments(3)
    masses = np.array([1.0, 2.0, 3.0])
    found = MODEL.inverse_dynamics(a["q"], a["qd"], a["qdd"], params={"m1": masses, "m2": 1.5})
    for k, mass in enumerate(masses):
        one = MODEL.inverse_dynamics(a["q"][k], a["qd"][k], a["qdd"][k], params={"m1": mass, "m2": 1.5})
        assert found[k] == pytest.approx(one, rel=1e-13)
    grid = MODEL.gravity_vector([0.1, 0.2], params={"m1": masses[:, None], "m2": np.array([[1.0, 2.0]])})
    assert grid.shape == (3, 2, 2)


@pytest.mark.parametrize("name", FUNCTIONS)
@pytest.mark.parametrize("count", [3, 40])
def test_whatever_varies_the_rest_may_stay(name: str, count: int) -> None:
    rng = np.random.default_rng(7)
    for varying in product((False, True), repeat=4):
        a = arguments(count)
        a = {kind: a[kind] if varies else a[kind][0] for kind, varies in zip(("q", "qd"), varying, strict=False)}
        a |= {"qdd": np.full(2, 0.3), "tau": np.full((1, 2), 0.2)}
        masses = {m: rng.uniform(1, 2, count) if v else 1.5 for m, v in zip(("m1", "m2"), varying[2:], strict=True)}
        found = call(MODEL, name, a, params=masses)
        found = np.broadcast_to(found, (count, *SHAPES[name]))
        for k in (0, count - 1):
            one = {kind: values[k] if values.shape == (count, 2) else values.reshape(2) for kind, values in a.items()}
            wanted = call(MODEL, name, one, params={m: float(np.broadcast_to(v, count)[k]) for m, v in masses.items()})
            assert found[k] == pytest.approx(wanted, rel=1e-12, abs=1e-12)


def test_parameters_may_be_a_sequence_or_a_table_in_order() -> None:
    q = [0.4, 0.1]
    by_name = MODEL.gravity_vector(q, params=PARAMETERS)
    values = [PARAMETERS[name] for name in MODEL.PARAMETERS]
    assert np.array_equal(MODEL.gravity_vector(q, params=values), by_name)
    assert np.array_equal(MODEL.gravity_vector(q, params=np.array(values)), by_name)
    table = MODEL.gravity_vector(q, params=np.array([values, values]))
    assert table == pytest.approx(np.array([by_name, by_name]))


def test_kinematics_asks_for_no_masses() -> None:
    assert MODEL.forward_kinematics([0.0, 0.0]).shape == (4, 4)


def test_lists_integers_views_and_other_floats_are_taken() -> None:
    wanted = MODEL.forward_kinematics(np.array([1.0, 2.0]))
    wide = np.array([[1.0, 9.0, 2.0, 9.0]])[0, ::2]
    single = np.array([1, 2], dtype=np.float32)
    for q in ([1, 2], (1.0, 2.0), np.array([1, 2]), single, wide, np.array([2.0, 1.0])[::-1]):
        assert np.array_equal(MODEL.forward_kinematics(q), wanted)


def test_arguments_stay_as_they_are_even_when_read_only() -> None:
    a = arguments(5)
    before = {kind: values.copy() for kind, values in a.items()}
    for values in a.values():
        values.flags.writeable = False
    for name in FUNCTIONS:
        call(MODEL, name, a, params=PARAMETERS)
    assert all(np.array_equal(a[kind], before[kind]) for kind in a)


def test_results_are_independent_of_each_other() -> None:
    q = arguments(3)["q"]
    first = MODEL.inertia_matrix(q, params=PARAMETERS)
    kept = first.copy()
    MODEL.inertia_matrix(q + 1, params=PARAMETERS)
    assert np.array_equal(first, kept)


def test_not_a_number_passes_through_and_infinity_does_not_raise() -> None:
    one = MODEL.forward_kinematics([math.nan, 1.0])
    batch = MODEL.forward_kinematics([[math.nan, 1.0], [0.0, 1.0]])
    assert np.isnan(one).any()
    assert np.array_equal(one, batch[0], equal_nan=True)
    assert np.isfinite(batch[1]).all()
    with np.errstate(invalid="ignore"):
        assert np.isnan(MODEL.forward_kinematics([math.inf, 1.0])).any()
        far = MODEL.forward_kinematics([[math.inf, 1.0]] + 30 * [[0.0, 1.0]])
    assert np.isnan(far[0]).any()
    assert np.isfinite(far[1:]).all()


@pytest.mark.parametrize(
    ("q", "message"),
    [
        ([1.0, 2.0, 3.0], r"q must have shape \(2,\) or \(\.\.\., 2\); got \(3,\)"),
        (1.0, r"got \(\)"),
        (np.zeros((2, 5)), r"got \(2, 5\)"),
        ([[1.0, 2.0], [1.0]], "unequal length"),
        ([], r"got \(0,\)"),
    ],
)
def test_wrong_shapes_are_refused_with_the_right_one(q: object, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        MODEL.forward_kinematics(q)


@pytest.mark.parametrize("q", [[1j, 2.0], ["a", "b"], [None, 1.0], np.array([1.0, 2.0], dtype=object)])
def test_what_is_no_real_number_is_refused(q: object) -> None:
    with pytest.raises(TypeError, match="q must be real numbers"):
        MODEL.forward_kinematics(q)


def test_batches_that_do_not_fit_are_refused() -> None:
    with pytest.raises(ValueError, match=r"do not broadcast: q \(3,\), qd \(4,\)"):
        MODEL.coriolis_matrix(np.zeros((3, 2)), np.zeros((4, 2)), params=PARAMETERS)
    with pytest.raises(ValueError, match=r"q \(3,\), params \(4,\)"):
        MODEL.gravity_vector(np.zeros((3, 2)), params={"m1": np.ones(4), "m2": 1})


@pytest.mark.parametrize("name", FUNCTIONS)
@pytest.mark.parametrize("batch", [(), (3,), (20,), (2, 3)])
def test_results_are_written_where_the_caller_says(name: str, batch: tuple[int, ...]) -> None:
    wanted = call(MODEL, name, arguments(*batch), params=PARAMETERS)
    out = np.full(wanted.shape, np.nan)
    assert call(MODEL, name, arguments(*batch), params=PARAMETERS, out=out) is out
    assert np.array_equal(out, wanted)
    wide = np.full((*wanted.shape, 3), 7.0)
    call(MODEL, name, arguments(*batch), params=PARAMETERS, out=wide[..., 1])
    assert np.array_equal(wide[..., 1], wanted)
    assert (wide[..., ::2] == 7.0).all()


@pytest.mark.parametrize("batch", [(), (5,), (20_000,)])
def test_results_may_overwrite_arguments(batch: tuple[int, ...]) -> None:
    a = arguments(*batch)
    wanted = MODEL.inverse_dynamics(a["q"], a["qd"], a["qdd"], params=PARAMETERS)
    MODEL.inverse_dynamics(a["q"], a["qd"], a["qdd"], params=PARAMETERS, out=a["qdd"])
    assert np.array_equal(a["qdd"], wanted)


def test_results_may_overlap_arguments() -> None:
    line = np.random.default_rng(1).uniform(-2, 2, (9002, 2))
    wanted = MODEL.gravity_vector(line[:-1].copy(), params=PARAMETERS)
    MODEL.gravity_vector(line[:-1], params=PARAMETERS, out=line[1:])
    assert np.array_equal(line[1:], wanted)


@pytest.mark.parametrize("batch", [(), (3,)])
@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (lambda out: out.tolist(), "float64 of shape .*; got list"),
        (lambda out: out[..., :1], r"float64 of shape .*\(\d*,? ?2,?\); got float64 of shape"),
        (lambda out: out.astype(np.float32), "got float32"),
        (lambda out: out.astype(">f8"), "got >f8"),
        (lambda out: np.broadcast_to(out, out.shape), "read-only"),
    ],
)
def test_a_place_that_does_not_fit_is_refused_and_left_alone(
    batch: tuple[int, ...], spoil: Callable[[np.ndarray], object], message: str
) -> None:
    place = spoil(np.full((*batch, 2), 7.0))
    with pytest.raises(ValueError, match=message):
        MODEL.gravity_vector(np.zeros((*batch, 2)), params=PARAMETERS, out=place)
    assert (np.asarray(place) == 7.0).all()


def test_a_refused_call_leaves_the_place_alone() -> None:
    place = np.full(2, 7.0)
    for q, params in (([0.0], PARAMETERS), ([0.0, 0.0], None)):
        with pytest.raises(ValueError, match="gravity_vector"):
            MODEL.gravity_vector(q, params=params, out=place)
    assert (place == 7.0).all()


def test_precomputed_parameters_give_what_parameters_give() -> None:
    given = dict(PARAMETERS)
    prepared = MODEL.precompute(given)
    wanted = {name: call(MODEL, name, arguments(3), params=PARAMETERS) for name in FUNCTIONS}
    given["m1"] = 1e3
    for name in FUNCTIONS:
        assert np.array_equal(call(MODEL, name, arguments(3), params=prepared), wanted[name])
    table = MODEL.precompute({"m1": np.array([2.0, 3.0, 4.0]), "m2": 1.5})
    assert MODEL.gravity_vector(arguments(3)["q"], params=table)[0] == pytest.approx(wanted["gravity_vector"][0])
    with pytest.raises(ValueError, match="precompute: unknown in params: m9"):
        MODEL.precompute({"m9": 1.0})
    with pytest.raises(ValueError, match="gravity_vector: missing in params: m2"):
        MODEL.gravity_vector([0.0, 0.0], params=MODEL.precompute({"m1": 1.0}))


def test_threads_do_not_disturb_each_other() -> None:
    model = numpy_model(planar())
    many = [arguments(20_000, seed=seed) for seed in range(8)]

    def torques(a: dict[str, np.ndarray]) -> np.ndarray:
        return model.inverse_dynamics(a["q"], a["qd"], a["qdd"], params=PARAMETERS)

    with ThreadPoolExecutor(4) as pool:
        found = list(pool.map(torques, many))
    assert all(np.array_equal(a, torques(b)) for a, b in zip(found, many, strict=True))


@pytest.mark.parametrize("scale", [1e-8, 1.0, 1e3, 1e6])
def test_sines_and_cosines_of_batches_are_exact_to_four_ulps(scale: float) -> None:
    robot = Robot.from_text("name: bar\nconvention: standard\njoints:\n  - {type: revolute}\n")
    turns = np.pi / 2 * np.random.default_rng(0).integers(-3, 4, 5000)
    q = np.random.default_rng(1).uniform(-scale, scale, 5000) + turns
    found = numpy_model(robot).forward_kinematics(q[:, None])
    assert np.abs(found[:, 0, 0] - np.cos(q)).max() < 4.5e-16
    assert np.abs(found[:, 1, 0] - np.sin(q)).max() < 4.5e-16
    small = np.abs(q) < 1e-3
    assert found[small, 1, 0] == pytest.approx(np.sin(q[small]), rel=1e-15)


def test_functions_of_parameters_alone_have_the_batch_of_the_parameters() -> None:
    graph = Graph()
    a, b = (Value(graph, graph.input(PARAMETER, i)) for i in range(2))
    tape = cut(graph, [value.ref for value in (a * b, a + b, a)])
    program = Program((Function(CONSTANT, (3,), tape, "by hand"),), ("a", "b"))
    model = numpy_model(planar(), program)
    assert model.gravity_vector({"a": 2.0, "b": 3.0}).tolist() == [6.0, 5.0, 2.0]
    table = model.gravity_vector(params={"a": np.full((4, 30), 2.0), "b": 3.0}, out=np.empty((4, 30, 3)))
    assert (table == [6.0, 5.0, 2.0]).all()
    assert model.gravity_vector(params={"a": np.array([2.0, 4.0]), "b": 3}).tolist() == [
        [6.0, 5.0, 2.0],
        [12.0, 7.0, 4.0],
    ]


def test_functions_of_nothing_are_constants() -> None:
    graph = Graph()
    tape = cut(graph, [graph.number(Fraction(k)) for k in (1, 2)])
    model = numpy_model(planar(), Program((Function(CONSTANT, (2,), tape, "by hand"),), ()))
    assert model.gravity_vector().tolist() == [1.0, 2.0]
    assert (
        casadi_model(
            planar(),
            Program((Function(CONSTANT, (2,), tape, "by hand"),), ()),
        )
        is not None
    )


@pytest.mark.parametrize(
    ("params", "message"),
    [
        (None, "missing in params: m1, m2"),
        ({"m1": 1.0}, "missing in params: m2"),
        ({"m1": 1.0, "m2": 1.0, "m3": 1.0}, "unknown in params: m3"),
        ([1.0], "params must have 2 entries"),
        (np.ones((3, 5)), "params must have 2 entries"),
    ],
)
def test_wrong_parameters_are_refused(params: object, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        MODEL.gravity_vector([0.0, 0.0], params=params)


def test_parameters_must_be_numbers() -> None:
    with pytest.raises(TypeError, match="m1 must be a real number"):
        MODEL.gravity_vector([0.0, 0.0], params={"m1": "heavy", "m2": 1.0})


def test_the_module_says_what_it_is() -> None:
    assert MODEL.DOF == 2
    assert MODEL.JOINT_NAMES == ("q1", "q2")
    assert MODEL.JOINT_TYPES == ("revolute", "prismatic")
    assert list(MODEL.LIMITS) == [(-math.pi, 2.0), None]
    assert MODEL.PARAMETERS == ("m1", "m2")
    assert set(MODEL.OPERATIONS) == {*FUNCTIONS, *IDENTIFICATION} == set(MODEL.__all__) - {
        "DOF", "JOINT_NAMES", "JOINT_TYPES", "LIMITS", "OPERATIONS", "PARAMETERS", "precompute",
        "STANDARD_PARAMETERS", "BASE_PARAMETERS", "BASE_FORMULAS",
    }  # fmt: skip
    for name in FUNCTIONS:
        assert "Args:" in getattr(MODEL, name).__doc__


def test_the_module_imports_numpy_and_the_standard_library_alone() -> None:
    tree = ast.parse(render_numpy(source_of(planar()))["model_numpy.py"])
    imports = [node for node in tree.body if isinstance(node, ast.Import | ast.ImportFrom)]
    assert [alias.name for node in imports for alias in node.names] == ["math", "operator", "struct", "numpy"]


def test_lines_are_clean() -> None:
    text = render_numpy(source_of(planar()))["model_numpy.py"]
    assert "\t" not in text
    assert "\r" not in text
    assert text.endswith("\n")
    assert not any(line != line.rstrip() for line in text.split("\n"))


def test_names_of_users_never_collide_with_names_of_ours() -> None:
    names = ["lambda", "t1", "k1", "p", "k", "sin", "np", "math", "functions", "q", "qd1", "c1", "s1", "print", "class"]
    names = [name for name in names if name not in ("sin", "qd1")]
    links = "\n".join(f"  - {{mass: {a}, com: [{b}, 0, 0]}}" for a, b in zip(names[::2], names[1::2], strict=False))
    count = len(names) // 2
    joints = "\n".join("  - {type: revolute, a: 0.5}" for _ in range(count))
    robot = Robot.from_text(
        f"name: names\nconvention: standard\njoints:\n{joints}\ngravity: [0, -9.81, 0]\nlinks:\n{links}\n"
    )
    model = numpy_model(robot, build_program(robot, Effort.QUICK))
    found = model.gravity_vector(np.full(count, 0.1), params={name: 1.0 for name in model.PARAMETERS})
    assert np.isfinite(found).all()


TITLES = [
    'a """ b',
    '"""',
    "back\\slash\\",
    "{{ 7*7 }}{% raw %}",
    "*/ // # \\input{x}",
    "two\nlines\r\nthree",
    "\u202eevil \u0416 \u4e2d\u6587 \U0001f916",
    "\\N{BULLET} \\x41 \\",
    "'''\n\"\"\"\nimport os",
]


@pytest.mark.parametrize("title", TITLES)
def test_titles_stay_inert(title: str) -> None:
    plain = planar()
    robot = Robot(**{k: getattr(plain, k) for k in plain.__dataclass_fields__} | {"title": title})
    text = render_numpy(source_of(robot))["model_numpy.py"]
    model = load(text)
    assert model.forward_kinematics([0.0, 0.0]).shape == (4, 4)
    usual = ast.parse(render_numpy(source_of(plain))["model_numpy.py"])
    assert ast.dump(ast.Module(ast.parse(text).body[1:], [])) == ast.dump(ast.Module(usual.body[1:], []))


@pytest.mark.sweep
def test_code_stays_compact() -> None:
    joints = "\n".join("  - {type: revolute, a: 0.3, d: 0.1, alpha: pi/2}" for _ in range(64))
    robot = Robot.from_text(f"name: long\nconvention: standard\njoints:\n{joints}\n")
    text = render_numpy(source_of(robot))["model_numpy.py"]
    assert len(text) < 300_000
    assert load(text).forward_kinematics(np.zeros(64)).shape == (4, 4)


def test_the_batch_of_the_parameters_leads_whether_a_function_needs_them_or_not() -> None:
    masses = {"m1": np.array([1.0, 2.0, 3.0]), "m2": 1.5}
    q = [0.1, 0.2]
    assert MODEL.forward_kinematics(q, params=masses).shape == (3, 4, 4)
    assert MODEL.inertia_matrix(q, params=masses).shape == (3, 2, 2)
    assert MODEL.jacobian(np.zeros((4, 1, 2)), params=masses).shape == (4, 3, 6, 2)


def test_base_parameters_depend_on_parameters_alone() -> None:
    """No batch without one in the parameters; the torques are those of the base regressor."""
    a = arguments(3)
    one = MODEL.base_parameters(params=PARAMETERS)
    assert one.shape == (len(MODEL.BASE_PARAMETERS),) == (len(MODEL.BASE_FORMULAS),)
    torques = MODEL.base_regressor(a["q"], a["qd"], a["qdd"], params=PARAMETERS) @ one
    np.testing.assert_allclose(torques, call(MODEL, "inverse_dynamics", a, params=PARAMETERS), rtol=0, atol=1e-12)
    masses = {"m1": np.array([[1.0], [2.0]]), "m2": np.array([0.5, 1.0, 2.0])}
    many = MODEL.base_parameters(params=masses)
    assert many.shape == (2, 3, len(one))
    assert np.array_equal(many[1, 2], MODEL.base_parameters(params={"m1": 2.0, "m2": 2.0}))
    out = np.empty_like(many)
    assert MODEL.base_parameters(params=masses, out=out) is out
    assert np.array_equal(out, many)


def test_columns_of_the_regressor_have_names() -> None:
    shape = call(MODEL, "regressor", arguments(), params=PARAMETERS).shape
    assert shape == (2, len(MODEL.STANDARD_PARAMETERS))
    assert MODEL.STANDARD_PARAMETERS[:2] == ("m1", "mx1")
