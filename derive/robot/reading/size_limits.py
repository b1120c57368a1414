"""Every limit on what a user's text may cost, in one place, each with its reason."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Limits:
    """Bounds on one expression; anything beyond them is refused with a message."""

    text_length: int = 4_000  # characters in the expression. A cell of a DH table is rarely longer than 40
    tokens: int = 1_000  # numbers, names, operators and parentheses; bounds the size of the tree
    # Nested parentheses, signs and powers; keeps every recursion over a tree far from Python's own limit.
    depth: int = 40
    exponent: int = 32  # largest absolute value of an exponent; lecture notes stop at 4
    digits: int = 60  # digits of one written number; beyond it no measurement and no standard constant goes
    decimal_exponent: int = 99  # largest absolute ``e`` of ``1e5`` notation; keeps numbers inside the range of a float
    # Bits of a folded numerator or denominator; 2**1000 is still a finite float, ``10**10**10`` is not.
    number_bits: int = 1_000
    # Upper bound of the terms after multiplying out, so that ``(a + b + c)**32`` cannot fill memory.
    expanded_terms: int = 2_000


CELL_LIMITS = Limits()
# For printed formulas: an expanded inertia matrix entry of a 6R arm has some 2,800 terms.
FORMULA_LIMITS = Limits(text_length=400_000, tokens=200_000, expanded_terms=200_000)


@dataclass(frozen=True, slots=True)
class FileLimits:
    """Bounds on one robot file."""

    # Bytes. The longest file of the lecture corpus has 11,000; 256 joints with full dynamics need about 110,000.
    size: int = 262_144
    depth: int = 16  # nested lists and mappings; the deepest legal place is four levels down, inside ``robot:`` five
    nodes: int = 40_000  # keys, values and list items together; bounds the work for files that are short but dense
    joints: int = 256  # rows that move, with variables of the root, and as many that do not; an import takes 11 s
    name_length: int = 64  # characters of a symbol or a robot's name; a file name must hold it
    title_length: int = 500  # characters of the title; one line of a handout holds some 90


FILE_LIMITS = FileLimits()
