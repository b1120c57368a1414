"""From the steps of a plan to segments: which belong together, how long they take, which pieces they are made of."""

from collections.abc import Sequence
from itertools import accumulate, pairwise

from sympy import Expr

from derive.errors import RobotFileError
from derive.motion.curves.limits import MOST_CRUISE, numeric_peak, placed, proportions, rounded_up
from derive.motion.curves.trajectory import ONE, Corner, Trajectory
from derive.motion.paths.hand import Hand
from derive.plans import profile as profiles
from derive.plans.plan import Plan
from derive.plans.profile import CRUISE, UNIT_PEAKS, VALUES, ZERO, AnyPiece, Curve, Piece, Profile, joined, symbolic
from derive.plans.segments import Joints, Segment, Step


def trajectory_of(plan: Plan, hand: Hand) -> Trajectory:
    """The segments of a plan with a path."""
    segments: list[Segment] = []
    name, start = plan.start, ZERO
    here = hand.configuration(name, None)
    runs: list[list[Step]] = []  # steps that are planned together: nothing stops between them
    for step in plan.steps:
        before = runs[-1][-1] if runs else step
        if runs and not before.stops and before.profile is step.profile and not (before.in_space or step.in_space):
            runs[-1].append(step)
        else:
            runs.append([step])
    for run in runs:
        names, corners = [name, *(step.to for step in run)], [here]
        if not run[0].follows:
            for step in run:
                corners.append(hand.configuration(step.to, corners[-1]))
        times, joints = _run(hand, run, len(segments), corners, start)
        ends = [f"{a} -> {b}" for a, b in pairwise(names)]
        segments += [Segment(ends[i], times[i], times[i + 1] - times[i], joints[i]) for i in range(len(run))]
        name, here, start = names[-1], corners[-1], times[-1]
        if run[0].follows:  # where the last pieces end
            here = tuple(symbolic(track[-1].values[1][0]) for track in joints[-1] if not isinstance(track[-1], Curve))
    return Trajectory(tuple(segments))


Timed = tuple[list[Expr], list[Joints]]  # when each of some segments begins, and the last one ends; their pieces


def _run(hand: Hand, run: Sequence[Step], first: int, corners: Sequence[Corner], start: Expr) -> Timed:
    if (step := run[0]).profile is Profile.FASTEST:
        found = hand.fastest(run, first, corners)
        joints: list[Joints] = [tuple(_moved(track, start, ONE) for track in pieces) for pieces in found]
        return [start, *(symbolic(pieces[0][-1].end) for pieces in joints)], joints
    if step.in_space:
        return _in_space(hand, step, corners[0], start)
    if step.by_hand or step.profile is Profile.SPLINE or len(run) > 1:
        return _passing(hand, run, corners, start)
    duration, cruises = _rest_to_rest_time(hand, step, *corners)
    ends = zip(*corners, cruises, strict=True)
    pieces = tuple(_single(step.profile, start, duration, q0, q1, cruise) for q0, q1, cruise in ends)
    return [start, start + duration], [pieces]


def _in_space(hand: Hand, step: Step, here: Corner, start: Expr) -> Timed:
    """The end effector on a line or an arc; by limits as long as its joints need."""
    cruise = CRUISE if step.cruise is None else hand.exact(step.cruise)
    _check_cruise(step, cruise)
    if step.profile is Profile.SPLINE:
        remedy = "write profile: quintic, or another one"
        raise RobotFileError(f"a line to {step.to} is no spline", remedy=remedy, location=step.location)

    def _followed(begin: Expr, duration: Expr) -> Joints:
        pieces = _single(step.profile, ZERO, duration, ZERO, ONE, cruise)
        return hand.follow(step, here, begin, Trajectory.of((pieces,), duration))

    if step.time is not None:
        duration = hand.exact(step.time)
        return [start, start + duration], [_followed(start, duration)]
    joints = _followed(ZERO, ONE)
    factor = _stretched(hand, step, [joints])
    return [start, start + factor], [tuple(_moved(track, start, factor) for track in joints)]


def _passing(hand: Hand, run: Sequence[Step], corners: Sequence[Corner], start: Expr) -> Timed:
    """Segments whose points are passed without a stop."""
    # By limits in the proportion of what each would need alone, or of the ways of an end effector that is on a spline.
    profile, by_hand = run[0].profile, run[0].by_hand
    if profile is not Profile.SPLINE and profile not in VALUES:
        found = f"a {profile} motion stops at its points, and {run[0].to} is passed"
        remedy = "write via: stop, or a profile of cubic, quintic, septic, spline, fastest"
        raise RobotFileError(found, remedy=remedy, location=run[0].location)
    timed = [step.time for step in run if step.time is not None]
    if timed and len(timed) < len(run):  # between two stops all segments have a time, or none
        untimed = next(step for step in run if step.time is None)
        remedy = "write a time for each segment between two stops, or for none"
        raise RobotFileError(f"no time from here to {untimed.to}", remedy=remedy, location=untimed.location)
    lengths = given = tuple(map(hand.exact, timed))
    if not given and by_hand:
        lengths = proportions(hand.distances(run, corners[0]))
    elif not given:
        speed, acceleration = UNIT_PEAKS[Profile.CUBIC if profile is Profile.SPLINE else profile]
        alone = []
        for step, (q0, q1) in zip(run, pairwise(corners), strict=True):
            ways = [abs(b - a) for a, b in zip(q0, q1, strict=True)]
            needed = hand.limits.stretch([speed * way for way in ways], [acceleration * way for way in ways])
            alone.append(float(_limited(step, needed)))
        lengths = proportions(alone)
    times = list(accumulate(lengths, initial=start if given else ZERO))
    tracks = []
    for positions in () if by_hand else zip(*corners, strict=True):
        if profile is Profile.SPLINE:
            tracks.append(profiles.spline(times, positions))
        else:
            rest = (ZERO,) * (VALUES[profile] - 2)
            ends = zip(positions, profiles.via_velocities(times, positions), strict=True)
            tracks.append(joined([(q, v, *rest) for q, v in ends], times))
    joints: list[Joints] = [tuple((track[i],) for track in tracks) for i in range(len(run))]
    if by_hand:
        joints = hand.splined(run, corners[0], times)
    if given:
        return times, joints
    # What was put together from time 0 on takes as long as limits ask for.
    factor = _stretched(hand, run[0], joints)
    moved: list[Joints] = [tuple(_moved(track, start, factor) for track in pieces) for pieces in joints]
    return [start + time * factor for time in times], moved


def _moved(track: Sequence[AnyPiece], start: Expr, factor: Expr) -> tuple[Piece, ...]:
    return tuple(placed(piece, start, factor) for piece in track if isinstance(piece, Piece))


def _stretched(hand: Hand, step: Step, segments: Sequence[Joints]) -> Expr:
    """The duration of pieces that were put together for one second, up to a microsecond."""
    tracks = [sum(pieces, ()) for pieces in zip(*segments, strict=True)]
    speeds, accelerations = ([abs(numeric_peak(track, order).value) for track in tracks] for order in (1, 2))
    return rounded_up(float(_limited(step, hand.limits.stretch(speeds, accelerations)))) or ONE


def _limited(step: Step, duration: Expr | None) -> Expr:
    if duration is None:
        remedy = "write {to: ..., time: 3}, or speed: and acceleration: of each joint"
        raise RobotFileError(f"no time from here to {step.to}", remedy=remedy, location=step.location)
    return duration


def _rest_to_rest_time(hand: Hand, step: Step, q0: Corner, q1: Corner) -> tuple[Expr, list[Expr]]:
    """The time of a segment between two stops, and of trapezoids the speed of each joint by distance and time."""
    ways = [abs(b - a) for a, b in zip(q0, q1, strict=True)]
    cruises = [CRUISE] * len(ways)
    if step.profile is Profile.TRAPEZOIDAL:
        if step.cruise is not None:
            cruises = [hand.exact(step.cruise)] * len(ways)
            _check_cruise(step, cruises[0], step.time and hand.exact(step.time), max(ways, key=float))
        elif step.time is None:
            cruises = [hand.limits.cruise(j, way) if way != 0 else CRUISE for j, way in enumerate(ways)]
        # Speed and acceleration of a trapezoid from 0 to 1 in one second.
        units = [(cruise, cruise**2 / (cruise - 1)) for cruise in cruises]
    else:
        units = [UNIT_PEAKS[step.profile]] * len(ways)
    if step.time is not None:
        return hand.exact(step.time), cruises
    peaks = [(speed * way, acceleration * way) for (speed, acceleration), way in zip(units, ways, strict=True)]
    needed = _limited(step, hand.limits.stretch([v for v, _ in peaks], [a for _, a in peaks]))
    return (needed if needed != 0 else ONE), cruises


def _check_cruise(step: Step, cruise: Expr, duration: Expr | None = None, way: Expr = ZERO) -> None:
    """A trapezoid gets to its speed and back in its time, or there is none."""
    if 1 < float(cruise) <= float(MOST_CRUISE):
        return
    allowed = "allowed: above 1, and 2 at most"
    if duration is not None and way != 0:
        least = float(way / duration)
        allowed += f": a speed V with D/T < V <= 2 D/T, here {least:.6g} < V <= {2 * least:.6g}"
    found = f"cruise {float(cruise):.6g} of the trapezoid to {step.to}"
    raise RobotFileError(found, allowed=allowed, location=step.location)


def _single(profile: Profile, start: Expr, duration: Expr, q0: Expr, q1: Expr, cruise: Expr) -> tuple[AnyPiece, ...]:
    if profile is not Profile.TRAPEZOIDAL:
        return profiles.rest_to_rest(profile, start, duration, q0, q1)
    return profiles.trapezoid(start, duration, q0, q1, cruise * abs(q1 - q0) / duration)
