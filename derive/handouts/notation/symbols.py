"""What the entries of matrices are called on the sheet, so that none looks like a symbol of the user's.

b_{12}, C_{12}, N_{12}, g_1, t_{11} and J_{11}; Christoffel symbols are c_{1,23}: with the comma they differ from
c_{123}, the cosine of a sum. Where a name is taken, an entry is written (B)_{12}.
"""

from __future__ import annotations

from dataclasses import dataclass

from derive.handouts.notation.notation import Notation
from derive.handouts.notation.pieces import Box, concatenate, greek, italic, script, upright
from derive.robot.style import FrameIndices

_TERM_LETTERS = ("u", "w", "h", "v", "k", "e", "x", "y", "z")


def bold(letter: str) -> Box:
    """A matrix or vector.

    Args:
        letter: Its letter.
    """
    return Box(f"\\mathbf{{{letter}}}", 10.0)


class Symbols:
    """Names of entries for one robot.

    Args:
        notation: The robot's notation.
        n: Number of joints.
    """

    def __init__(self, notation: Notation, n: int) -> None:
        self.options = notation.options
        self._taken = notation.taken
        self._comma = "," if n > 9 else ""
        self._gamma = bool(notation.separator)

    @property
    def inertia_letter(self) -> str:
        """Letter of the inertia matrix: B, M or D; its entries have the lower-case one."""
        return self.options.inertia.value

    def frame(self, letter: str, frame: int | str, reference: int | str) -> Box:
        r"""A matrix of one frame in another: \mathbf{A}_{1}^{0}, or {}^{0}\mathbf{A}_{1} with the frames on the left.

        Args:
            letter: The matrix.
            frame: Index of the frame that is described.
            reference: Index of the frame in which it is described.
        """
        lower, upper = italic(str(frame)), italic(str(reference))
        if self.options.frames is FrameIndices.RIGHT:
            return script(bold(letter), lower, upper)
        return concatenate(script(Box("{}", 0.0), sup=upper), script(bold(letter), lower))

    def entry(self, letter: str, row: int, column: int) -> Box:
        """Entry of a matrix.

        Args:
            letter: Letter of the entries, such as ``b``.
            row: Its row, from 1.
            column: Its column, from 1.
        """
        return self._free(letter, f"{row}{self._comma}{column}")

    def component(self, letter: str, row: int) -> Box:
        """Entry of a vector.

        Args:
            letter: Letter of the entries, such as ``g``.
            row: Its place, from 1.
        """
        return self._free(letter, str(row))

    def torque(self, row: int) -> Box:
        """Force or torque of a joint.

        Args:
            row: The joint, from 1.
        """
        tau = script(greek("tau"), italic(str(row)))
        return script(upright("tau"), italic(str(row))) if tau.tex in self._taken else tau

    def christoffel(self, i: int | str, j: int | str, k: int | str) -> Box:
        """The Christoffel symbol c_{i,jk} of the first kind.

        Args:
            i: The joint whose force it gives, from 1, or a letter that stands for it.
            j: One of the two joints that move.
            k: The other one.
        """
        indices = f"{i},{j}{self._comma}{k}"
        if self._gamma:
            return script(greek("Gamma"), italic(indices))
        return self._free("c", indices)

    def term(self, group: int, index: int) -> Box:
        """A named intermediate term.

        Args:
            group: Number of the quantity; each has a letter of its own.
            index: Number of the term, from 1.
        """
        letters = [letter for letter in _TERM_LETTERS if not any(tex.startswith(letter) for tex in self._taken)]
        letters = letters or ["\\Lambda "]
        letter = letters[group % len(letters)]
        text = str(index) if group < len(letters) else f"{group // len(letters)},{index}"
        return script(italic(letter), italic(text))

    def _free(self, letter: str, indices: str) -> Box:
        plain = script(italic(letter), italic(indices))
        if plain.tex not in self._taken:
            return plain
        matrix = concatenate(Box("(", 5.0), bold(letter.upper()), Box(")", 5.0))
        return script(matrix, italic(indices))


@dataclass(frozen=True, slots=True)
class EntryNamer:
    """(row, column) -> name of an entry of a matrix.

    Attributes:
        symbols: Names of entries for the robot.
        letter: Letter of the entries.
    """

    symbols: Symbols
    letter: str

    def __call__(self, row: int, column: int) -> Box:
        """The name of one entry."""
        return self.symbols.entry(self.letter, row, column)
