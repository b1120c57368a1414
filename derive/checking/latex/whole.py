"""Texts and printed matrices as a whole: conventions, names of entries, one cause of slips."""

import random
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from collections.abc import Set as AbstractSet
from contextlib import suppress
from dataclasses import replace
from itertools import combinations, product

import numpy as np
import numpy.typing as npt

from derive.checking.formulas.edits import NO_VALUE, float_value
from derive.checking.formulas.findings import Finding
from derive.checking.latex.equations import Sides, listed
from derive.checking.latex.formula import LatexReader
from derive.checking.latex.left import AXES, Left, taken_apart
from derive.checking.latex.matrices import Table
from derive.checking.latex.meanings import ALIKE, Meanings, Right, at_a_point
from derive.checking.latex.names import PRIME, LatexNames
from derive.checking.latex.pieces import AROUND, MATRIX_MARK, LatexPiece
from derive.errors import CheckError, Location
from derive.lecture.sympy_conversion import Matrix, expression_from_sympy
from derive.model.equality import Verdict, compare
from derive.model.model import Model
from derive.robot.expression import ZERO, Call, Expression, Name, Sum, add, is_constant, multiply, names
from derive.robot.names import joint_label, own_names, velocity_name
from derive.robot.parser import parse_expression
from derive.robot.robot import Robot

_ANGLES_TRIED, _ROUNDING = 24, 1e-9  # points at which two formulas are taken for sine and cosine, and how near to 1
OF_ANGLE = re.compile(
    r"\\?(?P<function>cos|sin|tan)(?![A-Za-z])\s*[({]*\s*(?P<angle>\\?[A-Za-z]+(?:_\{?\w\}?)?)\s*[)}]*"
)
_COLUMN = re.compile(r"(?:[nosapP]|[rRtT])_?(?:[xyz]|[1-4][1-4])|[xyzXYZ]_?(?:target|des|goal|d)")
_NAME = r"\\?[A-Za-z]+(?:_\{?[a-z]\}?)?"
_LIST_OF_NAMES = re.compile(rf"[\[(]{_NAME}(?:,{_NAME})+[\])](?:\^.*)?")  # [x, y, \theta]^T
_FONTS = re.compile(r"\\(?:mathbf|boldsymbol|bm|mathrm|vec|mathit|text)(?![A-Za-z])|[{}]|\\[,;:!]")
_GRAVITY = re.compile(r"([+-]|^(?=\\tau))(?:\\tau_?)?[gG](?:_?[a-z])?(?:\([^()]*\))?(?=[-+]|$)")
# A Christoffel symbol with letters for its indices.
_SYMBOL = re.compile(r"(?:\\\w+\{)?(?:\\?[A-Za-z]+)\}?_\{?([a-z],?[a-z],?[a-z])\}?(?:\(.*\))?")
# A partial derivative that is subtracted, and the index of its variable.
_SUBTRACTED = re.compile(
    r"-\s*(?:\\[dt]?frac\s*\{\s*\\partial(?:[^{}]|\{[^{}]*\})*\}\s*\{\s*\\partial\s*(?:q|\\theta)\s*_\s*\{?\s*([a-z])\s*\}?\s*\})"
)
_JOINTS = re.compile(r"(?:\\(?:var)?theta|(?<![A-Za-z\\])q)\s*_\s*\{?\s*([1-9])\s*(?![0-9])\}?")
Defined = tuple[str, int, Expression, LatexPiece]  # a name, its equation's number, what it stands for, its side
_BLOCK = re.compile(r"[nosapPRdtT](?:[0-9]{1,2}|e|E|EE)?")  # in [R p; 0 1] or [n o a p; 0 0 0 1]


def names_its_columns(piece: LatexPiece) -> bool:
    """Whether a side is a matrix of names for the entries of a pose, n o a p or r_11 ... p_z."""
    if len(piece.matrices) != 1 or piece.text.strip(AROUND) != MATRIX_MARK:
        return False
    lefts = [taken_apart(cell.text) for cell in piece.cells if cell.text.strip() not in "01"]
    if {len(row) for row in piece.matrices[0].rows} <= {2, 4} and len(piece.matrices[0].rows) == 2 and len(lefts) > 1:
        plain = [left and replace(left, sup="", before="", arguments="") for left in lefts]  # seen from some frame
        return all(left and left.is_plain and _BLOCK.fullmatch(left.flat) for left in plain)
    plain = [left and (replace(left, sup="", before="") if left.labelled else left) for left in lefts]
    return len(lefts) > 2 and all(left and left.is_plain and _COLUMN.fullmatch(left.flat) for left in plain)


def base_letters(equations: Iterable[Sides]) -> frozenset[str]:
    """A letter that is the reference of all matrices with scripts before them, and the frame of none."""
    sides = (side for equation in equations for side in equation if not side.matrices)
    lefts = [left for side in sides if (left := taken_apart(side.text)) and left.before and left.head in "TMRHJA"]
    letters = {left.before for left in lefts}
    frames = {left.sub + left.before_sub for left in lefts}
    is_reference = len(letters) == 1 and len(lefts) > 2 and not letters & frames
    return frozenset(letters if is_reference else ()).difference("0123456789")


def named_columns(equations: Iterable[Sides]) -> dict[str, int]:
    """Letters of the columns of a pose that a matrix of the text names, such as m, n, o and p."""
    for matrix in (matrix for equation in equations for side in equation for matrix in side.matrices):
        if len(rows := matrix.rows[:3]) < len(AXES) or {len(row) for row in rows} != {4}:
            continue
        cells = [(axis, taken_apart(cell.text)) for axis, row in zip(AXES, rows, strict=True) for cell in row]
        plain = [left.head if left and left.is_plain and left.sub == axis else "" for axis, left in cells]
        if "" not in plain and plain[:4] == plain[4:8] == plain[8:]:
            return {head: column for column, head in enumerate(plain[:4], 1)}
    return {}


def _named_cells(equation: Sides) -> tuple[list[Left], Counter[str]]:
    """Names among the sides of an equation, and how many cells of its matrices are a letter with their own place."""
    lefts = [left for side in equation if not side.matrices and (left := taken_apart(side.text))]
    grids = (side.matrices[0].rows for side in equation if side.text.strip(AROUND) == MATRIX_MARK)
    rows = [(i, row) for grid in grids for i, row in enumerate(grid, 1)]
    cells = [(f"{i}{j}", taken_apart(cell.text)) for i, row in rows for j, cell in enumerate(row, 1)]
    own = (left for at, left in cells if left and replace(left, primes=0).is_plain and left.sub == at)
    return lefts, Counter(left.head + PRIME * left.primes for left in own)


def named_entries(equations: Iterable[Sides]) -> Iterator[tuple[int, str, Left]]:
    r"""Letters for the entries of a matrix, from an equation on that names them: ``J^{-1} = [J_{11} ...]``."""
    for index, (lefts, heads) in enumerate(map(_named_cells, equations)):
        for head, count in heads.most_common(1):
            if lefts and count > 2 and lefts[0].head not in ("T", "A", "H", "R"):
                yield index, head, lefts[0]


def named_parts(equations: Sequence[Sides], meanings: Meanings) -> Iterator[tuple[int, Matrix | None]]:
    r"""Matrices of which n_x ... p_z are the entries from an equation on, where they are so of several in turn."""
    naming = ((i, e[0]) for i, e in enumerate(equations) if any(map(names_its_columns, e)))
    named = ((i, left) for i, side in naming if (left := taken_apart(side.text)))
    found = [(i, target) for i, left in named for target in meanings.targets(left)[:1] if not target.rows]
    usual = {target for _, target in found if target.quantity in ("T", f"T[0,{meanings.robot.n}]")}
    if len({target for _, target in found if target not in usual}) + bool(usual) > 1:
        for i, target in found:
            right = meanings.right(target) if target not in usual else None
            yield i, right.value if right else None


def entry_letters(equations: Iterable[Sides]) -> frozenset[str]:
    """Letters of the author's own for the entries of a rotation: ``R_6^3 = [m_{11} ...]``."""
    known = (heads for lefts, heads in map(_named_cells, equations) if any(left.head in "RTHA" for left in lefts))
    return frozenset(head for heads in known for head, count in heads.items() if count > 8) - {*"rRtT"}


def transforms(equations: Iterable[Sides]) -> set[str]:
    """Names of transforms that the text gives matrices, and that are no entries: ``T_{21} = [...]``."""
    lefts = (taken_apart(first.text) for first, *others in equations if any(side.matrices for side in others))
    return {left.flat for left in lefts if left and re.fullmatch("[TtRr][0-9]{2}", left.flat)}


def momenta(text: str, n: int) -> dict[str, int]:
    """Which momentum p_1 is, in a text with Hamilton's equations; none in another one."""
    is_hamiltons = re.search("[Hh]amilton|mathcal *[{]? *H|\u54c8\u5bc6", text)
    return {str(k): k for k in range(1, n + 1)} if is_hamiltons else {}


def by_angles_of_table(model: Model, text: str) -> Model | None:
    r"""A model with theta_2 as the whole cell of the table, where a text with angles theta says q_2 + \pi/2 of it."""
    robot, cells = model.robot, r"q_\{?(\d)\}?\s*[-+]\s*(?:\\[cdt]?frac\{?)?(?:\\pi|90)"
    told, moved = {f"q{k}" for k in re.findall(cells, text)}, {j.variable for j in robot.joints if j.theta != ZERO}
    if robot.is_tree or not told & moved or "\\theta_" not in text:
        return None
    joints = (replace(j, theta=ZERO if j.variable in told else j.theta) for j in robot.joints)
    return Model(replace(robot, joints=tuple(joints)), model.style)


# Other ways to count frames, as `Meanings` has them, and what the report says of each.
COUNTED = {"counts_world": "frame 0 is read as the world, frame 1 as the base of the robot"}
COUNTED |= {"counts_rows": "frames are counted by the rows of the table"}


def best(rights: Iterable[Right], table: Table) -> float:
    """The likeness of a table to what it is most like."""
    return max((right.fits(table) for right in rights), default=0.0)


def of_all(count: int, total: int) -> str:
    """How many matrices agree, in words."""
    return f"{count} of {total} matri{'ces' if total > 1 else 'x'}"


def are_sine_and_cosine(sine: Expression, cosine: Expression) -> bool:
    """Whether two formulas are sine and cosine of an angle all around the circle; sqrt(1 - c^2) is never negative."""
    rng, found = random.Random(0), list[tuple[float, float]]()
    for _ in range(_ANGLES_TRIED):
        at = {name: rng.uniform(-2, 2) for name in sorted({*names(sine), *names(cosine)})}
        with suppress(*NO_VALUE):
            found.append((float_value(sine, at), float_value(cosine, at)))
    is_circle = all(abs(s * s + c * c - 1) < _ROUNDING for s, c in found)
    return bool(found) and is_circle and min(s for s, _ in found) < 0 and min(c for _, c in found) < 0


def of_every_link(equations: Iterable[Sides], n: int) -> Iterator[tuple[str, LatexPiece]]:
    r"""Names that one equation with a letter for the link defines for each link: ``\omega_i = \dot\theta_i``."""
    for first, *others in equations:
        left = taken_apart(first.text) if len(others) == 1 and not (first.matrices or others[0].matrices) else None
        if left is None or not (left.is_plain and left.sub in ("i", "j", "k")) or "sum" in others[0].text:
            continue
        index = re.compile(rf"(?<=_){left.sub}(?![A-Za-z])|(?<=_\{{){left.sub}(?=\}})|(?<=_\{{[a-z]){left.sub}(?=\}})")
        for link in map(str, range(1, min(n, 9) + 1)) if index.search(others[0].text) else ():  # E_k is no E_1
            yield left.head + link, replace(others[0], text=index.sub(link, others[0].text))


def renamed(equations: Iterable[Sides], plain: LatexReader) -> dict[str, Expression]:
    r"""Joint variables by the author's letters for all of them: ``q = [x; \theta] = [q_1; q_2]``."""
    joints, found = [Name(joint.variable) for joint in plain.names.robot.movers], dict[str, Expression]()
    known = own_names(plain.names.robot)
    for equation in equations:
        columns = [s.cells if s.text.strip(AROUND) == MATRIX_MARK else listed(s) for s in equation]
        columns, are_joints = [cells for cells in columns if len(cells) == len(joints)], False
        for cells in columns:
            with suppress(CheckError):
                are_joints |= [plain.formula(cell) for cell in cells] == joints
        for cells in columns if are_joints else ():
            lefts = [taken_apart(cell.text) for cell in cells]
            pairs = ((x.flat, q) for x, q in zip(lefts, joints, strict=True) if x and x.is_plain and not x.sub)
            found |= {name: q for name, q in pairs if name not in known}
    return found


def opposes_gravity(texts: Iterable[str]) -> bool:
    r"""Whether an equation of motion in symbols has gravity with the torques, as in ``M \ddot q = \tau + g``."""
    sides = ["".join(_FONTS.sub("", text).split()) for text in texts]
    if len(sides) != 2 or not any("ddot" in side for side in sides) or re.search("[0-9]|sin|cos", "".join(sides)):
        return False
    signs = [(sign, "ddot" in side) for side in sides for sign in _GRAVITY.findall(side)]
    return any((sign == "-") == is_moving for sign, is_moving in signs)


def refuse_other_arm(robot: Robot, texts: Iterable[str], start: Location) -> None:
    """A document whose formulas name more joints than the robot has is about another arm."""
    n = robot.n
    if [joint_label(joint.variable) for joint in robot.movers] != [str(i) for i in range(1, n + 1)]:
        return
    named = [max(map(int, labels)) for text in texts if (labels := _JOINTS.findall(text))]
    if len(beyond := [label for label in named if label > n]) > 2 and 2 * len(beyond) > len(named):
        many = f"names joint {max(beyond)} in {len(beyond)} formulas, for {robot.name} with {n}"
        remedy = "give the robot that the document is about"
        raise CheckError(f"a document that {many}", remedy=remedy, location=start)


def other_capitals(robot: Robot, equations: Iterable[Sides], words: set[str]) -> frozenset[str]:
    """Names with a capital, given or asked for by an equation, that a text tells from those with a small letter."""
    small, names = words | own_names(robot), LatexNames(robot)
    found = set[str]()
    for equation in equations:
        lefts = [None if side.matrices else taken_apart(side.text) for side in equation]
        is_given = any(left is None and "_" in side.text for left, side in zip(lefts, equation, strict=True))
        found |= {left.flat for left in lefts if left is not None and left.is_plain and is_given}
    return frozenset(w for w in found if w != (other := w[0].lower() + w[1:]) and other in small and names.knows(other))


def torque_index(texts: Iterable[str]) -> int | None:
    """Which index of a Christoffel symbol is that of the torque: that of the variable of the subtracted derivative."""
    first, *others = texts
    symbol = _SYMBOL.fullmatch("".join(first.split()))
    minus = next(filter(None, map(_SUBTRACTED.search, others)), None)
    if symbol is None or minus is None:
        return None
    letters = symbol[1].replace(",", "")
    return letters.index(minus[1]) if minus[1] in letters else None


def is_no_claim(piece: LatexPiece) -> bool:
    """Whether a side says how a matrix is made, by the names of its entries or by derivatives."""
    if _LIST_OF_NAMES.fullmatch("".join(piece.text.split())):
        return True
    return names_its_columns(piece) or (bool(piece.cells) and all("\\partial" in cell.text for cell in piece.cells))


def other_factorisation(model: Model, findings: tuple[Finding, ...]) -> tuple[Finding, ...]:
    """C is not unique: printed rows with the right C qd are right; of a whole C it is said whether its N is skew."""
    entries = {(f.row, f.column): f for f in findings if f.quantity == "C" and f.question is not None}
    places = range(1, model.n + 1)
    rows = [i for i in places if all((i, j) in entries for j in places)]
    if not (wrong := [i for i in rows if not all(entries[i, j].verdict.equal for j in places)]):
        return findings
    rates = [Name(velocity_name(joint.variable)) for joint in model.robot.movers]
    velocity_torques, rate = model.quantity("Cqd"), model.quantity("Bdot")
    printed = {place: f.question.printed for place, f in entries.items() if f.question is not None}

    def is_right(i: int) -> bool:
        torque = add(*(multiply(printed[i, j], rates[j - 1]) for j in places))
        return compare(model.robot, expression_from_sympy(velocity_torques[i - 1]), torque).equal

    other = [i for i in wrong if is_right(i)]
    is_ours = sum(f.verdict.equal and f.right != 0 for f in entries.values()) >= len(entries) / 2
    for i in () if is_ours else set(wrong) - set(other):
        cause = f"row {i} times qd is not row {i} of C qd; which of its entries is wrong is not certain"
        slips = {f for f in findings if f.quantity == "C" and f.row == i and not f.verdict.equal and not f.cause}
        if len({f.column for f in slips}) > 1:
            findings = tuple(replace(f, cause=cause) if f in slips else f for f in findings)
    note = ", another factorisation with the same C qd"
    if len(rows) == model.n and other == wrong:
        # of N = Bdot - 2 C, which is skew where Bdot = C + C^T
        pairs = [(rate[i - 1, j - 1], add(printed[i, j], printed[j, i])) for i, j in product(places, repeat=2)]
        is_skew = all(compare(model.robot, expression_from_sympy(e), both).equal for e, both in pairs)
        note += f"; its N is{'' if is_skew else ' not'} skew-symmetric"
        other = rows
    equal = Verdict(equal=True, exact=True)
    return tuple(replace(f, verdict=equal, note=note) if f.quantity == "C" and f.row in other else f for f in findings)


def uncertain_entries(findings: tuple[Finding, ...], n: int) -> frozenset[Finding]:
    """Wrong entries of C in rows that are not printed as a whole, which may be those of another factorisation."""
    entries = [f for f in findings if f.quantity == "C" and f.row and f.column]
    wrong = [f for f in entries if not f.verdict.equal]
    if sum(f.verdict.equal and f.right != 0 for f in entries) >= len(wrong):  # the text has this factorisation
        return frozenset()
    columns = {row: {f.column for f in entries if f.row == row} for row in range(1, n + 1)}
    return frozenset(f for f in wrong if len(columns[f.row]) < n)


def one_cause(right: Right, table: Table) -> str:
    """What makes a whole printed matrix right, where one change does; empty where none does."""
    values = at_a_point(*(entry.formula for entry in table.entries), *map(expression_from_sympy, right.value))
    if not values:
        return ""
    wanted, printed = np.reshape(values, (2, *table.shape))[::-1]
    changes = ((cause, a) for cause, a in _changes(printed) if a.shape == wanted.shape)
    return next((cause for cause, a in changes if np.allclose(a, wanted, rtol=ALIKE, atol=ALIKE)), "")


def _changes(a: npt.NDArray[np.float64]) -> Iterator[tuple[str, npt.NDArray[np.float64]]]:
    """Slips that concern a matrix as a whole, and the matrix without them."""
    yield "the matrix is transposed", a.T
    yield "the sign of all entries", -a
    if a.shape == (4, 4):
        turned = a.copy()
        turned[:3, :3] = a[:3, :3].T
        yield "the rotation is transposed", turned
    for axis, word in enumerate(("row", "column")):
        for i in range(a.shape[axis]):
            signs = np.where(np.arange(a.shape[axis]) == i, -1.0, 1.0)
            yield f"the sign of {word} {i + 1}", a * (signs[:, None] if axis == 0 else signs)
        for i, j in combinations(range(a.shape[axis]), 2):
            order = np.arange(a.shape[axis])
            order[[i, j]] = j, i
            yield f"{word}s {i + 1} and {j + 1} are exchanged", np.take(a, order, axis)


def divided_rows(robot: Robot, findings: tuple[Finding, ...]) -> tuple[Finding, ...]:
    """Rows of B, C qd and g that are right but for what the text has divided the equation of motion of the row by."""
    equations = (re.fullmatch(r"tau\[(?P<row>\d)\]/\((?P<by>.+)\)", f.quantity) for f in findings if f.verdict.equal)
    factors = {int(match["row"]): match["by"] for match in equations if match}

    def mended(f: Finding) -> Finding:
        if f.quantity not in ("B", "Cqd", "g") or f.row not in factors or f.question is None:
            return f
        right, factor = f.question.right, parse_expression(factors[f.row], f.location)
        is_right = not f.verdict.equal and compare(robot, right, multiply(f.question.printed, factor)).equal
        note = f", of the equation divided by {factors[f.row]}"
        return replace(f, verdict=Verdict(True, True), note=note, cause="", question=None) if is_right else f

    return tuple(map(mended, findings)) if factors else findings


def constrains(one: Expression, other: Expression, moving: AbstractSet[str], parameters: AbstractSet[str]) -> bool:
    """Whether an equation gives a joint variable, or its rate, by other ones and parameters: a condition."""
    if not isinstance(one, Name) or one.name not in moving:
        return False
    if isinstance(other, Sum) and all(term == one or is_constant(term) for term in other.terms):
        return True  # theta_2 = q_2 - pi/2, the offset of the table
    if isinstance(other, Call) and other.function == "atan2" and not moving.isdisjoint(names(other)):
        return False  # theta_5 = Atan2(s_6, c_6), a solution
    return {*names(other)} <= (parameters | moving) - {one.name}


def is_shifted(name: str, equations: Iterable[Sides]) -> bool:
    """Whether a joint variable with primes is an angle of a figure, as theta_2 = theta_2' + pi/2 says."""
    joint = re.sub(r"[\s']|\^?\{?\\prime\}?", "", name)
    return any(e[1:] and "".join(e[0].text.split()) == joint and name.strip() in e[1].text for e in equations)


def is_force(side: LatexPiece, rest: str, equations: Iterable[Sides]) -> bool:
    """Whether a side is a name behind an equation of motion that no other equation has."""
    having = [e for e in equations if any(side.text.strip() in other.text for other in e)]
    return "\\ddot" in rest and len(having) == 1 and having[0][0] is not side


def unused(defined: Iterable[Defined], equations: Sequence[Sides], compared: set[int]) -> Iterator[Defined]:
    """Definitions that no formula uses which is compared, neither itself nor by what it defines."""
    waiting, live, own = list(defined), compared, dict[Defined, str]()
    for one in waiting:  # an angle is used by its cosine as well
        name = one[3].text.strip()
        own[one] = angle["angle"] if (angle := OF_ANGLE.fullmatch(name)) else name
    while live:
        texts = [text for i in live for side in equations[i] for text in side.texts]
        used = [one for one in waiting if any(own[one] in text for text in texts)]
        waiting, live = [one for one in waiting if one not in used], {index for _, index, _, _ in used}
    yield from (one for one in waiting if not one[3].inline)
