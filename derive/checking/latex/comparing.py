"""The sides of one printed equation against each other, and against the quantities that they name."""

import re
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import product

from derive.checking.by_value import ByValue
from derive.checking.formulas.branches import SIGN
from derive.checking.formulas.diagnosis import RENAMED, Question, Repair, other_orders
from derive.checking.formulas.edits import float_value
from derive.checking.formulas.findings import NOTHING_KNOWN, Finding, Role, compared, judge, undecidable
from derive.checking.latex.conditions import AMONG, DECIMALS, DIGITS, ROUGHLY, Condition, Values, ways
from derive.checking.latex.left import AXES, Left, taken_apart
from derive.checking.latex.matrices import Entry, Table
from derive.checking.latex.meanings import Right
from derive.checking.latex.pieces import LatexPiece
from derive.checking.latex.poses import Claim, Poses, names_of_pose
from derive.checking.latex.scope import ANGLES, Scope
from derive.checking.latex.targets import Target
from derive.checking.latex.whole import constrains, one_cause
from derive.errors import CheckError, Location, quoted
from derive.lecture.shorthand import notation_text
from derive.lecture.sympy_conversion import expression_from_sympy
from derive.model.equality import Verdict, compare
from derive.robot import expression as tree
from derive.robot.expression import ZERO, Call, Expression, Name, Pi, Sum, is_constant, names, negate, substitute
from derive.robot.names import acceleration_name, own_names, velocity_name

ANY = frozenset("fFhkKuvwQeVLWS")  # letters for anything: they contradict no quantity that is asked about
VAGUE = 0.6  # part of the entries that must be right for a letter without indices to name a matrix
MOVING = 6  # entries with symbols of a matrix that is not one step, as a turn about an axis is
_AXES_UNSAID = frozenset("pPrdovVJjxX")  # letters of what may be seen from any frame, whatever is usual
_VELOCITY = re.compile(r"\\dot\s*\{?\s*(?:p_\{?\s*)?[xyz](?![A-Za-z])|(?<![A-Za-z\\])[vV]_\{?\s*[xyz]")
_ARROW = re.compile(r"[\s.,$]*\\(?:implies|iff|Rightarrow|Longrightarrow|Leftrightarrow)(?![A-Za-z])")


@dataclass(frozen=True, slots=True)
class Side:
    """A side of an equation: the quantities that it may name, and what it says or why it says nothing."""

    piece: LatexPiece
    left: Left | None = None
    targets: tuple[Target, ...] = ()
    value: Expression | Table | None = None
    error: CheckError | None = None
    factors: tuple[Left, ...] = ()  # of a product of transforms
    frames: tuple[int, int] | None = None  # where such a product leads, if one factor follows the other
    is_branch: bool = False  # whether it is a joint variable with a label that may be that of a branch
    keeps_pose: bool = False  # whether all joints with that label together leave the end effector where it is


class Comparing:
    """Comparisons of one text."""

    def __init__(self, scope: Scope, quantity: str) -> None:
        self.scope, self.asked, self.document = scope, quantity, scope.document
        self.model, self.robot, self.text = scope.model, scope.model.robot, scope.text
        self.meanings, self.plain = scope.meanings, scope.plain
        self._values = ByValue(scope.model, scope.poses)
        self.conditions: list[Condition] = []
        self.loose: dict[Finding, str] = {}  # positions that are called x, y or z, which may be those of any point
        self.joints = {joint.variable: joint for joint in self.robot.movers}
        self.rates = set(map(velocity_name, self.joints))
        self._accelerations = set(map(acceleration_name, self.joints))
        self._moving = self.joints.keys() | self.rates | self._accelerations
        self.parameters = own_names(self.robot) - self.joints.keys()

    def _typed(self, side: LatexPiece) -> str:
        return " ".join(re.sub(r"\\\\|&", " ", self.text[side.start : side.end]).split())

    def _refused(self, side: LatexPiece, found: str, remedy: str = "") -> CheckError:
        return CheckError(found, remedy=remedy, location=self.plain.location(side.start))

    def _by_value(self, value: Expression | Table, name: str, text: str, where: Location) -> Finding | None:
        """That a formula is a quantity of the robot, whatever the author calls it; None where it has no such values."""
        quantity = self._values.quantity(value, taken_apart(name))
        return Finding(quantity, 0, 0, Role.PRINTED, text, Verdict(True, False), "", where) if quantity else None

    def _about(self, side: LatexPiece, quantity: str, verdict: Verdict, repair: Repair | None = None) -> Finding:
        """What is said of a side as a whole."""
        text, where = self._typed(side), self.plain.location(side.start)
        return Finding(quantity, 0, 0, Role.PRINTED, text, verdict, "", where, repair=repair)

    def _constant_matrix(self, named: list[Side], is_identity: bool) -> Table | None:
        """Zeros, or an identity matrix, in the shape of what is named; None of one formula."""
        rights = (right for name in named for target in name.targets if (right := self.meanings.right(target)))
        shape = next((right.value.shape for right in rights), (1, 1))
        if shape == (1, 1) or (is_identity and shape[0] != shape[1]):
            return None
        rows, columns = map(range, shape)
        return Table(tuple(tuple(Entry(tree.number(int(is_identity and i == j))) for j in columns) for i in rows))

    def _states(self, side: LatexPiece, text: str, values: tuple[Values, ...], is_of_side: bool = False) -> None:
        line, end, letters = self.plain.location(side.start).line or 0, side.end, "".join(text.split())
        if not is_of_side:  # where what was typed ends, blanks aside
            end = side.start
            while letters and end < len(self.text):
                letters, end = letters.removeprefix(self.text[end]), end + 1
        if values:
            self.conditions.append(Condition(line, end, text, values, is_of_side))

    def _identities(self, said: list[Side], *, is_nameless: bool = False) -> Iterator[Finding | Claim]:
        """Sides that say the same, or should; nameless if no other side says what they are."""
        moving = [s for s in said if isinstance(s.value, Table) or not is_constant(s.value or ZERO) or s.value == ZERO]
        printed, said = said, moving if len(moving) > 1 and self.document else said  # a number at the end: an example's
        first = said[0]
        is_angle = isinstance(first.value, Sum) and all(isinstance(term, Name) for term in first.value.terms)
        is_name = is_angle or (isinstance(first.value, Name | Call) and not (first.left and first.left.labelled))
        others = [side.value for side in said[1:] if side.value and not isinstance(side.value, Table)]
        given = (self.parameters.issuperset(n for n in names(e) if n[0] != SIGN) for e in others)
        one = first.value  # d_4 = s_1 p_x - c_1 p_y is a claim about the pose
        # by the velocity of the end effector the rates of the joints are claims as well
        has_rates = self.robot.passive or any(_VELOCITY.search(side.piece.text) for side in said[1:])
        known = self.joints.keys() | (self.rates | self._accelerations if has_rates else set())
        # and \dot\theta_1 by the momenta is one about these
        known = known | (self.rates & {n for e in others for n in names(e)})
        is_parameter = isinstance(one, Name) and one.name not in known and not names_of_pose(one, *others)
        poses = self.scope.poses  # x_1 = 0 and z_1 = d_1 say where a point is
        is_point = poses and any(map(poses.is_point, names_of_pose(one) if isinstance(one, Name) else ()))
        is_point = is_point and all(e == ZERO or not is_constant(e) for e in others)
        if is_parameter or (is_name and any(given) and not is_point):
            what = "a symbol of the robot" if is_parameter else "given a number, a condition"
            values = [side.value for side in printed if side.value is not None and not isinstance(side.value, Table)]
            self._states(first.piece, " = ".join(self._typed(side.piece) for side in said), ways(values))
            remedy = "write a quantity such as T_3^0 = or b_{11} = on the left"
            raise self._refused(first.piece, f"{quoted(self._typed(first.piece))} is {what}", remedy)
        for side in said[1:]:
            if isinstance(first.value, Table) and isinstance(side.value, Table):
                found_all = tuple(self._entry_by_entry(first.piece, first.value, side.piece, side.value))
                is_right = all(isinstance(one, Finding) and one.verdict.equal for one in found_all)
                if is_nameless and is_right and (like := self._almost(side.value)):
                    raise self._refused(side.piece, f"the matrices are equal, and like {like} but for some entries")
                yield from found_all
                continue
            if isinstance(first.value, Table) or isinstance(side.value, Table) or not first.value or not side.value:
                raise self._refused(side.piece, "matrices on both sides")
            where = self.plain.location(side.piece.start)
            question = Question(self.robot, side.value, first.value)
            left, right = self._typed(first.piece), self._typed(side.piece)
            if names_of_pose(first.value, side.value):
                yield Claim(first.value, side.value, left, right, where, is_branch=first.is_branch)
                continue
            found = compared(question, left, (0, 0), Role.IDENTITY, right, left, where)
            if first.is_branch and (side.value == first.value or not (found.verdict.equal or found.some)):
                if not first.keeps_pose:
                    raise self._refused(side.piece, f"the label in {quoted(left)} may be that of a branch")
                found = replace(found, verdict=Verdict(True, False), note=", another solution with the same pose")
            found = self._rounded(found, first.value, side.value, left, right)
            if not found.verdict.equal and self._is_condition(first.piece, first.value, side.piece, side.value):
                raise self._refused(side.piece, f"{quoted(left)} = {quoted(right)} is a condition")
            yield found

    def _is_condition(self, first: LatexPiece, one: Expression, second: LatexPiece, other: Expression) -> bool:
        """Whether two formulas that differ hold somewhere, as an equation of motion does, and are kept as such."""
        if self.document and _ARROW.match(self.text, second.end):
            return True
        if isinstance(one, Name) and one.name in {joint.variable for joint in self.robot.passive}:
            return False
        left, right = self._typed(first), self._typed(second)
        # M qdd + ... = f says how the arm moves, and holds for no acceleration but that
        is_motion = not self._accelerations.isdisjoint((*names(one), *names(other)))
        is_lagranges = "dt" in left and "\\partial" in right and "dt" not in right
        is_motion = is_motion and self.document and (is_lagranges or not re.search(r"\\partial|dt", left + right))
        held = ways([one, other])  # m_3 l_2 = m_4 l_1
        is_of_parameters = self.document and held and self.parameters.issuperset((*names(one), *names(other)))
        if is_motion or is_of_parameters or self._constrains(one, other):
            self._states(first, f"{left} = {right}", held)
            return True
        return is_constant(one) != is_constant(other)

    def _constrains(self, one: Expression, other: Expression) -> bool:
        return self.document and constrains(one, other, self.rates | self.joints.keys(), self.parameters)

    def _entry_by_entry(
        self, first: LatexPiece, one: Table, second: LatexPiece, other: Table
    ) -> Iterator[Finding | Claim]:
        if one.shape != other.shape or not self.document:
            raise self._refused(second, "matrices on both sides")
        entries = list(zip(one.entries, other.entries, strict=True))
        unknown = next((entry.unknown for pair in entries for entry in pair if entry.unknown), None)
        if unknown is not None:
            raise unknown
        if all(isinstance(a.formula, Name) and is_constant(b.formula) for a, b in entries):
            values = {a.formula.name: b.formula for a, b in entries if isinstance(a.formula, Name)}
            self._states(second, self._typed(second), (values,))
            raise self._refused(second, "a configuration, joint by joint")
        found: list[Finding | Claim] = []
        for a, b in entries:
            left, right = a.text or self._typed(first), b.text or self._typed(second)
            claim = Claim(a.formula, b.formula, left, right, self.plain.location(second.start))
            is_open = names_of_pose(a.formula, b.formula)
            found.append(claim if is_open else self._rounded(claim.read(self.robot), a.formula, b.formula, left, right))
        is_right = all(isinstance(one, Finding) and one.verdict.equal for one in found)
        used = {name for pair in entries for entry in pair for name in names(entry.formula)}
        if not is_right and not self._accelerations.isdisjoint(used):
            raise self._refused(second, "an equation of motion")
        if not is_right and self.parameters.issuperset(used):
            raise self._refused(second, "a numeric example")
        if not is_right and all(self._constrains(a.formula, b.formula) for a, b in entries):
            raise self._refused(second, "a condition on the joints")
        yield from found

    def _almost(self, table: Table) -> str:
        """The transform whose entries a matrix without a name has, but for three at most; none if it has all."""
        if table.shape != (4, 4) or sum(not is_constant(entry.formula) for entry in table.entries) < MOVING:
            return ""
        n = self.robot.n
        pairs = (f"T[{i},{j}]" for i in range(n) for j in range(i + 1, n + 1))
        rights = (self.meanings.right(Target(name)) for name in ("T", *pairs))
        fits = {right.quantity: right.fits(table) for right in rights if right is not None}
        best = max(fits, key=lambda name: fits[name])
        return best if 13 / 16 <= fits[best] < 1 else ""

    def _rounded(self, found: Finding, one: Expression, other: Expression, left: str, right: str) -> Finding:
        """Angles are equal up to full turns, numbers to a few units of the last printed digit; more is uncertain."""
        is_angle = isinstance(one, Name) and one.name in self.joints and self.joints[one.name].is_revolute
        for turns in (-2, 2) if self.document and is_angle and found.question and not found.verdict.equal else ():
            if compare(self.robot, one, tree.add(other, tree.multiply(tree.number(turns), Pi()))).equal:
                return replace(found, verdict=Verdict(True, True), note=", up to a full turn", question=None)
        if found.verdict.equal or not (self.document and is_constant(one) and is_constant(other)):
            return found
        gap = abs(float_value(one, {}) - float_value(other, {}))
        places = next((p for text in (right, left) if (p := [len(d) for d in DECIMALS.findall(text)])), [])
        if places and gap <= DIGITS * 10.0 ** -min(places):
            return replace(found, verdict=Verdict(equal=True, exact=False), question=None)
        if places and gap <= ROUGHLY * abs(float_value(one, {})):
            raise CheckError(f"{quoted(left)} = {quoted(right)} may be rounded on the way", location=found.location)
        return found

    def _compared(self, name: Side, table: Table, offset: int) -> Iterator[Finding]:
        """The findings for the first quantity that is meant of which everything is right; else for the first one."""
        known = names_of_pose(*(entry.formula for entry in table.entries))
        if known and self.scope.poses is not None:
            yield from self._posed(self.scope.poses, known, name, table, offset)
            return
        # a letter means several things: the candidate that the printed formula equals decides, else the likeliest
        chosen: tuple[Finding, ...] = ()
        rights, fits = self._fitting(name, table)
        self._refuse_vague(name, table, fits)
        for right, fitting in fits:
            found = tuple(self._entries(right, fitting, offset))
            if all(finding.unknown or finding.verdict.equal for finding in found):
                chosen = found
                break
            chosen = chosen or found
        is_right = bool(chosen) and all(finding.verdict.equal for finding in chosen)
        exchanged = self._exchanged(name, table) if chosen and not is_right else None
        if exchanged is not None and name.left is not None and name.left.head in "pPrdo":
            # vectors may be written otherwise than transforms: p_E^S beside T_S^E
            chosen = tuple(self._entries(exchanged, exchanged.fitting(table) or table, offset))
            is_right, exchanged = True, None
        if exchanged is not None:
            repair = Repair((), f"the frames exchanged: the matrix is {exchanged.quantity}", ZERO)
            yield self._about(name.piece, chosen[0].quantity, NOTHING_KNOWN, repair=repair)
            return
        if chosen and not is_right and self.document and (elsewhere := self._elsewhere(name, table)):
            chosen = (elsewhere,)
        self._refuse_sign(name, chosen)
        wrong = [f for f in chosen if not f.verdict.equal and f.unknown is None]
        causes = (one_cause(right, fitting) for right, fitting in fits if right.quantity == chosen[0].quantity)
        if len(wrong) > 1 and (cause := next(causes, "")):
            chosen = (*(replace(f, cause=cause) for f in wrong), *(f for f in chosen if f not in wrong))
        if isinstance(name.value, Call) and table.shape == (1, 1) and not is_right:  # c_{12}, which is a cosine too
            (entry,) = table.rows[0]
            side = Side(LatexPiece(entry.text, entry.offset), value=entry.formula)
            identity = tuple(one for one in self._identities([name, side]) if isinstance(one, Finding))
            has_rates = not self.rates.isdisjoint(names(entry.formula))  # as an entry of C has
            is_token = name.left is not None and name.left.head in ("c", "s") and not has_rates
            chosen = identity if identity and (not chosen or is_token or identity[0].verdict.equal) else chosen
        if not chosen:
            raise self._unfit(name, rights, table, offset)
        if name.left is not None and name.left.head in AXES and name.left.is_plain and not name.left.sub:
            self.loose |= dict.fromkeys(chosen, name.left.head)
        yield from chosen

    def _elsewhere(self, name: Side, table: Table) -> Finding | None:
        """That a vector or a coordinate is right, seen from another frame or origin."""
        if (left := name.left) is None or re.match("[0-9](?:to|rightarrow)", left.sub):  # from a point that is named
            return None
        is_vector = left.head in _AXES_UNSAID and table.shape != (1, 1)
        # a lone z beside a radius is one from another origin, not that of an earlier point in the base
        firsts = (taken_apart(equation[0].text) for equation in self.scope.equations if len(equation) > 1)
        if not is_vector and {f.flat for f in firsts if f is not None and f.flat in AXES} != {left.flat}:
            return None
        found = self._by_value(table, name.piece.text, self._typed(name.piece), self.plain.location(name.piece.start))
        return found if found and (is_vector or found.quantity[0] in "(-") else None

    def _fitting(self, name: Side, table: Table) -> tuple[tuple[Right, ...], list[tuple[Right, Table]]]:
        """What may be meant, and of that what has the shape of the table, the likeliest matrix first."""
        used = {word for entry in table.entries for word in names(entry.formula)}
        has_force = not used.isdisjoint(self.meanings.forces)
        rights = tuple(right for right in self._meant(name) if right.quantity.startswith("statics") == has_force)
        if not self.joints.keys().isdisjoint(used):  # an axis that moves is a column of a Jacobian, not one at home
            rights = tuple(map(self._moving_axis, rights))
        if not self._accelerations.isdisjoint(used):  # K of an equation of motion is no energy
            energies = ("kinetic", "potential", "lagrangian")
            rights = tuple(right for right in rights if not right.quantity.startswith(energies))
        if not self.rates.isdisjoint(used):  # which these stand before
            rights = tuple(right for right in rights if right.quantity not in ("centrifugal", "coriolis"))
        fits = [(right, fitting) for right in rights if (fitting := right.fitting(table)) is not None]
        is_jacobian = name.left is not None and name.left.head == "J" and 1 not in table.shape
        is_jacobian = is_jacobian and all(right.likeness(fitting) < VAGUE for right, fitting in fits)
        if is_jacobian and (by_rows := self.meanings.jacobian_by_rows(table)) is not None:
            self.scope.readings.append(f"a Jacobian is read as the rows {', '.join(map(str, by_rows.rows))} of ours")
            return (by_rows,), [(by_rows, table)]
        if len(fits) > 1 and table.shape != (1, 1):
            fits.sort(key=lambda pair: -pair[0].likeness(pair[1]))
        return rights, fits

    def _moving_axis(self, right: Right) -> Right:
        """The axis of a joint in any configuration, of one in the home position; anything else as it is."""
        axis = re.fullmatch(r"(body_)?screw\[([0-9]+)\]", right.quantity)
        moving = axis and self.meanings.right(Target("J_end" if axis[1] else "J_space", right.rows, (int(axis[2]),)))
        return moving or right

    def _unfit(self, name: Side, rights: tuple[Right, ...], table: Table, offset: int) -> CheckError:
        """Of what is printed in a shape that nothing has which is meant."""
        if not rights:
            allowed = "inverses of transforms and of at most 3 rows"
            where = self.plain.location(name.piece.start)
            return CheckError(f"{quoted(self._typed(name.piece))} is not derived", allowed=allowed, location=where)
        shapes = " or ".join(dict.fromkeys(f"{r.value.shape[0]}x{r.value.shape[1]}" for r in rights))
        printed = f"{rights[0].quantity} printed as {table.shape[0]}x{table.shape[1]}"
        return CheckError(printed, allowed=f"allowed: {shapes}", location=self.plain.location(offset))

    def _refuse_vague(self, name: Side, table: Table, fits: list[tuple[Right, Table]]) -> None:
        """A letter for anything names a matrix only if most entries fit; an energy is certain where something moves."""
        used = {word for entry in table.entries for word in names(entry.formula)}
        is_torque = fits and table.shape != (1, 1) and all(r.quantity == "Cqd" for r, _ in fits)
        if is_torque and used and self.rates.isdisjoint(used):
            raise self._refused(name.piece, f"{quoted(self._typed(name.piece))} has no velocities")
        is_energy = not self.rates.isdisjoint(used) and all(r.quantity.startswith(("kinetic", "lagr")) for r, _ in fits)
        # two coordinates of an arm that moves in space may be those in the plane of its links
        is_flat = table.shape == (2, 1) and all(right.columns == (4,) or right.quantity == "p" for right, _ in fits)
        is_flat = is_flat and len(self.robot.ends) < 2
        is_flat = is_flat and not self.joints.keys().isdisjoint(map(str, self.model.quantity("T")[2, 3].free_symbols))
        # of axes home may be another configuration
        if fits and name.targets and all("screw" in target.quantity for target in name.targets):
            least = VAGUE if len(table.entries) > len(AXES) else 1
            if all(right.likeness(fitting) < least for right, fitting in fits):
                raise self._refused(name.piece, f"{quoted(self._typed(name.piece))} is no axis of ours at home")
        lefts = {equation[0].text.strip() for equation in self.scope.equations}
        are_axes = name.left is not None and {name.left.flat, *"XY"} <= lefts & {*"XYZ"}  # coordinates, told together
        if name.left is None or not (name.left.is_vague or is_flat) or not fits or are_axes:
            return
        # the angle of a planar arm has all joints
        is_angle = name.left.head in ANGLES and isinstance(table.entries[0].formula, Sum) and used == self.joints.keys()
        is_scalar = table.shape == (1, 1)  # which is right at least for one of them
        if is_scalar and any(found.verdict.equal for pair in fits for found in self._entries(*pair, 0)):
            return
        if not (is_energy or is_angle) and all(right.likeness(fitting) < VAGUE for right, fitting in fits):
            shown = " or ".join(dict.fromkeys(right.shown for right, _ in fits[:3]))
            raise self._refused(name.piece, f"{quoted(self._typed(name.piece))} is not certain: it could be {shown}")

    def _refuse_sign(self, name: Side, chosen: tuple[Finding, ...]) -> None:
        """The sign of det J depends on the order of rows, that of tau_g on its side of the equation of motion."""
        is_torque = name.left is not None and name.left.flat == "taug" and not self.meanings.has_gravity_opposed
        is_open = not (self.meanings.has_jacobian or self.meanings.jacobian)
        for found in chosen if self.document else ():
            is_signed = (is_open and found.quantity in ("detJ", "det J")) or (is_torque and found.quantity == "g")
            question = found.question if is_signed and not found.verdict.equal else None
            if question and compare(self.robot, negate(question.right), question.printed).equal:
                what = "side of the equation of motion" if is_torque else "order of the rows"
                raise self._refused(name.piece, f"the sign depends on the {what}, which the text does not print")

    def _posed(self, poses: Poses, known: set[str], name: Side, table: Table, offset: int) -> Iterator[Finding]:
        """The findings with the usual meaning of names of the pose, and the meaning of points that makes all right."""
        readings = poses.point_readings(known) if any(map(poses.is_point, known)) else [poses.readings[0].values]
        for values in ({**values, **poses.labels()} for values in readings):
            posed = tuple(tuple(replace(e, formula=substitute(e.formula, values)) for e in row) for row in table.rows)
            if names_of_pose(*(entry.formula for row in posed for entry in row)):
                continue  # a name without a value
            with suppress(*([CheckError] if len(readings) > 1 else [])):
                found = tuple(self._compared(name, Table(posed), offset))
                if len(readings) == 1 or all(finding.verdict.equal for finding in found):
                    yield from found
                    return
        what = f"which points {', '.join(sorted(known))} mean is not certain"
        raise CheckError(what, location=self.plain.location(offset))

    def _exchanged(self, name: Side, table: Table) -> Right | None:
        """What a matrix is that is right with the two frames of its left side exchanged."""
        if name.left is None or name.left.scripts is None or table.shape == (1, 1):
            return None
        other = self.meanings.reading ^ frozenset([name.left.scripts])
        return next((right for right in self.scope.rights_read(name.left, other) if right.fits(table) == 1), None)

    def _meant(self, name: Side) -> Iterator[Right]:
        """What a left side may mean, of that only what is asked about, if something is."""
        meant = (right for target in name.targets if (right := self.meanings.right(target)) is not None)
        if not self.asked:
            yield from meant
            return
        asked = tuple(self.meanings.asked(self.asked))
        if not name.targets:
            yield from asked
            return
        all_meant = tuple(meant)
        pairs = [(right, next((other for other in asked if right.agrees(other)), None)) for right in all_meant]
        agreeing = [right if same.value.shape != right.value.shape else same for right, same in pairs if same]
        if not agreeing and all_meant and name.left is not None and name.left.head not in ANY:
            text, means = self._typed(name.piece), all_meant[0]
            found = f"left side {quoted(text)} means {means.shown}, but the quantity asked about is {self.asked}"
            raise self._refused(name.piece, found, "leave one of them out")
        yield from agreeing or asked

    def misnamed(self, index: int, found: Sequence[Finding | Claim]) -> list[Finding]:
        """Entries of a matrix, else right, in which a name that nothing here has stands for one of ours."""
        entries = [f for f in found if isinstance(f, Finding) and f.role is Role.PRINTED]
        unknown = [f for f in entries if f.unknown]
        slips, is_right = list[Finding](), all(f.verdict.equal or f.unknown for f in entries)
        if not is_right or len(entries) < AMONG * len(unknown):
            return []
        for f in unknown:
            name = re.match(r"(?:unknown name ')?(\w+)", f.unknown.found if f.unknown else "")
            if name and (right := self.meanings.right(Target(f.quantity))) and f.row <= right.value.rows:
                with suppress(CheckError):
                    printed = self.scope.reader(index, {name[1]: Name(name[1])}).formula(LatexPiece(f.text, 0))
                    derived = right.value[f.row - 1, max(f.column - 1, 0)]
                    question = Question(self.robot, printed, expression_from_sympy(derived))
                    slip = compared(question, f.quantity, (f.row, f.column), f.role, f.text, derived, f.location)
                    slips += [slip] if (repair := judge(slip).repair) and RENAMED.issuperset(repair.kinds) else []
        return slips if len(slips) == len(unknown) else []

    def _entries(self, right: Right, table: Table, offset: int) -> Iterator[Finding]:
        places = product(right.rows, right.columns)
        for entry, place, derived in zip(table.entries, places, right.value, strict=True):
            if entry.is_open:
                continue
            text = entry.text or notation_text(entry.formula, self.robot)
            if entry.unknown is not None:
                yield undecidable(right.quantity, place, Role.PRINTED, text, entry.unknown)
                continue
            where = self.plain.location(entry.offset or offset)
            others = other_orders(self.model, right.quantity)
            question = Question(self.robot, entry.formula, expression_from_sympy(derived), others=others)
            found = compared(question, right.quantity, place, Role.PRINTED, text, derived, where)
            if right.quantity == "manipulability" and found.question and not found.verdict.equal:
                # the root of a determinant, of which lengths are taken out as if they were positive
                squares = (tree.power(e, 2) for e in (found.question.printed, found.question.right))
                verdict = Verdict(compare(self.robot, *squares).equal, exact=True)
                found = replace(found, verdict=verdict, note=", up to a sign" if verdict.equal else "")
            if right.quantity.startswith("potential") and found.question and not found.verdict.equal:
                # a potential energy counts from any height
                difference = tree.add(question.printed, negate(question.right))
                if compare(self.robot, difference, substitute(difference, dict.fromkeys(self.joints, ZERO))).equal:
                    found = replace(found, verdict=Verdict(equal=True, exact=True), note=", up to a constant")
            yield found
