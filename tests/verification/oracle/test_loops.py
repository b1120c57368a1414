"""The oracle of closed loops against Pinocchio, which knows the open tree and what joins its frames."""

import random
from dataclasses import replace
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

from derive.errors import VerificationError
from derive.exchange.formats import exported
from derive.robot.description import BASE, Joining
from derive.robot.expression import number
from derive.robot.robot import Robot
from derive.verification.oracle.frames import numeric_arm
from derive.verification.oracle.functions import Following
from derive.verification.samples import sample_sets
from derive.verification.tolerance import expectation
from tests.random_robots import _yaml, seeds
from tests.verification.oracle.pinocchio_reference import Array
from tests.verification.oracle.test_physics import relative_error

# Rows by name: the row before, the type, * of passive ones, theta, and a and alpha in the standard convention, a pair
# of lengths for one between them. Then what joins which frames.
TURN, LONG = "revolute*", (1.0, 1.5)
CRANK: dict[str, Any] = {"crank": (BASE, "revolute", 1, (0.3, 0.6), 0), "rod": ("crank", TURN, 2, LONG, 0)}
GROUND: dict[str, Any] = {"ground": (BASE, "fixed", 0.3, (0.9, 1.4), 0)}
ROCKER, LEVER = GROUND | {"rocker": ("ground", TURN, 0, LONG, 0)}, {"lever": (BASE, TURN, 0, LONG, 0)}
RAIL = {"rail": (BASE, "fixed", 0.4, 0.2, "pi/2"), "slide": ("rail", "prismatic*", 0, 0, 0)}
YOKE = {"crank": (BASE, "revolute", 0, 0.4, "pi/2"), "yoke": ("crank", TURN, 0, 0, "pi/2")}
PIN = ("rod", "rocker", "revolute")
SKEW = {"crank": (BASE, "revolute", 1, (0.3, 0.6), 0.4), "ground": (BASE, "fixed", 0.3, (0.9, 1.4), 0.7)}
HORN = {"rocker": ("ground", TURN, 0.2, LONG, 0.5), "horn": ("rocker", "fixed", 0.4, 0.2, 0.3)}
# A four-bar linkage on a lever, which another rod moves by the rocker of that.
CAM = {
    "cam": ("lever", "revolute", 0, 0.15, 0.2),
    "plate": ("lever", "fixed", 0.5, 0.4, 0.3),
    "dog": ("plate", TURN, 1, 0.6, 0),
}
MECHANISMS: dict[str, Any] = {
    "rssr": (SKEW | HORN, ("crank", "horn", "distance", 1.3)),
    "rssp": (SKEW | {"slide": ("ground", "prismatic*", 0, 0.1, 0)}, ("slide", "crank", "distance", 2)),
    "rods": (
        {"crank": (BASE, "revolute", 1, 0.4, 0.4), "lever": (BASE, TURN, 0, 0.5, 0.2)} | CAM,
        ("dog", "cam", "distance", 0.7),
        ("dog", "crank", "distance", 1.1),
    ),
    "four-bar": (CRANK | ROCKER, PIN),
    "five-bar": (
        CRANK | GROUND | {"right": ("ground", "revolute", 0, 0.4, 0), "rocker": ("right", TURN, 0, 1.6, 0)},
        PIN,
    ),
    "six-bar": (CRANK | {"link": ("rod", TURN, 0, LONG, 0)} | ROCKER | LEVER, PIN, ("link", "lever", "revolute")),
    "slider-crank": (CRANK | RAIL | {"rocker": ("slide", "fixed", 0, 0, "-pi/2")}, PIN),
    "weld": (CRANK | {"pin": ("rod", TURN, 0, 0, 0)} | ROCKER, ("pin", "rocker", "fixed")),
    "ball": (
        YOKE | {"rod": ("yoke", TURN, 0, 1.3, 0), "ground": (BASE, "fixed", 0.3, 1.1, "pi/2")} | ROCKER,
        ("rod", "rocker", "spherical"),
    ),
    "shaper": (
        CRANK | {"rod": ("crank", TURN, 0, 0, "pi/2")} | GROUND | {"rocker": ("ground", TURN, 0, 0.1, "pi/2")},
        ("rod", "rocker", "prismatic"),
    ),
}
# Solved numerically: a plate between a rod and two rockers, a platform on three rods, and a ring of skew axes.
HIPS = {f"hip{k}": (BASE, "fixed", 2.1 * k, 0.3, "pi/2") for k in range(3)}
ARMS = {f"arm{k}": (f"hip{k}", "revolute", 0, (0.4, 0.6), 0) for k in range(3)}
SKEWS = (0.9, -0.7, 1.2, -1.1, 0.8, 0.4)
ITERATED: dict[str, Any] = {
    "plate": (
        CRANK
        | {"plate": ("rod", TURN, 0, (0.5, 0.7), 0), "corner": ("plate", "fixed", 2, 0.4, 0)}
        | {"ground": (BASE, "fixed", 0.3, (0.8, 1.1), 0), "left": ("ground", TURN, 0, LONG, 0)}
        | {"post": (BASE, "fixed", 1.2, (0.8, 1.1), 0), "right": ("post", TURN, 0, LONG, 0)},
        ("plate", "left", "revolute"),
        ("corner", "right", "revolute"),
    ),
    "rods-3": (
        {"east": (BASE, "prismatic*", 0, 0, "pi/2"), "north": ("east", "prismatic*", "pi/2", 0, "pi/2")}
        | {"up": ("north", "prismatic*", 0, 0, 0), **{f"knob{k}": ("up", "fixed", 2.1 * k, 0.1, 0) for k in range(3)}}
        | HIPS
        | ARMS,
        *((f"arm{k}", f"knob{k}", "distance", 1.2) for k in range(3)),
    ),
    "ring": (
        {"crank": (BASE, "revolute", 1, (0.2, 0.3), 0.5)}
        | {f"link{k}": (f"link{k - 1}" if k else "crank", TURN, k, (0.8, 1.0), skew) for k, skew in enumerate(SKEWS)}
        | {"lever": (BASE, "revolute", 0.3, 0.4, 0.9)},
        ("link5", "lever", "fixed"),
    ),
}
HELD = {Joining.REVOLUTE: [0, 1, 2, 3, 4], Joining.PRISMATIC: [0, 1, 3, 4, 5], Joining.SPHERICAL: [0, 1, 2]}


def mechanism(name: str, seed: int) -> Robot:
    """One with random numbers, in either convention and branch."""
    rng, (rows, *joins) = random.Random(seed), (MECHANISMS | ITERATED)[name]
    standard = rng.random() < 0.5

    def drawn(low: float, high: float) -> float:
        return round(rng.uniform(low, high), 3)

    cells = {k: (drawn(*row[3]) if isinstance(row[3], tuple) else row[3], row[4]) for k, row in rows.items()}
    # In the modified convention a and alpha are those of the row before, and what is joined stands on rows of its own.
    tips = {f"{k}-tip": (k, "fixed", 0) for join in joins for k in join[:2] if not standard}
    texts, links = [], []
    for at, (label, (after, kind, theta, *_)) in enumerate((rows | tips).items()):
        a, alpha = cells.get(label if standard else after, (0, 0))
        sign, moving = rng.choice(["-", ""]), {"r": "theta", "p": "d"}.get(kind[0], "")
        text = {"type": kind.rstrip("*"), "name": label, "after": after, "theta": theta, "a": a, "alpha": alpha}
        moved = {"q": f"x{at}", moving: f"{sign}x{at} + {drawn(0, 2)}"} if moving else {}
        texts.append(text | moved | ({"passive": True} if kind.endswith("*") else {}))
        body = {"xx": 0.4, "yy": 0.5, "zz": drawn(0.5, 0.8), "xy": 0.1, "yz": 0.05}
        links.append({"mass": drawn(1, 3), "com": [drawn(-0.5, 0.5) for _ in range(3)], "inertia": body})
        if moving:
            friction = {"viscous": drawn(0, 0.5), "coulomb": drawn(0, 0.5)}
            links[-1] |= {"armature": drawn(0, 0.5), "friction": friction}
    loops, ends = [], dict[str, Any]()
    for one, other, by, *length in joins:
        own = (rng.choice("+-") + "+") * (by == "spherical")  # whose own angles are the last choice
        branch = rng.choice("+-") + own if name in MECHANISMS else ""
        pair = [k if standard else f"{k}-tip" for k in (one, other)]
        loops.append({"join": pair, "by": by, "branch": branch} | ({"length": length[0]} if length else {}))
        ends |= {f"{side}{len(loops) - 1}": {"after": k} for side, k in zip("ab", pair, strict=True)}
    block = {"name": name, "convention": "standard" if standard else "modified", "joints": texts, "links": links}
    return Robot.from_text(_yaml(block | {"ends": ends, "loops": loops, "gravity": [1.5, -9, 2]}))


class Outside:
    """A mechanism, and its open tree in Pinocchio."""

    def __init__(self, name: str, seed: int) -> None:
        self.robot = robot = mechanism(name, seed)
        self.samples = sample_sets(robot, 5, np.random.default_rng(seed))[0]
        self.oracle, self.q = self.samples.oracle, self.samples.arguments["q"]
        joints = tuple(replace(joint, follows=(), limits=(number(-9), number(9))) for joint in robot.joints)
        tree = replace(robot, loops=(), coupled=(), joints=joints)
        self.model, self.arm = pin.buildModelFromXML(exported(tree, "urdf", "given").text), numeric_arm(tree)
        self.model.armature, self.model.gravity.linear = self.arm.armature, self.arm.gravity
        self.data = self.model.createData()
        names = ([f"{side}{k}" for side in "ab"] for k in range(len(robot.loops)))
        self.joined = [[self.model.frames[self.model.getFrameId(name)] for name in pair] for pair in names]

    def gap(self, x: Array) -> Array:
        """What is between the joined frames and has to vanish."""
        pin.forwardKinematics(self.model, self.data, x)
        places = [[self.data.oMi[f.parentJoint] * f.placement for f in pair] for pair in self.joined]
        if Joining.DISTANCE in (loop.by for loop in self.robot.loops):
            ways = (a.translation - b.translation for a, b in places)
            return np.array([np.linalg.norm(way) for way in ways]) - [loop[1] for loop in self.oracle.arm.loops]
        between = zip(self.robot.loops, places, strict=True)
        return np.hstack([pin.log6(b.actInv(a)).vector[HELD.get(loop.by, range(6))] for loop, (a, b) in between])

    def friction(self, xd: Array) -> Array:
        return np.array(self.arm.viscous * xd + self.arm.coulomb[0] * np.sign(xd))

    def accelerations(self, x: Array, xd: Array, tau: Array) -> Array:
        """Of all joints, held together by Pinocchio's constraints, of which some are dependent."""
        held, six = pin.StdVec_RigidConstraintModel(), pin.ContactType.CONTACT_6D
        for loop, (a, b) in zip(self.robot.loops, self.joined, strict=True):
            ends = (a.parentJoint, a.placement, b.parentJoint, b.placement)
            kind = six if loop.by is Joining.FIXED else pin.ContactType.CONTACT_3D
            held.append(pin.RigidConstraintModel(kind, self.model, *ends, pin.LOCAL))
        data = pin.StdVec_RigidConstraintData([each.createData() for each in held])
        pin.initConstraintDynamics(self.model, self.data, held, data)
        torques = -self.friction(xd)
        torques[[not joint.follows for joint in self.robot.joints]] += tau
        settings = pin.ProximalSettings(1e-14, 1e-14, 1e-8, 50)
        found = pin.constraintDynamics(self.model, self.data, x, xd, torques, held, data, settings)
        return np.array(found)


@pytest.mark.parametrize("seed", seeds(40, 2, 20))
@pytest.mark.parametrize("name", [*MECHANISMS, *ITERATED])
@pytest.mark.first(3)
def test_all_joints_accelerate_as_under_pinocchios_constraints(name: str, seed: int) -> None:
    """Joined frames stay so to second order, and what holds them does no work, also where Pinocchio has no joint."""
    outside, step = Outside(name, seed), 1e-4
    qd, tau = (outside.samples.arguments[k] for k in ("qd", "tau"))
    tau = tau + np.random.default_rng(seed).uniform(-5, 5, tau.shape)
    qdd = outside.oracle.evaluate("forward_dynamics", outside.q, qd, tau)
    following = outside.oracle.following(outside.q)
    states = following.arguments(("q", "qd", "qdd"), (outside.q, qd, qdd))
    for x, xd, xdd, w, t in zip(*states, following.slope, tau, strict=True):
        before, now, after = (outside.gap(x + h * xd + h * h / 2 * xdd) for h in (-step, 0.0, step))
        assert np.abs(now).max() < 1e-13
        assert np.abs(after - before).max() / (2 * step) < 1e-5 * (1 + np.abs(xd).max() ** 3)
        assert np.abs(after + before).max() / step**2 < 1e-5 * (1 + np.abs(xd).max() ** 4)
        assert (
            relative_error(w.T @ (pin.rnea(outside.model, outside.data, x, xd, xdd) + outside.friction(xd)), t) < 1e-9
        )
        if name not in ("shaper", "rssr", "rssp", "rods", "rods-3"):
            assert relative_error(xdd, outside.accelerations(x, xd, t)) < 1e-8


@pytest.mark.first(3)
@pytest.mark.parametrize("seed", seeds(40, 1, 20))
@pytest.mark.parametrize("name", MECHANISMS)
def test_functions_are_derivatives_of_poses_and_energies(name: str, seed: int) -> None:
    outside, step = Outside(name, seed), 1e-5
    oracle, q, (qd, h) = outside.oracle, outside.q, (outside.samples.arguments[k] for k in ("qd", "h"))

    def of(name: str, *rest: Array) -> Any:
        return lambda q: oracle.evaluate(name, q, *rest)

    def along(function: Any, way: Array) -> Array:
        return np.array((function(q + step * way) - function(q - step * way)) / (2 * step))

    states = zip(oracle.following(q).x, along(lambda q: oracle.following(q).x, qd), strict=True)
    twice = np.array([rates @ pin.crba(outside.model, outside.data, x) @ rates for x, rates in states])
    b, c, j = of("inertia_matrix")(q), of("coriolis_matrix", qd)(q), of("jacobian_a0")(q)
    assert relative_error(np.einsum("ki,kij,kj->k", qd, b, qd), twice) < 1e-7
    assert relative_error(of("kinetic_energy", qd)(q), twice / 2) < 1e-7
    assert relative_error(along(of("inertia_matrix"), qd), c + np.swapaxes(c, -1, -2)) < 1e-6
    assert relative_error(of("coriolis_vector", qd)(q), np.einsum("kij,kj->ki", c, qd)) < 1e-12
    assert relative_error(of("jacobian_dot_a0", qd)(q), along(of("jacobian_a0"), qd)) < 1e-6
    assert relative_error(of("wrench_torques_a0", h)(q), np.einsum("kij,ki->kj", j, h)) < 1e-12
    for k, unit in enumerate(np.eye(outside.robot.dof)):
        assert relative_error(of("gravity_vector")(q)[:, k], along(of("potential_energy"), unit)) < 1e-7
        assert relative_error(j[:, :3, k], along(of("forward_kinematics_a0"), unit)[:, :3, 3]) < 1e-7


def test_a_wrong_closed_form_is_an_error_and_an_open_loop_has_no_value() -> None:
    samples = Outside("four-bar", 0).samples
    oracle, q = samples.oracle, samples.arguments["q"]
    guess = oracle.guess
    assert guess is not None
    assert {"regressor", "jacobian_hessian_a0"}.isdisjoint(oracle.functions)
    value = oracle.evaluate("passive_positions", q)
    turned = replace(oracle, guess=lambda q: guess(q) + 2 * np.pi)
    assert relative_error(turned.evaluate("passive_positions", q), value) < 1e-14
    assert (expectation("passive_positions", samples, (q,)).errors(value + np.array([2 * np.pi, 0])) < 1e-14).all()
    with pytest.raises(VerificationError, match=r"closed form of loops: 0\.001 "):
        replace(oracle, guess=lambda q: guess(q) + 1e-3).evaluate("inertia_matrix", q)
    assert np.isnan(replace(oracle, guess=lambda q: guess(q) * np.nan).evaluate("coriolis_matrix", q, q)).all()


def test_slopes_keep_the_joined_frames_together() -> None:
    outside, step = Outside("four-bar", 1), 1e-5
    oracle, q = outside.oracle, outside.q
    ahead, here, back = (Following.of(oracle.arm, q + k * step, oracle.guess) for k in (1, 0, -1))
    assert np.nanmax(np.abs((ahead.x - back.x) / (2 * step) - here.rates(np.ones_like(q)))) < 1e-6
