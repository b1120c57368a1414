r"""A sheet of the five-bar linkage, and what its famous condition is worth: motors that do not feel each other.

Spong, Hutchinson and Vidyasagar (Robot Modeling and Control, 2006, chapter 7) choose the masses of a parallelogram
linkage so that m3 l2 lc3 = m4 l1 lc4. Its inertia matrix is then diagonal and constant, and each motor has the equation
of a pendulum of its own.

    python examples/five_bar.py > five-bar.tex

prints B, C, g and the condition that derive finds, and how far motor 1 pushes link 2 with and without it.
"""

from __future__ import annotations

import sys

import numpy as np
import sympy

from derive import Model, load

SHEET = r"""\documentclass{article}
\usepackage{amsmath}
\begin{document}
%s
\end{document}
"""


def share(model: Model, lc4: float) -> float:
    """The acceleration of q2 per unit of that of q1 when motor 1 alone pushes, where it is largest."""
    numbers = dict.fromkeys(("l1", "l2", "m1", "m2", "m3", "m4", "I1", "I2", "I3", "I4"), 1.0)
    numbers |= {"lc1": 0.5, "lc2": 0.5, "lc3": 0.5, "lc4": lc4}
    inertia = np.array(model.at("B", [0.3, 0.3], values=numbers).tolist(), dtype=float)
    qdd = np.linalg.solve(inertia, [1.0, 0.0])
    return float(abs(qdd[1] / qdd[0]))


def main() -> int:
    """Print the sheet; the status says whether the condition decouples."""
    model = Model(load("five-bar"))
    lines = [
        rf"\[ {letter} = {sympy.latex(getattr(model, name))} \]"
        for name, letter in (("B", "B(q)"), ("C", r"C(q, \dot q)"), ("g", "g(q)"))
    ]
    (((left, right),),) = model.decoupling.conditions
    lines += [rf"$B$ is diagonal where \[ {sympy.latex(left)} = {sympy.latex(right)}. \]"]
    for lc4 in (0.8, 0.5):
        lines += [
            rf"With $l_{{c4}} = {lc4}$ motor 1 moves link 2 by {share(model, lc4):.1%} of link 1. ".replace("%", r"\%")
        ]
    print(SHEET % "\n".join(lines))
    return int(share(model, 0.5) > 1e-12)


if __name__ == "__main__":
    sys.exit(main())
