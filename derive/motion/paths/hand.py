"""The end effector of a plan's robot: configurations of points that are poses, and its way on lines and arcs."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, cached_property, partial
from itertools import pairwise
from math import isfinite, nan
from typing import Self

import numpy as np
from sympy import Expr, Float, Integer, Symbol, sstr

from derive.arrays import Array
from derive.errors import QuantityError, RobotFileError, quoted
from derive.motion.curves.limits import Limits
from derive.motion.curves.trajectory import ONE, Corner, Trajectory
from derive.motion.paths.fastest import UNIFORM, FastestMotion, Torques, grid_of, smooth_path
from derive.motion.paths.poses import NEAR, NODES, Follower, Way, rotation_of, rotation_vector, spline_way
from derive.motion.torques.functions import Functions, arm_of
from derive.plans.plan import Plan
from derive.plans.profile import ZERO, Piece
from derive.plans.segments import Joints, Point, Step, Vector
from derive.robot.description import Link
from derive.robot.evaluate import evaluate
from derive.robot.expression import Expression
from derive.robot.robot import Robot

MET = 1e-9  # largest difference, relative, of both sides of a condition that holds
ARRIVED = 1e-6  # largest difference between a configuration and where a line ends [rad or m]


@dataclass(frozen=True)
class Arm:
    """The serial arm that leads to an end."""

    robot: Robot
    places: tuple[int, ...]  # of its joints among those of the plan
    functions: Functions  # its kinematics

    @classmethod
    def to(cls, plan: Plan, values: Mapping[str, float], end: str) -> Self:
        """The arm to an end of a plan's robot."""
        names = frozenset({"forward_kinematics", "jacobian", "jacobian_dot"})
        poses = any(point.pose and point.end == end for point in plan.points.values())
        arm, places = arm_of(plan.robot, end)
        return cls(arm, places, Functions(arm, names, values, inverse=poses))

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Of the solutions of its inverse kinematics."""
        from derive.inverse.closed.solve import solve
        from derive.inverse.words.postures import postures

        names = postures(self.robot, solve(self.robot)).names if self.functions.branches > 1 else ()
        return tuple(name or f"#{k}" for k, name in enumerate(names, 1))

    def q(self, corner: Sequence[Expr]) -> Array:
        """Its joint variables of a configuration."""
        return np.array([corner[place] for place in self.places], dtype=float)


class Hand:
    """Knows where the points of a plan are."""

    def __init__(
        self, plan: Plan, values: Mapping[str, float], exact: Callable[[Vector], Corner], torques: Torques
    ) -> None:
        self._plan, self._values, self._exact, self._torques = plan, values, exact, torques
        self._arm = cache(partial(Arm.to, plan, values))

    @cached_property
    def limits(self) -> Limits:
        """The largest speeds, accelerations and torques of the plan."""
        plan = self._plan
        torque = plan.torque if plan.robot.has_dynamics and not plan.base else (None,) * plan.robot.dof
        cells = (plan.speed, plan.acceleration, torque)
        return Limits(*(tuple(None if cell is None else self.exact(cell) for cell in most) for most in cells))

    def exact(self, value: Expression) -> Expr:
        """A cell with the numbers of its symbols."""
        return self._exact((value,))[0]

    def configuration(self, name: str, before: Corner | None) -> Corner:
        """Joint variables at a point; of a pose the solution nearest to where the arm comes from, on its branch."""
        if (point := self._plan.points[name]).q is not None:
            return self._exact(point.q)
        corner, arm = list(before or (ZERO,) * self._plan.robot.dof), self._arm(point.end)
        start = arm.q(corner)
        pose, branches = self._pose(point, arm), self.branches.get(name, ())
        if not np.isfinite(found := arm.functions.nearest(pose, start, branches)).all():
            inverse = f"'inverse[{point.end}]'" if point.end else "inverse"
            remedy = f"derive show {self._plan.robot.source} {inverse} says what a pose must satisfy"
            with_branch = f" within its limits with branch {quoted(point.branch, 80)}" if point.branch else ""
            if with_branch and np.isfinite(arm.functions.nearest(pose, start)).all():
                remedy = "with another branch it does: leave branch out for the nearest one"
            else:
                with_branch += why_not(arm.robot, pose, self._values)
            found_text = f"the arm does not reach {point.name}{with_branch}"
            raise RobotFileError(found_text, remedy=remedy, location=point.location)
        for place, value in zip(arm.places, found, strict=True):
            corner[place] = Float(value)
        return tuple(corner)

    @cached_property
    def branches(self) -> Mapping[str, tuple[int, ...]]:
        """The solutions on which the points are that name a branch."""
        robot, found = self._plan.robot, {}
        for name, point in self._plan.points.items():
            if not point.branch:
                continue
            names, wanted = self._arm(point.end).names, _words(point.branch)
            found[name] = tuple(k for k, own in enumerate(names) if wanted <= _words(own))
            if not found[name]:
                allowed = f"allowed: {'; '.join(names)}; or some of these words" if names else ""
                said = f"point {name}: no branch {quoted(point.branch)} of {robot.name}"
                said += "" if names else ", whose solutions have no names"
                remedy = "leave branch out for the nearest"
                raise RobotFileError(said, allowed=allowed, remedy=remedy, location=point.location)
        return found

    def _pose(self, point: Point, arm: Arm) -> Array:
        if point.pose is None:
            return arm.functions("forward_kinematics", arm.q(self._exact(point.q or ())))
        pose = np.eye(4)
        pose[:3, 3] = [evaluate(cell, self._values) for cell in point.pose.position]
        if point.pose.angles is not None:
            a, b, c = (evaluate(cell, self._values) for cell in point.pose.angles)
            # R = Rz(a) Ry(b) Rz(c), or Rz(yaw) Ry(pitch) Rx(roll).
            for axis, angle in ((2, a), (1, b), (2, c)) if point.pose.is_zyz else ((2, c), (1, b), (0, a)):
                pose[:3, :3] = pose[:3, :3] @ rotation_of(angle * np.eye(3)[axis])
        return pose

    def follow(self, step: Step, before: Corner, start: Expr, unit: Trajectory) -> Joints:
        """The pieces of each joint while the end effector moves on a line or an arc."""
        end, arm = self._plan.points[step.to], self._arm(step.end)
        q = arm.q(before)
        here = arm.functions("forward_kinematics", q)
        try:
            if step.through:
                way = Way.arc(here, self._pose(self._plan.points[step.through], arm), self._pose(end, arm))
            else:
                way = Way.line(here, self._pose(end, arm))
        except ValueError as error:
            raise RobotFileError(str(error), remedy="write line: yes", location=step.location) from None
        follower, duration = self._follower(step), float(unit.duration)
        joints = _standing(before, start, unit.duration)
        # Where sdd jumps, as of trapezoids, a node stands; between, places at even times.
        jumps = [float(piece.start) for piece in unit.segments[0].joints[0][1:]]
        for count in NODES if step.through or not follower.arrived(way, q) else ():
            edges = pairwise([0.0, *jumps, duration])
            parts = [np.linspace(a, b, max(2, round(count * (b - a) / duration)) + 1)[:-1] for a, b in edges]
            local = np.append(np.concatenate(parts), duration)
            s, sd, after = (value[:, 0] for value in unit(local))
            # sdd just before each jump; after it as the profile says.
            earlier = np.where(np.isin(local, jumps), unit(np.nextafter(local, -np.inf))[2][:, 0], after)
            # Twice as many nodes until the hand is on its way halfway between them.
            tracks = follower.pieces(way, q, float(start) + local, (s, sd, earlier, after))
            joints = _beside(joints, arm, tracks)
            if follower.farthest(way, tracks, unit((local[:-1] + local[1:]) / 2)[0][:, 0]) <= NEAR:
                break
        self._check_arrival(step, joints)
        if step.through in self.branches:
            self._check_branch(step, step.through, joints)
        return joints

    def splined(self, run: Sequence[Step], before: Corner, times: Sequence[Expr]) -> list[Joints]:
        """The pieces of each joint, by segments, while the end effector moves on a spline between times [s]."""
        arm = self._arm(run[0].end)
        q = arm.q(before)
        local = [time - times[0] for time in times]
        way = spline_way(local, self._poses(run, before))
        follower = self._follower(run[0])
        for count in NODES:
            inner = [np.linspace(float(a), float(b), count + 1)[:-1] for a, b in pairwise(local)]
            s = np.concatenate([*inner, [float(local[-1])]])
            one, none = np.ones_like(s), np.zeros_like(s)
            tracks = follower.pieces(way, q, float(times[0]) + s, (s, one, none, none))
            if follower.farthest(way, tracks, (s[:-1] + s[1:]) / 2) <= NEAR:
                break
        parts = [tuple(track[k * count : (k + 1) * count] for track in tracks) for k in range(len(run))]
        still = [_standing(before, a, b - a) for a, b in pairwise(times)]
        found = [_beside(joints, arm, part) for joints, part in zip(still, parts, strict=True)]
        for step, joints in zip(run, found, strict=True):
            self._check_arrival(step, joints)
        return found

    def distances(self, run: Sequence[Step], before: Corner) -> list[float]:
        """How far the end effector goes from point to point [m], or where it only turns [rad]."""
        pairs = list(pairwise(self._poses(run, before)))
        ways = [float(np.linalg.norm(b[:3, 3] - a[:3, 3])) for a, b in pairs]
        turns = [float(np.linalg.norm(rotation_vector(b[:3, :3] @ a[:3, :3].T))) for a, b in pairs]
        return ways if any(ways) else turns

    def _poses(self, run: Sequence[Step], before: Corner) -> list[Array]:
        """Where the end effector is at the start of segments and at each end."""
        arm = self._arm(run[0].end)
        ends = (self._pose(self._plan.points[step.to], arm) for step in run)
        return [arm.functions("forward_kinematics", arm.q(before)), *ends]

    def _follower(self, step: Step) -> Follower:
        arm = self._arm(step.end)
        given = (arm.robot.inverse.given or ()) if step.end else ()  # an end is moved by what its poses are solved for
        held = tuple(k for k, joint in enumerate(arm.robot.joints) if joint.variable in given)
        return Follower(arm.functions, arm.robot, self._values, step.location, held)

    def _check_arrival(self, step: Step, joints: Joints) -> None:
        """A point that is given by joint variables is reached with these."""
        end, last = self._plan.points[step.to], (pieces[-1] for pieces in joints)
        arrived = np.array([float(piece.values[1][0]) for piece in last if isinstance(piece, Piece)])
        if end.q is not None and np.abs(arrived - np.array(self._exact(end.q), dtype=float)).max() > ARRIVED:
            found = f"the way to {step.to} ends in another posture of the arm than {step.to} has"
            remedy = f"give {step.to} as a pose, or go there by joints"
            raise RobotFileError(found, remedy=remedy, location=step.location)
        if step.to in self.branches:
            self._check_branch(step, step.to, joints)

    def _check_branch(self, step: Step, name: str, joints: Joints) -> None:
        """Where the way comes to a point, the arm is on the branch of that."""
        arm = self._arm(step.end)
        functions = arm.functions
        tracks = [[piece for piece in joints[place] if isinstance(piece, Piece)] for place in arm.places]
        rows = [[*(float(piece.values[0][0]) for piece in track), float(track[-1].values[1][0])] for track in tracks]
        q, point, follower = np.array(rows).T, self._plan.points[name], self._follower(step)
        # A point of an arc is passed at the node that is nearest to it.
        off = functions("forward_kinematics", q)[:, :3, 3] - self._pose(point, arm)[:3, 3]
        here = q[-1 if name == step.to else int((off**2).sum(axis=1).argmin())]
        pose, turns = functions("forward_kinematics", here), [joint.is_revolute for joint in arm.robot.joints]
        # From each solution to the arm: angles that differ by whole turns are one, sin(off/2) is zero.
        names = self._arm(point.end).names
        ways = (functions.nearest(pose, here, (k,)) - here for k in range(len(names)))
        gaps = (np.abs(np.where(turns, np.sin(way / 2), way)).max() for way in ways)
        if (found := next((k for k, gap in enumerate(gaps) if gap <= ARRIVED), None)) in self.branches[name]:
            return
        # An arm changes its branch in singular configurations alone: the message says which one was nearest.
        nearest = int(np.argmin([follower.regularity(row) for row in q]))
        factor = follower.factor(q[nearest])
        said = "outside its limits" if found is None else f"on branch {quoted(names[found], 80)}"
        raise RobotFileError(
            f"the way to {step.to} comes to {name} {said}, not {quoted(point.branch, 80)}: no singular configuration, "
            f"where that could change, is on it; nearest to one it is after {nearest / (len(q) - 1):.0%} of it"
            + (f", by {factor}" if factor else ""),
            remedy="start the way on that branch, or go there by joints",
            location=step.location,
        )

    def fastest(self, run: Sequence[Step], first: int, corners: Sequence[Corner]) -> list[Joints]:
        """The pieces of each joint, segment by segment, in the shortest time; the first begins at time 0."""
        step = run[0]
        if self._plan.base and any(self._plan.torque):
            remedy = "leave out torque: or base:"
            found = "torques of a fastest motion on a base that moves are not known"
            raise RobotFileError(found, remedy=remedy, location=step.location)
        if step.in_space:
            joints, knots = self.follow(step, corners[0], ZERO, UNIFORM), np.array([0.0, 1.0])
            if joints == _standing(corners[0], ZERO, ONE):
                return [joints]
            path = Trajectory.of(joints)  # a line or an arc as a path q(s): its motion at constant speed in one second
        elif len(run) == 1 and corners[0] == corners[1]:
            return [_standing(corners[0], ZERO, ONE)]
        else:
            numbers = np.array(corners, dtype=float)
            speed = self.limits.numbers()[0]
            # s by the length of the chords, which count each joint by the time at its largest speed, where it has one.
            chords = np.linalg.norm(np.diff(numbers, axis=0) / np.where(np.isfinite(speed), speed, 1.0), axis=1)
            if still := next((each for each, chord in zip(run, chords, strict=True) if chord == 0), None):
                remedy = "leave it out, or write via: stop"
                raise RobotFileError(f"the arm does not move to {still.to}", remedy=remedy, location=still.location)
            lengths = np.append(0.0, np.cumsum(chords))
            knots = lengths / lengths[-1]
            path = smooth_path(knots, numbers)
        grid = grid_of(path, knots)
        # Which step, and so which payload, each interval of the grid belongs to.
        steps = np.asarray(first + np.searchsorted(knots[1:], grid[:-1], side="right"))
        links = (not self._plan.robot.coupled and self._plan.robot.links) or (Link(),) * self._plan.robot.dof
        even = np.array([evaluate(link.signed[1], self._values) for link in links])
        try:
            nodes = FastestMotion(path, grid, steps, self.limits.numbers(), self._torques, even).solve()
        except QuantityError as error:
            raise error.at(step.location) from None
        edges = np.searchsorted(grid, knots).tolist()
        exact = {} if step.in_space else dict(zip(edges, corners, strict=True))
        return [nodes.pieces(a, b, exact) for a, b in pairwise(edges)]


def _words(branch: str) -> set[str]:
    """What the name of a branch says: ``shoulder left, elbow up`` is two of these."""
    return {" ".join(part.lower().split()) for part in branch.split(",")}


def why_not(robot: Robot, pose: Array, values: Mapping[str, float]) -> str:
    """The first condition on a pose that an arm does not reach which does not hold, from its inverse kinematics."""
    from derive.model.kinematic_model import KinematicModel

    found = KinematicModel(robot).inverse
    known: dict[Expr, Expr] = {Symbol(name): Float(value) for name, value in values.items()}
    known |= {found.pose[i, j]: Float(pose[i, j]) for i in range(3) for j in range(4)}
    for solution in found.solutions:
        numbers = known | {sign: Integer(value) for sign, value in solution.signs.items()}
        for line in (*found.definitions, *solution.lines):
            value = _size(line.value, numbers)
            numbers |= {line.symbol: Float(value)} if isfinite(value) else {}
        for step in found.steps:
            if not step.exists.is_Relational:
                continue
            left, right = _size(step.exists.lhs, numbers), _size(step.exists.rhs, numbers)
            if (left < right) if step.exists.rel_op.startswith(">") else (left > right):
                told = f"{sstr(step.exists.lhs)} {step.exists.rel_op} {sstr(step.exists.rhs)}"
                return f": {sstr(step.unknown)} is real for {told}, which are {left:.6g} and {right:.6g}"
        for equation in found.conditions:
            left, right = _size(equation.left, numbers), _size(equation.right, numbers)
            if abs(left - right) > MET * (1 + abs(right)):
                said = f"{sstr(equation.left)} = {sstr(equation.right)}"
                return f": {said} does not hold, these are {left:.6g} and {right:.6g}"
    return ""


def _size(value: Expr, known: Mapping[Expr, Expr]) -> float:
    """The number of an expression; not a number where it has no real one."""
    return float(found) if (found := value.xreplace(known).evalf()).is_real else nan


def _beside(joints: Joints, arm: Arm, tracks: Joints) -> Joints:
    """The pieces of all joints, where those of an arm move by its tracks and others as they did."""
    moved = dict(zip(arm.places, tracks, strict=True))
    return tuple(moved.get(place, pieces) for place, pieces in enumerate(joints))


def _standing(corner: Corner, start: Expr, duration: Expr) -> Joints:
    return tuple((Piece(start, duration, ((q, ZERO, ZERO), (q, ZERO, ZERO))),) for q in corner)
