"""Random arms and links for motions."""

from collections.abc import Callable

import numpy as np

Random = np.random.Generator


def cells(values: object) -> str:
    """Numbers of six digits in a row."""
    return ", ".join(repr(round(float(value), 6)) for value in values)  # type: ignore[attr-defined]


def arm(random: Random, n: int, *, rough: bool) -> str:
    """The block of a robot with links of six points each, rotors, and friction."""
    joints, links = [], []
    for i in range(n):
        alpha, a = random.choice(["0", "pi/2", "-pi/2", "pi/3"]), 0.3 if i == 0 else random.choice([0, 0.25, 0.4])
        slides = random.random() < 0.25
        free = f"theta: {random.choice(['0', 'pi/2'])}" if slides else f"d: {random.choice([0, 0.15, 0.3])}"
        joints.append(f"{{type: {'prismatic' if slides else 'revolute'}, a: {a}, alpha: {alpha}, {free}}}")
        masses, places = random.uniform(0.2, 1, 6), random.normal(size=(6, 3)) * 0.15
        com = masses @ places / masses.sum()
        off = places - com
        inertia = sum(m * (r @ r * np.eye(3) - np.outer(r, r)) for m, r in zip(masses, off, strict=True))
        entries = {"xx": (0, 0), "yy": (1, 1), "zz": (2, 2), "xy": (0, 1), "xz": (0, 2), "yz": (1, 2)}
        moments = ", ".join(f"{name}: {cells([np.asarray(inertia)[at]])}" for name, at in entries.items())
        viscous, coulomb = (random.uniform(0, 2), random.uniform(0, 1.5)) if rough else (0, 0)
        friction = f"{{viscous: {cells([viscous])}, coulomb: {cells([coulomb])}}}"
        body = f"mass: {cells([masses.sum()])}, com: [{cells(com)}], inertia: {{{moments}}}"
        links.append(f"{{{body}, armature: {cells([random.uniform(0.01, 0.1)])}, friction: {friction}}}")
    gravity = random.choice(["[0, 0, -9.81]", "[0.5, -9.81, 1]"])
    kind = f"convention: {random.choice(['standard', 'modified'])}, gravity: {gravity}"
    return f"robot: {{name: arm, {kind},\n  joints: [{', '.join(joints)}],\n  links: [{', '.join(links)}]}}\n"


def points(random: Random, n: int, names: str) -> str:
    """Points of a plan, within a radian or a metre of zero."""
    return "points: {" + ", ".join(f"{name}: [{cells(random.uniform(-1, 1, n))}]" for name in names) + "}\n"


def simulated(random: Random) -> str:
    """A plan with some law, friction, load, push and plant."""

    def _perhaps(share: float, text: Callable[[], str]) -> str:
        return text() if random.random() < share else ""

    def _load() -> str:
        body = f"com: [0.05, 0, 0.1], inertia: [0.01, 0.02, 0.02], mass: {cells([random.uniform(0.1, 2)])}"
        return f", payload: {{{body}}}"

    n = int(random.integers(1, 5))
    profile = random.choice(["quintic", "cubic", "trapezoidal", "spline", "septic", "harmonic"])
    law = random.choice(["none", "pd", "pd-gravity", "computed-torque"])
    period = "" if law == "none" else _perhaps(0.3, lambda: f", period: {random.choice([0.005, 0.02, 0.013])}")
    gains = "" if law == "none" else ", kp: 100, kd: 20"
    push = f"[{{joint: q{random.integers(1, n + 1)}, torque: 3, start: 0.3, end: 0.8}}]"
    return (
        arm(random, n, rough=True)
        + points(random, n, "abc")
        + f"profile: {profile}\nfriction: {random.choice(['none', 'smooth', 'exact'])}\n"
        + f"path: [a, {{to: b, time: 1{_perhaps(0.5, _load)}}}, {{to: c, time: 1{_perhaps(0.5, _load)}}}]\n"
        + f"control: {{law: {law}{gains}{period}}}\n"
        + _perhaps(0.4, lambda: f"disturbance: {push}\n")
        + _perhaps(0.3, lambda: "base: {x: sin(2*t)/3, z: t**2/4, rpy: [t/2, 0.3, t**2/3]}\n")
        + _perhaps(0.4, lambda: f"plant: {{payload: {cells([random.uniform(0.1, 1)])}}}\n")
    )
