"""Writes docs/errata.md from the lecture corpus: ``python -m tests.docs.errata``."""

from collections.abc import Iterator
from itertools import permutations

import numpy as np
from sympy import Expr, Rational, pi, sqrt, sstr

from derive.checking.files import file_printout
from derive.checking.report import Printout, errata_report
from derive.motion.motion import Motion
from derive.robot.evaluate import evaluate
from derive.robot.robot import Robot
from derive.verification.oracle.functions import Oracle
from tests.lectures.results import CORPUS
from tests.places import ROOT

PAGE = ROOT / "docs" / "errata.md"
TITLES = {
    "000": "Document 000: lecture notes on robot kinematics and mechatronics (C. Laschi)",
    "001": "Document 001: lecture slides 'Cinematica degli scheletri' (N. A. Borghese)",
    "002": "Document 002: lecture slides 'Cinemática Direta' (USP)",
    "003": "Document 003: lecture slides on direct kinematics (A. De Luca)",
    "004": "Document 004: report on the SCARA manipulator (University of Perugia)",
}
HEAD = (
    "This page lists the errors that `derive check` finds in five lecture documents; the command itself wrote it "
    "(`make errata`). Formulas are in the shorthand of the notes: `c12` is the cosine of the sum of the first two "
    "joint angles, `**` a power. In the Newton-Euler equations `w`, `wd`, `v`, `vd` are velocities and accelerations, "
    "`@` is a matrix product. The last section is about motions; its items are commands and numbers."
)


def printouts() -> list[Printout]:
    return [file_printout(path) for path in sorted(CORPUS.glob("*.yaml"))]


def page() -> str:
    found = printouts()
    documents = {finding.remark.document.title for p in found for finding in p.report.findings}
    documents |= {p.report.document.title for p in found}
    report = errata_report(found, {name: TITLES[name[:3]] for name in documents if name}, HEAD)
    return "\n".join([report, *section()]).rstrip() + "\n"


# -- what is wrong in the simulation of document 004: commands and numbers, computed from the motion that it describes


TITLE = "## Motions of document 004"

SIMULATION = "Risultati della simulazione (pick and place), figures 15-19; appendix: Il codice MATLAB per lo SCARA"

APPENDIX = "appendix: Il codice MATLAB per lo SCARA"


def section() -> list[str]:
    motion = Motion.load("scara-pick-and-place")
    items = (
        *_unscaled(motion),
        *_without_time(),
        *_impossible(motion.plan.robot),
        *_unassigned(motion.plan.robot),
        *_singular(motion),
    )
    head = (
        "The plan `scara-pick-and-place` (`derive move scara-pick-and-place`) shows errors of the report's simulation: "
        "quintic `jtraj`, 3 s for each of five segments, sampled every Tc = 0.01 s."
    )
    return [TITLE, "", head, "", *items]


def _item(name: str, *told: str) -> list[str]:
    words = ("place", "printed", "right", "numbers", "why")
    return [f"### {name}", "", *(f"- {word}: {text}" for word, text in zip(words, told, strict=True)), ""]


def _unscaled(motion: Motion) -> Iterator[str]:
    """Differences of samples, taken for derivatives."""
    found = []
    for segment, joint, unit in ((0, 0, "rad"), (1, 2, "m")):
        start = float(motion.trajectory.segments[segment].start)
        q = motion(start + np.arange(301) / 100)[0][:, joint]
        first = np.diff(q)
        peaks = motion.peaks[segment]
        speed, acceleration = peaks.speeds[joint].value, peaks.accelerations[joint].value
        found.append(
            f"joint {joint + 1}: drawn {first.max():.6g} and {np.diff(first).max():.6g}, "
            f"right {_exact(speed)} {unit}/s and {_exact(acceleration)} {unit}/s^2"
        )
    yield from _item(
        "`diff(q)` and `diff(diff(q))`",
        SIMULATION,
        "differences of samples, drawn as velocities and accelerations",
        "`diff(q)/Tc` and `diff(diff(q))/Tc^2`",
        "; ".join(found),
        "a difference of two samples is Tc times a velocity, a second difference Tc^2 times an acceleration: the axes "
        "of the panels are too small by factors 100 and 10,000, apart from the error of the difference itself.",
    )


def _exact(value: Expr) -> str:
    return f"{sstr(value)} = {float(value):.6g}"


def _without_time() -> Iterator[str]:
    """What jtraj gives for a number of samples instead of their times."""
    speed, acceleration = Rational(15, 8) * pi / 2, 10 / sqrt(3) * pi / 2
    yield from _item(
        "`jtraj(q0, q1, length(t1))`",
        APPENDIX,
        "a number of samples, 301, as the third argument",
        "the vector of times, `jtraj(q0, q1, t1)`",
        f"a move of pi/2: peaks {_exact(speed)} and {_exact(acceleration)}, right {_exact(speed / 3)} rad/s and "
        f"{_exact(acceleration / 9)} rad/s^2",
        "the polynomial s(u) = 10 u^3 - 15 u^4 + 6 u^5 has its largest slope 15/8 at u = 1/2 and its largest curvature "
        "10/sqrt(3) at u = (3 - sqrt(3))/6; with a number of samples u is time itself, so that the 3 s are never used: "
        "positions are right, and the velocities and accelerations that jtraj returns are 3 and 9 times too large.",
    )


def _impossible(robot: Robot) -> Iterator[str]:
    """Inertias that no body has."""
    for index, link in enumerate(robot.links, start=1):
        moments = [evaluate(moment, {}) for moment in (link.inertia.xx, link.inertia.yy, link.inertia.zz)]
        for a, b, c in permutations(range(3)):
            if a < b and moments[a] + moments[b] < moments[c]:
                axes = "xyz"
                printed = ", ".join(f"{moment:g}" for moment in moments)
                yield from _item(
                    f"`L{{{index}}}.I`",
                    APPENDIX,
                    f"moments of inertia {printed} kg m^2 about {', '.join(axes)}",
                    f"I{axes[c]}{axes[c]} at most {moments[a] + moments[b]:g}, or larger others; the report does not "
                    "say which",
                    f"I{axes[a]}{axes[a]} + I{axes[b]}{axes[b]} - I{axes[c]}{axes[c]} = "
                    f"{moments[a] + moments[b] - moments[c]:g} kg m^2",
                    "Ixx + Iyy - Izz is twice the integral of z^2 over the mass, about any point, and so for every "
                    f"order of the axes: never negative. The inertia of link {index} is physically inconsistent.",
                )


def _unassigned(robot: Robot) -> Iterator[str]:
    """Numbers that the script gives to other variables than it uses."""
    masses = ", ".join(f"{evaluate(link.mass, {}):g}" for link in robot.links)
    yield from _item(
        "`L{1}.m`, ..., `L{4}.B` and `fkine(SCARA,q)`",
        APPENDIX,
        f"masses {masses} kg and all other dynamic data to `L{{1}}` to `L{{4}}`; `PosPinza0 = fkine(SCARA,q)`",
        "`L1.m`, ..., of the links that `robot({L1,L2,L3,L4})` is made of; `fkine(SCARA,qRiposo)`",
        f"the robot of the script weighs 0 kg, right {sum(evaluate(link.mass, {}) for link in robot.links):g} kg",
        "the links are created as L1 to L4, and L{1} to L{4} are cells of another variable, so no dynamic parameter "
        "reaches the robot; q is still the symbolic vector there, so the gripper position is a formula. "
        "Neither changes figures 15 to 19, which show only joint variables.",
    )


def _singular(motion: Motion) -> Iterator[str]:
    """Via points at which the Jacobian loses rank."""
    oracle = Oracle.of(motion.plan.robot)
    ranks = {}
    for name, point in motion.plan.points.items():
        q = np.array([evaluate(cell, {}) for cell in point.q or ()])
        ranks[name] = int(np.linalg.matrix_rank(oracle.evaluate("jacobian", q)[[0, 1, 2, 5]], tol=1e-9))
    path = [motion.plan.start, *(step.to for step in motion.plan.steps)]
    singular = [name for name in path if ranks[name] < 4]
    yield from _item(
        "points " + ", ".join(f"`{name}`" for name in singular),
        SIMULATION,
        "via points with theta2 = 0, among them the one where the piece is placed",
        "any theta2 except 0 and pi",
        "rank of J: " + ", ".join(f"{name} {rank}" for name, rank in ranks.items()),
        f"det J is a multiple of sin(theta2), which the report itself names as the only singularity (Singolarità "
        f"cinematiche dello SCARA): {len(singular)} of the {len(path)} points of its path are singular. Motions by "
        "joint angles pass there; straight lines and inverse Jacobians do not.",
    )


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
