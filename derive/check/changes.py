"""Changes of a formula in words: ``sign of the 2nd term, -a2*c12``."""

from __future__ import annotations

from collections.abc import Sequence

from derive.check.edits import Edit, Kind, ordinal
from derive.check.shorthand import notation_text
from derive.robot.expression import Expression, Product, Sum
from derive.robot.robot import Robot


def changes_text(edits: Sequence[Edit], robot: Robot) -> str:
    """One change, or several and how many, with formulas in the notation of the robot."""
    texts = [_text(edit, robot) for edit in edits]
    return texts[0] if len(texts) == 1 else f"{len(texts)} changes: {'; '.join(texts)}"


def _text(edit: Edit, robot: Robot) -> str:
    def shown(e: Expression) -> str:
        return notation_text(e, robot)

    parent = edit.place.parent
    match edit:
        case Edit(kind=Kind.SIGN, new=None) if parent is None:
            whole = f"sign: {shown(edit.node)} instead of {shown(edit.old)}"
            return "sign of the whole" if isinstance(edit.old, Sum) else whole
        case Edit(kind=Kind.SIGN, new=None) if parent is not None:
            place = f" of {shown(parent)}" if edit.place.depth > 1 else ""
            return f"sign of the {ordinal(edit.place.index + 1)} term{place}, {shown(edit.old)}"
        case Edit(kind=Kind.EXTRA_TERM):
            return f"extra term: {shown(edit.old)}"
        case Edit(kind=Kind.EXTRA_FACTOR):
            return f"extra factor: {shown(edit.old)} in {shown(edit.place.node)}"
        case Edit(kind=Kind.MISSING_FACTOR, new=new) if new is not None:
            return f"missing factor: {shown(new)} of {shown(edit.old)}"
        case Edit(kind=Kind.MISSING_TERM, new=new) if new is not None:
            return f"missing term: {shown(new)}" + (f" beside {shown(edit.old)}" if parent is not None else "")
        case Edit(new=new) if new is not None:
            context = f" in {shown(parent)}" if isinstance(parent, Product) else ""
            return f"{edit.kind.words}: {shown(new)} instead of {shown(edit.old)}{context}"
    raise ValueError(edit.kind)
