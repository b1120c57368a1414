"""Files of printed Newton-Euler equations, in base coordinates or link by link, and the loop around them."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from derive.check import tree
from derive.check.diagnosis import Repair
from derive.check.edits import Kind
from derive.check.findings import FileReport, Finding, Role
from derive.check.recursion_values import RESULTS, SETS, Case, cases
from derive.check.remarks import printed_in, remark
from derive.check.vector_diagnosis import diagnose_vector
from derive.check.vector_formula import Vector, nodes, read_vector, value_of
from derive.errors import CheckError
from derive.mechanics.equality import Verdict
from derive.robot import document
from derive.robot.document import Node, Scalar
from derive.robot.expression import Name
from derive.robot.wording import listed, near_miss, quoted

UNREAD = ("initial_conditions", "textual", "lagrange")
_KEYS = ("source", "algorithm", *SETS, *UNREAD)
_EQUATION = ("correct", "kind", "note", "variants", "implied", "duplicate")
_LOOP = ("id", "printed_stop", "correct_stop")
_TOLERANCE = 1e-10
_SHOWN = {"newton_euler_base": "Newton-Euler, base frame", "newton_euler_link": "Newton-Euler, link frame"}


def check_methods(root: document.Mapping, source: str) -> FileReport:
    """Compare every printed equation with what the recursion computes.

    Args:
        root: The file, with at least one set of equations.
        source: Its name.

    Raises:
        CheckError: An equation, or the structure around it, cannot be read.
    """
    top = tree.mapping(root, "the file", (), _KEYS)
    findings: list[Finding] = []
    for name in SETS:
        for node in tree.items(tree.child(top, name), name):
            findings += _equation(name, node)
    loop = tree.child(top, "algorithm")
    if loop is not None:
        block = tree.mapping(loop, "algorithm", (), ("steps", "errata"))
        for node in tree.items(tree.child(block, "errata"), "errata"):
            findings += _loop(node)
    unread = tuple(name for name in UNREAD if name in top.entries)
    return FileReport(source, "Newton-Euler recursion", tuple(findings), unread, printed_in(top))


def _equation(name: str, node: Node) -> Iterator[Finding]:
    item = tree.mapping(node, "an equation", ("id", "joint", "result", "printed", "status"), _EQUATION)
    joint = tree.word(item, "joint", ("any", "revolute", "prismatic"), "any")
    result = tree.word(item, "result", RESULTS, "")
    known = [case for case in cases(name) if joint in ("any", case.joint)]
    erratum = tree.word(item, "status", ("ok", "erratum"), "ok") == "erratum"
    shown = f"{_SHOWN[name]}: {tree.scalar(item.entries['id'][1], 'id').text} ({joint} joint)"
    right = tree.child(item, "correct")
    for key, role in (("printed", Role.EQUATION), ("correct", Role.CORRECTION)):
        text = tree.child(item, key)
        if isinstance(text, Scalar):
            wrong = erratum and role is Role.EQUATION
            reference = right.text if isinstance(right, Scalar) else text.text
            yield _finding(item, shown, text, result, known, role, wrong, reference)


def _finding(
    item: document.Mapping,
    name: str,
    text: Scalar,
    result: str,
    known: list[Case],
    role: Role,
    erratum: bool,
    right: str,
) -> Finding:
    printed = read_vector(text.text, text.inner)
    _require_names(printed, known[0], text)
    names = [n for n in known[0].values if n != result]

    def holds(e: Vector) -> bool:
        return all(_holds(e, case, result) for case in known)

    equal = holds(printed)
    repair = None if equal else diagnose_vector(printed, names, holds)
    shown = right if right != text.text or repair is None else str(repair.formula)
    where, said = text.inner, remark(item)
    verdict = Verdict(equal, False)
    return Finding(name, 0, 0, role, text.text, verdict, shown, where, erratum, repair=repair, remark=said)


def _holds(e: Vector, case: Case, result: str) -> bool:
    try:
        value = value_of(e, case.values)
    except (ValueError, TypeError):
        return False
    expected = case.values[result]
    return np.shape(value) == np.shape(expected) and bool(np.max(np.abs(value - expected)) < _TOLERANCE)


def _require_names(e: Vector, case: Case, text: Scalar) -> None:
    for node, _ in nodes(e):
        if node.operation == "name" and node.text not in case.values:
            raise CheckError(
                f"unknown name {quoted(node.text)}",
                allowed=f"allowed: {listed(case.values)}",
                remedy=near_miss(node.text, case.values),
                location=text.location,
            )


def _loop(node: Node) -> Iterator[Finding]:
    """The backward recursion starts at joint n; it must go on to joint 1 for every joint to get its torque."""
    item = tree.mapping(node, "an entry of errata", _LOOP, ("status", "kind", "note"))
    name, printed, correct = (tree.scalar(item.entries[key][1], key) for key in _LOOP)
    said = remark(item)
    for text, role in ((printed, Role.EQUATION), (correct, Role.CORRECTION)):
        shown = f"stop at i = {text.text}"
        verdict = Verdict(text.text == "1", True)
        erratum = role is Role.EQUATION and not verdict.equal
        repair = Repair((Kind.INDEX,), f"index: 1 instead of {text.text}", Name("1")) if not verdict.equal else None
        yield Finding(name.text, 0, 0, role, shown, verdict, "stop at i = 1", text.inner, erratum, None, repair, said)
