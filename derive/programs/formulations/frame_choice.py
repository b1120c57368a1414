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

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import NamedTuple

from derive.mechanics.chain import Body, Chain, ChainJoint
from derive.mechanics.joint_motion import axis, shift, turn_about_z, turn_vector
from derive.mechanics.newton_euler import FrameChoice, Place
from derive.mechanics.regrouping import Rule, regroup
from derive.mechanics.vectors import Frame, Matrix, Vector, add, column, identity, matmul, multiply, scale
from derive.programs.optimise.search_policy import POLICY
from derive.programs.tape.build import Cost
from derive.programs.tape.graph import MINUS_ONE, ONE, Ref
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
    if joint.revolute and joint.offset:
        found.append(Place.BEFORE)
    followers = [chain.joints[k] for k in chain.followers(i)]
    if joint.revolute and len(followers) == 1:
        after = followers[0]
        if after.revolute and _direction(axis(after)) and after.offset:
            found.append(Place.BEYOND)
    return tuple(found)


def holdable(chain: Chain[Value], i: int) -> bool:
    """Whether the axes of a link may stay behind its joint: nothing but parallel axes may follow."""
    joint = chain.joints[i]
    if not (joint.revolute or _is_unturned(joint)):
        return False
    followers = (chain.joints[k] for k in chain.followers(i))
    return all(_direction(axis(after)) != 0 and (after.revolute or _is_unturned(after)) for after in followers)


def _is_unturned(joint: ChainJoint[Value]) -> bool:
    return joint.cosine.ref == ONE and not joint.sine


def _slides_along_all(chain: Chain[Value], i: int) -> bool:
    """Whether joint i slides along the axis about which, or along which, all joints before it move."""
    joints = [chain.joints[i], *(chain.joints[k] for k, _ in chain.inward(i))]
    if len(joints) == 1 or joints[0].revolute:
        return False
    is_along = all(_direction(axis(joint)) for joint in joints[:-1])
    return is_along and all(joint.revolute or _is_unturned(joint) for joint in joints)


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
            back = -after.offset if _direction(axis(after)) > 0 else after.offset
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
            direction = _direction(axis(joint))
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


# -- runs of joints with parallel axes: one turn by the sum of their angles in place of one turn after another
#
# Where the axis of a revolute joint is parallel to that of the revolute joint before it, opposed or not, with prismatic
# joints between them or not, the constant rotation between the two leaves z where it is up to its sign, and turns about
# z add: Rot(z, t_1) C Rot(z, t_2) = Rot(z, t_1 +- t_2) C. In the axes in which a run begins, joint frame i is turned by
# Rot(z, phi_i) C_i with phi_i = t_1 +- t_2 ... and C_i constant, and origins are sums of constant vectors turned by one
# phi each: a_1 c_1 + a_2 c_12.


class Turn(NamedTuple):
    """The angle of a revolute joint with its sign in a sum; joints count from 0."""

    joint: int
    direction: int


# Cosine and sine of a signed sum of joint angles; of no angle 1 and 0.
SumOfTurns = Callable[[Sequence[Turn]], tuple[Value, Value]]


@dataclass(frozen=True, slots=True)
class Placement:
    """Joint frame i in the axes of its run: Rot(z, phi) constant, at ``origin``."""

    cosine: Value  # cos(phi)
    sine: Value  # sin(phi)
    constant: Matrix[Value]  # C, 3x3; z goes to z or -z where the joint turns
    origin: Vector[Value]  # from the run's origin, in its axes
    step: Vector[Value]  # the last part of ``origin``, from the joint frame before
    direction: int  # +1 where z_i is z of the run, -1 where it points the other way, 0 for a slide across

    def turned(self, v: Vector[Value]) -> Vector[Value]:
        """A vector of joint frame i in the axes of the run."""
        return turn_vector(self.cosine, self.sine, multiply(self.constant, v))

    def axis(self) -> Vector[Value]:
        """z_i in the axes of the run."""
        return turn_vector(self.cosine, self.sine, column(self.constant, 2))


@dataclass(frozen=True, slots=True)
class ParallelRun:
    """Consecutive joints whose revolute axes are parallel."""

    first: int  # index of its first joint, from 0
    # Constant, from the last joint frame of the run before (for the first run frame 0) to the run's axes.
    fixed: Frame[Value]
    placements: tuple[Placement, ...]  # one for each joint

    @property
    def last(self) -> Placement:
        """The joint frame from which the next run goes on."""
        return self.placements[-1]


def parallel_runs(chain: Chain[Value], total: SumOfTurns) -> tuple[ParallelRun, ...]:
    """The runs of an arm, as long as they can be."""
    runs: list[ParallelRun] = []
    first = 0
    # Greedy: each run goes on until a joint turns about another direction.
    while first < chain.n:
        placements = _placements(chain, first, total)
        runs.append(ParallelRun(first, chain.joints[first].fixed, placements))
        first += len(placements)
    return tuple(runs)


def _placements(chain: Chain[Value], first: int, total: SumOfTurns) -> tuple[Placement, ...]:
    """The joints of the run that begins with some joint, up to that which turns about another direction."""
    zero, one = chain.zero, chain.one
    constant, origin = identity(zero, one), (zero, zero, zero)
    fixed = Frame(constant, origin)
    cosine, sine = one, zero
    turns: tuple[Turn, ...] = ()
    found: list[Placement] = []
    for i in range(first, chain.n):
        joint = chain.joints[i]
        if i > first:
            fixed = joint.fixed
        # C_i = C_{i-1} K: the constant rotation behind the turn by phi.
        before, constant = constant, matmul(constant, fixed.rotation)
        z = column(constant, 2)
        # The way to joint frame i is constant before the turn so far: K's position, and the offset along z_i.
        step = turn_vector(cosine, sine, add(multiply(before, fixed.position), scale(joint.offset, z)))
        origin = add(origin, step)
        if joint.revolute:
            # Parallel if z_i is +-z of the run, exactly; the first joint always is.
            direction = _direction(z)
            if direction == 0:
                break
            # phi = t_1 +- t_2 ..., taken as one cosine and sine.
            turns = (*turns, Turn(i, direction))
            cosine, sine = total(turns)
        else:
            # A slide's own constant turn about z goes into C.
            constant = matmul(constant, joint.motion(zero, one).rotation)
        found.append(Placement(cosine, sine, constant, origin, step, _direction(column(constant, 2))))
    return tuple(found)


def _direction(z: Vector[Value]) -> int:
    """+1 for the z axis itself, -1 for its opposite, else 0; exact."""
    if z[0] or z[1]:
        return 0
    return {ONE: 1, MINUS_ONE: -1}.get(z[2].ref, 0)
