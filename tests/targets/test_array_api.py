"""Generated functions on arrays of other libraries: dtype kept, compiled, vectorised and differentiated."""

import random
from collections.abc import Iterator

import array_api_strict as strict
import jax
import jax.numpy as jnp
import numpy as np
import pytest

from derive.robot.robot import Robot
from tests.random_robots import random_robot
from tests.targets.generated_models import FUNCTIONS, PARAMETERS, arguments, call, numpy_model, planar

MODEL = numpy_model(planar())
EXACT = {"rtol": 1e-12, "atol": 1e-12}


@pytest.fixture(autouse=True)
def _double_precision() -> Iterator[None]:
    with jax.enable_x64(True):
        yield


@pytest.mark.first(12)
@pytest.mark.parametrize("library", [strict, jnp])
@pytest.mark.parametrize("name", FUNCTIONS)
@pytest.mark.parametrize("batch", [(), (2, 3)])
def test_other_arrays_give_what_numpy_gives(library: object, name: str, batch: tuple[int, ...]) -> None:
    given = arguments(*batch)
    wanted = call(MODEL, name, given, params=PARAMETERS)
    found = call(MODEL, name, {kind: library.asarray(value) for kind, value in given.items()}, params=PARAMETERS)
    assert found.__array_namespace__() is library
    assert (found.shape, found.dtype) == (wanted.shape, library.float64)
    np.testing.assert_allclose(np.asarray(found), wanted, **EXACT)


@pytest.mark.parametrize("library", [strict, jnp])
def test_empty_batches_stay_empty(library: object) -> None:
    assert MODEL.forward_kinematics(library.zeros((0, 3, 2))).shape == (0, 3, 4, 4)


@pytest.mark.parametrize("library", [strict, jnp])
def test_the_dtype_of_the_arguments_is_kept_and_integers_become_floats(library: object) -> None:
    half = library.asarray([0.1, 0.2], dtype=library.float32)
    assert MODEL.forward_kinematics(half).dtype == library.float32
    assert MODEL.gravity_vector(half, params=PARAMETERS).dtype == library.float32
    assert MODEL.coriolis_matrix(half, [1.0, 2.0], params=PARAMETERS).dtype == library.float32
    assert MODEL.coriolis_matrix(half, np.ones(2), params=PARAMETERS).dtype == library.float32
    assert MODEL.coriolis_matrix(half, library.ones(2), params=PARAMETERS).dtype == library.float64
    assert MODEL.forward_kinematics(library.asarray([1, 2])).dtype == library.float64


def test_python_numbers_among_compiled_arguments_do_not_widen_single_precision() -> None:
    half = jnp.asarray([0.1, 0.2], dtype=jnp.float32)
    gravity = jax.jit(lambda q, params: MODEL.gravity_vector(q, params=params))
    assert gravity(half, PARAMETERS).dtype == jnp.float32


@pytest.mark.parametrize("library", [strict, jnp])
def test_arrays_of_parameters_broadcast_against_the_batch(library: object) -> None:
    q, masses = arguments(3)["q"], np.array([1.0, 2.0, 3.0])
    wanted = MODEL.gravity_vector(q, params={"m1": masses, "m2": 1.5})
    q, masses = library.asarray(q), library.asarray(masses)
    for params in ({"m1": masses, "m2": 1.5}, {"m1": masses, "m2": library.asarray(1.5)}):
        np.testing.assert_allclose(np.asarray(MODEL.gravity_vector(q, params=params)), wanted, **EXACT)
    table = library.stack([masses, 0 * masses + 1.5], axis=-1)
    np.testing.assert_allclose(np.asarray(MODEL.gravity_vector(q, params=table)), wanted, **EXACT)
    alone = MODEL.gravity_vector(np.asarray(q), params={"m1": masses, "m2": 1.5})
    assert alone.__array_namespace__() is library
    assert MODEL.forward_kinematics([0.1, 0.2], params={"m1": masses}).shape == (3, 4, 4)


def test_arguments_broadcast_against_each_other() -> None:
    given = arguments(4, 3)
    q, qd, qdd = given["q"][0, 0], given["qd"][:, :1], given["qdd"][0]
    found = MODEL.inverse_dynamics(jnp.asarray(q), jnp.asarray(qd), qdd, params=PARAMETERS)
    np.testing.assert_allclose(found, MODEL.inverse_dynamics(q, qd, qdd, params=PARAMETERS), **EXACT)


@pytest.mark.first(1)
@pytest.mark.parametrize("seed", range(2))
def test_jax_compiles_vectorises_and_differentiates(seed: int) -> None:
    robot = random_robot(random.Random(seed + 40), 2 + seed)
    model, params = numpy_model(Robot.from_text(robot.text)), robot.values
    given = arguments(5, joints=robot.n)
    q, qd, qdd = given["q"], given["qd"], given["qdd"]

    def tau(q: object, qd: object, qdd: object) -> object:
        return model.inverse_dynamics(q, qd, qdd, params=params)

    wanted = tau(q, qd, qdd)
    np.testing.assert_allclose(jax.jit(tau)(q, qd, qdd), wanted, rtol=1e-11, atol=1e-11)
    np.testing.assert_allclose(jax.jit(jax.vmap(tau))(q, qd, qdd), wanted, rtol=1e-11, atol=1e-11)
    inertia = jax.jacfwd(tau, argnums=2)(*map(jnp.asarray, (q[0], qd[0], qdd[0])))
    np.testing.assert_allclose(inertia, model.inertia_matrix(q[0], params=params), rtol=1e-11, atol=1e-11)


def test_gradients_reach_arguments_and_parameters() -> None:
    q, step = jnp.asarray([0.3, 0.4]), 1e-6

    def total(q: object, masses: dict[str, object]) -> object:
        return MODEL.gravity_vector(q, params=masses).sum()

    slope, by_mass = jax.jit(jax.grad(total, argnums=(0, 1)))(q, PARAMETERS)
    ends = [(total(q.at[i].add(step), PARAMETERS), total(q.at[i].add(-step), PARAMETERS)) for i in (0, 1)]
    differences = [(after - before) / step for after, before in ends]
    np.testing.assert_allclose(slope, np.array(differences) / 2, atol=1e-8)
    heavier = total(np.asarray(q), {**PARAMETERS, "m1": 3.0}) - total(np.asarray(q), PARAMETERS)
    assert by_mass["m1"] == pytest.approx(heavier, rel=1e-9)


def test_single_precision_is_compiled_in_single_precision_and_integers_become_it_where_that_is_usual() -> None:
    with jax.enable_x64(False):
        assert MODEL.forward_kinematics(jnp.asarray([1, 2])).dtype == jnp.float32
        q = jnp.asarray([0.3, 0.4], dtype=jnp.float32)
        found = jax.jit(lambda q: MODEL.inertia_matrix(q, params=PARAMETERS))(q)
        assert found.dtype == jnp.float32
        np.testing.assert_allclose(found, MODEL.inertia_matrix(np.asarray(q), params=PARAMETERS), rtol=1e-5)


def test_precomputed_parameters_serve_all_libraries() -> None:
    prepared, q = MODEL.precompute(PARAMETERS), arguments(3)["q"]
    wanted = MODEL.inertia_matrix(q, params=PARAMETERS)
    for library in (strict, jnp):
        found = MODEL.inertia_matrix(library.asarray(q), params=prepared)
        np.testing.assert_allclose(np.asarray(found), wanted, **EXACT)


def test_torch_tensors_stay_tensors_and_carry_gradients() -> None:
    torch = pytest.importorskip("torch")
    given = arguments(3)
    q = torch.tensor(given["q"], requires_grad=True)
    found = MODEL.inverse_dynamics(q, given["qd"], torch.tensor(given["qdd"]), params=PARAMETERS)
    wanted = MODEL.inverse_dynamics(given["q"], given["qd"], given["qdd"], params=PARAMETERS)
    np.testing.assert_allclose(found.detach().numpy(), wanted, **EXACT)
    found.sum().backward()
    assert q.grad.shape == (3, 2)
    assert MODEL.forward_kinematics(torch.ones(2, dtype=torch.float32)).dtype == torch.float32


@pytest.mark.parametrize("library", [strict, jnp])
def test_what_does_not_fit_is_refused_as_for_numpy(library: object) -> None:
    with pytest.raises(ValueError, match=r"q must have shape \(2,\) or \(\.\.\., 2\); got \(3,\)"):
        MODEL.forward_kinematics(library.zeros(3))
    with pytest.raises(ValueError, match=r"do not broadcast: q \(3,\), qd \(4,\)"):
        MODEL.coriolis_matrix(library.zeros((3, 2)), np.zeros((4, 2)), params=PARAMETERS)
    with pytest.raises(TypeError, match=r"must be real numbers; got dtype .*complex128"):
        MODEL.forward_kinematics(library.zeros(2, dtype=library.complex128))
    with pytest.raises(ValueError, match="out is for NumPy's arrays"):
        MODEL.forward_kinematics(library.zeros(2), out=np.empty((4, 4)))
    with pytest.raises(ValueError, match="missing in params: m2"):
        MODEL.gravity_vector(library.zeros(2), params={"m1": library.asarray(1.0)})
    with pytest.raises(TypeError, match=r"arrays of one library.*got array_api_strict, jax\.numpy"):
        MODEL.coriolis_matrix(strict.zeros(2), jnp.zeros(2), params=PARAMETERS)
