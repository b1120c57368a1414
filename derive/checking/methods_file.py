"""Files of printed Newton-Euler equations, in base coordinates or link by link, and the loop around them.

Every link of some arms with revolute and prismatic joints, odd twists and full inertia tensors is a case: an equation
is right when it gives, from what the recursion knows at that step, what the recursion computes there.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cache, partial, reduce
from itertools import chain, islice
from operator import add, matmul, mul
from typing import Any

import numpy as np
from lark import Token
from lark.exceptions import UnexpectedInput
from lark.visitors import Transformer_NonRecursive

from derive.checking.formulas import reading
from derive.checking.formulas.diagnosis import Repair
from derive.checking.formulas.edits import SlipKind
from derive.checking.formulas.findings import FileReport, Finding, Role
from derive.checking.formulas.reading import required_text
from derive.checking.latex.grammar import parser
from derive.errors import CheckError, Location, listed, near_miss, quoted
from derive.mechanics.floats import FloatDomain
from derive.mechanics.printed_newton_euler import LinkStep, PrintedRecursion, printed_newton_euler
from derive.model.equality import Verdict
from derive.robot.expression import Name
from derive.robot.parser import place
from derive.robot.reading.document import Node, YamlMapping, YamlScalar
from derive.robot.robot import Robot

Array = Any

SETS: Mapping[str, Callable[..., PrintedRecursion[float]]] = {
    "newton_euler_base": partial(printed_newton_euler, base=True),
    "newton_euler_link": partial(printed_newton_euler, base=False),
}
RESULTS = ("w", "wd", "vd", "a", "F", "N", "f", "n", "tau")  # what an equation may compute
ARMS = (("rpr", 1), ("rrp", 2), ("prrpr", 3))  # joints, both kinds as first, inner and last one, and seed
UNREAD = ("initial_conditions", "textual", "lagrange")
_EQUATION = ("correct", "kind", "note", "variants", "implied", "duplicate")
_LOOP = ("id", "printed_stop", "correct_stop")
_TOLERANCE = 1e-10  # absolute: far above the rounding of the recursion here, far below what a wrong equation misses

LinkCase = tuple[str, Mapping[str, Array]]  # the joint of a link; by name what it has there, a number, (3,) or (3, 3)


def check_methods(root: YamlMapping, source: str) -> FileReport:
    """Compare every printed equation with what the recursion computes."""
    top = reading.mapping(root, "the file", (), ("source", "algorithm", *SETS, *UNREAD))
    findings = [f for name in SETS for x in reading.items(reading.child(top, name), name) for f in _equation(name, x)]
    if (loop := reading.child(top, "algorithm")) is not None:
        block = reading.mapping(loop, "algorithm", (), ("steps", "errata"))
        # the backward recursion starts at joint n; it must go on to joint 1 for every joint to get its torque
        for node in reading.items(reading.child(block, "errata"), "errata"):
            item = reading.mapping(node, "an entry of errata", _LOOP, ("status", "kind", "note"))
            loop_name, printed, correct = (required_text(item, key) for key in _LOOP)
            said = reading.remark(item)
            for text, role in ((printed, Role.EQUATION), (correct, Role.CORRECTION)):
                shown, verdict = f"stop at i = {text.text}", Verdict(text.text == "1", True)
                change = Repair((SlipKind.INDEX,), f"index: 1 instead of {text.text}", Name("1"))
                repair, erratum = None if verdict.equal else change, role is Role.EQUATION and not verdict.equal
                where, stop = text.inner, "stop at i = 1"
                found = Finding(loop_name.text, 0, 0, role, shown, verdict, stop, where, erratum, None, repair, said)
                findings.append(found)
    unread = tuple(name for name in UNREAD if name in top.entries)
    return FileReport(source, "Newton-Euler recursion", tuple(findings), unread, reading.printed_in(top))


def _equation(name: str, node: Node) -> Iterator[Finding]:
    item = reading.mapping(node, "an equation", ("id", "joint", "result", "printed", "status"), _EQUATION)
    joint = reading.word(item, "joint", ("any", "revolute", "prismatic"), "any")
    result = reading.word(item, "result", RESULTS, "")
    erratum, said = reading.status(item) == "erratum", reading.remark(item)
    known = [values for its_joint, values in cases(name) if joint in ("any", its_joint)]
    shown = f"Newton-Euler, {name.rpartition('_')[2]} frame: {required_text(item, 'id').text} ({joint} joint)"
    correction = reading.child(item, "correct")
    for key, role in (("printed", Role.EQUATION), ("correct", Role.CORRECTION)):
        text = reading.child(item, key)
        if not isinstance(text, YamlScalar):
            continue
        printed = read_vector(text.text, text.inner)
        if unknown := [named for named in names_in(printed) if named not in known[0]]:
            found, allowed = f"unknown name {quoted(unknown[0])}", f"allowed: {listed(known[0])}"
            raise CheckError(found, allowed=allowed, remedy=near_miss(unknown[0], known[0]), location=text.location)
        holds = partial(_holds_for_all, cases=known, result=result)
        equal = holds(printed)
        repair = None if equal else diagnose_vector(printed, [n for n in known[0] if n != result], holds)
        right = correction.text if isinstance(correction, YamlScalar) else text.text
        if right == text.text and repair is not None:
            right = str(repair.formula)
        wrong, where, verdict = erratum and role is Role.EQUATION, text.inner, Verdict(equal, False)
        yield Finding(shown, 0, 0, role, text.text, verdict, right, where, wrong, repair=repair, remark=said)


def _holds_for_all(e: Vector, cases: Sequence[Mapping[str, Array]], result: str) -> bool:
    """Whether an equation gives what the recursion computes, at every link."""
    with suppress(ValueError, TypeError):
        pairs = ((value_of(e, values), values[result]) for values in cases)
        return all(np.shape(a) == np.shape(b) and np.max(np.abs(a - b)) < _TOLERANCE for a, b in pairs)
    return False


@cache
def cases(name: str) -> tuple[LinkCase, ...]:
    """All links of the arms."""
    found = []
    for types, seed in ARMS:
        robot = _arm(types, seed)
        rng = random.Random(robot.name)
        q, qd, qdd = ([rng.uniform(-1.5, 1.5) for _ in range(robot.n)] for _ in range(3))
        links = SETS[name](robot, FloatDomain(robot, q), qd, qdd).links
        found += [_case(links, i) for i in range(robot.n)]
    return tuple(found)


def _case(links: tuple[LinkStep[float], ...], i: int) -> LinkCase:
    """What the names of printed equations stand for at one link; z_prev is in base coordinates in both sets."""
    step = links[i]
    data, before, now = step.data, step.previous, step.motion
    values: dict[str, Any] = {"w": now.w, "wd": now.wd, "v": now.v, "vd": now.vd, "a": step.a, "F": step.F, "N": step.N}
    values |= {"f": step.wrench.f, "n": step.wrench.n, "tau": step.tau}
    values |= {"w_prev": before.w, "wd_prev": before.wd, "v_prev": before.v, "vd_prev": before.vd}
    values |= {"p": data.p, "s": data.s, "m": data.mass, "I": data.inertia, "b": data.viscous}
    values |= {"qd": data.qd, "qdd": data.qdd, "f_next": step.following.f, "n_next": step.following.n}
    arrays = {name: np.array(value) for name, value in values.items()}
    rotation, previous = np.array(data.rotation), np.array(data.before)
    following = np.array(links[i + 1].data.before).T if i + 1 < len(links) else np.eye(3)
    # into the link's own frame: Rp from the link before, Rn from the next one, R0 from the base
    z0 = np.array([0.0, 0.0, 1.0])
    arrays |= {"Rp": previous, "Rn": following, "R0": rotation.T, "z0": z0}
    arrays |= {"z_prev": rotation @ previous @ z0, "p_in_next": following.T @ arrays["p"]}
    return "revolute" if data.revolute else "prismatic", arrays


def _arm(types: str, seed: int) -> Robot:
    rng = random.Random(seed)

    def _number(scale: float = 1.0) -> float:
        return round(rng.uniform(0.2, 1.2) * scale, 3)

    lines = [f"name: arm-{types}", "convention: standard", "joints:"]
    for letter in types:
        own, kind = {"r": ("d", "revolute"), "p": ("theta", "prismatic")}[letter]
        lines.append(f"  - {{type: {kind}, {own}: {_number()}, a: {_number()}, alpha: {_number()}}}")
    lines += ["gravity: [0, 0, -9.81]", "links:"]
    for _ in types:
        moments = ", ".join(f"{axes}: {2 + _number()}" for axes in ("xx", "yy", "zz"))
        tensor = moments + "".join(f", {axes}: {_number(0.1)}" for axes in ("xy", "xz", "yz"))
        body = f"mass: {_number()}, com: [{_number()}, {_number()}, {_number()}], inertia: {{{tensor}}}"
        lines.append(f"  - {{{body}, friction: {{viscous: {_number()}}}}}")
    return Robot.from_text("\n".join(lines) + "\n")


MAX_LENGTH = 400  # characters; three times the longest equation of the books, and no tree of them is too deep


@dataclass(frozen=True, slots=True)
class Vector:
    """A node: a name, a number, or an operation on the nodes below."""

    operation: str  # ``name``, ``number``, ``+``, ``*``, ``@``, ``cross`` or ``-`` (of one part)
    text: str = ""  # the name, or the digits
    parts: tuple[Vector, ...] = ()  # the nodes below

    def __str__(self) -> str:
        match self.operation:
            case "name" | "number":
                return self.text
            case "cross":
                return f"cross({self.parts[0]}, {self.parts[1]})"
            case "-":
                return f"-{_bracketed(self.parts[0])}"
            case "+":
                rest = (f" - {str(p)[1:]}" if p.operation == "-" else f" + {p}" for p in self.parts[1:])
                return str(self.parts[0]) + "".join(rest)
            case _:
                return (" @ " if self.operation == "@" else "*").join(map(_bracketed, self.parts))


def _bracketed(part: Vector) -> str:
    return f"({part})" if part.operation in "+-" else str(part)


def read_vector(text: str, where: Location) -> Vector:
    """A printed vector equation's right-hand side."""
    if len(text) > MAX_LENGTH:
        allowed = f"allowed: at most {MAX_LENGTH} characters"
        raise CheckError("vector equation too long", allowed=allowed, location=where)
    try:
        return _VectorBuilder().transform(parser("vector_equation.lark").parse(text))
    except UnexpectedInput as error:
        at = min(getattr(error, "pos_in_stream", None) or 0, len(text))
        found, there = f"vector equation {quoted(text, 80)}", place(text, at, where)
        raise CheckError(found, allowed="allowed: names, numbers, + - * @, cross(a, b)", location=there) from None


class _VectorBuilder(Transformer_NonRecursive[Token, Vector]):
    def __default__(self, data: str, children: list[Any], meta: object) -> Vector:
        """What a rule of the grammar makes of its parts."""
        match data, children:
            case (("name" | "number"), (token,)):
                return Vector(str(data), str(token))
            case "negative", (_, product):
                return Vector("-", parts=(product,))
            case "cross", (a, b):
                return Vector("cross", parts=(a, b))
            case "sum", (first, *rest):
                pairs = zip(rest[::2], rest[1::2], strict=True)
                signed = (Vector("-", parts=(term,)) if sign == "-" else term for sign, term in pairs)
                return Vector("+", parts=(first, *signed))
            case "product", (first, *rest):
                found: Vector = first
                for sign, factor in zip(rest[::2], rest[1::2], strict=True):
                    found = Vector(str(sign), parts=(found, factor))
                return found
        raise AssertionError(data)


_OPERATIONS: Mapping[str, Callable[[Array, Array], Array]] = {"+": add, "*": mul, "@": matmul, "cross": np.cross}


def value_of(e: Vector, values: Mapping[str, Array]) -> Array:
    """The value of an equation whose names stand for numbers, vectors (3,) and matrices (3, 3)."""
    if not e.parts:
        return values[e.text] if e.operation == "name" else float(e.text)
    parts = [value_of(part, values) for part in e.parts]
    shapes = {np.shape(part) for part in parts}
    if (e.operation == "+" and len(shapes) > 1) or (e.operation == "cross" and shapes != {(3,)}):
        raise ValueError("vectors beside scalars, or a cross product of something else than vectors")
    return reduce(_OPERATIONS[e.operation], parts) if len(parts) > 1 else -parts[0]


def names_in(e: Vector) -> Iterator[str]:
    """Every name in an equation, in order of appearance."""
    if e.operation == "name":
        yield e.text
    for part in e.parts:
        yield from names_in(part)


Change = tuple[SlipKind, str, Vector]

MAX_TRIES = 10_000  # changes of one kind that are tried, so that the search ends for the longest equation too


def diagnose_vector(printed: Vector, names: Sequence[str], holds: Callable[[Vector], bool]) -> Repair | None:
    """One change that makes an equation hold, or two names of the same letter; None where no such change does."""
    ways = {what: partial(_changes, what, names) for what in ("sign", "relative", "operation", "other")}
    single = (change for way in ways.values() for change in islice(_everywhere(printed, way), MAX_TRIES))
    # two names of the same letters: a link's index mistaken throughout one term
    pairs = (
        (kind, f"2 changes: {first}; {second}", twice)
        for kind, first, changed in _everywhere(printed, ways["relative"])
        for _, second, twice in _everywhere(changed, ways["relative"])
    )
    tried = chain(((1, *change) for change in single), ((2, *change) for change in islice(pairs, MAX_TRIES)))
    found = (Repair((kind,) * count, text, Name(str(made))) for count, kind, text, made in tried if holds(made))
    return next(found, None)


def _everywhere(e: Vector, change: Callable[[Vector], Iterator[Change]]) -> Iterator[Change]:
    """The equation with one of its nodes changed, for every node from the root down."""
    yield from change(e)
    for i, part in enumerate(e.parts):
        for kind, text, changed in _everywhere(part, change):
            yield kind, text, replace(e, parts=(*e.parts[:i], changed, *e.parts[i + 1 :]))


def _changes(what: str, names: Sequence[str], node: Vector) -> Iterator[Change]:
    """The changes of one sort at one node; relatives have the same first letter, another dot or another index."""
    match what, node.operation:
        case "sign", "+":
            for i, term in enumerate(node.parts):
                other = term.parts[0] if term.operation == "-" else Vector("-", parts=(term,))
                turned = Vector("+", parts=(*node.parts[:i], other, *node.parts[i + 1 :]))
                yield SlipKind.SIGN, f"sign of {term}", turned
        case (("relative" | "other"), "name"):
            kind = SlipKind.INDEX if what == "relative" else SlipKind.SYMBOL
            for name in names:
                if name != node.text and (name[0] == node.text[0]) is (what == "relative"):
                    yield kind, f"{kind.value}: {name} instead of {node.text}", Vector("name", name)
        case "operation", "cross" | "+" if len(node.parts) == 2:  # a cross product where a sum is meant, or the reverse
            exchanged = Vector("+" if node.operation == "cross" else "cross", parts=node.parts)
            yield SlipKind.SYMBOL, f"operation: {exchanged} instead of {node}", exchanged
