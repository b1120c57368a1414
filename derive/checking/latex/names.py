r"""Names as LaTeX prints them, found among the names of a robot: ``m_{\ell_1}`` is ml1, ``\vartheta_2`` joint 2."""

import re
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cache
from itertools import count

from derive.checking.formulas.branches import SIGN
from derive.errors import CheckError
from derive.lecture.shorthand import resolve_tokens
from derive.robot import tree
from derive.robot.description import Convention
from derive.robot.expression import ZERO, Call, Expression, Name, Pi, Sum, add, is_constant, names, negate
from derive.robot.names import acceleration_name, joint_labels, own_names, velocity_name
from derive.robot.robot import Robot

_GREEK = (
    "alpha beta gamma delta epsilon zeta eta theta iota kappa lambda mu nu xi omicron pi rho sigma sigma tau upsilon "
    "phi chi psi omega"
)
# Macros and signs that draw a letter, some in another way.
FLAT = {sign: name for i, name in enumerate(_GREEK.split()) for sign in (chr(ord("\u03b1") + i), name)}
FLAT |= {"ell": "l", "vartheta": "theta", "varphi": "phi", "varepsilon": "epsilon", "\u03d1": "theta", "\u03d5": "phi"}
ENERGY = "\u2202"  # before the letter of an energy that is differentiated
PRIME = "\u2032"  # of a name of the text's own; a plain one is a derivative
_JOINT = re.compile(r"(theta|th|q|d)([0-9]+)")
_ANGLE_SUM = re.compile(r"(theta|th|q)([0-9]{2,})")
_CHRISTOFFEL = re.compile(r"c[0-9]+,[0-9]{2,}|c[0-9]+,[0-9]+,[0-9]+")
_ANGLES = re.compile("(?:alpha|beta|gamma|theta|phi|psi)[0-9]*")
_ANGLE = {"c": "cos", "s": "sin"}

PlusMinus = Iterator[Name]  # gives every plus-minus of a text a name


def plus_minus() -> PlusMinus:
    """The names of all that a text may have."""
    return (Name(f"{SIGN}{k}") for k in count(1))


@dataclass(frozen=True, slots=True)
class Symbol:
    """A printed name."""

    text: str  # its letters, digits and commas, scripts set on the line
    offset: int  # where it begins
    dots: int = 0  # derivatives with respect to time


@dataclass(eq=False)
class LatexNames:
    """What printed names stand for: exact ones first, then joints and tokens such as c_{12}, then the one alike."""

    robot: Robot
    abbreviations: Mapping[str, Expression] = field(default_factory=dict)  # what names of the text itself stand for
    entry: Callable[[str], Expression | None] = lambda name: None  # the entry of a quantity that a name is
    signs: PlusMinus | None = None  # names for its plus-minus signs; None where none may occur
    cosine_first: bool | None = None  # whether Atan2 takes the cosine first; None if either will do
    foreign: frozenset[str] = frozenset()  # capitals that are other names than the robot's, for the text has both

    def __post_init__(self) -> None:
        self.own = own_names(self.robot).union(self.abbreviations)
        self.words: dict[str, str] = {}
        self._derived: dict[str, Expression] = {}  # what stands for a derivative in a text
        self._known = cache(self._meaning)

    def sign(self, word: str) -> str:
        """One character that stands for a word in a text; the same for the same word."""
        sign = next((sign for sign, known in self.words.items() if known == word), chr(0xE100 + len(self.words)))
        self.words[sign] = word
        return sign

    def standing_for(self, formula: Expression) -> str:
        """One character that stands for a formula in a text."""
        known = (word for word, other in self._derived.items() if other == formula)
        word = next(known, f"{ENERGY}{len(self._derived)}")
        self._derived[word] = formula
        return self.sign(word)

    def meaning(self, symbol: Symbol) -> Expression:
        """The expression that a printed name stands for."""
        return self._known(symbol.text, symbol.dots)

    def knows(self, text: str) -> bool:
        """Whether a printed name without dots stands for something, and for one thing only."""
        with suppress(CheckError):
            return bool(self.meaning(Symbol(text, 0)))
        return False

    def _meaning(self, text: str, dots: int) -> Expression:
        if text in self._derived:
            return self._derived[text]
        if _CHRISTOFFEL.fullmatch(text) and (entry := self.entry(text)):  # c_{1,23}; without the comma it is a cosine
            return entry
        text = text.replace(",", "")
        # c_{2-3}, the cosine of a difference of joint angles
        opposed = re.fullmatch(r"([csCS])((?:theta|th|q)?[0-9]+)((?:[-+](?:theta|th|q)?[0-9]+)+)", text)
        text = text if opposed else text.replace("+", "")
        if text == "pi":
            return Pi()
        if dots:
            return self._derivative(text, dots)
        angle = text[1:]  # the Greek one in c_{\alpha_1}; only of letters that are never lengths
        if text not in self.own and text[0].lower() in _ANGLE and _ANGLES.fullmatch(angle) and angle in self.own:
            return Call(_ANGLE[text[0].lower()], (self.abbreviations.get(angle, Name(angle)),))
        if opposed:
            signs, labels = re.findall("[-+]", opposed[3]), re.findall("[0-9]+", text)
            sums = ((x, sum_of_angles(self.robot, x)) for x in labels)
            angles = [add(*s) if s else resolve_tokens(Name(self._name(f"q{x}")), self.robot) for x, s in sums]
            others = (negate(a) if sign == "-" else a for sign, a in zip(signs, angles[1:], strict=True))
            return Call(_ANGLE[opposed[1].lower()], (add(angles[0], *others),))
        name = self._name(text)
        try:
            return resolve_tokens(Name(name), self.robot, self.abbreviations)
        except CheckError:
            if (match := _ANGLE_SUM.fullmatch(text)) and (terms := sum_of_angles(self.robot, match[2])):
                return add(*terms)
            if entry := self.entry(text) or self._cell(text):
                return entry
            raise

    def _cell(self, text: str) -> Expression | None:
        """The number in the table for which a document prints the usual name of its cell, d_1 or alpha_2."""
        match = re.fullmatch("(d|a|alpha)([1-9])", text)
        if match is None or self.signs is None or not tree.is_row_by_row(self.robot):
            return None
        # a_1 and alpha_1 are those of the row behind it in modified tables, but not where its length is d_1 (Khalil)
        is_khalils = any(name[0] == "d" for joint in self.robot.joints for name in names(joint.a))
        is_late = self.robot.convention is Convention.MODIFIED and match[1] != "d" and not is_khalils
        row = int(match[2]) - 1
        rows = [*self.robot.joints, *self.robot.fixed]
        cells = [getattr(one, match[1]) for one in (rows[row + is_late : row + is_late + 1] + rows[row : row + 1])]
        return next((cell for cell in cells if cell != ZERO and is_constant(cell)), None)

    def circular(self, symbol: Symbol) -> str:
        r"""``cos`` or ``sin`` where c or s stands for the function, as in ``c\theta_1``; otherwise empty."""
        plain = symbol.text.lower() in _ANGLE and not symbol.dots and symbol.text not in self.own
        return _ANGLE[symbol.text.lower()] if plain else ""

    def _derivative(self, text: str, dots: int) -> Expression:
        """The velocity or acceleration of a joint, or of a sum of joint angles."""
        variables = [joint.variable for joint in self.robot.movers]
        terms = [self._name(text)]
        if terms[0] not in variables:
            match = _ANGLE_SUM.fullmatch(text)
            angles = sum_of_angles(self.robot, match[2]) if match else ()
            terms = [term.name for term in angles if isinstance(term, Name)]
        if not terms and dots < 3 and (entry := self.entry(text + "'" * dots)):
            return entry
        if not terms:
            found = f"derivative of {text}, which is not a joint variable"
            raise CheckError(found, allowed=f"allowed: {', '.join(variables)}")
        if dots > 2:
            raise CheckError(f"{dots} dots", allowed="allowed: one for a velocity, two for an acceleration")
        return add(*(Name(velocity_name(term) if dots == 1 else acceleration_name(term)) for term in terms))

    def _name(self, text: str) -> str:
        """The robot's name, or the token, that is printed like this; the text itself where there is none."""
        if text in self.own or text in self.foreign:
            return text
        if (match := _JOINT.fullmatch(text)) and (variable := self._variable(match[1], match[2])):
            return variable
        if match := re.fullmatch(r"([csCS])((?:(?:theta|th|q)?[0-9]+)+)", text):
            return match[1].lower() + re.sub("[a-z]", "", match[2])
        for likeness, wanted in enumerate(_alike(text)):
            # a name that the text itself defines, such as A_x, is not another one in small letters
            known = self.own - self.abbreviations.keys() if likeness == 2 else self.own
            known = known if likeness < 2 or len(text) > 1 else frozenset()  # D is another letter than d
            found = sorted(name for name in known if _alike(name)[likeness] == wanted)
            if len(found) > 1:
                ways = " or ".join(found[:2])
                raise CheckError(f"{text} can be read in two ways, {ways}", remedy="write the name out")
            if found:
                return found[0]
        return text

    def _variable(self, stem: str, label: str) -> str:
        """The variable of the joint with a label, printed as theta, d or q; empty where there is none."""
        labels = joint_labels(self.robot)
        for joint in self.robot.movers:
            if labels[joint.variable] != label:
                continue
            if stem == "q" or (stem in ("theta", "th")) is joint.is_revolute:
                return joint.variable
            if stem != "d":
                remedy = f"its variable is d_{label} or q_{label}"
                raise CheckError(f"theta_{label}: joint {label} is prismatic", remedy=remedy)
        return ""


def sum_of_angles(robot: Robot, digits: str) -> tuple[Expression, ...]:
    r"""The joint angles of ``\theta_{12}``; none where the digits are no labels of revolute joints."""
    with suppress(CheckError):
        token = resolve_tokens(Name(f"c{digits}"), robot)
        angle = token.arguments[0] if isinstance(token, Call) else token
        return angle.terms if isinstance(angle, Sum) else ()
    return ()


def _alike(name: str) -> tuple[str, str, str]:
    """What names share that differ in underscores; in the place of the digits too; and in case too."""
    joined = re.sub("^var(?=phi|theta)", "", name.replace("_", ""))
    digits_last = "".join(sorted(joined, key=str.isdigit))
    return joined, digits_last, digits_last.casefold()
