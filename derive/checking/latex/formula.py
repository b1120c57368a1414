r"""Formulas in the LaTeX of lecture notes as expression trees: ``c_1 \left(a_2 c_2 + a_3 c_{23}\right)``.

What is not understood is refused at its place, in words; nothing is ever guessed from a macro that is not known.
"""

import re
from collections.abc import Mapping

from lark.exceptions import UnexpectedCharacters, UnexpectedInput, UnexpectedToken

from derive.checking.latex.grammar import MisplacedError, parsed
from derive.checking.latex.left import taken_apart
from derive.checking.latex.matrices import Entry, Table, joined_blocks
from derive.checking.latex.names import ENERGY, FLAT, PRIME, LatexNames, Symbol
from derive.checking.latex.pieces import AROUND, MATRIX_MARK, LatexPiece, PrintedMatrix
from derive.checking.latex.quantities import slope
from derive.checking.latex.typography import ALTERNATIVE, PRIMED
from derive.errors import CheckError, DeriveError, Location, UnknownNameError, near_miss, quoted
from derive.lecture.sympy_conversion import expression_from_sympy, expression_to_sympy
from derive.robot.expression import ZERO, Expression, Name, expanded_terms, names, power
from derive.robot.names import acceleration_name, own_names, velocity_name
from derive.robot.parser import place
from derive.robot.reading.size_limits import FORMULA_LIMITS
from derive.robot.robot import Robot

# Of a formula multiplied out; an analytic Jacobian of a 7R arm has 300,000, and long formulas are compared at points.
MAX_EXPANDED_TERMS = 1_000_000

MACROS = (
    *("cos", "sin", "tan", "sqrt", "frac", "tfrac", "dfrac", "left", "right", "dot", "ddot", "cdot", "times", "quad"),
    *("alpha", "beta", "gamma", "delta", "epsilon", "theta", "vartheta", "lambda", "mu", "nu", "xi", "pi", "rho"),
    *("sigma", "tau", "phi", "varphi", "chi", "psi", "omega", "ell", "mathrm", "text", "operatorname", "mathbf"),
)

_LONG_SCRIPT = re.compile(r"([_^])\s*([A-Za-z0-9][0-9]+)")
_REMEDIES = {
    "=": "write only the right-hand side",
    "'": "primes have no meaning here; remove it",
    "^": "write an exponent as ^2 or ^{2}, that of a function as \\cos^2\\theta_1 or (\\cos\\theta_1)^2",
    "&": "check one entry at a time",
    "$": "dollar signs may only stand around the whole formula",
    "|": "use brackets",
    ",": "write decimals with a point; separate equations by a line break",
    **dict.fromkeys((".", "\u2026", "\u22ef"), "write out what dots stand for"),
    **dict.fromkeys("<>", "only equations can be compared"),
}
_MACRO_REMEDIES = {
    **dict.fromkeys(("ldots", "cdots", "dots", "vdots", "ddots", "dotsc", "dotsb"), "write out what dots stand for"),
    **dict.fromkeys(("pm", "mp"), "these are two formulas; check one sign at a time"),
    **dict.fromkeys(("newcommand", "renewcommand", "def", "DeclareMathOperator"), "write own macros out"),
    **dict.fromkeys(("sum", "prod", "int"), "write the terms out"),
    **dict.fromkeys(("bar", "hat", "tilde", "overline", "widehat"), "names have dots only; write a plain name"),
    **dict.fromkeys(("arctan", "arccos", "arcsin"), r"write \operatorname{atan2}(y, x)"),
    **dict.fromkeys(("approx", "simeq", "leq", "geq", "le", "ge", "neq", "sim"), "only equations can be compared"),
}

MAX_TERMS = 20_000  # of a formula that is differentiated, multiplied out
_INNER = r"(?:[^{}]|\{(?:[^{}]|\{(?:[^{}]|\{[^{}]*\})*\})*\})*"
_BRACKETED = r"(?:\((?:[^()]|\((?:[^()]|\([^()]*\))*\))*\)|\[(?:[^][]|\[[^][]*\])*\])"
_DEL = r"\\partial(?![A-Za-z])"
_PARTIAL = re.compile(
    rf"\\[dtc]?frac\s*\{{\s*{_DEL}(?P<above>{_INNER})\}}\s*\{{\s*{_DEL}(?P<below>{_INNER})\}}(?P<behind>\s*{_BRACKETED})?"
)
_TOTAL = rf"\\dot\s*(?:(?P<sign>[%s])|(?P<bracket>{_BRACKETED})|\{{\s*(?P<inner>[%s]|{_BRACKETED})\s*\}})"


class LatexReader:
    """Reads the pieces of one text."""

    def __init__(self, names: LatexNames, text: str, start: Location) -> None:
        self.names, self._text, self._start = names, text, start
        self._read: dict[LatexPiece, Expression | Table] = {}  # a text is gone through several times

    def location(self, offset: int) -> Location:
        """The place of a character."""
        return place(self._text, offset, self._start)

    def _refused(self, offset: int, found: str, allowed: str = "", remedy: str = "") -> CheckError:
        return CheckError(found, allowed=allowed, remedy=remedy, location=self.location(offset))

    def formula(self, piece: LatexPiece) -> Expression:
        """What a piece says that is no matrix."""
        found = self.value(piece)
        if isinstance(found, Table):
            raise self._refused(piece.start, "matrix where a formula is expected")
        return found

    def value(self, piece: LatexPiece, known: Mapping[int, Table] | None = None) -> Expression | Table:
        """What a piece says; known are the matrices at some of its marks."""
        if not known and piece in self._read:
            return self._read[piece]
        self._check_size(piece)
        tables: dict[int, Expression | Table] = {**(known or {})}
        marks = [i for i, letter in enumerate(piece.text) if letter == MATRIX_MARK and i not in tables]
        tables |= {i: self._matrix(matrix) for i, matrix in zip(marks, piece.matrices, strict=bool(piece.matrices))}
        try:
            text = _DOUBLE_PLUS.sub(" ", piece.text)
            if self.names.signs is not None:  # a document, with labels of branches and primed names of its own
                text = _BRANCH.sub(lambda m: m[1].ljust(len(m[0])), text)
                if ALTERNATIVE.search(text):
                    raise CheckError("two formulas, of which either may hold", remedy="check one at a time")
                text = _BARS.sub("\\1\ue003\\2\ue004\\3", text.replace("\\vert", "|    "))
                text = _OF_MATRIX.sub(self._of_matrix, text)
                text = _ARGUMENTS.sub(lambda m: (m[1] or m[2]).ljust(len(m[0])), text)
                text = _SEEN_FROM.sub(self._seen_from, text)
                text = _PRIMED_NAME.sub(self._primed, text)
            if "\\partial" in text or "\\dot" in text:
                text = self.without_derivatives(text)
            found = parsed(_RUN.sub(self._long_name, text), self.names, tables)
        except UnexpectedInput as error:
            raise self._refusal(piece, error) from None
        except MisplacedError as error:
            raise error.error.at(self.location(piece.offset + error.offset)) from None
        except DeriveError as error:
            raise error.at(self.location(piece.start)) from None
        except ZeroDivisionError:
            raise self._refused(piece.start, "division by zero") from None
        formulas = [found] if not isinstance(found, Table) else [entry.formula for entry in found.entries]
        if any(expanded_terms(formula, MAX_EXPANDED_TERMS) > MAX_EXPANDED_TERMS for formula in formulas):
            raise self._refused(piece.start, "formula has too many terms when multiplied out")
        self._read |= {} if known else {piece: found}
        return found

    def without_derivatives(self, text: str) -> str:
        """A formula with one sign for each derivative in it, as long as before."""
        robot, read, sign, signs = self.names.robot, self._differentiated, self.names.standing_for, "\0"
        while match := _PARTIAL.search(text):
            above, end = match["above"], match.end()
            if above.strip():
                end -= len(match["behind"] or "")
            else:
                above = match["behind"] or ""
            variable = read(match["below"])
            by = variable.name if isinstance(variable, Name) else ""
            if by not in {name for joint in robot.movers for name in (joint.variable, velocity_name(joint.variable))}:
                raise CheckError("derivative by what is not a joint variable or its velocity")
            signs += (found := sign(derivative(robot, read(above), by)))
            text = text[: match.start()] + found.ljust(end - match.start()) + text[end:]
        while match := re.search(_TOTAL % (signs, signs), text):
            signs += (found := sign(derivative(robot, read(match["sign"] or match["bracket"] or match["inner"]), "t")))
            text = text[: match.start()] + found.ljust(len(match[0])) + text[match.end() :]
        return text

    def _differentiated(self, text: str) -> Expression:
        """What a derivative is taken of, or by: of a letter for an energy that the text does not define, the energy."""
        left = taken_apart(text)
        energy = None if left is None or self.names.knows(left.flat) else self.names.entry(f"{ENERGY}{left.flat}")
        found = None if MATRIX_MARK in text else energy or parsed(_RUN.sub(self._long_name, text), self.names, {})
        if found is None or isinstance(found, Table):
            raise CheckError("derivative of a matrix")
        return found

    def _long_name(self, match: re.Match[str]) -> str:
        """One sign for a run of letters that is a name of the robot, as SymPy prints it: ``qd_{1}``, ``Ixx_{1}``."""
        if (run := match["run"]) is None:
            return match[0]
        sub = re.sub(r"[^A-Za-z0-9]", "", match["sub"] or "")
        knows = self.names.knows
        is_defined = run + sub in self.names.abbreviations
        if not knows(run + sub) or (not is_defined and all(map(knows, (*run[:-1], run[-1] + sub)))):
            return match[0]
        return self.names.sign(run).rjust(len(run)) + match[0][len(run) :]

    def _seen_from(self, match: re.Match[str]) -> str:
        """One sign for a coordinate of a frame, or an entry of its axes, that is seen from another one; none for 0."""
        if match["entry"]:
            return match["entry"].rjust(len(match[0]))
        part = match[match.lastgroup or 0]
        name, frames = re.sub("[^A-Za-z0-9]", "", part), re.findall("[0-9]", match[0].replace(part, ""))
        entry = self.names.entry(f"{name}^{frames[0]}") if len(frames) == 1 else None
        return (self.names.standing_for(entry) if entry else match["column"] or match[0]).ljust(len(match[0]))

    def _of_matrix(self, match: re.Match[str]) -> str:
        """One sign for the determinant of a matrix that is derived, or for the square of a velocity: v_1^T v_1."""
        left = taken_apart(match["in"] or match["bare"] or match["name"])
        flat, known = left.flat if left is not None else "", None
        if match["name"]:
            known = power(self.names.meaning(Symbol(flat, 0)), 2) if self.names.knows(flat) else None
        elif flat:
            known = self.names.entry(f"det{flat}")
        return (self.names.standing_for(known) if known else match[0]).ljust(len(match[0]))

    def _primed(self, match: re.Match[str]) -> str:
        """One sign for a letter with primes."""
        letter = match["letter"].removeprefix("\\")
        sign = self.names.sign(FLAT.get(letter, letter) + PRIME * len(re.findall(r"'|\\prime", match["primes"])))
        return (sign + (match["sub"] or "") + (match["more"] or "")).ljust(len(match[0]))

    def _matrix(self, matrix: PrintedMatrix) -> Expression | Table:
        """The entries of a matrix; one with an unknown name says so, since the others can be compared all the same."""
        if len({len(row) for row in matrix.rows}) != 1:
            where = self.location(matrix.rows[-1][0].start) if matrix.rows else self._start
            lengths = " and ".join(map(str, sorted({len(row) for row in matrix.rows}))) or "no"
            remedy = r"check & and \\ of its rows"
            raise CheckError(f"matrix whose rows have {lengths} entries", remedy=remedy, location=where)
        if any(cell.text.strip(AROUND) == MATRIX_MARK for row in matrix.rows for cell in row):
            table = joined_blocks([[self.value(cell) for cell in row] for row in matrix.rows])
        else:
            table = Table(tuple(tuple(self._entry(cell) for cell in row) for row in matrix.rows))
        if matrix.is_determinant and (determinant := table.determinant).unknown is not None:
            raise determinant.unknown
        return determinant.formula if matrix.is_determinant else table

    def _entry(self, cell: LatexPiece) -> Entry:
        text = " ".join(self._text[cell.start : cell.end].split())
        if not cell.text.strip():
            raise self._refused(cell.start, "empty entry", remedy="write 0")
        if self.names.signs is not None and _OPEN.fullmatch(cell.text.strip()):
            return Entry(ZERO, text, cell.start, is_open=True)
        try:
            return Entry(self.formula(cell), text, cell.start)
        except CheckError as error:
            if self.names.signs is None and not isinstance(error, UnknownNameError):
                raise
            return Entry(ZERO, text, cell.start, unknown=error)

    def _check_size(self, piece: LatexPiece) -> None:
        text, longest, deepest = piece.text, FORMULA_LIMITS.text_length, FORMULA_LIMITS.depth
        if len(text) > longest:
            raise self._refused(piece.start, f"formula of {len(text)} characters", f"allowed: at most {longest}")
        if not text.strip(" \t\r\n$"):
            raise self._refused(piece.offset, "empty formula", remedy="write the right-hand side")
        depth = 0
        for match in re.finditer(r"[][(){}]", text):
            depth += 1 if match[0] in "([{" else -1
            if depth > deepest:
                allowed = f"allowed: at most {deepest}"
                raise self._refused(piece.offset + match.start(), "brackets nested too deeply", allowed)

    def _refusal(self, piece: LatexPiece, error: UnexpectedInput) -> CheckError:
        """The message for text that the grammar does not know."""
        text, offset = piece.text, len(piece.text)
        if isinstance(error, UnexpectedToken | UnexpectedCharacters):
            at_end = isinstance(error, UnexpectedToken) and error.token.type == "$END"
            offset = offset if at_end else error.pos_in_stream or 0
        where, rest = piece.offset + offset, text[offset:]
        if not rest.strip():
            return self._refused(where, "formula ends too early", remedy="check brackets and braces")
        before = text[:offset].rstrip()
        script_start = len(before) - 1 if before.endswith(("_", "^")) else offset  # reading may stop in mid script
        if match := _LONG_SCRIPT.match(text, script_start):
            mark, script = match[1], match[2]
            shown = f"LaTeX prints only {script[0]!r} of {mark}{script} as a script"
            return self._refused(piece.offset + match.start(), shown, remedy=f"write {mark}{{{script}}}")
        if match := re.match(r"\\[A-Za-z]+|\\.", rest):
            if (name := match[0][1:]) in MACROS:
                return self._refused(where, f"{match[0]} at a place where it has no meaning")
            if name in _MACRO_REMEDIES:
                return self._refused(where, f"{match[0]} in a formula", remedy=_MACRO_REMEDIES[name])
            hint = near_miss(name, MACROS).replace("'", "\\", 1).replace("'", "")
            hint = hint or "allowed: " + ", ".join(f"\\{macro}" for macro in (*MACROS[:5], "cdot")) + ", Greek letters"
            return self._refused(where, f"unknown macro {quoted(match[0])}".replace("\\\\", "\\"), remedy=hint)
        sign = "'" if rest[0] in PRIMED.values() else rest[0]
        return self._refused(where, f"unexpected {quoted(sign)}", remedy=_REMEDIES.get(sign, "check it"))


# A run of letters that is no macro, no script and no word in roman letters, with its subscript.
_RUN = re.compile(
    r"\\(?:math[a-z]+|text[a-z]*|operatorname\*?|boldsymbol|bm|pmb|vec|mbox)\s*\{[^{}]*\}|\\[A-Za-z]+|_\s*\{[^{}]*\}"
    r"|(?P<run>[A-Za-z]{2,})(?P<sub>[0-9]*\s*(?:_\s*(?:\{[^{}]*\}|[A-Za-z0-9]))?)"
)
# The label of a branch, as in \\theta_1^{(2)}, s_3^{+} and \\theta_4^{base}.
_BRANCH = re.compile(
    r"((?:\\(?:var)?theta|(?<![A-Za-z\\])[qdcs])\s*_\s*(?:\{[^{}]*\}|\w))\s*\^\s*"
    r"(?:\{\s*(?:\([^(){}]{1,3}\)|[-+]|(?:\\(?:text|mathrm)\s*\{)?\s*(?:base|up|down|left|right|front|back|flip)\s*\}?)\s*\}|[-+])"
)
# The arguments of an entry, M_{11}(\\theta_2), b_{12}(q), or of any name that has more than one: f_x(x, \\dot x).
_JOINT = r"(?:\\d*dot\s*)?\{?(?:\\(?:var)?theta|[qx])\}?(?:\s*_\s*\{?[0-9]\}?)?"
_ARGUMENTS = re.compile(
    rf"((?<![A-Za-z\\])[MBDCGgJNH]\s*_\s*(?:\{{[0-9, ]+\}}|[0-9]))\s*\(\s*{_JOINT}(?:\s*,\s*{_JOINT})*\s*\)"
    rf"|(\\?[A-Za-z]+\s*_\s*(?:\{{[^{{}}]+\}}|\\[a-z]+|\w))\s*\(\s*{_JOINT}(?:\s*,\s*{_JOINT})+\s*\)"
)
_OF_MATRIX = re.compile(
    r"\\det(?![a-z])\s*(?:\((?P<in>(?:[^()]|\(\\?\w+\))*)\)|(?P<bare>\\[a-z]+\s*\{[A-Z]\}|[A-Z]))"
    r"|(?<![\\A-Za-z])(?P<name>(?:\\[a-z]+\s*)?(?:\{[A-Za-z]\}|[A-Za-z])\s*_\s*(?:\{\w+\}|\w))"
    r"\s*\^\s*(?:T|\\top|\{\s*(?:T|\\top)\s*\})\s*(?:\\cdot)?\s*(?P=name)(?![\s{}]*[\^_'])"
)
_RAISED = r"\^\s*(?:[0-9]|\{\s*[0-9]\s*\})"
_ENTRY = r"(?:r\s*_\s*\{\s*[1-3]\s*,?\s*[1-3]\s*\}|[nsoapP]\s*_\s*(?:[xyz]|\{\s*[xyz]\s*\}))"
# P_{6x}^0 and {}^1n_{4z}, an entry of the pose with the base before it, {}^0r_{11}, or with another frame: {}^1r_{11},
# r_{11}^{(5)} and a_x^3, but not p_x^3.
_SEEN_FROM = re.compile(
    rf"\{{\s*\}}\s*\^\s*(?:0|\{{\s*0\s*\}})\s*(?P<entry>[rRnsoap]\s*_)"
    rf"|(?:\{{\s*\}}\s*|^\s*|(?<=[-+=(&*])\s*){_RAISED}\s*(?P<other>{_ENTRY})"
    rf"|(?<![A-Za-z\\])(?P<behind>{_ENTRY})\s*\^\s*\{{\s*\([1-9]\)\s*\}}"
    rf"|(?<![A-Za-z\\])(?P<column>[nsoa]\s*_\s*(?:[xyz]|\{{\s*[xyz]\s*\}}))\s*\^\s*(?:[3-9]|\{{\s*[3-9]\s*\}})"
    rf"|(?:\{{\s*\}}\s*)?(?:{_RAISED}\s*)?(?<![A-Za-z\\])(?P<name>[pPnsoaFfN]\s*_\s*\{{?\s*[1-9]\s*,?\s*[xyz]\s*\}}?)"
    rf"(?:\s*{_RAISED})?"
)
_INDEX = r"\s*_\s*(?:\{[^{}]*\}|\w)"
_PRIMED_NAME = re.compile(
    rf"(?P<letter>\\(?:{'|'.join(filter(str.isascii, FLAT))})|(?<![A-Za-z\\])[A-Za-z])(?P<sub>{_INDEX})?"
    rf"(?P<primes>'+|\s*\^\s*\{{\s*(?:(?:'|\\prime)\s*)+\}}|\s*\^\s*\\prime)(?P<more>{_INDEX})?"
)
_OPEN = re.compile(r"\*|\\(?:ast|star|diamond|bullet|times|cdot|cdots|dots|ldots|square|Box)(?![A-Za-z])")
_DOUBLE_PLUS = re.compile(r"\+(?=\s*[-+])")  # a sum that is broken after its sign and has one before the next term, too
_BARS = re.compile(r"^([^|]*)\|([^|]+)\|([^|]*)$")  # |x|, the only bars of a formula


def derivative(robot: Robot, formula: Expression, by: str) -> Expression:
    """The derivative of a formula that has names of the robot alone."""
    joints = [joint.variable for joint in robot.movers]
    moving = {name for q in joints for name in (q, velocity_name(q), acceleration_name(q))}
    if isinstance(formula, Name) and formula.name not in moving:
        raise CheckError("derivative of a symbol")
    if not own_names(robot).union(moving).issuperset(names(formula)):
        raise CheckError("derivative of what has other names than those of the robot")
    if expanded_terms(formula, MAX_TERMS) > MAX_TERMS:
        raise CheckError("derivative of a formula with too many terms")
    return expression_from_sympy(slope(robot, expression_to_sympy(formula), by))
