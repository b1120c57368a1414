"""What the sides of one printed equation say: quantities by their names, formulas, matrices, products of transforms."""

import re
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace
from functools import cached_property, partial, reduce
from itertools import chain, pairwise
from operator import mul

from derive.checking.any_row import ANY_ROW, misprints
from derive.checking.chains import between, chained, factors, frames_of, has_all_exponentials
from derive.checking.formulas.diagnosis import PAIRED, Question, Repair
from derive.checking.formulas.edits import SlipKind
from derive.checking.formulas.findings import NOTHING_KNOWN, Finding, Role, compared, judge
from derive.checking.latex.comparing import ANY, Comparing, Side
from derive.checking.latex.conditions import ways
from derive.checking.latex.equations import Sides, listed
from derive.checking.latex.left import AXES, Left, taken_apart
from derive.checking.latex.matrices import Entry, Table
from derive.checking.latex.matrix_names import MatrixNames, are_alike
from derive.checking.latex.names import Symbol
from derive.checking.latex.pieces import AROUND, MATRIX_MARK, LatexPiece
from derive.checking.latex.poses import names_of_pose
from derive.checking.latex.scope import Scope
from derive.checking.latex.targets import Target, is_scalar
from derive.checking.latex.whole import is_no_claim
from derive.errors import CheckError, UnknownNameError, quoted
from derive.lecture.sympy_conversion import expression_from_sympy, expression_to_sympy
from derive.model.equality import Verdict, compare
from derive.robot import expression as tree
from derive.robot.expression import ZERO, Expression, Name, Number, add, is_constant, names, negate, number, substitute

_PLAIN = re.compile(r"\\(?:mathbf|boldsymbol|bm|vec|mathrm)(?![A-Za-z])|[{}]")
_SPAN = re.compile(r"[pPoO]_?([0-9en])-[pPoO]_?([0-9])")  # p_3 - p_0
_MARKUP = re.compile(r"\\(?:math[a-z]+|boldsymbol|bm|vec)|[\s{}()\[\]]")
_LAGRANGE = re.compile(r"\\dot\\[dt]?frac\\partial(\w)\\partial\\dotq-\\[dt]?frac\\partial\1\\partialq")
_SINGULAR = re.compile(
    r"(?i)\\det\b|sing[uo]la|\u5947[\u5f02\u7570]|\u7279\u7570|\ud2b9\uc774|\u043e\u0441\u043e\u0431"
)
_IDENTITY = re.compile(r"(?:I|\\mathbb1|\\mathbb\{?I\}?)_?[1-6]?(?:\\times[1-6])?")
MOVING_JOINTS = 3  # joints of an arm whose equations of motion are written out


class SideReading(Comparing):
    """Reads the sides of the equations of one text."""

    def __init__(self, scope: Scope, quantity: str) -> None:
        super().__init__(scope, quantity)
        self.reader = scope.reader(0)
        self._figures: dict[str, str] = {}  # lengths and angles that names must be for their formulas to be right
        self._matrices = MatrixNames(scope.meanings, self.reader, scope.equations if scope.document else ())

    def _multiplied(self, named: list[Side], side: Side) -> Finding | None:
        """The verdict on a product of transforms; a wrong one where matrices of the text settle the frames."""
        frames = {frames_of(target, self.robot): target for name in named for target in name.targets}
        whole = [target for target in frames.values() if target.quantity == "T"]  # also without the base and the tool
        frames |= dict.fromkeys([(0, self.robot.n)], whole[0]) if whole else {}
        if not side.factors or not named:
            return None
        # they lead from the one to the other frame of what is named
        if side.frames is not None and side.frames in frames:
            return replace(self._about(side.piece, frames[side.frames].quantity, Verdict(True, True)), same=True)
        is_settled = any(name.left is None or name.left.scripts in self.scope.settled for name in named)
        if side.frames is not None and side.frames[::-1] in frames and not is_settled:
            return replace(self._about(side.piece, between(*side.frames, self.robot), Verdict(True, True)), same=True)
        rights = [next(iter(self.scope.rights_read(left, self.meanings.reading)), None) for left in side.factors]
        wanted, shapes = next(self._meant(named[0]), None), {right.value.shape for right in rights if right is not None}
        if wanted is None or None in rights or shapes != {wanted.value.shape}:
            return None
        product = reduce(mul, (right.value for right in rights if right is not None))
        table = Table(tuple(tuple(Entry(expression_from_sympy(e)) for e in row) for row in product.tolist()))
        if wanted.fits(table) == 1:
            return self._about(side.piece, wanted.quantity, Verdict(True, False))
        lefts = [name.left for name in named if name.left is not None]
        kinds = {left.scripts for left in (*lefts, *side.factors)} - {None}
        if not lefts or lefts[0].scripts not in self.scope.settled or len(kinds) != 1:
            return None
        repair = Repair((), "the order of the factors: each begins at the frame to which the one before it leads", ZERO)
        return self._about(side.piece, wanted.quantity, NOTHING_KNOWN, repair=repair)

    def _by_names(self, side: Side, named: list[Side], said: list[Side]) -> Finding | None:
        """That a formula with names of matrices is equal to what stands beside it; None where that is not known."""
        is_open = isinstance(side.value, Table) and any(entry.unknown for entry in side.value.entries)
        is_name = side.left is not None and not side.left.factor  # which says nothing about what it stands for
        if not (side.error or is_open) or is_name or not self.document:
            return None
        rights = [right for name in named for target in name.targets if (right := self.meanings.right(target))]
        printed = [other.value for other in said if isinstance(other.value, Table)]
        poses = self.scope.poses.readings if self.scope.poses else []  # [x y z]^T = R p + t
        tables = printed + [t.changed(partial(substitute, values=pose.values)) for pose in poses for t in printed]
        found = self._matrices.values(side.piece)
        with suppress(CheckError):  # entries of an inertia tensor that drop out
            found = chain(self._with_letters(0, (side.piece,), {}, "I.+")[0], found)
        for table in found:
            # zeros times anything are zeros: they show nothing
            quantity = next((r.quantity for r in rights if r.fits(table) == 1 and any(r.value)), "")
            if quantity or any(are_alike(table, other) for other in tables):
                finding = self._about(side.piece, quantity or self._typed(side.piece), Verdict(True, False))
                return finding if quantity else replace(finding, role=Role.IDENTITY)
        return None

    def otherwise(self, index: int, equation: Sides) -> tuple[Finding, ...]:
        """What can be said of an equation that is not read as it stands."""
        if re.match(r"\s*T\b", equation[0].text) and any(has_all_exponentials(s.text, self.robot.n) for s in equation):
            return (self._about(equation[0], "T", Verdict(True, True)),)
        found = self._home(equation) or self._of_any_row(index, equation)
        found = found or self._singular(equation) or self._of_motion(equation)
        return found or (*self._sides_by_value(equation),) or self._of_unknown(index, equation)

    def _home(self, equation: Sides) -> tuple[Finding, ...]:
        """That a place or a frame is right where all joint variables are zero: r_1(0) = [...], M = [...]."""
        left = taken_apart(equation[0].text)
        with suppress(CheckError):
            value = self.reader.value(equation[-1])
            is_home = left and (left.arguments == "(0)" or left.flat == "M")
            if left and is_home and isinstance(value, Table) and (quantity := self._values.at_home(value, left)):
                found = self._about(equation[-1], quantity, Verdict(True, False))
                return (replace(found, note=", with all joint variables zero"),)
        return ()

    def _of_any_row(self, index: int, equation: Sides) -> tuple[Finding, ...]:
        """That a matrix with letters is that of any row of the table, or differs from it in one entry."""
        with suppress(CheckError):
            (table,), letters = self._with_letters(index, equation[-1:], {})
            entries = misprints(table, letters, self.robot.convention)
            right = Verdict(entries == [], exact=False)
            cause = f"entry {entries[0]}, for a row is {ANY_ROW[self.robot.convention]}" if entries else ""
            repair = Repair((), cause, ZERO) if cause else None
            return (self._about(equation[0], "A[i]", right, repair),) if entries is not None else ()
        return ()

    def _singular(self, equation: Sides) -> tuple[Finding, ...]:
        """That the arm is singular where an equation holds, as the sentence around it says."""
        first, *others = equation
        around = self.text[max(first.start - 200, 0) : equation[-1].end + 200]
        if len(others) == 1 and _SINGULAR.search(around) and "det" not in first.text:
            with suppress(CheckError):
                zero = add(self.reader.formula(first), negate(self.reader.formula(others[0])))
                if not names_of_pose(zero) and self._values.is_singular(zero):
                    return (self._about(first, "singularities", Verdict(True, False)),)
        return ()

    def _of_motion(self, equation: Sides) -> tuple[Finding, ...]:
        """That an equation of motion is right, or has one slip, whatever the author calls the torque."""
        formulas: list[Expression] = []
        for side in equation:
            with suppress(CheckError):
                if not (left := taken_apart(side.text)) or left.dots:  # a name such as tau is right by itself
                    formulas.append(self.reader.formula(side))
        if self._accelerations.isdisjoint(name for value in formulas for name in names(value)):
            return ()
        values = [*formulas, *(add(a, negate(b)) for a, b in pairwise(formulas))]
        text, where = " = ".join(map(self._typed, equation)), self.plain.location(equation[0].start)
        for quantity in (self._values.quantity(value, None) for value in values):
            if quantity.startswith(("tau", "-tau")):
                return (Finding(quantity, 0, 0, Role.PRINTED, text, Verdict(True, False), "", where),)
        is_known = self.robot.has_dynamics and self.robot.n <= MOVING_JOINTS
        quantity, right = self._values.motions.meant(values[-1]) if is_known else ("", None)
        if right is None:
            return ()
        question = Question(self.robot, values[-1], right)
        found = compared(question, quantity, (0, 0), Role.PRINTED, text, expression_to_sympy(right), where)
        # a letter that cannot be read may be a force between two bodies, and the equation that of one of them
        known = {*SlipKind} if len(formulas) == len(equation) else {*PAIRED}
        repair = judge(found).repair
        return (found,) if found.verdict.equal or (repair and known.issuperset(repair.kinds)) else ()

    def _sides_by_value(self, equation: Sides) -> Iterator[Finding]:
        """What sides of an equation are by their values beside a name, or a matrix of names, of the author's own."""
        for first, others in ((equation[0], equation[1:] or equation), (equation[-1], equation[:-1])):
            # a display without a name, as words before it say what it is
            is_lone = len(equation) == 1 and not (first.inline and first.text.strip(AROUND) != MATRIX_MARK)
            is_lone |= len(equation) == 1 and bool(listed(first))
            if not is_lone and (len(equation) == 1 or not self._is_own_name(first, is_first=first is equation[0])):
                continue
            for side in others:
                are_names = all(taken_apart(cell.text) for cell in side.cells or (side,))
                if are_names and (side.matrices or len(others) == 1):
                    continue
                with suppress(CheckError):
                    where = self.plain.location(side.start)
                    value = next(self._matrices.values(side), None) or self.reader.value(side)
                    if found := self._by_value(value, "" if is_lone else first.text, self._typed(side), where):
                        yield found
            return

    def _is_own_name(self, side: LatexPiece, *, is_first: bool) -> bool:
        """Whether a side that cannot be read is a name, or a matrix of names, or one of coordinates of a point."""
        if side.matrices and all((left := taken_apart(cell.text)) and left.is_point for cell in side.cells):
            return True
        with suppress(CheckError):
            value = self.reader.value(side)
            if not isinstance(value, Table) or not any(entry.unknown for entry in value.entries):
                return False
        if side.matrices:  # v_x is that of the end effector
            lefts = (taken_apart(cell.text) for cell in side.cells)
            return all(left and (left.head == "Q" or left.sub not in AXES) for left in lefts)
        # beside a sum that cannot be read, the value of the other side says nothing
        tight = re.sub(r"\{[^{}]*\}|\([^()]*\)", "", side.text).strip(" -")
        return not re.search("[-+]", tight) if is_first else taken_apart(side.text) is not None

    def _with_letters(
        self, index: int, pieces: Sides, own: dict[str, Expression], kind: str = ".+"
    ) -> tuple[list[Table], list[str]]:
        """What pieces say, and the names of a kind in them that stand for themselves."""
        while True:
            reader = self.scope.reader(index, own)
            try:
                values = [reader.value(piece) for piece in pieces]
                tables = [value if isinstance(value, Table) else Table(((Entry(value),),)) for value in values]
                if unknown := next((e.unknown for table in tables for e in table.entries if e.unknown), None):
                    raise unknown
            except UnknownNameError as error:
                if (name := re.search(f"'({kind})'", error.found)) is None or name[1] in own:
                    raise
                own = own | {name[1]: Name(f"?{name[1]}")}
            else:
                used = {name for table in tables for entry in table.entries for name in names(entry.formula)}
                return tables, sorted(name[1:] for name in used if name[0] == "?")

    def _of_unknown(self, index: int, equation: Sides) -> tuple[Finding, ...]:
        """That a formula is right if what no formula explains are torques, a length, an angle, or a constant energy."""
        definitions = ((name, {e for _, e in found}) for name, found in self.scope.definitions.items())
        several = {n: Name(f"?{n}") for n, found in definitions if len(found - {*filter(is_constant, found)}) > 1}
        left = taken_apart(equation[0].text)
        energy = self.meanings.formula(left, ("potential",)) if left else None
        moves = energy and not self.joints.keys().isdisjoint(names(energy))
        known = {left.flat: energy} if left and energy and moves else {}
        for given in ({}, several) if len(equation) > 1 else ():
            with suppress(CheckError, ArithmeticError):  # a reading may divide by what is zero
                (first, other), letters = self._with_letters(index, (equation[0], equation[-1]), given | known)
                pairs = list(zip(first.entries, other.entries, strict=first.shape == other.shape))
                zeros = [add(a.formula, negate(b.formula)) for a, b in pairs]
                if first.shape != other.shape or are_alike(first, other):
                    continue  # what a name is given there
                (note, *more), zero = {self._values.motions.driven(zero, letters) for zero in zeros}, zeros[0]
                if known and letters:
                    still = add(zero, negate(substitute(zero, dict.fromkeys(self.joints, ZERO))))
                    ways = (dict.fromkeys((f"?{letter}" for letter in letters), number(k)) for k in (0, 1, 3))
                    is_still = all(compare(self.robot, substitute(still, way), ZERO).equal for way in ways)
                    note = "up to a constant" if is_still else note
                if not note and len(letters) == 1 and len(equation) == 2 and len(zeros) == 1:
                    meant = self._values.solved(f"?{letters[0]}", zero)
                    if meant and self._figures.setdefault(letters[0], meant) == meant:  # in all formulas the same
                        note = f"where {letters[0]} is {meant}"
                if note and not more:
                    (text, *_, said), where = map(self._typed, equation), self.plain.location(equation[0].start)
                    found = Finding(text, 0, 0, Role.IDENTITY, said, Verdict(True, False), "", where, note=f", {note}")
                    return (found,)
        return ()

    def identity(self, side: Side, first: Side) -> Side:
        """A side, where it is the letter of an identity matrix with the matrix in the shape of the first side."""
        is_identity = side.value is None and _IDENTITY.fullmatch("".join(_PLAIN.sub("", side.piece.text).split()))
        table = self._constant_matrix([first], True) if is_identity and self.document else None
        return side if table is None else Side(side.piece, value=table)

    def side(self, piece: LatexPiece, may_name: bool, *, has_points: bool = False) -> Side:
        """What a side says, or names if it may."""
        is_formula = piece.matrices or (not may_name and "\\partial" in piece.text)
        left = None if is_formula else taken_apart(piece.text)
        joint = self._branch_of(left) if left is not None else None
        if left is not None and joint is None and left.sup.isdigit() and replace(left, sup="").is_plain:
            known = self.plain.names  # a_1^2 is a power of a symbol of the robot
            left = None if left.flat in known.own or (left.head in "dq" and known.knows(left.flat)) else left
        targets = self.meanings.targets(left) if left else ()
        if may_name and has_points and left is not None and left.is_plain and left.flat in self.scope.definitions:
            targets = ()  # ... = h, where the text says what h is
        if has_points and left is not None and left.head in AXES:
            targets = tuple(filter(is_scalar, targets))
        if left is not None and left.dots and self.scope.is_own(replace(left, dots=0)):
            targets = tuple(target for target in targets if not target.by)  # the rate of a joint, not of a vector
        if may_name and left is None and (span := _SPAN.fullmatch("".join(_PLAIN.sub("", piece.text).split()))):
            places = [self.robot.n if end.isalpha() else int(end) for end in (span[1] or "e", span[2] or "e")]
            if max(places) <= self.robot.n:
                quantity = f"p[{places[0]}]-p[{places[1]}]"
                return Side(piece, None, (Target(quantity), Target(quantity, (1, 2))))
        if may_name and left is None and (product := factors(piece.text)):
            error = self._refused(piece, "a product of matrices", "multiply it out")
            frames = chained(self.meanings, product)
            # a chain names the transform from its first frame to its last one, such as T_1^0 T_2^1 = [...]
            parts = ((), (1, 2, 3), (1, 2)) if product[0].head == "R" else ((), (1, 2, 4), (1, 2, 3))
            targets = tuple(Target(between(*frames, self.robot), part, part) for part in parts) if frames else ()
            return Side(piece, None, targets, error=error, frames=frames, factors=product)
        if may_name and joint is not None:
            is_other = left is not None and self._label(left) in self._same_pose
            return Side(piece, left, (), joint, is_branch=True, keeps_pose=is_other)
        if left is None and has_all_exponentials(piece.text, self.robot.n):
            error = self._refused(piece, "a product of exponentials or of all rows")
            return Side(piece, error=error, factors=(Left("T"),), frames=frames_of(Target("T"), self.robot))
        if may_name and left is None and re.search(r"\\(?:partial|nabla)", piece.text):
            with suppress(CheckError):
                return Side(piece, value=self.reader.value(piece))
            is_lagrange = _LAGRANGE.fullmatch(_MARKUP.sub("", piece.text))
            if targets := (Target("tau"),) if is_lagrange else self.meanings.derivatives(piece.text):
                return Side(piece, None, targets)
        if may_name and left is not None:
            # a coordinate of a point, or an entry of a rotation: which frame is meant is settled by all of them
            is_open = (left.is_point or left.labelled or re.fullmatch("[rR][1-3]{2}", left.flat)) and not left.dots
            if (point := self._stands_for(left) if has_points and is_open else None) is not None:
                return Side(piece, left, (), point)
            is_screw = not has_points and any("screw" in target.quantity for target in targets)  # S_1 is a sine, too
            if targets and (is_screw or not self.scope.is_own(left)):
                return Side(piece, left, targets)
        try:
            return Side(piece, left, targets, self.reader.value(piece))
        except CheckError as error:
            return Side(piece, left, targets, error=error)

    def _stands_for(self, left: Left) -> Expression | None:
        """What stands for a name of the pose or of a point until it is known which one is meant."""
        poses = self.scope.poses
        return None if poses is None or self.scope.is_own(left) else poses.placeholder(left.labelled or left.flat)

    def claiming(self, index: int, equation: Sides) -> list[LatexPiece]:
        """The sides that say something: neither names that the text defines nor how a matrix is made."""
        if self.document and (left := taken_apart(equation[0].text)) and left.arguments == "(0)":
            raise self._refused(equation[0], f"{quoted(self._typed(equation[0]))} is a value at the start")
        pieces = [piece for piece in equation if (index, piece.offset) not in self.scope.names]
        if len(pieces) == 1 < len(equation):  # h = K, which says what K is: compared with what else says so
            return []
        if len(pieces) > 2:
            pieces = [piece for piece in pieces if not self._names_new_entries(piece)]
        if len(pieces) > 1 and any(map(is_no_claim, pieces)):
            pieces = [piece for piece in pieces if not is_no_claim(piece)]
            if len(pieces) < 2 and not any(piece.matrices for piece in equation):
                return []
            if len(pieces) < 2:
                raise self._refused(equation[-1], "a matrix that gives names to the entries of a pose")
        # T(alpha, a, d, theta) between a name and its matrix says how the matrix is made
        kept = [p for p in pieces if p.matrices or not ((left := taken_apart(p.text)) and left.is_of_parameters)]
        return kept if len(kept) > 1 and any(piece.matrices for piece in pieces) else pieces

    def _names_new_entries(self, piece: LatexPiece) -> bool:
        """Whether a side is a matrix of names that nothing knows, between what it is and what they stand for."""
        lefts = [taken_apart(cell.text) for cell in piece.cells]
        if piece.text.strip(AROUND) != MATRIX_MARK or len(lefts) < 2:
            return False
        return all(left and left.sub and not left.dots and not self.scope.is_own(left) for left in lefts)

    def _branch_of(self, left: Left) -> Expression | None:
        r"""The joint variable in ``\theta_2'``, ``\theta_{2,1}`` or ``q_{3a}``; None of another left side."""
        match = re.fullmatch(r"(?P<joint>[0-9]+)(?:,?(?:[ab+-]|I{1,3}|IV|up|down|d|des|ref)|,[1-8])?", left.sub)
        is_labelled = match is not None and (left.primes or left.sup or match["joint"] != left.sub)
        if not self.document or match is None or not is_labelled or left.dots:
            return None
        name = Symbol(left.head + match["joint"], 0)
        is_joint = left.head in ("theta", "q", "d") and not (left.primes and left.flat in self.scope.definitions)
        meaning = self.plain.names.meaning(name) if is_joint and self.plain.names.knows(name.text) else None
        if not isinstance(meaning, Name) or meaning.name not in self.joints:
            return None
        if left.sup.isdigit() and not self.joints[meaning.name].is_revolute:
            return None  # a power of a slide
        cells = (e for _, e in self.scope.definitions.get(name.text, ()) if {*names(e)} == {meaning.name})
        return next(cells, meaning)  # \theta_4 = -q_4, the cell of the table

    @cached_property
    def _same_pose(self) -> frozenset[str]:
        r"""Labels of solutions that move some joints and not the end effector: \theta_4' = \theta_4 + \pi, ..."""
        solutions: dict[str, dict[str, Expression]] = {}
        for first, *others in self.scope.equations:
            left = taken_apart(first.text) if others else None
            joint = self._branch_of(left) if left is not None else None
            with suppress(CheckError):
                if left is not None and joint is not None and (value := self.reader.formula(others[-1])) != joint:
                    (name,) = self.joints.keys() & {*names(joint)}
                    is_opposed = negate(Name(name)) in (joint.terms if isinstance(joint, tree.Sum) else (joint,))
                    moved = add(negate(joint), value)
                    moved = add(Name(name), negate(moved) if is_opposed else moved)
                    solutions.setdefault(self._label(left), {})[name] = moved
        known, keeps = self.joints.keys() | self.parameters, self._values.keeps_pose
        own = {x: v for x, v in solutions.items() if known.issuperset(n for e in v.values() for n in names(e))}
        return frozenset(label for label, values in own.items() if len(values) > 1 and keeps(values))

    @staticmethod
    def _label(left: Left) -> str:
        return left.head + left.sup + "'" * left.primes + re.sub("^[0-9],?", "", left.sub)

    def _naming(self, sides: list[Side], has_no_matrix: bool) -> list[Side]:
        """The sides that name quantities; conditions in their arguments are kept."""
        for side in sides:
            for part in side.left.arguments.strip("{}()").split(",") if side.left is not None else ():
                if "=" in part:  # J(theta_2 = 0)
                    with suppress(CheckError):
                        values = [self.plain.formula(LatexPiece(text, 0)) for text in part.split("=")]
                        self._states(side.piece, part, ways(values), is_of_side=True)
        first, *others = sides
        named = [s for s in sides if s.targets and (s.value is None or (s is first and others))]
        if not any(isinstance(s.value, Table) and len(s.value.entries) == 6 for s in sides):  # B_1 may be anything
            named = [s for s in named if not all("screw" in t.quantity and len(t.rows) != 3 for t in s.targets)]
        if has_no_matrix:  # a length of the robot, not a vector with its letter
            is_own = first.left is not None and not first.left.arguments and self.scope.is_own(first.left)
            is_length = is_own and not any(map(is_scalar, first.targets))
            named = [s for s in named if s is not first or not is_length]
        named = [side for side in named if not side.factors] or named[:1]  # a product beside what it is says how
        if has_no_matrix and isinstance(first.value, Name) and first.value.name in self.joints:
            named = [side for side in named if side is not first]  # d_3 is the joint, not the vector to frame 3
        # a partial derivative says which entry J_21 is, and r_1 = p_3 - p_0 what r_1 is
        named = [s for s in named if not (s.left and re.fullmatch(r"J\d\d", s.left.flat + s.left.arguments))] or named
        named = [side for side in named if side.left is None] or named
        return [side for side in named if side.left is None or side.left.head not in ANY] or named

    def _said(self, side: Side, derived: bool) -> Side:
        """What a side says that names a quantity, too: its formula, or else what is derived for it."""
        if (read := self.side(side.piece, False)).value is not None or not derived:
            return read
        rights = (self.meanings.right(target) for target in side.targets)
        if (value := next((right.value for right in rights if right is not None), None)) is None:
            return read
        rows = (tuple(Entry(expression_from_sympy(entry)) for entry in row) for row in value.tolist())
        return Side(side.piece, value=Table(tuple(rows)))

    def _named_cells(self, first: Side, second: Side) -> list[tuple[Side, Entry]]:
        """Cells of a matrix of names beside those of the matrix that says what they are."""
        cells = first.piece.cells
        if first.piece.text.strip(AROUND) != MATRIX_MARK or not isinstance(second.value, Table):
            return []
        lefts, entries = [taken_apart(cell.text) for cell in cells], second.value.entries
        targets = [tuple(filter(is_scalar, self.meanings.targets(left))) if left else () for left in lefts]
        if len(cells) != len(entries) or not all(targets):
            return []
        return [(Side(c, x, t), e) for c, x, t, e in zip(cells, lefts, targets, entries, strict=True)]

    def _is_configuration(self, side: Side, table: Table) -> bool:
        """Whether theta = (0, 0, 0) gives all joints a value, which is a condition then."""
        cells, left = [entry.formula for entry in table.entries], side.left
        is_all = left is not None and left.head in ("theta", "q") and left.is_plain and not left.sub
        if not is_all or len(cells) != len(self.joints) or not all(map(is_constant, cells)):
            return False
        end = self.text.find("$", side.piece.start)
        values = dict(zip(self.joints, cells, strict=True))
        self._states(side.piece, " ".join(self.text[side.piece.start : end].split()), (values,))
        return True

    def _refuse_example(self, side: Side, findings: tuple[Finding, ...]) -> None:
        """Numbers in a document belong to an example at values of the joints that are not known here."""
        entries = [e.formula for e in side.value.entries] if isinstance(side.value, Table) else [side.value]
        decimals = [e for e in entries if e is not None and is_constant(e) and e not in (ZERO, number(1), number(-1))]
        # a whole matrix of numbers for one that moves, such as that of the home position
        rights = [f.question.right for f in findings if f.question and "screw" not in f.quantity]
        moves = not all(map(is_constant, rights))
        still = frozenset() if self.conditions else self.parameters - self._moving
        is_example = len(entries) > 1 and moves and all(e is not None and still.issuperset(names(e)) for e in entries)
        is_of_pose = moves and all(finding.quantity[:1] in "Tp" or finding.quantity == "tau" for finding in findings)
        is_condition = side.piece.inline and is_of_pose and len(entries) == 1 and isinstance(entries[0], Number)
        if self.document and (len(decimals) * 2 > len(entries) or is_example or is_condition):
            what = "a matrix of numbers" if len(entries) > 1 else quoted(self._typed(side.piece))
            raise self._refused(side.piece, f"{what} is a numeric example")
