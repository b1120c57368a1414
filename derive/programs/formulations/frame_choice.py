"""The free choices of a recursion: where frames stand and turn, and which inertial parameters are left.

Every combination of choices gives the same values. Three choices of a joint change the chain itself (`arrange`), none
of them what any recursion computes:

- *place*: a joint turns about its axis wherever on it the origin stands, so its constant offset d may come before or
  after it, or join the offset of a parallel axis; links then share origins, and levers vanish.
- *held*: quantities of a link may be written in any axes. Axes that its joint does not turn save the turn of every
  motion and force; instead the body's constants are turned, which pays where no further joint follows, or where the
  next axis is parallel and its link is turned by the sum of the angles at once.
- *second_moments*: see `derive.mechanics.regrouping`.

The others are made inside recursions (`derive.mechanics.newton_euler`). The cheapest choices for one function of one
robot are found by a short search (`FrameChoiceSearch`).
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import product

from derive.mechanics.chain import Body, Chain, ChainJoint
from derive.mechanics.joint_motion import shift, turn_about_z, turn_vector
from derive.mechanics.newton_euler import FrameChoice, Place
from derive.mechanics.regrouping import Rule, regroup
from derive.mechanics.vectors import Frame, Vector, add, scale
from derive.programs.formulations.parallel_axes import SumOfTurns, Turn
from derive.programs.optimise.search_policy import POLICY
from derive.programs.tape.build import Cost
from derive.programs.tape.graph import MINUS_ONE, ONE, ZERO, Ref
from derive.programs.tape.value import Value

FrameChoices = tuple[FrameChoice, ...]  # what is chosen at each joint
CHAIN_CHOICES = ("place", "held", "second_moments")
ALL_CHOICES = (*CHAIN_CHOICES, "column", "squares", "grown")
Outputs = tuple[Ref, ...]
Trial = Callable[[FrameChoices], Outputs]  # traces a function with some choices
Price = Callable[[Outputs], Cost]  # what some outputs cost


def arrange(
    chain: Chain[Value], choices: Sequence[FrameChoice], total: SumOfTurns, half: Value, *, axial: bool = False
) -> Chain[Value]:
    """The chain as the frame choices ask, in base parameters."""
    rules = [Rule(choice.second_moments, axial and _slides_along_all(chain, i)) for i, choice in enumerate(choices)]
    return _held(regroup(_placed(chain, choices), rules, half), choices, total)


def places(chain: Chain[Value], i: int) -> tuple[Place, ...]:
    """Where the origin of a joint frame may stand, as far as this makes a difference."""
    joint = chain.joints[i]
    # Moving the origin along the axis matters only where there is an offset to leave out.
    found = [Place.AFTER]
    if joint.revolute and joint.offset.ref != ZERO:
        found.append(Place.BEFORE)
    followers = [chain.joints[k] for k in chain.followers(i)]
    if joint.revolute and len(followers) == 1:
        after = followers[0]
        if after.revolute and _direction(after) and after.offset.ref != ZERO:
            found.append(Place.BEYOND)
    return tuple(found)


def holdable(chain: Chain[Value], i: int) -> bool:
    """Whether the axes of a link may stay behind its joint: nothing but parallel axes may follow."""
    joint = chain.joints[i]
    if not (joint.revolute or _is_unturned(joint)):
        return False
    followers = (chain.joints[k] for k in chain.followers(i))
    return all(_direction(after) != 0 and (after.revolute or _is_unturned(after)) for after in followers)


def _is_unturned(joint: ChainJoint[Value]) -> bool:
    return joint.cosine.ref == ONE and joint.sine.ref == ZERO


def _direction(joint: ChainJoint[Value]) -> int:
    """+1 where the axis continues z of the link before, -1 where it is opposed, else 0; exact."""
    return {ONE: 1, MINUS_ONE: -1}.get(joint.fixed.rotation[2][2].ref, 0)


def _slides_along_all(chain: Chain[Value], i: int) -> bool:
    """Whether joint i slides along the axis about which, or along which, all joints before it move."""
    joints = [chain.joints[i], *(chain.joints[k] for k, _ in chain.inward(i))]
    if len(joints) == 1 or joints[0].revolute:
        return False
    return all(map(_direction, joints[:-1])) and all(joint.revolute or _is_unturned(joint) for joint in joints)


def _placed(chain: Chain[Value], choices: Sequence[FrameChoice]) -> Chain[Value]:
    """Origins moved along their axes."""
    joints, bodies = list(chain.joints), list(chain.bodies)
    for i, choice in enumerate(choices):
        if choice.place is Place.AFTER:
            continue
        # How far the origin goes back along z: by its own offset, or forward by that of the next joint.
        if choice.place is Place.BEFORE:
            back = joints[i].offset
        else:
            after = joints[chain.followers(i)[0]]
            back = -after.offset if _direction(after) > 0 else after.offset
        joints[i] = replace(joints[i], offset=joints[i].offset - back)
        # Seen from there all places have `back` more along z: h + m p, and the tensor by Steiner.
        lever, body = (chain.zero, chain.zero, back), bodies[i]
        moment = add(body.first_moment, scale(body.mass, lever))
        bodies[i] = Body(body.mass, moment, shift(body.mass, body.first_moment, body.inertia, lever))
        for k in chain.followers(i):
            fixed = joints[k].fixed
            # The next joint's constant frame starts at the new origin.
            joints[k] = replace(joints[k], fixed=Frame(fixed.rotation, add(fixed.position, lever)))
    return replace(chain, joints=tuple(joints), bodies=tuple(bodies))


@dataclass(frozen=True, slots=True)
class _Lag:
    """The turn of a link from the axes in which it is held, or from those before its joint."""

    turns: tuple[Turn, ...]
    cosine: Value
    sine: Value

    def turned(self, v: Vector[Value]) -> Vector[Value]:
        """A vector of the link in those axes."""
        return turn_vector(self.cosine, self.sine, v)


def _held(chain: Chain[Value], choices: Sequence[FrameChoice], total: SumOfTurns) -> Chain[Value]:
    """Links held in the axes before their joints; K lets their turn through, as it leaves z where it is."""
    joints: list[ChainJoint[Value]] = []
    bodies: list[Body[Value]] = []
    lags: list[_Lag | None] = []
    for i, (joint, body, choice) in enumerate(zip(chain.joints, chain.bodies, choices, strict=True)):
        before = lags[joint.parent] if joint.parent >= 0 else None
        turns = (Turn(i, 1),) if joint.revolute else ()
        # Where the link before is held, its turn passes through: about the same axis or the opposite one, angles add.
        if before is None:
            lag = _Lag(turns, joint.cosine, joint.sine)
        else:
            direction = _direction(joint)
            turns = (*(Turn(k, sign * direction) for k, sign in before.turns), *turns)
            lag = _Lag(turns, *total(turns))
        # Constant positions of the next joint are turned by what the link before did not turn.
        fixed = Frame(joint.fixed.rotation, before.turned(joint.fixed.position)) if before else joint.fixed
        # A held link's frame does not turn, so its body is turned instead.
        c, s = (chain.one, chain.zero) if choice.held else (lag.cosine, lag.sine)
        joints.append(replace(joint, fixed=fixed, cosine=c, sine=s))
        if choice.held:
            body = Body(body.mass, lag.turned(body.first_moment), turn_about_z(lag.cosine, lag.sine, body.inertia))
        bodies.append(body)
        lags.append(lag if choice.held else None)
    return replace(chain, joints=tuple(joints), bodies=tuple(bodies))


class FrameChoiceSearch:
    """Searches the cheapest frame choices for one function of one chain.

    It may stop anywhere: from the best of some starts it changes one choice of one joint after another to what makes
    the traced graph cheapest, until nothing gets cheaper or the work is spent. Work is counted in nodes.
    """

    def __init__(self, chain: Chain[Value], choices: Sequence[str], trial: Trial, price: Price) -> None:
        self._chain = chain
        self._choices = choices
        self._trial = trial
        self._price = price
        self._traced: dict[FrameChoices, Outputs] = {}
        self._costs: dict[Outputs, int] = {}
        self._work_left = POLICY.frame_choice_work

    def best(self, starts: Sequence[FrameChoices], count: int = 1) -> tuple[FrameChoices, ...]:
        """The cheapest choices found, and others that come close."""
        if self._chain.n > POLICY.frame_choice_joints:
            return (starts[0],)
        best = starts[0]
        self._cost(best)
        for start in starts[1:]:
            best = min(best, start, key=self._cost) if self._work_left > 0 else best
        while self._work_left > 0:
            before = best
            for i, name in product(range(self._chain.n), self._choices):
                for change in self._changes(i, best[i], name):
                    if self._work_left > 0:
                        best = min(best, (*best[:i], change, *best[i + 1 :]), key=self._cost)
            if best == before:
                break
        # Different choices may trace the same program: of these the first one.
        first: dict[Outputs, FrameChoices] = {}
        for choices, outputs in self._traced.items():
            first.setdefault(outputs, choices)
        ranked = sorted(first, key=self._costs.__getitem__)[:count]
        limit = POLICY.frame_choice_margin * self._costs[ranked[0]]
        return tuple(first[outputs] for outputs in ranked if self._costs[outputs] <= limit)

    def _changes(self, i: int, choice: FrameChoice, name: str) -> Sequence[FrameChoice]:
        """What is chosen at a joint with one thing chosen otherwise, if that matters there."""
        turns = self._chain.joints[i].revolute
        match name:
            case "place":
                return [replace(choice, place=place) for place in places(self._chain, i) if place is not choice.place]
            case "held" if holdable(self._chain, i):
                return [replace(choice, held=not choice.held)]
            case "second_moments" if turns:
                return [replace(choice, second_moments=not choice.second_moments)]
            case "column":
                return [replace(choice, column=not choice.column)]
            case "squares" if turns and choice.column:
                return [replace(choice, squares=not choice.squares)]
            case "grown" if turns and choice.held and choice.column and choice.squares:
                return [replace(choice, grown=not choice.grown)]
        return []

    def _cost(self, choices: FrameChoices) -> int:
        outputs = self._traced.get(choices)
        if outputs is None:
            outputs = self._traced[choices] = self._trial(choices)
        # Priced once; the nodes looked at are the work.
        if outputs not in self._costs:
            cost = self._price(outputs)
            self._costs[outputs] = cost.body
            self._work_left -= cost.nodes
        return self._costs[outputs]


def starting_choices(chain: Chain[Value]) -> tuple[FrameChoices, ...]:
    """Where the search for frame choices starts."""
    n = chain.n
    can = [holdable(chain, i) for i in range(n)]
    held = (can, [can[i] and not chain.followers(i) for i in range(n)], [False] * n)
    return tuple(tuple(FrameChoice(held=h, second_moments=True) for h in row) for row in held)
