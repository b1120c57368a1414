"""The shorthand of lecture notes: ``c12`` is cos(q1 + q2), ``qd1`` the velocity of the joint labelled 1.

A label is the number at the end of a joint variable's name (4, 5, 6 for a wrist with q4, q5, q6). The digits of a token
are a label as a whole if they can be (``c10`` with a joint labelled 10), otherwise labels side by side (``c124``); two
ways to read them are one too many. What the robot itself calls c1 is never a token.

`read_formula` reads it; `notation_text` writes printed trees in it, grouping and order kept: ``s1*(a2*c2 - d3*s23)``.
"""

import difflib
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import lru_cache

from derive.errors import CheckError, ExpressionError, Location, UnknownNameError, listed, placed, quoted
from derive.robot import expression as tree
from derive.robot.description import derivatives
from derive.robot.expression import Call, Expression, Name, Sum, names, to_text
from derive.robot.names import acceleration_name, joint_label, joint_labels, own_names, velocity_name
from derive.robot.parser import FORMULA_FUNCTIONS, TokenKind, parse_expression, place, tokenize
from derive.robot.reading.size_limits import FORMULA_LIMITS
from derive.robot.robot import Robot

MAX_TOKEN_DIGITS = 24  # digits of one token: twelve two-digit labels; no notes add up more angles
_CIRCULAR = re.compile(r"([cs])([0-9]+)")
_LABELLED = re.compile(r"(q|qd|qdd)([0-9]+)")
_FUNCTION = {"c": "cos", "s": "sin"}
_RENAME: Mapping[str, Callable[[str], str]] = {"q": str, "qd": velocity_name, "qdd": acceleration_name}


def read_formula(
    text: str,
    robot: Robot,
    location: Location | None = None,
    abbreviations: Mapping[str, Expression] | None = None,
    functions: frozenset[str] = FORMULA_FUNCTIONS,
) -> Expression:
    """A printed formula as an expression in the robot's own names."""
    start = location or Location("<expression>")
    with placed(start):
        vocabulary = _vocabulary(robot, abbreviations)
    try:
        expression = parse_expression(text, start, functions | ({"sign"} - vocabulary.own), FORMULA_LIMITS)
        tokens = tokenize(text, start, FORMULA_LIMITS)
    except ExpressionError as error:
        where = error.location or start
        raise CheckError(error.found, allowed=error.allowed, remedy=error.remedy, location=where) from None
    # names in the order in which they stand, so that an error is placed at the first that is unknown
    wanted = set(names(expression))
    meanings: dict[str, Expression] = {}
    for token in tokens:
        if token.kind is TokenKind.NAME and token.text in wanted and token.text not in meanings:
            with placed(place(text, token.offset, start)):
                meanings[token.text] = vocabulary.meaning(token.text)
    found, limit = tree.substitute(expression, meanings), FORMULA_LIMITS.expanded_terms
    if tree.expanded_terms(found, limit) > limit:  # abbreviations may have made it long
        said = "formula has too many terms when multiplied out"
        raise CheckError(said, allowed=f"allowed: at most {limit}", location=start)
    return found


def resolve_tokens(
    expression: Expression, robot: Robot, abbreviations: Mapping[str, Expression] | None = None
) -> Expression:
    """An expression with the tokens of lecture notes replaced by what they stand for."""
    vocabulary = _vocabulary(robot, abbreviations)
    return tree.substitute(expression, {name: vocabulary.meaning(name) for name in dict.fromkeys(names(expression))})


@dataclass(frozen=True)
class _Vocabulary:
    """What names mean in the formulas of one robot."""

    own: frozenset[str]  # the robot's symbols, joint variables, velocities and accelerations
    revolute: Mapping[str, tuple[str, ...]]  # label -> variables of revolute joints that have it
    prismatic: Mapping[str, tuple[str, ...]]  # label -> variables of prismatic joints that have it
    abbreviations: Mapping[str, Expression] = field(default_factory=dict)  # names that stand for an expression

    def meaning(self, name: str) -> Expression:
        if name in self.abbreviations:
            return self.abbreviations[name]
        if name in self.own:
            return Name(name)
        if match := _CIRCULAR.fullmatch(name):
            return self._sine_or_cosine(name, _FUNCTION[match[1]], match[2])
        match = _LABELLED.fullmatch(name)
        variables = (*self.revolute.get(match[2], ()), *self.prismatic.get(match[2], ())) if match else ()
        if match is None or not variables:
            allowed = "allowed: symbols and joint variables of the robot, velocities, tokens such as c1, s12, qd1"
            raise UnknownNameError(f"unknown name {quoted(name)}", allowed=allowed, remedy=self._hint(name))
        if len(renamed := [_RENAME[match[1]](variable) for variable in variables]) > 1:
            raise CheckError(f"{name} can be read in two ways, {' or '.join(renamed[:2])}", remedy="write one of them")
        return Name(renamed[0])

    def _sine_or_cosine(self, token: str, function: str, digits: str) -> Expression:
        """The function of the sum of the joint angles whose labels are the digits."""
        if len(digits) > MAX_TOKEN_DIGITS:
            raise CheckError(f"token {quoted(token)}", allowed=f"allowed: at most {MAX_TOKEN_DIGITS} digits")
        # two ways to read the digits that sum the same angles are one: c12 is cos(q1 + q2) in either order
        readings: dict[frozenset[str], tuple[str, ...]] = {}
        whole = ((variable,) for variable in self.revolute.get(digits, ()))
        for reading in whole if digits in self.revolute else _splits(digits, self.revolute, frozenset()):
            readings.setdefault(frozenset(reading), reading)
            if len(readings) == 2:
                shown = " or ".join(f"{function}({' + '.join(reading)})" for reading in readings.values())
                raise CheckError(f"{token} can be read in two ways, {shown}", remedy="write the function out")
        if readings:
            (reading,) = readings.values()
            return Call(function, (tree.add(*(Name(variable) for variable in reading)),))
        if sliding := self.prismatic.get(digits):
            raise UnknownNameError(f"{token}: joint {digits} is prismatic", remedy=f"its variable is {sliding[0]}")
        found = f"{token}: its digits are no labels of revolute joints"
        remedy = self._hint(token) or "a symbol of that name must occur in the robot file"
        raise UnknownNameError(found, allowed=f"labels {', '.join(self.revolute) or 'none'}", remedy=remedy)

    def _hint(self, name: str) -> str:
        """Up to three names that look alike; of equally near ones those with the same first letter."""
        tokens = [f"{letter}{label}" for letter in "cs" for label in self.revolute]
        wrong = name[:80]
        known = dict.fromkeys([*tokens, *self.abbreviations, *sorted(self.own)])
        ratios = {candidate: difflib.SequenceMatcher(None, wrong, candidate).ratio() for candidate in known}
        close = [candidate for candidate, ratio in ratios.items() if ratio >= 0.5]
        nearest = sorted(close, key=lambda c: (-ratios[c], c[0] != wrong[0]))[:3]
        return f"did you mean {listed(nearest)}?" if nearest else ""


def _vocabulary(robot: Robot, abbreviations: Mapping[str, Expression] | None) -> _Vocabulary:
    plain = _robot_vocabulary(robot)
    if taken := sorted((abbreviations or {}).keys() & plain.own):
        raise CheckError(f"abbreviation {taken[0]!r} is also a name of the robot", remedy="choose another name for it")
    return replace(plain, abbreviations={**plain.abbreviations, **(abbreviations or {})})


@lru_cache(maxsize=16)
def _robot_vocabulary(robot: Robot) -> _Vocabulary:
    rates = (rename(joint.variable) for joint in robot.movers for rename in (velocity_name, acceleration_name))
    linear = {joint.variable: joint.meant for joint in robot.joints if joint.meant is not None}
    still = {variable.variable: tree.ZERO for variable in robot.variables}
    for name, value in [*linear.items()]:
        for rename in (velocity_name, acceleration_name):
            moving = tree.substitute(value, {variable: Name(rename(variable)) for variable in still})
            linear[rename(name)] = tree.add(moving, tree.negate(tree.substitute(value, still)))
    slopes = (name.name for name in derivatives(robot).values())
    by_label: dict[bool, dict[str, tuple[str, ...]]] = {True: {}, False: {}}
    labels = joint_labels(robot)
    for joint in robot.movers:
        if label := labels[joint.variable]:
            found = by_label[joint.is_revolute]
            found[label] = (*found.get(label, ()), joint.variable)
    return _Vocabulary(own_names(robot).union(rates, slopes), by_label[True], by_label[False], linear)


def _splits(digits: str, labels: Mapping[str, tuple[str, ...]], used: frozenset[str]) -> Iterator[tuple[str, ...]]:
    """All ways to read digits as distinct labels side by side."""
    if not digits:
        yield ()
        return
    for label, variables in labels.items():
        rest = digits[len(label) :]
        if not label or label in used or not digits.startswith(label) or not _divisible(rest, tuple(labels)):
            continue
        for variable in variables:
            yield from ((variable, *others) for others in _splits(rest, labels, used | {label}))


@lru_cache(maxsize=4096)
def _divisible(digits: str, labels: tuple[str, ...]) -> bool:
    """Whether digits are labels side by side, repeats allowed; it cuts the search short."""
    return not digits or any(
        label and digits.startswith(label) and _divisible(digits[len(label) :], labels) for label in labels
    )


def notation_text(expression: Expression, robot: Robot, write: Callable[[Fraction], str] = str) -> str:
    """A tree as one line; ``c12`` for cos(q1 + q2) where that can be read in one way only."""
    revolute = {joint.variable for joint in robot.variables if joint.is_revolute}
    digits = {variable: digit for variable, digit in clear_labels(robot).items() if variable in revolute}
    return to_text(_with_tokens(expression, digits), write)


def clear_labels(robot: Robot) -> dict[str, str]:
    """Joint variable -> its digit; none where tokens such as c12 could be read in two ways."""
    labels = {joint.variable: joint_label(joint.variable) for joint in robot.variables}
    is_clear = all(len(label) == 1 for label in labels.values()) and len(set(labels.values())) == len(labels)
    return labels if is_clear and not any(map(_CIRCULAR.fullmatch, own_names(robot))) else {}


def _with_tokens(e: Expression, labels: Mapping[str, str]) -> Expression:
    """A tree with names such as c12 in the place of cosines and sines of labelled joint angles."""
    if isinstance(e, Call) and e.function in _FUNCTION.values():
        (angle,) = e.arguments
        terms = angle.terms if isinstance(angle, Sum) else (angle,)
        found = [labels.get(term.name, "") if isinstance(term, Name) else "" for term in terms]
        if all(found) and len(set(found)) == len(found):
            return Name(e.function[0] + "".join(sorted(found)))
    return tree.rebuilt(e, lambda part: _with_tokens(part, labels))
