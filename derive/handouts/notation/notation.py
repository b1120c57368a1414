r"""The notation of one robot: how its symbols are written, which angles are abbreviated, what stands first.

A name becomes a glyph: ``ml1`` is m_{l1}, ``alpha1`` is \alpha_{1}. What no rule covers, and what would look like
another symbol of the same robot, is set in monospace letters as the user typed it: no two names of a robot look the
same. Joint variables may have another letter than in the robot file (q1 written \theta_1, \vartheta_1 or q_1, d3
written d_3 or q_3); their index is the label of the joint, the digits at the end of the variable's name. A variable
without a label keeps its name, and so does one whose letter and index would look like another symbol of the robot.

c_{12} stands for cos(q1 + q2), labels being the digits at the end of the joint variables' names. As soon as one label
has two digits every sum is written with commas, c_{1,2}, so that c_{12} can only be the cosine of joint 12.

Terms and factors have the order that textbooks use. Factors: number, ratios, masses and inertias, other parameters,
prismatic variables, cosines and sines by joint, brackets, velocities, accelerations. Terms: accelerations before
velocities before the rest, then by inertial parameter, terms without cosines and sines before those with, by joint from
the base outwards, cosine before sine, then by parameter; multiples of pi last. Equal keys keep the order of the
expression.
"""

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cache, cached_property
from typing import Any, Self

from sympy import pi

from derive.handouts.notation.pieces import EMPTY, GREEK, Box, concatenate, greek, italic, monospace, script, upright
from derive.robot.description import INERTIA, derivatives
from derive.robot.expression import names
from derive.robot.names import acceleration_name, joint_label, limit_symbols, robot_symbols, velocity_name
from derive.robot.options.handout import AngleLetter, Functions, NotationOptions, SliderLetter
from derive.robot.robot import Robot
from derive.robot.rounding import DIGITS, is_given_in_decimals

LONGEST_SUFFIX = 2  # letters after the first that still read as a subscript: Ixx, cx, ml; longer names are words
_COMMA = Box(",", 3.0)
_ABBREVIATION = re.compile(r"[cs]_\{[0-9,]+\}")  # what is read as the cosine or sine of a joint angle, such as c_{12}
_REVOLUTE_LETTERS: Mapping[AngleLetter, Box] = {
    AngleLetter.THETA: greek("theta"),
    AngleLetter.VARTHETA: greek("vartheta"),
    AngleLetter.Q: italic("q"),
}
_PRISMATIC_LETTERS: Mapping[SliderLetter, Box] = {SliderLetter.D: italic("d"), SliderLetter.Q: italic("q")}


@dataclass(frozen=True, slots=True)
class Glyph:
    r"""A symbol."""

    head: Box  # the letter or word
    sub: Box = EMPTY  # the subscript, empty if there is none
    accent: str = ""  # ``\dot``, ``\ddot`` or empty

    @property
    def box(self) -> Box:
        """The symbol as it is printed."""
        return self.power(EMPTY)

    def power(self, exponent: Box) -> Box:
        """The symbol raised to a power."""
        head = self.head
        accented = Box(f"{self.accent}{{{head.tex.rstrip()}}}", head.width) if self.accent else head
        return script(accented, self.sub, exponent)


def natural(name: str) -> Glyph:
    """A name as a textbook would print it, else in monospace letters."""
    parts = name.split("_")
    if (match := re.fullmatch(r"([A-Za-z]+)([0-9][A-Za-z0-9]*)?", parts[0])) is None or not all(parts):
        return Glyph(monospace(name))
    letters, suffix = match.group(1), ""
    if letters in GREEK and letters != "pi":
        head = greek(letters)
    elif len(letters) <= 1 + LONGEST_SUFFIX:
        head, suffix = italic(letters[0]), letters[1:]
    else:
        head = upright(letters)
    suffix += match.group(2) or ""
    subscripts = [italic(suffix)] if suffix else []
    for part in parts[1:]:  # behind an underscore: a Greek letter, an index, or a word with or without one
        word = part.rstrip("0123456789")
        if part in GREEK:
            subscripts.append(greek(part))
        elif len(word) <= LONGEST_SUFFIX:
            subscripts.append(italic(part))
        else:
            subscripts.append(upright(part) if word == part else concatenate(upright(word), italic(part[len(word) :])))
    commas = (box for subscript in subscripts for box in (_COMMA, subscript))
    return Glyph(head, concatenate(*list(commas)[1:]) if subscripts else EMPTY)


def distinct(names: Iterable[str], chosen: Mapping[str, Glyph] | None = None) -> Iterator[tuple[str, Glyph]]:
    """A glyph for each name; an earlier name keeps its own one where two would look the same."""
    taken: set[str] = set()
    for name in names:
        glyph = (chosen or {}).get(name) or natural(name)
        if glyph.box.tex in taken or _ABBREVIATION.fullmatch(glyph.box.tex):
            glyph = Glyph(monospace(name))
        taken.add(glyph.box.tex)
        yield name, glyph


def variable_glyphs(robot: Robot, names: Iterable[str], options: NotationOptions) -> dict[str, Glyph]:
    """The joint variables that are written with another letter than in the robot file."""
    names = tuple(names)
    chosen: dict[str, Glyph] = {}
    turning, sliding = _REVOLUTE_LETTERS.get(options.angle), _PRISMATIC_LETTERS.get(options.prismatic)
    for mover in robot.movers:
        letters, label = turning if mover.is_revolute else sliding, joint_label(mover.variable)
        if letters and label:
            chosen[mover.variable] = Glyph(letters, italic(label))
    while True:  # giving one glyph up may bring back a name that clashes with another in turn
        printed = {name: (chosen.get(name) or natural(name)).box.tex for name in names}
        uses = Counter(printed.values())
        if not (clashing := {name for name in chosen if uses[printed[name]] > 1}):
            return chosen
        chosen = {name: glyph for name, glyph in chosen.items() if name not in clashing}


@dataclass(frozen=True)
class Notation:
    """How the symbols of a robot are written."""

    glyphs: Mapping[str, Glyph]  # the symbol of every name, velocities and accelerations included
    positions: Mapping[str, tuple[int, int]]  # in the order of factors: parameters, variables, rates, accelerations
    labels: Mapping[str, str]  # joint variable of a revolute joint -> its label, where no other one has that
    inertial: Mapping[str, int]  # masses, inertias and ratios, in the order of the links
    decimals: bool  # whether rationals are printed as decimals
    digits: int | None = DIGITS  # significant digits of a number in print; None for all of them
    comma: bool = False  # whether decimals stand behind a comma
    degrees: bool = False  # whether multiples of pi in angles are written in degrees
    options: NotationOptions = field(default_factory=NotationOptions)  # what the robot file or the reader chose

    @classmethod
    def of(cls, robot: Robot, options: NotationOptions | None = None, *, comma: bool = False) -> Self:
        """The notation of a robot; without options variables are written as in the robot file."""
        options = options or NotationOptions()
        labels = {mover.variable: joint_label(mover.variable) for mover in robot.movers if mover.is_revolute}
        uses = Counter(labels.values())
        positions = {name: (0, index) for index, name in enumerate(robot_symbols(robot))}
        variables = [mover.variable for mover in robot.movers]
        everything = dict.fromkeys((*variables, *robot_symbols(robot), *(name for name, _ in robot.parameters)))
        printed = dict.fromkeys((*everything, *limit_symbols(robot)))
        glyphs = dict(distinct(everything, variable_glyphs(robot, printed, options)))
        for of, derivative in derivatives(robot).items():  # G of two names, H of three
            glyphs[derivative.name] = Glyph(italic(derivative.name[0]), concatenate(*(glyphs[name].box for name in of)))
        for name in variables:
            glyphs[velocity_name(name)] = replace(glyphs[name], accent="\\dot")
            glyphs[acceleration_name(name)] = replace(glyphs[name], accent="\\ddot")
        for index, name in enumerate(variables):
            positions[name] = (1, index)
            positions[velocity_name(name)] = (2, index)
            positions[acceleration_name(name)] = (3, index)
        return cls(
            glyphs=glyphs,
            positions=positions,
            labels={variable: label for variable, label in labels.items() if label and uses[label] == 1},
            inertial=_inertial(robot),
            decimals=is_given_in_decimals(robot),
            comma=comma,
            options=options,
        )

    def glyph(self, name: str) -> Glyph:
        """The symbol of a name."""
        return self.glyphs.get(name) or natural(name)

    def with_terms(self, terms: Mapping[str, Glyph]) -> Self:
        """The same notation with further symbols, for named intermediate terms."""
        return replace(self, glyphs={**self.glyphs, **terms})

    @property
    def abbreviates(self) -> bool:
        """Whether c_{12} is written for the cosine of a sum of joint angles."""
        return self.options.functions is Functions.SHORT

    @cached_property
    def taken(self) -> frozenset[str]:
        """LaTeX of every symbol of the robot."""
        return frozenset(glyph.box.tex for glyph in self.glyphs.values())

    @cached_property
    def separator(self) -> str:
        """What stands between the labels of a sum."""
        return "," if any(len(label) > 1 for label in self.labels.values()) else ""

    def abbreviation(self, letter: str, variables: tuple[str, ...], exponent: Box) -> Box:
        """The abbreviated cosine or sine of a sum of joint angles, raised to a power."""
        text = self.separator.join(self.labels[variable] for variable in variables)
        return script(italic(letter), italic(text), exponent)


def _inertial(robot: Robot) -> dict[str, int]:
    found: dict[str, None] = {}
    for link in robot.links:
        cells = [link.mass, *(getattr(link.inertia, key) for key in INERTIA), link.armature]
        cells += [link.motor.ratio, link.motor.mass, link.motor.inertia] if link.motor is not None else []
        found.update(dict.fromkeys(name for cell in cells for name in names(cell)))
    return {name: index for index, name in enumerate(found)}


# -- the order of terms and factors

BaseKey = tuple[int, tuple[int, ...], str]
FactorKey = tuple[int, tuple[int, ...], str, float]
FactorKeys = tuple[FactorKey, ...]
TermKey = tuple[int, FactorKeys, tuple[int, ...], FactorKeys, FactorKeys, FactorKeys]

_NUMBER, _UNKNOWN, _INERTIAL, _PARAMETER, _OFFSET = range(5)
_TRIGONOMETRIC, _OTHER, _BRACKET, _VELOCITY, _ACCELERATION = range(5, 10)
_CLASS_OF_POSITION = (_PARAMETER, _OFFSET, _VELOCITY, _ACCELERATION)
_NO_POSITION = (0, 0)


class Order:
    """Sort keys for the expressions of one robot."""

    def __init__(self, notation: Notation) -> None:
        self._positions, self._inertial, self._angles = notation.positions, notation.inertial, notation.labels
        self.factor, self._base = cache(self._factor_key), cache(self._base_key)
        self._terms: dict[Any, TermKey] = {}

    def _factor_key(self, factor: Any) -> FactorKey:
        base, exponent = factor.as_base_exp()
        return (*self._base(base), float(exponent) if exponent.is_number else 0.0)

    def term(self, term: Any) -> TermKey:
        """Sort key of a term of a sum."""
        if term in self._terms:
            return self._terms[term]
        # Of c m2 a1 l2 s2 qd1 qd2: the rates first, then inertial parameters, sines and cosines, other parameters.
        rest = term.as_coeff_Mul()[1]
        factors = rest.args if rest.is_Mul else (rest,)
        bases = [factor.as_base_exp()[0] for factor in factors]
        inertial = sorted(self._inertial[base.name] for base in bases if base.is_Symbol and base.name in self._inertial)
        keys = sorted(self.factor(factor) for factor in factors)
        motion = tuple(key for key in keys if key[0] >= _VELOCITY)
        trigonometric = tuple(key for key in keys if key[0] == _TRIGONOMETRIC)
        plain = tuple(key for key in keys if key[0] < _TRIGONOMETRIC)
        brackets = tuple(key for key in keys if key[0] in (_OTHER, _BRACKET))
        rank = -keys[-1][0] if motion else int(rest.has(pi))
        if rest.is_Symbol and rest.name in self._angles:  # q1 + beta, with the joint angle first
            rank = -1
        known = self._terms[term] = (rank, motion, tuple(inertial), trigonometric, plain, brackets)
        return known

    def _base_key(self, base: Any) -> BaseKey:
        if base.is_Symbol and base.name in self._inertial:
            return (_INERTIAL, (self._inertial[base.name],), "")
        if base.is_Symbol:
            if (position := self._positions.get(base.name)) is None:
                return (_UNKNOWN, (), base.name)
            return (_CLASS_OF_POSITION[position[0]], (position[1],), "")
        if base.is_Number or base.is_NumberSymbol:
            return (_NUMBER, (), str(base))
        name = getattr(base.func, "__name__", "")
        # Of a sine or cosine the joints in its argument count, of a bracket whether it holds anything but rates.
        positions = [self._positions.get(symbol.name, _NO_POSITION) for symbol in base.free_symbols]
        if name in ("cos", "sin"):
            angle = base.args[0]
            joints = tuple(sorted(index for rank, index in positions if rank == 1))
            plain = joints and (angle.is_Symbol or all(term.is_Symbol for term in angle.args))
            return (_TRIGONOMETRIC, joints, name if plain else f"{angle} {name}")
        if not base.is_Add:
            return (_OTHER, (), str(base))
        return (_VELOCITY if all(rank >= 2 for rank, _ in positions) else _BRACKET, (), "")


def is_below(exponent: Any) -> bool:
    """Whether a power belongs into a denominator."""
    return bool(exponent.is_Rational and exponent < 0)
