r"""What a LaTeX text says as a whole: its equations, the names that it defines, and how it writes transforms."""

import re
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import replace
from fractions import Fraction
from functools import cached_property, partial
from itertools import chain, islice, product

from derive.checking.chains import chained, factors
from derive.checking.inverse.reading import printed_words
from derive.checking.latex import whole
from derive.checking.latex.equations import Sides, equations
from derive.checking.latex.formula import LatexReader
from derive.checking.latex.left import AXES, Left, Reading, Scripts, taken_apart
from derive.checking.latex.matrices import LARGEST_DETERMINANT, Entry, Table
from derive.checking.latex.meanings import Meanings, Right, entry_or_rate, is_rate
from derive.checking.latex.names import LatexNames, Symbol, plus_minus
from derive.checking.latex.pieces import LatexPiece
from derive.checking.latex.poses import Poses
from derive.checking.latex.quantities import force_named
from derive.checking.latex.targets import is_scalar, names_end
from derive.checking.latex.typography import cleaned
from derive.errors import CheckError, Location
from derive.lecture.sympy_conversion import expression_from_sympy
from derive.model.equality import compare
from derive.model.model import Model
from derive.robot.description import IDENTITY
from derive.robot.expression import Call, Expression, Name, Pi, Sum, add, is_constant, multiply, names, negate, number
from derive.robot.names import own_names, robot_symbols, velocity_name

MAX_EQUATIONS = 1_500  # equations of one text; a whole handout of a 6R arm has some 600
MAX_SIDES = 20  # sides of one equation
MAX_PASSES = 12  # how often definitions are gone through that need one that stands behind them
_LENT = frozenset("uvwhkexyzfFQTKVUP")  # letters of quantities, just as often short names for parts of formulas
ANGLES = ("phi", "theta", "psi")  # orientation, or any angle of a figure

_ARC = re.compile(
    r"\s*(?:\\operatorname\{)?(?:\\text\{)?\\?[aA](?:rc)?(?:tan|cos|sin|TAN)|\s*\\(?:tan|cos|sin)\s*\^\s*\{?-\s*1"
)
_OF_ROTATION = re.compile(r"(?<![A-Za-z\\])(?:[rR]|[nsoa](?=\s*_\s*\{?[xyz]))\s*_")
_OF_PLACE = re.compile(r"(?<![A-Za-z])(?:p\s*_\s*\{?\s*)?[xy](?![A-Za-z])")
_SQUARED = re.compile(r"(?P<name>\\?[A-Za-z]+(?:_(?:\{\w+\}|\w))?)\s*\^\s*(?:2|\{\s*2\s*\})")
# An angular velocity of a link, squared in an energy; \omega_1 + \omega_2 are rates of joints.
_TURNS = re.compile(r"(?s)(?!.*omega_\{?\d\}? ?\+ ?\\omega).*(?:omega_\{?[2-9]|theta\}?_\{c\s*[1-9]\s*)\}?\s*\^\s*\{?2")
_READINGS = (frozenset[Scripts](), frozenset(Scripts))
_TRIPLE = re.compile(r"(?:c|C|Gamma)[0-9]{3}")


class Scope:
    """One text for one robot."""

    def __init__(
        self, model: Model, text: str, start: Location, document: bool, *, cosine_first: bool | None = None
    ) -> None:
        self._cosine_first, self._signs = cosine_first, plus_minus() if document else None
        self.model, self.robot, self.text, self.start, self.document = model, model.robot, text, start, document
        has_time = "t" not in robot_symbols(self.robot)
        found = equations(text, start, document=document, time=has_time)
        self.equations = tuple(islice(found, MAX_EQUATIONS + 1))  # what is compared, in the order of the text
        if len(self.equations) > MAX_EQUATIONS or any(len(e) > MAX_SIDES for e in self.equations):
            allowed = f"allowed: at most {MAX_EQUATIONS} with {MAX_SIDES} sides each"
            raise CheckError("too many equations in one text", allowed=allowed, location=start)
        if not self.equations:
            nothing = "no mathematics between $ signs, in brackets or in displays" if document else "empty formula"
            raise CheckError(nothing, remedy="write a formula or an equation", location=start)
        typed = [[text[side.start : side.end] for side in equation] for equation in self.equations]
        # what the text defines is read first: the order of Christoffel indices, then abbreviations
        orders = {i: order for i, texts in enumerate(typed) if (order := whole.torque_index(texts)) is not None}
        self.meanings = Meanings(model)
        plain = cleaned(text, has_time)
        words = set(printed_words(plain)) - own_names(self.robot) if document else set[str]()
        self._foreign = whole.other_capitals(self.robot, self.equations, words)
        self.plain = LatexReader(LatexNames(self.robot, foreign=self._foreign), text, start)
        self.meanings.has_turns = _TURNS.match(plain) is not None
        self.meanings.columns = columns = whole.named_columns(self.equations) if document else {}
        named = whole.entry_letters(self.equations), whole.transforms(self.equations)
        has_one_end = document and len(self.robot.ends) < 2  # of several, a pose without a name is none's
        self.poses = Poses(model, plain, columns, *named) if has_one_end else None
        self.meanings.forces = frozenset(filter(None, map(force_named, words)))
        self.meanings.has_o_columns = self.poses is not None and self.poses.has_o_columns
        behind = [left for e in self.equations for s in e if not s.matrices and (left := taken_apart(s.text))]
        self.meanings.names_end = document and any(map(names_end, behind))
        self.meanings.counts_joints = any(x.flat.lower() == f"p{self.robot.n + 1}" for x in behind)
        self.meanings.momenta |= whole.momenta(text, self.robot.n) if document else {}
        self.meanings.bases = whole.base_letters(self.equations) if document else frozenset()
        self.readings, self.torques = list[str](), dict[str, Expression]()  # unusual ways to read the text, in words
        self._define()
        lent = self._lent_letters() if document else frozenset[str]()
        if lent := lent | frozenset("h" * bool(document and re.search(r"g\s*h\s*_", plain))):  # heights, m_1 g h_1
            self.meanings.lent = lent
            self._define()
        self.meanings.torque = next(iter(orders.values())) if orders else self._settled_torque() if document else 0
        self.meanings.reading = self._settled_reading()
        self._settle_frames()
        self.meanings.is_angular_first = self._settled_rows()
        self.meanings.has_gravity_opposed = any(map(whole.opposes_gravity, typed))
        if self.meanings.has_gravity_opposed:
            self.readings.append("gravity is read as the torque that it exerts, -dU/dq, as the equations of motion say")
        self.defining |= orders.keys()
        self._settle_jacobian()
        self.torques = self._torques()
        # from which equation on n_x ... p_z are entries of which matrix; None for the whole arm
        self.parts = list(whole.named_parts(self.equations, self.meanings)) if document else []
        self.namings = list(whole.named_entries(self.equations)) if document else []

    @cached_property
    def shifts(self) -> dict[str, Expression]:
        r"""Joint variables by those that the text counts from another zero: ``\theta_1 = \theta_1' + 90^\circ``."""
        found = {}
        for first, *others in self.equations if self.document else ():
            for side in others:
                own = re.sub(r"'+|\^\s*\{?\s*\\prime\s*\}?", lambda m: " " * len(m[0]), side.text)
                with suppress(CheckError):
                    if own != side.text and not first.matrices and first.text.strip() in own:
                        joint, value = self.plain.formula(first), self.plain.formula(replace(side, text=own))
                        terms = value.terms if isinstance(value, Sum) else ()
                        is_shift = sum(map(is_constant, terms)) == len(terms) - 1
                        if isinstance(joint, Name) and joint in terms and is_shift:
                            found[joint.name] = value
        return found

    def _torques(self) -> dict[str, Expression]:
        r"""What c_1 and h_2 are in equations of motion, by what the text says of them: with gravity, or without it."""
        found: dict[str, Expression] = {}
        rates = {velocity_name(joint.variable) for joint in self.robot.movers}
        sides = ((taken_apart(e[0].text), e[-1]) for e in self.equations if e[1:] and not e[0].matrices)
        # only equations of motion take them
        has_accelerations = any("\\ddot" in side.text for side in chain.from_iterable(self.equations))
        for left, side in sides if self.document and has_accelerations else ():
            targets = self.meanings.targets(left) if left and left.head in "cChHnNV" else ()
            meant = (self.meanings.right(target) for target in targets if target.quantity in ("Cqd", "bias"))
            if left and (rights := [*filter(None, meant)]):
                with suppress(CheckError):
                    value = self._reads.value(side)
                    table = value if isinstance(value, Table) else Table(((Entry(value),),))
                    right = max(rights, key=lambda right: right.fits(table))
                    if not rates.isdisjoint(name for entry in table.entries for name in names(entry.formula)):
                        entries = zip(right.rows, map(expression_from_sympy, right.value), strict=True)
                        found |= {f"{left.head}{row}": entry for row, entry in entries}
        return found

    def defined(self) -> Iterator[whole.Defined]:
        """Names with the number of the equation that defines each, what it stands for, and the side that it is."""
        for name, index, meaning in ((name, *pair) for name, pairs in self.definitions.items() for pair in pairs):
            yield name, index, meaning, next(s for s in self.equations[index] if (index, s.offset) in self.names)

    @cached_property
    def _printed(self) -> list[tuple[list[Left], list[Table]]]:
        """Of each equation the sides that are names, and those that are matrices which can be read."""
        found = []
        for equation in self.equations:
            lefts = [left for side in equation if not side.matrices and (left := taken_apart(side.text))]
            tables: list[Table] = []
            for side in equation if lefts else ():
                with suppress(CheckError):
                    tables += [value] if side.matrices and isinstance(value := self._reads.value(side), Table) else []
            found.append((lefts, tables))
        return found

    def _pairs(self, is_wanted: Callable[[Left], object], *, each: bool = False) -> Iterator[tuple[Left, Table]]:
        """The first quantity of a kind in an equation with the last matrix beside it, or each with each."""
        for lefts, tables in self._printed:
            wanted = [left for left in lefts if is_wanted(left) and self.meanings.targets(left)]
            yield from product(wanted, tables) if each else product(wanted[:1], tables[-1:])

    def _lent_letters(self) -> frozenset[str]:
        """Letters with two indices that formulas use, and that are not the entries which they usually mean."""
        votes: dict[str, list[bool]] = {}
        said, joints = [s for e in self.equations for s in e], {joint.variable for joint in self.robot.movers}
        for first, *others in self.equations:
            own = first.text.strip()
            if not any(own in text for side in said if side.text.strip() != own for text in side.texts):
                continue
            left = None if first.matrices else taken_apart(first.text)
            if left is None or not left.is_plain or not re.fullmatch("[1-9]{2}", left.sub) or self.is_own(left):
                continue
            rights = [r for t in self.meanings.targets(left) if is_scalar(t) and (r := self.meanings.right(t))]
            rights = [right for right in rights if not joints.isdisjoint(map(str, right.value.free_symbols))]
            for side in others[-1:] if rights else ():
                with suppress(CheckError):
                    entry = Table(((Entry(self._reads.formula(side)),),))
                    votes.setdefault(left.head, []).append(any(right.likeness(entry) for right in rights))
        return frozenset(head for head, fits in votes.items() if len(fits) > 1 and not any(fits))

    def _settled_reading(self) -> Reading:
        """Which frame of a transform is the reference: what most matrices of the text need, else what is usual."""
        votes: Counter[Scripts] = Counter()
        seen: Counter[Scripts] = Counter()
        self._vote_by_products(votes, seen)
        of_products = votes.copy()
        fits = list[tuple[Scripts, float, float]]()
        for left, table in self._pairs(lambda left: left.scripts):
            usual, turned = (whole.best(self.rights_read(left, reading), table) for reading in _READINGS)
            fits += [(left.scripts, usual, turned)] if left.scripts else []
        alike = {scripts for scripts, *both in fits if max(both) > 0.7}  # of others the frames are not those of ours
        for scripts, usual, turned in (fit for fit in fits if fit[0] in alike):
            votes[scripts] += (turned > usual) - (turned < usual)
            seen[scripts] += turned != usual
        self.settled = frozenset(scripts for scripts, vote in votes.items() if vote != of_products[scripts])
        turned_round = [scripts for scripts, vote in votes.items() if vote > 0]
        for scripts in turned_round:
            agreeing = whole.of_all((votes[scripts] + seen[scripts]) // 2, seen[scripts])
            self.readings.append(f"transforms are read as {scripts.value} = pose of frame i in frame j ({agreeing})")
        return frozenset(turned_round)

    def _settle_frames(self) -> None:
        """Whether frame 0 of the text is the world before a base, or rows without motion count: what most need."""
        possible = (self.robot.base != IDENTITY, self.robot.fixed and self.poses)
        for (way, said), is_possible in zip(whole.COUNTED.items(), possible, strict=True) if self.document else ():
            votes = list[int]()
            for left, table in self._pairs(lambda left: left.head in "TAH") if is_possible else ():
                setattr(self.meanings, way, False)
                usual = whole.best(self.rights_read(left, self.meanings.reading), table)
                setattr(self.meanings, way, True)
                other = whole.best(self.rights_read(left, self.meanings.reading), table)
                votes.append((other > usual) - (other < usual))
            setattr(self.meanings, way, sum(votes) > 0 and 2 * votes.count(1) >= len(votes))
            if getattr(self.meanings, way):
                self.readings.append(f"{said} ({whole.of_all(votes.count(1), len(votes))})")

    def _settled_rows(self) -> bool:
        """Whether whole Jacobians have the angular velocity above the linear one: what most of them need."""
        vote = 0
        for left, table in self._pairs(lambda left: left.head == "J", each=True):
            if table.shape[0] == 6:
                wholes = [target for target in self.meanings.targets(left) if not target.rows]
                orders = (wholes, [replace(target, rows=(4, 5, 6, 1, 2, 3)) for target in wholes])
                usual, turned = (whole.best(filter(None, map(self.meanings.right, order)), table) for order in orders)
                vote += (turned > usual) - (turned < usual)
        if vote > 0:
            self.readings.append("Jacobians are read with the rows of the angular velocity above the others")
        return vote > 0

    def _settle_jacobian(self) -> None:
        """Whether the Jacobian of the text is ours, or which other one: the sign of det J follows its rows."""
        for left, table in self._pairs(lambda left: left.head == "J" and left.sub + left.turned == "", each=True):
            if left.dots or any(e.unknown for e in table.entries) or all(is_constant(e.formula) for e in table.entries):
                continue
            rights = filter(None, map(self.meanings.right, self.meanings.targets(left)))
            fits = any(right.likeness(fitting) > 0.5 for right in rights if (fitting := right.fitting(table)))
            self.meanings.has_jacobian |= fits
            if not fits and table.shape[0] == table.shape[1] <= LARGEST_DETERMINANT:
                self.meanings.jacobian = table

    def _settled_torque(self) -> int:
        """Which index of Christoffel symbols is that of the torque: what most of them need, else the first."""
        printed = []
        for equation in self.equations:
            lefts = [left for side in equation if (left := taken_apart(side.text)) and _TRIPLE.fullmatch(left.flat)]
            with suppress(CheckError):
                table = Table(((Entry(self._reads.formula(equation[-1])),),)) if lefts else None
                printed += [(left, table) for left in lefts if table]
        votes = []
        for self.meanings.torque in range(3):
            targets = [(target, table) for left, table in printed for target in self.meanings.targets(left)[:1]]
            votes.append(sum(right.likeness(table) for one, table in targets if (right := self.meanings.right(one))))
        self.meanings.torque = 0
        if best := max(range(3), key=votes.__getitem__):
            index = f"the {('', 'second', 'third')[best]} index is that of the torque ({votes[best]:g} agree)"
            self.readings.append(f"of Christoffel symbols {index}")
        return best

    def _vote_by_products(self, votes: Counter[Scripts], seen: Counter[Scripts]) -> None:
        """A product of transforms is a chain in one order of the frames only."""
        usual = self.meanings.reading
        products = (factors(side.text) for e in self.equations for side in e if not side.matrices)
        for lefts in filter(None, products):
            scripts, *others = {left.scripts for left in lefts}
            if others or scripts is None:
                continue
            fits = [chained(self.meanings, lefts) is not None for self.meanings.reading in _READINGS]
            votes[scripts] += fits[1] - fits[0]
            seen[scripts] += fits[1] != fits[0]
        self.meanings.reading = usual

    def rights_read(self, left: Left, reading: Reading) -> list[Right]:
        """What a left side may mean in a reading."""
        usual, self.meanings.reading = self.meanings.reading, reading
        targets = self.meanings.targets(left)
        self.meanings.reading = usual
        return [right for target in targets if (right := self.meanings.right(target)) is not None]

    def _define(self) -> None:
        """Names that sides define; a definition may need another one that stands before or behind it."""
        # by name the formulas that it is given, each with the number of its equation
        self.definitions: dict[str, list[tuple[int, Expression]]] = {}
        self.defining: set[int] = set()  # numbers of the equations that only define something
        # sides that are such a name, by the number of the equation and the offset of the side
        self.names: set[tuple[int, int]] = set()
        self._of_links = whole.renamed(self.equations, self.plain) if self.document else {}  # and of joints
        self._circles: dict[str, dict[str, Expression]] = {}  # sine and cosine of angles that the text gives both of
        several = [(i, e) for i, e in enumerate(self.equations) if e[1:] and not any(factors(s.text) for s in e)]
        named = [(i, e, tuple(self._new_name(side, i, side is e[0]) for side in e)) for i, e in several]
        # what names a quantity by a name, such as b_{22} = p_1, defines that name only where nothing else does
        waiting = sorted((some for some in named if any(some[2])), key=lambda some: self._quantities(*some[1:]))
        for _ in range(MAX_PASSES):
            left = [some for some in waiting if not self._defines(*some)]
            if len(left) == len(waiting):
                break
            waiting = left
        for name, side in whole.of_every_link(self.equations, self.robot.n) if self.document else ():
            if not self.plain.names.knows(name):
                with suppress(CheckError):
                    self._of_links[name] = self.reader(0).formula(side)
        self._reads = self.reader(0)

    def _defines(self, index: int, equation: Sides, names: tuple[str, ...]) -> bool:
        """Whether an equation gives a new name to a formula that can be read by now."""
        name, reader = next(filter(None, names)), self.reader(index)
        if name in self.definitions and self._quantities(equation, names):
            return True
        for side, its_name in zip(equation, names, strict=True):
            with suppress(CheckError):
                if not its_name:
                    meaning = self._angle(name, equation[names.index(name)], reader.formula(side))
                    self.definitions.setdefault(name, []).append((index, meaning))
                    self.defining |= {index} if names[0] and len(equation) == 2 else set()
                    self.names |= {(index, s.offset) for s, n in zip(equation, names, strict=True) if n == name}
                    return True
        return False

    def _angle(self, name: str, side: LatexPiece, meaning: Expression) -> Expression:
        r"""What a name stands for: an angle in either half of the circle where a side is ``\cos\psi``."""
        if self.document and _SQUARED.fullmatch(side.text.strip()):
            return Call("sqrt", (meaning,))
        if (match := whole.OF_ANGLE.fullmatch(side.text.strip())) is None or self._signs is None:
            return meaning
        pair = self._circles.setdefault(name, {})
        pair[match["function"]] = meaning
        if {"sin", "cos"} <= pair.keys() and whole.are_sine_and_cosine(pair["sin"], pair["cos"]):
            return Call("atan2", (pair["sin"], pair["cos"]))
        sign, half = next(self._signs), multiply(number(Fraction(1, 2)), Pi())
        principal = Call("a" + match["function"], (meaning,))
        match match["function"]:
            case "cos":
                return multiply(sign, principal)
            case "sin":  # pi/2 +- (pi/2 - asin)
                return add(half, multiply(sign, add(half, negate(principal))))
        return add(principal, half, multiply(sign, half))

    def _quantities(self, equation: Sides, names: tuple[str, ...]) -> int:
        """Whether sides other than the name are quantities of the robot, such as b_{22}: 0 none, 1 some, 2 all."""
        lefts = [taken_apart(side.text) for side, name in zip(equation, names, strict=True) if not name]
        known = [bool(left and not self.is_own(left) and self.meanings.targets(left)) for left in lefts]
        return any(known) + all(known)

    def reader(self, index: int, more: dict[str, Expression] | None = None) -> LatexReader:
        """Reads an equation with the names that are defined at it or before it, else behind it."""
        meanings = dict(self._of_links)
        for name, found in self.definitions.items():
            # numbers are those of an example, but where they alone say what a name is
            defined = [one for one in found if not is_constant(one[1])] or found
            if force_named(name) in self.meanings.forces:
                continue
            # the last definition before the equation, else the first one behind it
            meanings[name] = min(defined, key=lambda pair: (pair[0] > index, abs(pair[0] - index)))[1]
        if any("\\ddot" in side.text for side in self.equations[index]):
            meanings |= self.torques
        meanings |= more or {}
        entry = partial(entry_or_rate, self.meanings, self.poses, meanings)
        names = LatexNames(self.robot, meanings, entry, self._signs, self._cosine_first, self._foreign)
        return LatexReader(names, self.text, self.start)

    def _new_name(self, side: LatexPiece, index: int, is_first: bool) -> str:
        """The name that a side is, where the robot does not know it and it is no quantity; otherwise empty."""
        left = None if side.matrices else taken_apart(side.text)
        if self.document and (match := whole.OF_ANGLE.fullmatch(side.text.strip())) is not None:
            angle = taken_apart(match["angle"])
            texts = (other.text for other in self.equations[index] if other is not side)
            is_free = angle and (not self._is_pose(angle) or any(map(_OF_PLACE.search, texts)))
            return angle.flat if angle and is_free and not self.plain.names.knows(angle.flat) else ""
        if self.document and (match := _SQUARED.fullmatch(side.text.strip())) is not None:
            left = taken_apart(match["name"])
            is_known = left is None or self.is_own(left) or left.is_point or self._is_pose(left) or is_rate(left.flat)
            return "" if is_known or left is None or any(map(is_scalar, self.meanings.targets(left))) else left.flat
        if self.document and left is not None and self._is_cell(left, index):
            return left.flat
        # of a joint variable or a point a prime may be the label of a branch or a derivative
        is_point = left is not None and bool(left.sub) and left.head in ("theta", "q", "d", "v", *AXES)
        is_point &= not (left and left.primes and whole.is_shifted(side.text, self.equations))
        if left is not None and left.primes and replace(left, primes=0).is_plain and self.document and not is_point:
            return left.flat  # a new angle or length, such as theta' = theta_2 - 90 degrees
        if left is None or not left.is_plain or self.is_own(left) or re.fullmatch("R[0-9]{4}|.*-.*", left.flat):
            return ""  # R_{36}(2,3) is an entry, z_{j-1} any axis
        if left.arguments and not (self.document and left.head in "rhlD"):  # r(q_2, q_3), a length in the plane
            return ""
        rest = " ".join(other.text for other in self.equations[index] if other is not side)
        is_angle = left.head in ANGLES and not left.sub
        if is_angle and self.document and _ARC.match(rest) and not _OF_ROTATION.search(rest):
            return left.flat  # an angle of a triangle, phi = arctan(...), unless entries of a rotation give it
        is_product = re.fullmatch(r"\s*[A-Za-z](?: +[A-Za-z])+\s*", side.text) is not None
        with suppress(CheckError):  # what looks like one name is a product of known ones, such as dC_{23}
            is_product |= len(left.head) > 1 and bool(self.plain.formula(side))
        if self.document and (is_product or is_rate(left.flat) or whole.is_force(side, rest, self.equations)):
            return ""
        if not left.is_point and self._is_pose(left):  # but z_w = p_{wz} - d_1
            return left.flat if self.poses and self.poses.is_other(left.flat, {*printed_words(rest)}) else ""
        if self.document and left.head == "omega" and not is_first:  # \dot\theta_1 = \omega_1, for equations of state
            rate = taken_apart(self.equations[index][0].text)
            if rate and rate.dots == 1 and self.is_own(replace(rate, dots=0)):
                return left.flat
        if not any(is_scalar(target) for target in self.meanings.targets(left)):
            return left.flat if left.head != "J" else ""
        # of the figure, not the Lagrangian, and a short name, not the kinetic energy
        is_length = left.flat in ("L", "K") and not re.search(r"dot|omega|['KTPUV]|(?<![A-Za-z\\])v", rest)
        is_lent = left.head in _LENT if left.sub else left.flat in "ku" or is_length
        if not is_first or not (is_angle or is_lent):
            return ""
        # what is a quantity by its letter is a name only where another formula has it
        first, own = 0 if is_angle or left.is_point else 1, side.text.strip()
        others = (e for i, e in enumerate(self.equations) if i != index and len(e) > 1)
        parts = (part for e in others for part in e[first:])
        is_used = any(own in text for part in parts if part.text.strip() != own for text in part.texts)
        return left.flat if is_used else ""

    def _is_cell(self, left: Left, index: int) -> bool:
        """Whether a joint's variable by another letter is a cell of its row, d_3 = q_3 - l_3, or a sum of joints."""
        if not left.is_plain or left.head not in ("d", "theta") or left.flat in own_names(self.robot):
            return False
        variable = self.plain.names.meaning(Symbol(left.flat, 0)) if self.is_own(left) else None
        if isinstance(variable, Sum):  # theta_{23} = q_2 - q_3, an angle of the author's own
            with suppress(CheckError):
                cells = [self.plain.formula(side) for side in self.equations[index][1:]]
                return any(isinstance(e, Sum) and not compare(self.robot, e, variable).equal for e in cells)
        if not isinstance(variable, Name):
            return False
        joints, own = {joint.variable for joint in self.robot.movers}, (variable, negate(variable))
        for side in self.equations[index][1:]:
            with suppress(CheckError):
                cell = self.plain.formula(side)
                terms = cell.terms if isinstance(cell, Sum) else (cell,)
                others = [term for term in terms if term not in own]
                is_still = joints.isdisjoint(name for term in others for name in names(term))
                # theta_2 = alpha_1 + alpha_2, the angle of a link from one direction
                is_sum = all(isinstance(term, Name) and term.name in joints for term in others)
                if cell != variable and len(others) < len(terms) and (is_still or is_sum):
                    return True
        return False

    def _is_pose(self, left: Left) -> bool:
        return self.poses is not None and self.poses.placeholder(left.flat) is not None

    def is_own(self, left: Left) -> bool:
        """Whether a left side is a name of the robot itself, such as a_1 or c_{12}."""
        return left.is_plain and self.plain.names.knows(left.flat)
