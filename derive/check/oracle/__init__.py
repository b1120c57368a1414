"""The independent recursion: every generated function once more, in plain NumPy floats, from the definitions.

It shares no code with `derive.mechanics` or `derive.algebra`: frames are products of elementary matrices, B comes from
Jacobians, C from Christoffel symbols of B differentiated by complex step, tau from Newton's and Euler's laws,
derivatives from complex steps.
"""

from __future__ import annotations

from derive.check.oracle.arm import Arm, numeric_arm
from derive.check.oracle.oracle import ANGLES, FUNCTIONS, Definition, Oracle

__all__ = ["ANGLES", "FUNCTIONS", "Arm", "Definition", "Oracle", "numeric_arm"]
