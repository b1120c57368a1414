"""The cheapest forms of the joints for one function of one robot, by a short search.

Every combination of forms gives the same values, so the search may stop anywhere: from two starts it changes one
choice of one joint after another to what makes the traced graph cheapest, until nothing gets cheaper or the effort is
spent. Effort is counted in nodes, not in seconds, so that the result depends on the robot alone.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

from derive.algebra.tape_graph import Ref
from derive.algebra.tape_value import Value
from derive.mechanics.arrangement import holdable, places
from derive.mechanics.chain import Chain
from derive.mechanics.joint_form import JointForm

Forms = tuple[JointForm, ...]
Outputs = tuple[Ref, ...]
Trial = Callable[[Forms], Outputs]
"""Traces a function with some forms."""

Price = Callable[[Outputs], tuple[int, int]]
"""What some outputs cost, and the nodes looked at to find that."""

_EFFORT = 45_000

_MANY_JOINTS = 24
"""Above this the first start is taken as it is."""

_CLOSE = 1.01
"""Costs that improvement may bring below the best one, in terms of it."""

CHAIN_CHOICES = ("place", "held", "second_moments")
ALL_CHOICES = (*CHAIN_CHOICES, "column", "squares", "grown")


class FormSearch:
    """Searches forms for one chain.

    Args:
        chain: The arm as built.
        choices: Names of the choices that make a difference to the function.
        trial: Traces the function.
        price: What that costs.
    """

    def __init__(self, chain: Chain[Value], choices: Sequence[str], trial: Trial, price: Price) -> None:
        self._chain = chain
        self._choices = choices
        self._trial = trial
        self._price = price
        self._traced: dict[Forms, Outputs] = {}
        self._costs: dict[Outputs, int] = {}
        self._effort = _EFFORT

    def best(self, starts: Sequence[Forms], count: int = 1) -> tuple[Forms, ...]:
        """The cheapest forms found and up to ``count - 1`` that come close, each with another graph."""
        if self._chain.n > _MANY_JOINTS:
            return (starts[0],)
        forms = starts[0]
        self._cost(forms)
        for start in starts[1:]:
            forms = min(forms, start, key=self._cost) if self._effort > 0 else forms
        while self._effort > 0:
            better = self._swept(forms)
            if better == forms:
                break
            forms = better
        return self._ranked(count)

    def _ranked(self, count: int) -> tuple[Forms, ...]:
        """One for each graph, cheapest first, the first found of equals."""
        first: dict[Outputs, Forms] = {}
        for forms, outputs in self._traced.items():
            first.setdefault(outputs, forms)
        ranked = sorted(first, key=self._costs.__getitem__)[:count]
        limit = _CLOSE * self._costs[ranked[0]]
        return tuple(first[outputs] for outputs in ranked if self._costs[outputs] <= limit)

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
            case "grown" if turns and form.held and form.column and form.squares:
                return [replace(form, grown=not form.grown)]
        return []

    def _cost(self, forms: Forms) -> int:
        outputs = self._traced.get(forms)
        if outputs is None:
            outputs = self._traced[forms] = self._trial(forms)
        if outputs not in self._costs:
            self._costs[outputs], nodes = self._price(outputs)
            self._effort -= nodes
        return self._costs[outputs]


def starting_forms(chain: Chain[Value]) -> tuple[Forms, ...]:
    """All held that can be, the last alone, none."""
    n = chain.n
    can = [holdable(chain, i) for i in range(n)]
    held = (can, [can[i] and i == n - 1 for i in range(n)], [False] * n)
    return tuple(tuple(JointForm(held=h, second_moments=True) for h in row) for row in held)
