"""What the left sides of printed equations mean for one robot: quantities, parts and entries with their values."""

from __future__ import annotations

import random
import re
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property, partial, reduce

import sympy

from derive.checking.formulas.edits import NO_VALUE, float_value
from derive.checking.latex.formula import derivative
from derive.checking.latex.left import AXES, FONT, Left, Reading, Turned, taken_apart
from derive.checking.latex.matrices import LARGEST_DETERMINANT, Table
from derive.checking.latex.names import ENERGY
from derive.checking.latex.poses import Poses
from derive.checking.latex.quantities import OF_VELOCITIES, OWN, force_named, own_quantity, slope, written
from derive.checking.latex.targets import Target, candidates, is_scalar
from derive.errors import QuantityError
from derive.lecture.sympy_conversion import Matrix, expression_from_sympy, expression_to_sympy
from derive.model.equality import scalar_quantity
from derive.model.model import Model
from derive.model.quantities import OF_ENDS, REGISTRY
from derive.model.quantity_names import parse
from derive.robot import tree
from derive.robot.expression import Expression, Name, is_constant, names
from derive.robot.names import joint_label, velocity_name

# Entries that may stand in formulas.
_ENTRY = re.compile(r"(b|B|t|r|R|J|p|c|C|g|G|m|M|d|D|h|H|Gamma|n|s|o|a)((?:(?<=J)[a-z]+)?(?:[0-9]+,?)+|[xyz])")
_TURN = re.compile(r"omega([1-9])|(?:theta|phi)[cCG]([1-9])'")  # of a link, about one direction
_OF_ROTATION = re.compile(r"R([0-9]{2}),?([1-3])([1-3])")  # R_{36,23}
_SEEN_FROM = re.compile(r"([pPnsoaFfN])([1-9][xyz])\^([0-9])")  # P6x^0
_OF_TIME = re.compile(
    r"\\dot(?:\((?P<round>.*)\)|\[(?P<square>.*)\]|\{(?P<braced>\\[dt]?frac\{.*\}\{.*\})\}|(?P<bare>\\[dt]?frac\{.*\}\{.*\}))"
)
_PARTIAL = re.compile(
    r"\\[dt]?frac\{\\partial(?P<above>.*)\}\{\\partial\{?(?P<rate>\\dot)?\{?(?:\\(?:var)?[Tt]heta|[qd])\}?_?\{?(?P<label>[0-9]*)\}*\}"
)
_TORQUES = ("tau", "Q", "u", "Gamma")
_SIX_ROWS = ("J", "J_end", "J_space", "J_dot", "twist")
ALIKE = 1e-4  # relative difference of two values at a point that rounded decimals may explain
LARGEST_INVERSE = 3  # rows of a matrix that is inverted; transforms are inverted whatever their size


@dataclass(frozen=True, slots=True)
class Right:
    """A derived quantity, or the part of it that is meant."""

    quantity: str  # its name
    value: Matrix  # the part
    rows: tuple[int, ...]  # its rows counted in the whole, 0 where that has none
    columns: tuple[int, ...]  # its columns likewise

    def fitting(self, table: Table) -> Table | None:
        """The printed table in this shape, a vector as it stands or turned; None where it does not fit."""
        turned = table.transposed if 1 in table.shape else table
        return next((t for t in (table, turned) if t.shape == self.value.shape), None)

    def likeness(self, table: Table) -> float:
        """Which part of the entries of a table in this shape has the same values at a point."""
        both = [(entry, e) for entry, e in zip(table.entries, self.value, strict=True) if not entry.is_open]
        pairs = [(entry.formula, expression_from_sympy(e)) for entry, e in both if not entry.unknown]
        points = [at_a_point(printed, derived) for printed, derived in pairs]
        alike = sum(abs(one - other) <= ALIKE * (1 + abs(other)) for one, other in filter(None, points))
        return alike / max(len(both), 1)

    def fits(self, table: Table) -> float:
        """The likeness of a table in any shape; 0 where it does not fit."""
        return self.likeness(fitting) if (fitting := self.fitting(table)) else 0.0

    def agrees(self, asked: Right) -> bool:
        """Whether it is what is asked about, or that is an entry or a part of it."""
        if self.value.shape == asked.value.shape:
            return bool(self.value == asked.value)
        return self.quantity == asked.quantity and asked.rows != (0,)

    @property
    def shown(self) -> str:
        """The quantity with the indices of the part, for messages."""
        indices = [str(i) for (i, *more) in (self.rows, self.columns) if i and not more]
        return f"{self.quantity}[{','.join(indices)}]" if indices else self.quantity


def at_a_point(*formulas: Expression) -> list[float]:
    """The values of formulas at one random point; none where one of them has no value there."""
    rng = random.Random(3)
    values = {name: rng.uniform(0.3, 1.7) for name in sorted({name for e in formulas for name in names(e)})}
    with suppress(*NO_VALUE):
        return [float_value(e, values) for e in formulas]
    return []


class Meanings:
    """The quantities of one robot, as left sides name them."""

    def __init__(self, model: Model) -> None:
        self._model, self.robot = model, model.robot
        self.torque = 0  # which index of a Christoffel symbol is that of the torque
        self.reading: Reading = frozenset()
        self.is_angular_first = False  # whether a whole Jacobian has the rows of the angular velocity above
        self.jacobian: Table | None = None  # a square Jacobian of the text that has other rows than ours
        self.has_jacobian = False  # whether the text prints one that is ours
        self.columns: dict[str, int] = {}  # letters of the columns of a pose that the text names
        self.bases: frozenset[str] = frozenset()  # letters of the text for the frame that all else is seen from
        self.entries: dict[str, Left] = {}  # letters for entries of a matrix, and that matrix
        self.counts_world = False  # whether frame 0 of the text is the world, and frame 1 the base of the robot
        self.counts_rows = False  # whether rows without motion are counted as frames, in the order of the table
        self.counts_joints = False  # whether p_1 is the first joint's place, p_2 the end of link 1
        self.names_end = False  # whether the text has another name for the end effector than the last frame's
        self.has_o_columns = False  # whether o_x is an entry of the second column of a rotation, beside n, a and p
        self.has_turns = False  # whether omega_2 is the angular velocity of link 2, not the rate of joint 2
        self.lent = frozenset[str]()  # letters with two indices that are names of the author's own
        self.forces = frozenset[str]()  # coordinates of a force or a moment on the end effector that the text names
        self.has_gravity_opposed = False  # whether gravity stands on the side of the torques: tau + g
        labels = [joint_label(joint.variable) for joint in self.robot.movers]
        self._first = int(labels[0]) if labels[0] and int(labels[-1] or 0) - int(labels[0]) == len(labels) - 1 else 1
        self._rights: dict[Target, Right | None] = {}
        variables = [joint.variable for joint in self.robot.movers]  # the momentum p_{\theta_1} of each
        self.momenta = {name: k for k, q in enumerate(variables, 1) for name in (q, f"theta{q[-1]}")}

    def targets(self, left: Left) -> tuple[Target, ...]:
        """The quantities that a left side may mean; without links there is no dynamics."""
        if left.sub in {end.name for end in self.robot.ends if end.name}:  # p_{left}
            of_ends = (t for t in self.targets(replace(left, sub="")) if t.quantity in OF_ENDS)
            return tuple(replace(target, quantity=f"{target.quantity}[{left.sub}]") for target in of_ends)
        indices = re.fullmatch(r"([1-9]),?([1-9])", left.sub) if left.is_plain and left.head in self.entries else None
        if indices is not None:
            entry = int(indices[1]), int(indices[2])
            matrices = [t for t in self.targets(self.entries[left.head]) if not is_scalar(t)]
            if matrices or len(self.entries[left.head].head) == 1:
                return tuple(replace(t, entry=entry) for t in matrices)
        if left.arguments.startswith("(\u2202"):  # the column of a derivative is that of its variable
            (row, label), is_slide = left.sub.split(","), left.arguments == "(\u2202d)"
            kinds = [(joint_label(joint.variable), joint.is_revolute) for joint in self.robot.movers]
            own = (k for k, kind in enumerate(kinds, 1) if kind == (label, not is_slide))
            left = replace(left, sub=f"{row},{next(own, label)}", arguments="")
        # c_1 of Hamilton's equations is a short name
        is_lent = left.head in self.lent and re.fullmatch("[1-9]{2}" if left.head != "h" else "[1-9]", left.sub)
        if left.is_plain and (is_lent or (left.head == "c" and "1" in self.momenta)):
            return ()
        if left.head in self.columns and left.is_plain and left.sub in AXES:
            return (Target("T", (AXES[left.sub],), (self.columns[left.head],)),)
        left = _from_world(left) if self.counts_world and left.head in "TAHRMpPoOd" and not left.dots else left
        left = replace(left, before="0") if left.before in self.bases else left
        if self.counts_joints and left.head in "pP" and left.is_plain and left.sub.isdigit() and int(left.sub):
            left = replace(left, sub=str(int(left.sub) - 1))
        found: dict[Target, None] = {}
        # \dot p of Hamilton's equations is -dH/dq, which has no accelerations
        is_momentum = left.head in "pP" and replace(left, dots=0).is_plain and left.sub in self.momenta
        if is_momentum and self.robot.has_dynamics and not (left.dots and "1" in self.momenta):
            found[Target("momentum", (self.momenta[left.sub],), by=("t",) * left.dots)] = None
        count = len(self._rows) - 1 if self.counts_rows else self.robot.n
        for target in candidates(left, count, self._first, self.reading, tool=self.robot.tool is not None):
            if self.counts_rows:
                target = replace(target, quantity=self._between_rows(target.quantity))
            name, _, place = target.quantity.partition("[")
            is_static = name.startswith("joint_") or (name == "tau" and left.head in _TORQUES)
            for axes in ("", "_end") if self.forces and is_static else ():
                kind = f"statics{re.sub('^(?:tau|joint)', '', name)}{axes}"
                inside = ",".join(filter(None, (place.removesuffix("]"), *sorted(self.forces))))
                found[replace(target, quantity=f"{kind}[{inside}]")] = None
            if name == "T" and not place and self.names_end and str(self.robot.n) in (left.sub, left.before_sub):
                continue
            known_by = "Cqd" if name in OF_VELOCITIES else name
            is_known = known_by in OWN or REGISTRY[known_by].is_of(self.robot)
            if is_known and (name != "lagrangian" or self.robot.links):
                if name == "christoffel" and place:  # ours have the index of the torque in front
                    order = place.removesuffix("]").split(",")
                    target = replace(target, quantity=f"{name}[{','.join([order.pop(self.torque), *order])}]")
                found[target] = None
        columns = [target for target in found if target.columns == (2,)]
        return tuple(columns if self.has_o_columns and left.head == "o" and columns else found)

    @cached_property
    def _rows(self) -> tuple[int, ...]:
        """Frames by the rows from base to end, as they are numbered here: those that move first."""
        labels = tree.labels(self.robot)
        return (0, *(labels.index(label) for label in tree.rows_to(self.robot, tree.ends(self.robot)[0].after)))

    def _between_rows(self, quantity: str) -> str:
        """A transform between frames that are counted by rows."""
        if (frames := re.fullmatch(r"(?P<kind>[TA])\[(?:(?P<first>[0-9]+),)?(?P<last>[0-9]+)\]", quantity)) is None:
            return quantity
        last = int(frames["last"])
        first = last - 1 if frames["kind"] == "A" else int(frames["first"] or 0)
        return f"T[{self._rows[first]},{self._rows[last]}]"

    def right(self, target: Target) -> Right | None:
        """What a target stands for, derived once; None where the robot has no such quantity or entry."""
        if self.is_angular_first and target.quantity in _SIX_ROWS and not target.rows and not target.is_determinant:
            target = replace(target, rows=(4, 5, 6, 1, 2, 3))
        is_of_jacobian = target.quantity == "detJ" or (target.is_determinant and target.quantity == "J")
        if self.jacobian is not None and is_of_jacobian:
            determinant = expression_to_sympy(self.jacobian.determinant.formula)
            return Right("detJ", sympy.ImmutableMatrix([[determinant]]), (0,), (0,))
        if target not in self._rights:
            self._rights[target] = None
            with suppress(QuantityError, IndexError):
                self._rights[target] = self._derived(target)
        found = self._rights[target]
        is_opposed = self.has_gravity_opposed and found is not None and target.quantity == "g"
        return replace(found, value=-found.value) if is_opposed and found is not None else found

    def jacobian_by_rows(self, table: Table) -> Right | None:
        """Our Jacobian with the rows that a printed one has, in its order, where most are rows of ours."""
        if len(self.robot.ends) > 1:
            return None
        ours, width = self._model.quantity("J"), table.shape[1]
        if not 1 < width <= ours.cols or not 1 < table.shape[0] <= ours.rows:
            return None
        rest, rows = [i for i in range(ours.rows) if any(ours.row(i))], list[int | None]()
        for printed in table.rows:
            own = Table((printed,))
            fits = (i for i in rest if not any(ours[i, width:]) and Right("J", ours[i, :width], (), ()).fits(own) == 1)
            rows.append(next(fits, None))
            rest = [i for i in rest if i != rows[-1]]
        known = [i for i in rows if i is not None]
        left = iter(rest)
        found = [i for i in (next(left, None) if i is None else i for i in rows) if i is not None]
        if len(found) < len(rows) or (width < ours.cols and None in rows):
            return None
        ours_printed = zip(found, table.rows, strict=True)
        alike = (Right("J", ours[i, :width], (), ()).fits(Table((row,))) >= 0.5 for i, row in ours_printed)
        if not (2 * len(known) > len(rows) or (known and all(alike))):  # the others have a slip each
            return None
        part = ours.extract(found, list(range(width)))
        return Right("J", part, tuple(i + 1 for i in found), tuple(range(1, width + 1)))

    def _derived(self, target: Target) -> Right:
        if target.entry or target.by:
            whole = self._derived(replace(target, entry=(), by=()))
            value = reduce(partial(slope, self.robot), target.by, whole.value)
            if not target.entry:
                rows, columns = _whole("", value).rows if whole.rows == (0,) else whole.rows, whole.columns
                return Right(f"derivative of {whole.quantity}", value, rows, columns)
            i, j = target.entry
            return Right(whole.quantity, value.extract([i - 1], [j - 1]), (i,), (j,))
        value = own_quantity(self._model, target.quantity)
        value = self._model.quantity(target.quantity) if value is None else value
        if not hasattr(value, "shape"):
            value = sympy.ImmutableMatrix([[value]])
            return Right(target.quantity + target.turned, self._turned(target, value), (0,), (0,))
        is_statics = target.quantity.startswith("statics")  # shown without the forces that the text names
        whole = _whole(target.quantity.partition("[")[0] if is_statics else target.quantity, value)
        rows = target.rows or tuple(range(1, value.shape[0] + 1))
        columns = target.columns or tuple(range(1, value.shape[1] + 1))
        part = value.extract([i - 1 for i in rows], [j - 1 for j in columns])
        if target.is_determinant:
            # rows of zeros go, those that a planar arm has in its 6 x n Jacobian; the rest must be square
            part = part.extract([i for i in range(part.rows) if any(part.row(i))], list(range(part.cols)))
            if part.shape[0] != part.shape[1] or not 0 < part.shape[0] <= LARGEST_DETERMINANT:
                raise QuantityError(f"determinant of {target.quantity}")
            return Right(f"det {target.quantity}", sympy.ImmutableMatrix([[part.det(method="berkowitz")]]), (0,), (0,))
        if target.turned in (Turned.TRANSPOSED, Turned.BOTH):
            rows, columns = columns, rows
        elif whole.columns == (0,):
            columns = (0,)
        return Right(whole.quantity + target.turned, self._turned(target, part), rows, columns)

    def derivatives(self, text: str) -> tuple[Target, ...]:
        r"""What a derivative on a left side may mean, such as ``\frac{\partial p}{\partial\theta_1}``."""
        text, by = "".join(FONT.sub("", text).split()), list[str]()
        text = re.sub(r"\\nabla(?:_\{?q\}?)?(\w)(?:\(q\))?", r"\\frac{\\partial\1}{\\partialq}", text)
        while match := _OF_TIME.fullmatch(text):
            text, by = match["round"] or match["square"] or match["braced"] or match["bare"], ["t", *by]
        match = _PARTIAL.fullmatch(text)
        if match is None or (left := taken_apart(match["above"])) is None:
            return ()
        left = replace(left, arguments=left.arguments or "(q)") if left.flat in "ku" else left
        if not match["label"]:
            by = ["qd" if match["rate"] else "q", *by]
        else:
            named = [j.variable for j in self.robot.movers if joint_label(j.variable) == match["label"]]
            by = [velocity_name(named[0]) if match["rate"] else named[0], *by] if named else []
        energies = ("kinetic", "potential", "lagr")
        of = (t for t in self.targets(left) if match["label"] or t.quantity.startswith(energies))
        found = tuple(replace(target, by=(*target.by, *by)) for target in of) if by else ()
        # the derivative of a position by all joint variables is the Jacobian
        is_place = by == ["q"] and left.head in "pPx"
        return (*found, *(Target("J", rows) for rows in ((1, 2, 3), (1, 2)) if is_place))

    def formula(self, left: Left, kinds: tuple[str, ...] = ("",)) -> Expression | None:
        """The first formula of some kinds that a left side may mean; None where there is none."""
        found = (target for target in self.targets(left) if is_scalar(target) and target.quantity.startswith(kinds))
        right = next(filter(None, map(self.right, found)), None)
        return expression_from_sympy(right.value[0, 0]) if right is not None else None

    def _turned(self, target: Target, part: Matrix) -> Matrix:
        if target.turned in (Turned.TRANSPOSED, Turned.BOTH):
            part = part.T
        if target.turned not in (Turned.INVERTED, Turned.BOTH):
            return part
        if target.quantity.partition("[")[0] in ("T", "A", "base", "tool", "end") and part.rows == part.cols:
            # [R p; 0 1]^-1 = [R^T -R^T p; 0 1], for planar transforms with a rotation of two rows
            size = sum(row < 4 for row in target.rows) or 3
            turn, place = part[:size, :size].T, part[:size, size:]
            moved = (-turn * place).applyfunc(partial(written, self._model))
            return sympy.ImmutableMatrix(turn.row_join(moved).col_join(part[size:, :]))
        if part.rows != part.cols or part.rows > LARGEST_INVERSE:
            raise QuantityError(f"inverse of {target.quantity}", allowed=f"allowed: up to {LARGEST_INVERSE} rows")
        # the inverse as adjugate over determinant, both reduced
        if (determinant := written(self._model, part.det(method="berkowitz"))) == 0:
            raise QuantityError(f"inverse of {target.quantity}, which is singular everywhere")
        return part.adjugate().applyfunc(lambda entry: written(self._model, entry) / determinant)

    def asked(self, quantity: str) -> Iterator[Right]:
        """What is asked about: an entry, or a quantity as a whole, or parts of it."""
        with suppress(QuantityError):
            yield Right(quantity, sympy.ImmutableMatrix([[scalar_quantity(self._model, quantity)]]), (0,), (0,))
        value = self._model.quantity(quantity)
        if hasattr(value, "shape"):
            yield _whole(quantity, value)
        name = parse(self._model, quantity)[0].name
        parts = (target for target in candidates(Left(name), self.robot.n) if target.quantity == quantity)
        yield from (right for target in parts if target.rows and (right := self.right(target)))


_RATE = re.compile(r"[pP]?([xyzXYZ])(?:e|E|ee|EE|p)?'|v([xyz])|omega([xyz])")  # of the end effector


def is_rate(name: str) -> bool:
    """Whether a name is that of a coordinate of the velocity of the end effector."""
    return _RATE.fullmatch(name) is not None


def entry_named(meanings: Meanings, poses: Poses | None, name: str) -> Expression | None:
    """The entry of a quantity with the name that it has in print, such as b12 and c1,22; None where there is none."""
    if rate := _RATE.fullmatch(name):
        axis = "xyz".index((rate[1] or rate[2] or rate[3]).lower()) + (4 if rate[3] else 1)
        right = meanings.right(Target("twist", (axis,)))
        return expression_from_sympy(right.value[0, 0]) if right else None
    if (force := force_named(name)) in meanings.forces:
        return Name(force)
    is_momentum = name[0] in "pP" and (len(name) > 2 or "1" in meanings.momenta)  # p_x of other pages is a place
    if is_momentum and (momentum := meanings.formula(Left("p", name[1:]), ("momentum",))):
        return momentum
    if poses is not None and (found := poses.placeholder(name)) is not None:
        return found
    if name.endswith("'") and name[1:-1] not in meanings.momenta and (entry := entry_named(meanings, None, name[:-1])):
        return expression_from_sympy(slope(meanings.robot, expression_to_sympy(entry), "t"))
    if name.startswith("det") and (whole := taken_apart(name[3:])):
        return meanings.formula(replace(whole, is_determinant=True))
    if name[0] == ENERGY:  # of the arm or of a link by its letter, L for their difference, or an entry of B
        left = Left(name[1:2], name[2:]) if name[2:].isdigit() or not name[2:] else Left(name[1:])
        return meanings.formula(left, ("kinetic", "potential", "lagrangian", "B"))
    if seen := _SEEN_FROM.fullmatch(name):
        return meanings.formula(Left(seen[1], seen[2], before=seen[3]))
    if of_rotation := _OF_ROTATION.fullmatch(name):
        right = next(filter(None, map(meanings.right, meanings.targets(Left("R", of_rotation[1])))), None)
        return expression_from_sympy(right.value[int(of_rotation[2]) - 1, int(of_rotation[3]) - 1]) if right else None
    turn = _TURN.fullmatch(name) if meanings.has_turns else None
    if turn and (right := meanings.right(Target(f"omega[{turn[1] or turn[2]},0]"))) and not any(right.value[:2, 0]):
        return expression_from_sympy(right.value[2, 0])
    own = taken_apart(f"{match[1]}_{{{match[2]}}}") if (match := _ENTRY.fullmatch(name)) else None
    kinds = ("B",) if own and own.head == "b" else ("",)  # b_2 of books is friction, or a width, as often as B qd + g
    return meanings.formula(own, kinds) if own is not None else None


def entry_or_rate(
    meanings: Meanings, poses: Poses | None, own: Mapping[str, Expression], name: str
) -> Expression | None:
    """The entry that a name is, or the rate of a name of the text's own."""
    found, of = entry_named(meanings, poses, name), own.get(name.rstrip("'"))
    if of is not None and not is_constant(of) and (found is None or isinstance(of, Name)):
        return reduce(lambda e, _: derivative(meanings.robot, e, "t"), range(name.count("'")), of)
    return found


def _from_world(left: Left) -> Left:
    """The same left side with the frames of the robot: one less each, and the world by a letter."""
    if left.is_plain and left.head in "AT" and left.sub.isdigit() and len(left.sub) == 1:
        sub = str(int(left.sub) - 1) if left.sub != "0" else "B"
        return replace(left, sub=sub, sup="B" if left.head == "T" or sub == "0" else "")
    less = str.maketrans({str(k): str(k - 1) if k else "B" for k in range(10)})
    scripts = ("sub", "sup", "before", "before_sub")
    return replace(left, **{name: getattr(left, name).translate(less) for name in scripts})


def _whole(quantity: str, value: Matrix) -> Right:
    rows, columns = value.shape
    return Right(quantity, value, tuple(range(1, rows + 1)), (0,) if columns == 1 else tuple(range(1, columns + 1)))
