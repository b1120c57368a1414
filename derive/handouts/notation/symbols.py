"""What entries of matrices and intermediate terms are called on the sheet, unlike any symbol of the user's.

b_{12}, C_{12}, N_{12}, g_1, t_{11} and J_{11}; Christoffel symbols are c_{1,23}: with the comma they differ from
c_{123}, the cosine of a sum. Where a name is taken, an entry is written (B)_{12}.
"""

from derive.handouts.notation.notation import Notation
from derive.handouts.notation.pieces import Box, bracketed, concatenate, greek, italic, script, upright
from derive.robot.options.handout import FrameIndices

_TERM_LETTERS = ("u", "w", "h", "v", "k", "e", "x", "y", "z")


def bold(letter: str) -> Box:
    """A matrix or vector."""
    return Box(f"\\mathbf{{{letter}}}", 10.0)


class Symbols:
    """Names of entries for one robot."""

    def __init__(self, notation: Notation, n: int, end: str = "") -> None:
        self.end = end  # of a tree with several ends that of which T and J are
        self.options = notation.options
        self._taken = notation.taken
        self._comma = "," if n > 9 else ""
        self._gamma = bool(notation.separator)

    @property
    def inertia_letter(self) -> str:
        """Letter of the inertia matrix: B, M or D; its entries have the lower-case one."""
        return self.options.inertia.value

    def of_end(self, letter: str) -> Box:
        """T or J: of a tree with the name of the end."""
        return script(bold(letter), upright(self.end)) if self.end else bold(letter)

    def frame(self, letter: str, frame: int | str | Box, reference: int | str | Box) -> Box:
        r"""A matrix of one frame in another: \mathbf{A}_{1}^{0}, or {}^{0}\mathbf{A}_{1} with frames on the left."""
        lower, upper = (i if isinstance(i, Box) else italic(str(i)) for i in (frame, reference))
        if self.options.frames is FrameIndices.RIGHT:
            return script(bold(letter), lower, upper)
        return concatenate(script(Box("{}", 0.0), sup=upper), script(bold(letter), lower))

    def entry(self, letter: str, row: int, column: int) -> Box:
        """Entry of a matrix."""
        indices = f"{row}{self._comma}{column}"
        if self.end and letter in "tJ":
            return script(bracketed(self.of_end(letter.upper())), italic(indices))
        return self._free(letter, indices)

    def component(self, letter: str, row: int) -> Box:
        """Entry of a vector."""
        return self._free(letter, str(row))

    def torque(self, row: int) -> Box:
        """Force or torque of a joint."""
        tau = script(greek("tau"), italic(str(row)))
        return script(upright("tau"), italic(str(row))) if tau.tex in self._taken else tau

    def christoffel(self, i: int | str, j: int | str, k: int | str) -> Box:
        """The Christoffel symbol c_{i,jk} of the first kind."""
        indices = f"{i},{j}{self._comma}{k}"
        return script(greek("Gamma"), italic(indices)) if self._gamma else self._free("c", indices)

    def term(self, group: int, index: int) -> Box:
        """A named intermediate term."""
        letters = [letter for letter in _TERM_LETTERS if not any(tex.startswith(letter) for tex in self._taken)]
        letters = letters or ["\\Lambda "]
        letter = letters[group % len(letters)]
        text = str(index) if group < len(letters) else f"{group // len(letters)},{index}"
        behind = [upright(self.end), italic(",")] if self.end else []
        return script(italic(letter), concatenate(*behind, italic(text)))

    def _free(self, letter: str, indices: str) -> Box:
        plain = script(italic(letter), italic(indices))
        return script(bracketed(bold(letter.upper())), italic(indices)) if plain.tex in self._taken else plain


class Group:
    """Which letter the named intermediate terms of each quantity have: a number for each, all different on a sheet."""

    # Small numbers get a letter of their own, larger ones a letter with two indices, see `Symbols.term`.
    # The quantities; g and tau have the same, for they stand in different parts.
    T, J, B, CHRISTOFFEL, C, N, TORQUE, POTENTIAL = range(8)
    SINGULARITY_BLOCKS = 60  # the one or two blocks of J whose determinants are taken
    DETERMINANT = 62
    DERIVATIVE, KINETIC, _FIRST_BODY = 998, 999, 1000  # before single bodies the quantities and the transforms

    @staticmethod
    def row(i: int) -> int:
        """The transform A_i."""
        return 8 + 3 * (i - 1)

    @staticmethod
    def factor(start: int) -> int:
        """A product of some rows in the middle of the arm."""
        return Group.row(start + 1) + 1

    @staticmethod
    def product(i: int) -> int:
        """The product of the first rows, T_i^0."""
        return Group.row(i + 1) + 2

    @staticmethod
    def axis(n: int, frame: int, column: int) -> int:
        """The axis or the origin of a frame; above all transforms."""
        return max(90, Group.row(n + 3)) + 2 * frame + column - 3

    @staticmethod
    def body(index: int, quantity: int) -> int:
        """A quantity of a link or rotor."""
        return Group._FIRST_BODY + 5 * index + quantity
