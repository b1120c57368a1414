"""The cheapest forms of the joints for one function of one robot, by a short search.

Every combination of forms gives the same values, so the search may stop anywhere: from two starts it changes one
choice of one joint after another to what makes the traced graph cheapest, until nothing gets cheaper or the effort is
spent. Effort is counted in nodes, not in seconds, so that the result depends on the robot alone.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

from derive.algebra.tape_value import Value
from derive.mechanics.arrangement import holdable, places
from derive.mechanics.chain import Chain
from derive.mechanics.joint_form import JointForm

Forms = tuple[JointForm, ...]
Price = Callable[[Forms], tuple[int, int]]
"""What a function costs with some forms, and the nodes looked at to find that."""

_EFFORT = 80_000

CHAIN_CHOICES = ("place", "held", "second_moments")
ALL_CHOICES = (*CHAIN_CHOICES, "column", "squares")


class FormSearch:
    """Searches forms for one chain.

    Args:
        chain: The arm as built.
        choices: Names of the choices that make a difference to the function.
        price: The function's cost.
    """

    def __init__(self, chain: Chain[Value], choices: Sequence[str], price: Price) -> None:
        self._chain = chain
        self._choices = choices
        self._price = price
        self._known: dict[Forms, int] = {}
        self._effort = _EFFORT

    def best(self, starts: Sequence[Forms]) -> Forms:
        """The cheapest forms found."""
        forms = min(starts, key=self._cost)
        while self._effort > 0:
            better = self._swept(forms)
            if better == forms:
                break
            forms = better
        return forms

    def _swept(self, forms: Forms) -> Forms:
        """Every choice of every joint once."""
        for i in range(len(forms)):
            for choice in self._choices:
                for change in self._changes(i, forms[i], choice):
                    if self._effort <= 0:
                        return forms
                    forms = min(forms, (*forms[:i], change, *forms[i + 1 :]), key=self._cost)
        return forms

    def _changes(self, i: int, form: JointForm, choice: str) -> Sequence[JointForm]:
        """The form with one choice made otherwise, if that matters at this joint."""
        turns = self._chain.joints[i].revolute
        match choice:
            case "place":
                return [replace(form, place=place) for place in places(self._chain, i) if place is not form.place]
            case "held" if holdable(self._chain, i):
                return [replace(form, held=not form.held)]
            case "second_moments" if turns:
                return [replace(form, second_moments=not form.second_moments)]
            case "column":
                return [replace(form, column=not form.column)]
            case "squares" if turns and form.column:
                return [replace(form, squares=not form.squares)]
        return []

    def _cost(self, forms: Forms) -> int:
        found = self._known.get(forms)
        if found is None:
            found, nodes = self._price(forms)
            self._known[forms] = found
            self._effort -= nodes
        return found


def starting_forms(chain: Chain[Value]) -> tuple[Forms, ...]:
    """All held that can be, the last alone, none."""
    n = chain.n
    can = [holdable(chain, i) for i in range(n)]
    held = (can, [can[i] and i == n - 1 for i in range(n)], [False] * n)
    return tuple(tuple(JointForm(held=h, second_moments=True) for h in row) for row in held)
