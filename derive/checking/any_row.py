r"""The transform of any row of the table, with letters: ``A_i = [...]`` by theta_i, d_i, a_i and alpha_i."""

import re
from collections.abc import Iterator, Sequence
from contextlib import suppress
from fractions import Fraction
from itertools import permutations
from math import cos, sin

import numpy as np

from derive.arrays import Array
from derive.checking.formulas.edits import NO_VALUE, float_value
from derive.checking.latex.matrices import Table
from derive.checking.latex.meanings import ALIKE
from derive.inverse.numeric.chain import NumericChain
from derive.robot.description import Convention, Joint, JointType
from derive.robot.expression import ZERO, is_constant, number
from derive.robot.robot import Robot

# theta_i, alpha_{i-1} and the name c_{\theta_i} of a cosine; any other letter is a length, such as a_i, r_n and d.
_LETTER = re.compile(
    r"(?:(?P<function>[cs])?(?P<angle>theta|th|alpha)|(?P<length>[a-z]))(?:[ijkn](?:[-+]1)?)?", re.IGNORECASE
)
ANY_ROW = {
    Convention.STANDARD: "Rz(theta) Tz(d) Tx(a) Rx(alpha)",
    Convention.MODIFIED: "Rx(alpha) Tx(a) Rz(theta) Tz(d)",
}
_ANGLES = {"theta": 0.7, "th": 0.7, "alpha": 1.1}  # any ones
_LENGTHS = (1.3, 0.4)


def misprints(table: Table, letters: Sequence[str], convention: Convention) -> list[tuple[int, int]] | None:
    """The entry, from 1, in which a matrix differs from that of any row, if one does; None of something else."""
    if table.shape not in ((4, 4), (3, 3)):
        return None
    found = list[list[tuple[int, int]]]()
    for values, step in _ways(letters, convention, len(table.rows)):
        with suppress(*NO_VALUE):
            printed = np.reshape([float_value(entry.formula, values) for entry in table.entries], table.shape)
            differing = np.argwhere(np.abs(printed - step[: len(table.rows), : len(table.rows)]) > ALIKE)
            found.append([(int(i) + 1, int(j) + 1) for i, j in differing])
    best = min(found, key=len, default=None)
    if best and (len(best) > 1 or is_constant(table.rows[best[0][0] - 1][best[0][1] - 1].formula)):
        return None
    return best


def _ways(letters: Sequence[str], convention: Convention, size: int) -> Iterator[tuple[dict[str, float], Array]]:
    """Values of the letters, and the transform with them, in which is zero what has no letter."""
    matches = {letter: match for letter in letters if (match := _LETTER.fullmatch(letter))}
    lengths = sorted({match["length"] for match in matches.values() if match["length"]})
    turned = {letter: match["angle"].lower() for letter, match in matches.items() if match["angle"]}
    angles = {angle[0]: _ANGLES[angle] for angle in turned.values()}
    if len(matches) < len(letters) or "t" not in angles or len(lengths) > len(_LENGTHS) * (size > 3):
        return
    of_function = {"c": cos, "s": sin, "": float}
    functions = {letter: (matches[letter]["function"] or "").lower() for letter in turned}
    values = {f"?{letter}": of_function[functions[letter]](_ANGLES[angle]) for letter, angle in turned.items()}
    values |= {f"?{letter}": _LENGTHS[lengths.index(matches[letter]["length"])] for letter in matches.keys() - turned}
    # Khalil's d is our a, his r our d
    for a, d in permutations([*_LENGTHS[: len(lengths)], 0.0, 0.0][:2]):
        along_z, along_x, twist = (number(Fraction(repr(x))) for x in (d, a, angles.get("a", 0.0)))
        joint = Joint(JointType.REVOLUTE, "q", 1, ZERO, along_z, along_x, twist)
        row = Robot("row", "", convention, (joint,))
        yield values, NumericChain.of(row).pose_and_jacobian(np.array([angles["t"]]))[0]
