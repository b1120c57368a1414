"""The cheapest forms of the joints for one function of one robot, by a short search.

Every combination of forms gives the same values, so the search may stop anywhere: from two starts it changes one
choice of one joint after another to what makes the traced graph cheapest, until nothing gets cheaper or the effort is
spent. Effort is counted in nodes, not in seconds, so that the result depends on the robot alone.

The arm rearranged for a recursion: where frames stand and turn, and which inertial parameters are left.

Three choices of a `FrameChoice` change the chain itself, none of them what any recursion computes:

- *place*: a joint turns about its axis wherever on it the origin stands, so its constant offset d may come before or
  after it, or join the offset of a parallel axis; links then share origins, and levers vanish.
- *held*: quantities of a link may be written in any axes. Axes that its joint does not turn save the turn of every
  motion and force; instead the body's constants are turned, which pays where no further joint follows, or where the
  next axis is parallel and its link is turned by the sum of the angles at once.
- *second_moments*: see `derive.mechanics.regrouping`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from derive.mechanics.chain import Body, Chain, ChainJoint
from derive.mechanics.joint_motion import shift, turn_about_z
from derive.mechanics.link_motion import FrameChoice, Place
from derive.mechanics.regrouping import Rule, regroup
from derive.mechanics.vectors import Frame, Vector, add, scale
from derive.programs.parallel_axes import SumOfTurns, Turn, about_z
from derive.programs.tape.graph import Ref
from derive.programs.tape.value import Value


def arrange(
    chain: Chain[Value], forms: Sequence[FrameChoice], total: SumOfTurns, half: Value, *, axial: bool = False
) -> Chain[Value]:
    """The chain as the forms ask, in base parameters; for dynamics alone, its tool and ends are those of the old one.

    Args:
        chain: The arm as built.
        forms: One for each joint; only such as `places` and `holdable` allow.
        total: Makes the cosine and sine of a sum of joint angles.
        half: The scalar 1/2.
        axial: Whether the recursion knows axial masses.
    """
    rules = [Rule(form.second_moments, axial and _slides_along_all(chain, i)) for i, form in enumerate(forms)]
    return _held(regroup(_placed(chain, forms), rules, half), forms, total)


def places(chain: Chain[Value], i: int) -> tuple[Place, ...]:
    """Where the origin of joint frame i may stand, as far as this makes a difference."""
    joint = chain.joints[i]
    found = [Place.AFTER]
    if joint.revolute and not _is(joint.offset, chain.zero):
        found.append(Place.BEFORE)
    if joint.revolute and i + 1 < chain.n:
        after = chain.joints[i + 1]
        if after.revolute and _direction(chain, after) and not _is(after.offset, chain.zero):
            found.append(Place.BEYOND)
    return tuple(found)


def holdable(chain: Chain[Value], i: int) -> bool:
    """Whether the axes of link i may stay behind its joint: nothing but a parallel axis may follow."""
    joint = chain.joints[i]
    if not (joint.revolute or _unturned(chain, joint)):
        return False
    if i + 1 == chain.n:
        return True
    after = chain.joints[i + 1]
    return _direction(chain, after) != 0 and (after.revolute or _unturned(chain, after))


def _is(value: Value, other: Value) -> bool:
    return value.ref == other.ref


def _unturned(chain: Chain[Value], joint: ChainJoint[Value]) -> bool:
    return _is(joint.cosine, chain.one) and _is(joint.sine, chain.zero)


def _direction(chain: Chain[Value], joint: ChainJoint[Value]) -> int:
    """+1 where the axis continues z of the link before, -1 where it is opposed, else 0; exact."""
    cosine = joint.fixed.rotation[2][2]
    return 1 if _is(cosine, chain.one) else -1 if _is(cosine, -chain.one) else 0


def _slides_along_all(chain: Chain[Value], i: int) -> bool:
    """Whether joint i slides along the axis about which, or along which, all joints before it move."""
    joints = chain.joints[: i + 1]
    if i == 0 or joints[i].revolute:
        return False
    parallel = all(_direction(chain, joint) for joint in joints[1:])
    return parallel and all(joint.revolute or _unturned(chain, joint) for joint in joints)


def _placed(chain: Chain[Value], forms: Sequence[FrameChoice]) -> Chain[Value]:
    """Origins moved along their axes."""
    joints, bodies = list(chain.joints), list(chain.bodies)
    for i, form in enumerate(forms):
        if form.place is Place.AFTER:
            continue
        back = joints[i].offset if form.place is Place.BEFORE else _offset_beyond(chain, joints[i + 1])
        joints[i] = replace(joints[i], offset=joints[i].offset - back)
        lever = (chain.zero, chain.zero, back)
        bodies[i] = _seen_from(bodies[i], lever)
        if i + 1 < chain.n:
            fixed = joints[i + 1].fixed
            joints[i + 1] = replace(joints[i + 1], fixed=Frame(fixed.rotation, add(fixed.position, lever)))
    return replace(chain, joints=tuple(joints), bodies=tuple(bodies))


def _offset_beyond(chain: Chain[Value], after: ChainJoint[Value]) -> Value:
    return -after.offset if _direction(chain, after) > 0 else after.offset


def _seen_from(body: Body[Value], lever: Vector[Value]) -> Body[Value]:
    """The body about a point from which the old origin is seen at ``lever``."""
    moment = add(body.first_moment, scale(body.mass, lever))
    return Body(body.mass, moment, shift(body.mass, body.first_moment, body.inertia, lever))


@dataclass(frozen=True, slots=True)
class _Lag:
    """The turn of a link from the axes in which it is held, or from those before its joint."""

    turns: tuple[Turn, ...]
    cosine: Value
    sine: Value

    def turned(self, v: Vector[Value]) -> Vector[Value]:
        return about_z(self.cosine, self.sine, v)


def _held(chain: Chain[Value], forms: Sequence[FrameChoice], total: SumOfTurns) -> Chain[Value]:
    """Links held in the axes before their joints; K lets their turn through, as it leaves z where it is."""
    joints: list[ChainJoint[Value]] = []
    bodies: list[Body[Value]] = []
    before: _Lag | None = None
    for i, (joint, body, form) in enumerate(zip(chain.joints, chain.bodies, forms, strict=True)):
        lag = _lag(chain, i, before, total)
        fixed = Frame(joint.fixed.rotation, before.turned(joint.fixed.position)) if before else joint.fixed
        c, s = (chain.one, chain.zero) if form.held else (lag.cosine, lag.sine)
        joints.append(replace(joint, fixed=fixed, cosine=c, sine=s))
        bodies.append(_turned(body, lag) if form.held else body)
        before = lag if form.held else None
    return replace(chain, joints=tuple(joints), bodies=tuple(bodies))


def _lag(chain: Chain[Value], i: int, before: _Lag | None, total: SumOfTurns) -> _Lag:
    """The turn of joint i from axes in which the link before may be held."""
    joint = chain.joints[i]
    own = (Turn(i, 1),) if joint.revolute else ()
    if before is None:
        return _Lag(own, joint.cosine, joint.sine)
    direction = _direction(chain, joint)
    turns = (*(Turn(k, sign * direction) for k, sign in before.turns), *own)
    return _Lag(turns, *total(turns))


def _turned(body: Body[Value], lag: _Lag) -> Body[Value]:
    return Body(body.mass, lag.turned(body.first_moment), turn_about_z(lag.cosine, lag.sine, body.inertia))


Forms = tuple[FrameChoice, ...]
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

    def _changes(self, i: int, form: FrameChoice, choice: str) -> Sequence[FrameChoice]:
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
    return tuple(tuple(FrameChoice(held=h, second_moments=True) for h in row) for row in held)
