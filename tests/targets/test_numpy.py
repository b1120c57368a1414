"""The modules in Python, NumPy's and the compiled one, as users meet them: shapes, batches, parameters, wrenches."""

import ast
import math
import re
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from fractions import Fraction
from itertools import product
from types import ModuleType
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from derive.programs.functions import INTERFACES
from derive.programs.program import Function, Program
from derive.programs.tape.build import cut
from derive.programs.tape.graph import Graph
from derive.programs.tape.tape import PARAMETER
from derive.programs.tape.value import Value
from derive.targets.numpy import render_numpy
from tests.rows import robot_of_rows
from tests.targets import generated_models as models
from tests.targets.generated_models import FUNCTIONS, IDENTIFICATION, PARAMETERS, arguments, call, numpy_model, planar
from tests.targets.languages import languages, running

SHAPES = {
    "forward_kinematics": (4, 4),
    "link_transforms": (2, 4, 4),
    **dict.fromkeys(("jacobian", "jacobian_end", "jacobian_dot"), (6, 2)),
    "jacobian_hessian": (6, 2, 2),
    **dict.fromkeys(("analytic_jacobian_rpy", "analytic_jacobian_zyz"), (6, 2)),
    **dict.fromkeys(("inertia_matrix", "coriolis_matrix", "task_inertia"), (2, 2)),
    **dict.fromkeys(("kinetic_energy", "potential_energy", "manipulability"), ()),
    **dict.fromkeys(("manipulability_position", "manipulability_orientation"), ()),
    **dict.fromkeys(("gravity_vector", "inverse_dynamics", "forward_dynamics", "coriolis_vector"), (2,)),
    **dict.fromkeys(("manipulability_dq", "wrench_torques", "wrench_torques_end"), (2,)),
    **dict.fromkeys(("wrench_torques_dq", "wrench_torques_end_dq"), (2, 2)),
    **{f"{name}_wrench{axes}": (2,) for name in ("inverse_dynamics", "forward_dynamics") for axes in ("", "_end")},
    **dict.fromkeys(("inverse_dynamics_wrench_dq", "inverse_dynamics_wrench_end_dq"), (2, 2)),
    **dict.fromkeys(("inverse_dynamics_dq", "inverse_dynamics_dqd"), (2, 2)),
    "base_regressor": (2, 8),
}

CONSTANT = replace(INTERFACES["gravity_vector"], arguments=())
"""A function of the parameters alone."""


@pytest.fixture(scope="module", params=languages("numpy", "native"))
def model(request: pytest.FixtureRequest) -> Iterator[ModuleType]:
    with running(request.param, planar()) as found:
        yield found.module


def same(found: object, wanted: object, tolerance: float = 1e-12) -> None:
    np.testing.assert_allclose(found, wanted, rtol=tolerance, atol=tolerance)  # type: ignore[arg-type]


@pytest.mark.parametrize("batch", [(), (1,), (7,), (32,), (2, 3), (0,), (3, 0, 2), (5001,)])
def test_results_have_the_shape_of_the_batch(model: ModuleType, batch: tuple[int, ...]) -> None:
    for name, shape in SHAPES.items():
        result = call(model, name, arguments(*batch), params=PARAMETERS)
        assert type(result) is (np.ndarray if result.ndim else np.float64)
        assert (result.shape, result.dtype, result.flags.c_contiguous) == ((*batch, *shape), np.float64, True)


@pytest.mark.parametrize("count", [3, 40])
def test_whatever_varies_the_rest_may_stay(model: ModuleType, count: int) -> None:
    rng = np.random.default_rng(7)
    for name, varying in product(FUNCTIONS, product((False, True), repeat=4)):
        a = arguments(count)
        a = {kind: a[kind] if varies else a[kind][0] for kind, varies in zip(("q", "qd"), varying, strict=False)}
        a |= {"qdd": np.full(2, 0.3), "tau": np.full((1, 2), 0.2), "h": np.ones(6)}
        masses = {m: rng.uniform(1, 2, count) if v else 1.5 for m, v in zip(("m1", "m2"), varying[2:], strict=True)}
        found = np.broadcast_to(call(model, name, a, params=masses), (count, *SHAPES[name]))
        for k in (0, count - 1):
            one = {kind: values[k] if values.shape == (count, 2) else values.ravel() for kind, values in a.items()}
            own = {m: float(np.broadcast_to(v, count)[k]) for m, v in masses.items()}
            same(found[k], call(model, name, one, params=own))


def test_parameters_are_a_sequence_or_a_table_in_order_or_arrays_by_name(model: ModuleType) -> None:
    q, masses = [0.4, 0.1], np.array([1.0, 2.0, 3.0])
    by_name = model.gravity_vector(q, params=PARAMETERS)
    values = [PARAMETERS[name] for name in model.PARAMETERS]
    for params in (values, np.array(values)):
        same(model.gravity_vector(q, params=params), by_name)
    same(model.gravity_vector(q, params=np.array([values, values])), [by_name, by_name])
    many = model.gravity_vector(q, params={"m1": masses, "m2": 1.5})
    for found, mass in zip(many, masses, strict=True):
        same(found, model.gravity_vector(q, params={"m1": mass, "m2": 1.5}))
    grid = {"m1": masses[:, None], "m2": np.array([[1.0, 2.0]])}
    assert model.gravity_vector([0.1, 0.2], params=grid).shape == (3, 2, 2)


def test_the_batch_of_the_parameters_leads_whether_a_function_needs_them_or_not(model: ModuleType) -> None:
    masses, q = {"m1": np.array([1.0, 2.0, 3.0]), "m2": 1.5}, [0.1, 0.2]
    assert model.forward_kinematics(q).shape == (4, 4)
    assert model.forward_kinematics(q, params=masses).shape == (3, 4, 4)
    assert model.inertia_matrix(q, params=masses).shape == (3, 2, 2)
    assert model.jacobian(np.zeros((4, 1, 2)), params=masses).shape == (4, 3, 6, 2)


def test_lists_integers_views_and_other_floats_are_taken(model: ModuleType) -> None:
    wanted, wide = model.forward_kinematics(np.array([1.0, 0.0])), np.array([[1.0, 9.0, 0.0, 9.0]])[0, ::2]
    kinds = (np.int64, np.bool_, np.float32, np.longdouble, ">f8")
    for q in ([1, 0], (1.0, 0.0), wide, np.array([0.0, 1.0])[::-1], *(np.array([1, 0], dtype=kind) for kind in kinds)):
        same(model.forward_kinematics(q), wanted)
    for rows in (([1.0, 0.0], [1.0, 0.0]), np.asfortranarray([[1.0, 0.0]] * 3), np.broadcast_to(wide, (9, 2))):
        same(model.forward_kinematics(rows), np.broadcast_to(wanted, (len(rows), 4, 4)))


def test_arguments_stay_as_they_are_even_when_read_only(model: ModuleType) -> None:
    for batch in ((), (9,)):
        a = arguments(*batch)
        before = {kind: values.copy() for kind, values in a.items()}
        for values in a.values():
            values.flags.writeable = False
        for name in FUNCTIONS:
            call(model, name, a, params=PARAMETERS)
        assert all(np.array_equal(a[kind], before[kind]) for kind in a)


def test_finite_numbers_and_what_is_no_number_raise_no_warning(model: ModuleType) -> None:
    with np.errstate(all="raise"):
        for name, batch in product(FUNCTIONS, ((), (5,))):
            call(model, name, arguments(*batch), params=PARAMETERS)
        one = model.forward_kinematics([math.nan, 1.0])
        batch = model.forward_kinematics([[math.nan, 1.0], [0.0, 1.0]])
    assert np.isnan(one).any()
    assert np.array_equal(one, batch[0], equal_nan=True)
    assert np.isfinite(batch[1]).all()
    with np.errstate(invalid="ignore"):
        assert np.isnan(model.forward_kinematics([math.inf, 1.0])).any()
        far = model.forward_kinematics([[math.inf, 1.0]] + 30 * [[0.0, 1.0]])
    assert np.isnan(far[0]).any()
    assert np.isfinite(far[1:]).all()


FK, G = "forward_kinematics", "gravity_vector"
REFUSED: list[tuple[type[Exception], str, tuple[Any, ...], Any, str]] = [
    (ValueError, FK, ([1.0, 2.0, 3.0],), None, r"q must have shape \(2,\) or \(\.\.\., 2\); got \(3,\)"),
    (ValueError, FK, (1.0,), None, r"got \(\)"),
    (ValueError, FK, (np.zeros((2, 5)),), None, r"got \(2, 5\)"),
    (ValueError, FK, ([[1.0, 2.0], [1.0]],), None, "unequal length"),
    (ValueError, FK, ([],), None, r"got \(0,\)"),
    (TypeError, FK, ([1j, 2.0],), None, "q must be real numbers"),
    (TypeError, FK, (["a", "b"],), None, "q must be real numbers"),
    (TypeError, FK, ([None, 1.0],), None, "q must be real numbers"),
    (TypeError, FK, (np.array([1.0, 2.0], dtype=object),), None, "q must be real numbers"),
    (ValueError, "coriolis_matrix", (np.zeros((3, 2)), np.zeros((4, 2))), PARAMETERS, r"q \(3,\), qd \(4,\)"),
    (ValueError, G, (np.zeros((3, 2)),), {"m1": np.ones(4), "m2": 1}, r"q \(3,\), params \(4,\)"),
    (ValueError, G, ([0.0, 0.0],), None, "missing in params: m1, m2"),
    (ValueError, G, ([0.0, 0.0],), {"m1": 1.0}, "missing in params: m2"),
    (ValueError, G, ([0.0, 0.0],), {"m1": 1.0, "m2": 1.0, "m3": 1.0}, "unknown in params: m3"),
    (ValueError, G, ([0.0, 0.0],), [1.0], "params must have 2 entries"),
    (ValueError, G, ([0.0, 0.0],), np.ones((3, 5)), "params must have 2 entries"),
    (TypeError, G, ([0.0, 0.0],), {"m1": "heavy", "m2": 1.0}, "m1 must be a real number"),
]


@pytest.mark.parametrize(("error", "name", "given", "params", "message"), REFUSED)
def test_what_does_not_fit_is_refused_with_what_does(
    model: ModuleType, error: type[Exception], name: str, given: tuple[Any, ...], params: Any, message: str
) -> None:
    place = np.full(SHAPES[name], 7.0)
    with pytest.raises(error, match=f"^{name}: .*{message}"):
        getattr(model, name)(*given, params=params, out=place)
    assert (place == 7.0).all()


@pytest.mark.parametrize("batch", [(), (3,), (20,), (2, 3)])
def test_results_are_written_where_the_caller_says_whatever_the_strides(
    model: ModuleType, batch: tuple[int, ...]
) -> None:
    for name in FUNCTIONS:
        wanted = call(model, name, arguments(*batch), params=PARAMETERS)
        wide = np.full((*wanted.shape, 3), 7.0)
        for out in (np.full(wanted.shape, np.nan), np.empty(wanted.shape[::-1]).T, wide[..., 1]):
            assert call(model, name, arguments(*batch), params=PARAMETERS, out=out) is out
            same(out, wanted, 1e-13)
        assert (wide[..., ::2] == 7.0).all()
        if wanted.ndim:
            strided = np.empty((*wanted.shape[:-1], 2 * wanted.shape[-1]))[..., ::-2]
            same(call(model, name, arguments(*batch), params=PARAMETERS, out=strided), wanted, 1e-13)


@pytest.mark.parametrize("batch", [(), (5,), (20_000,)])
def test_results_may_overwrite_arguments(model: ModuleType, batch: tuple[int, ...]) -> None:
    given = list(arguments(*batch).values())[:3]
    wanted = model.inverse_dynamics(*given, params=PARAMETERS)
    for place in range(3):
        copies = [value.copy() for value in given]
        model.inverse_dynamics(*copies, params=PARAMETERS, out=copies[place])
        same(copies[place], wanted, 1e-13)


def test_results_may_overlap_arguments(model: ModuleType) -> None:
    line = np.random.default_rng(1).uniform(-2, 2, (9002, 2))
    wanted = model.gravity_vector(line[:-1].copy(), params=PARAMETERS)
    model.gravity_vector(line[:-1], params=PARAMETERS, out=line[1:])
    same(line[1:], wanted, 1e-13)


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
    model: ModuleType, batch: tuple[int, ...], spoil: Callable[[np.ndarray], object], message: str
) -> None:
    place = spoil(np.full((*batch, 2), 7.0))
    with pytest.raises(ValueError, match=message):
        model.gravity_vector(np.zeros((*batch, 2)), params=PARAMETERS, out=place)
    assert (np.asarray(place) == 7.0).all()


def test_precomputed_parameters_give_what_parameters_give(model: ModuleType) -> None:
    given = dict(PARAMETERS)
    prepared = model.precompute(given)
    wanted = {name: call(model, name, arguments(3), params=PARAMETERS) for name in FUNCTIONS}
    given["m1"] = 1e3
    for name in FUNCTIONS:
        assert np.array_equal(call(model, name, arguments(3), params=prepared), wanted[name])
    table = model.precompute({"m1": np.array([2.0, 3.0, 4.0]), "m2": 1.5})
    same(model.gravity_vector(arguments(3)["q"], params=table)[0], wanted["gravity_vector"][0])
    with pytest.raises(ValueError, match="precompute: unknown in params: m9"):
        model.precompute({"m9": 1.0})
    with pytest.raises(ValueError, match="gravity_vector: missing in params: m2"):
        model.gravity_vector([0.0, 0.0], params=model.precompute({"m1": 1.0}))


def test_results_are_independent_of_each_other_and_of_threads(model: ModuleType) -> None:
    many = [arguments(20_000, seed=seed) for seed in range(8)]

    def torques(a: dict[str, np.ndarray]) -> np.ndarray:
        return model.inverse_dynamics(a["q"], a["qd"], a["qdd"], params=PARAMETERS)

    with ThreadPoolExecutor(4) as pool:
        found = list(pool.map(torques, many))
    assert all(np.array_equal(a, torques(b)) for a, b in zip(found, many, strict=True))


def test_base_parameters_depend_on_parameters_alone(model: ModuleType) -> None:
    """No batch without one in the parameters; the torques are those of the base regressor."""
    a = arguments(3)
    one = model.base_parameters(params=PARAMETERS)
    assert one.shape == (len(model.BASE_PARAMETERS),) == (len(model.BASE_FORMULAS),)
    torques = model.base_regressor(a["q"], a["qd"], a["qdd"], params=PARAMETERS) @ one
    same(torques, call(model, "inverse_dynamics", a, params=PARAMETERS))
    masses = {"m1": np.array([[1.0], [2.0]]), "m2": np.array([0.5, 1.0, 2.0])}
    many = model.base_parameters(params=masses)
    assert many.shape == (2, 3, len(one))
    same(many[1, 2], model.base_parameters(params={"m1": 2.0, "m2": 2.0}))
    out = np.empty_like(many)
    assert model.base_parameters(params=masses, out=out) is out
    assert np.array_equal(out, many)


def test_the_module_says_what_it_is(model: ModuleType) -> None:
    assert (model.DOF, model.JOINT_NAMES, model.JOINT_TYPES) == (2, ("q1", "q2"), ("revolute", "prismatic"))
    assert (list(model.LIMITS), model.PARAMETERS) == ([(-math.pi, 2.0), None], ("m1", "m2"))
    constants = {"DOF", "JOINT_NAMES", "JOINT_TYPES", "LIMITS", "OPERATIONS", "PARAMETERS", "precompute"}
    constants |= {"STANDARD_PARAMETERS", "BASE_PARAMETERS", "BASE_FORMULAS", "SIGNATURES"}
    assert set(model.OPERATIONS) == {*FUNCTIONS, *IDENTIFICATION} == set(model.__all__) - constants - {"UFUNCS"}
    assert all("Args:" in getattr(model, name).__doc__ for name in FUNCTIONS)
    assert model.STANDARD_PARAMETERS[:2] == ("m1", "mx1")
    regressor = call(model, "regressor", arguments(), params=PARAMETERS)
    assert regressor.shape == (2, len(model.STANDARD_PARAMETERS))


def test_lines_are_clean_and_numpy_and_the_standard_library_are_imported_alone() -> None:
    text = render_numpy(models.source_of(planar()))["model_numpy.py"]
    assert not set(text) & {"\t", "\r"}
    assert text.endswith("\n")
    assert not any(line != line.rstrip() for line in text.split("\n"))
    imports = [node for node in ast.parse(text).body if isinstance(node, ast.Import | ast.ImportFrom)]
    assert [alias.name for node in imports for alias in node.names] == ["math", "operator", "struct", "numpy"]


@pytest.mark.parametrize("scale", [1e-8, 1.0, 1e3, 1e6])
def test_sines_and_cosines_of_batches_are_exact_to_four_ulps(scale: float) -> None:
    turns = np.pi / 2 * np.random.default_rng(0).integers(-3, 4, 5000)
    q = np.random.default_rng(1).uniform(-scale, scale, 5000) + turns
    found = models.numpy_model(robot_of_rows("R")).forward_kinematics(q[:, None])
    assert np.abs(found[:, 0, 0] - np.cos(q)).max() < 4.5e-16
    assert np.abs(found[:, 1, 0] - np.sin(q)).max() < 4.5e-16
    small = np.abs(q) < 1e-3
    assert found[small, 1, 0] == pytest.approx(np.sin(q[small]), rel=1e-15)


def test_functions_of_parameters_alone_have_the_batch_of_the_parameters() -> None:
    graph = Graph()
    a, b = (Value(graph, graph.input(PARAMETER, i)) for i in range(2))
    tape = cut(graph, [value.ref for value in (a * b, a + b, a)])
    program = Program((Function(CONSTANT, (3,), tape, "by hand"),), ("a", "b"))
    model = models.numpy_model(planar(), program)
    assert model.gravity_vector({"a": 2.0, "b": 3.0}).tolist() == [6.0, 5.0, 2.0]
    table = model.gravity_vector(params={"a": np.full((4, 30), 2.0), "b": 3.0}, out=np.empty((4, 30, 3)))
    assert (table == [6.0, 5.0, 2.0]).all()
    two = model.gravity_vector(params={"a": np.array([2.0, 4.0]), "b": 3})
    assert two.tolist() == [[6.0, 5.0, 2.0], [12.0, 7.0, 4.0]]


def test_functions_of_nothing_are_constants() -> None:
    graph = Graph()
    tape = cut(graph, [graph.number(Fraction(k)) for k in (1, 2)])
    program = Program((Function(CONSTANT, (2,), tape, "by hand"),), ())
    assert models.numpy_model(planar(), program).gravity_vector().tolist() == [1.0, 2.0]
    assert models.casadi_model(planar(), program) is not None


@pytest.mark.sweep
def test_code_stays_compact() -> None:
    robot = robot_of_rows("|".join(["R a: 0.3, d: 0.1, alpha: pi/2"] * 64))
    text = render_numpy(models.source_of(robot))["model_numpy.py"]
    assert len(text) < 330_000
    assert models.load(text).forward_kinematics(np.zeros(64)).shape == (4, 4)


JACOBIANS = {"world": "jacobian", "end": "jacobian_end"}


@pytest.mark.parametrize("frame", JACOBIANS)
@pytest.mark.parametrize("batch", [(), (3,), (40,), (0,)])
def test_forward_dynamics_undoes_the_torques_of_a_wrench(model: ModuleType, frame: str, batch: tuple[int, ...]) -> None:
    a, loaded = arguments(*batch), {"wrench_frame": frame, "params": PARAMETERS}
    felt = np.einsum("...ij,...i->...j", getattr(model, JACOBIANS[frame])(a["q"]), a["h"])
    tau = model.inverse_dynamics(a["q"], a["qd"], a["qdd"], wrench=a["h"], **loaded)
    same(tau, model.inverse_dynamics(a["q"], a["qd"], a["qdd"], params=PARAMETERS) - felt)
    same(model.forward_dynamics(a["q"], a["qd"], tau, wrench=a["h"], **loaded), a["qdd"], 1e-10)
    out = np.empty((4, *batch, 2))
    several = model.inverse_dynamics(a["q"], a["qd"], a["qdd"], wrench=np.stack(4 * [a["h"]]), out=out, **loaded)
    assert several is out
    same(out, np.stack(4 * [tau]))


@pytest.mark.parametrize("frame", JACOBIANS)
def test_derivatives_are_at_a_constant_wrench(model: ModuleType, frame: str) -> None:
    a, step = arguments(), 1e-6
    loaded = {"wrench": 1e3 * a["h"], "wrench_frame": frame, "params": PARAMETERS}
    moves = step * np.stack([np.eye(2), -np.eye(2)])
    forth, back = model.inverse_dynamics(a["q"] + moves, a["qd"], a["qdd"], **loaded)
    found = model.inverse_dynamics_dq(a["q"], a["qd"], a["qdd"], **loaded)
    same(found, (forth - back).T / (2 * step), 1e-5)


@pytest.mark.parametrize("frame", JACOBIANS)
def test_a_file_may_ask_for_dynamics_that_take_the_wrench_as_an_argument(model: ModuleType, frame: str) -> None:
    a, suffix = arguments(3), "_end" * (frame == "end")
    for name, order in (("inverse_dynamics", ""), ("forward_dynamics", ""), ("inverse_dynamics", "_dq")):
        motion = (a["q"], a["qd"], a["tau" if name == "forward_dynamics" else "qdd"])
        found = getattr(model, f"{name}_wrench{suffix}{order}")(*motion, a["h"], params=PARAMETERS)
        plain = getattr(model, f"{name}{order}")
        same(found, plain(*motion, params=PARAMETERS, wrench=a["h"], wrench_frame=frame), 1e-10)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"wrench": np.ones(5)}, "wrench must have shape (6,) or (..., 6); got (5,)"),
        ({"wrench": np.ones((4, 6))}, "batch shapes do not broadcast: q (3,), qd (3,), qdd (3,), wrench (4,)"),
        ({"wrench": np.ones(6), "wrench_frame": "tool"}, "wrench_frame must be one of ('world', 'end'); got 'tool'"),
        ({"wrench": np.ones(6), "out": np.ones(2)}, "out must be a NumPy array of float64 of shape (3, 2)"),
    ],
)
def test_what_is_no_wrench_is_refused(model: ModuleType, options: dict[str, Any], message: str) -> None:
    a = arguments(3)
    with pytest.raises(ValueError, match=re.escape(f"inverse_dynamics: {message}")):
        model.inverse_dynamics(a["q"], a["qd"], a["qdd"], params=PARAMETERS, **options)


def test_jax_compiles_dynamics_under_a_wrench() -> None:
    found, a = numpy_model(planar()), arguments(3)

    def tau(h: Any) -> Any:
        return found.inverse_dynamics(a["q"], a["qd"], a["qdd"], params=PARAMETERS, wrench=h)

    with jax.enable_x64(True):
        same(jax.jit(tau)(jnp.asarray(a["h"])), tau(a["h"]))
