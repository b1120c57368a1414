"""`Motion`: a plan that can be asked for positions, torques, peaks and work."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from textwrap import shorten
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike
from sympy import Expr, Symbol

from derive.arrays import Array, Flags, Indices
from derive.errors import QuantityError, RobotFileError
from derive.lecture.sympy_conversion import expression_to_sympy
from derive.motion.curves.limits import Bounds, Function, Violation, bounds_of, exceeded, nearby, peak
from derive.motion.curves.trajectory import Trajectory, curves_of, followed, read_recording
from derive.motion.paths.hand import Hand
from derive.motion.paths.segments import trajectory_of
from derive.motion.torques import functions
from derive.motion.torques.base_torques import BaseCurve, BaseTorques, carried_body
from derive.motion.torques.functions import LEAST_INTERVALS, Functions
from derive.plans.catalogue import plan_text, waypoints
from derive.plans.cells import PATHS, TIME_NAME
from derive.plans.plan import Plan, load_plan, plan_from_bytes
from derive.plans.profile import TIME
from derive.plans.segments import Load, SegmentPeaks, Step
from derive.robot.description import INERTIA
from derive.robot.evaluate import evaluate, parameter_values
from derive.robot.expression import Expression
from derive.robot.inertial_parameters import LINK_PARTS
from derive.robot.names import free_symbols

if TYPE_CHECKING:  # simulations are imported where there is one
    from derive.inverse.loops.linkage import Reached
    from derive.motion.simulation.simulation import Run

MOST_SAMPLES = 1_000_000  # of a motion: a thousand seconds at a kilohertz


@dataclass(frozen=True)
class Motion:
    """A motion of a robot.

    Attributes:
        plan: What its file says.
    """

    plan: Plan

    def __getstate__(self) -> dict[str, Plan]:
        """The plan; what follows from it holds compiled code, and is made again."""
        return {"plan": self.plan}

    @classmethod
    def load(cls, path: str | Path) -> Motion:
        """Read a plan.

        Args:
            path: Of a YAML file, or the name of a built-in plan.

        Raises:
            RobotFileError: The file cannot be read or is no plan.
            UnknownRobotError: Neither a file nor the name of a plan.
        """
        return cls.of(load_plan(path))

    @classmethod
    def of(cls, plan: Plan) -> Motion:
        """The motion of a plan that its arm can follow, its trajectory computed.

        Args:
            plan: What its file says.

        Raises:
            RobotFileError: The arm cannot move so, or the motion has too many samples.
        """
        motion = cls(plan)
        motion._samples_in(motion.duration)
        if plan.robot.loops:
            q = motion(motion.times)[0]
            _, closed, missing = functions.joint_positions(plan.robot, q, motion.values, motion.reached)
            of_first = missing[~closed][:1].tolist()  # zero of loops with formulas
            what = f"are open by {of_first[0]:.3g} [m, or entries of rotations]" if any(of_first) else "do not close"
            motion._check_loops(motion.times, closed, what)
        for k, each in enumerate(plan.disturbances):
            if (start := evaluate(each.start, motion.values)) >= motion.duration:
                found = f"a disturbance from {start:.6g} s on, and the motion ends after {motion.duration:.6g} s"
                raise RobotFileError(found, remedy="leave it out", location=plan.places[f"disturbance, {k}"])
        if plan.control.period is not None:
            from derive.motion.simulation.simulation import period_of

            period_of(plan, motion.values, motion.duration)
        if motion.base is not None:
            motion.base(np.zeros(1), 0)
        return motion

    @classmethod
    def from_text(cls, text: str, source: str = "<text>") -> Motion:
        """Read a plan from YAML text.

        Args:
            text: Contents of a plan.
            source: Name for messages.

        Raises:
            RobotFileError: The text is no plan.
        """
        return cls.of(plan_from_bytes(text.encode("utf-8", "surrogatepass"), source))

    @classmethod
    def from_dict(cls, keys: Mapping[str, Any], source: str = "<plan>") -> Motion:
        """A plan as data: the keys of its file, with numbers, texts of cells such as ``pi/2``, lists and arrays.

        Args:
            keys: ``{"robot": "scara-matlab", "points": {...}, "path": [...]}``, in the units of the robot file.
            source: Name for messages; the path of a robot is relative to its folder.

        Raises:
            RobotFileError: These are no plan.
        """
        return cls.from_text(plan_text(keys), source)

    @classmethod
    def through(cls, robot: str, points: ArrayLike, times: ArrayLike | None = None, **keys: Any) -> Motion:
        """A motion through configurations.

        Args:
            robot: A built-in name, or the path of a robot file.
            points: One row a configuration, (points, n), in the units of the robot file.
            times: Of the segments [s], (points - 1,), or one for all; None where limits decide.
            **keys: Further keys of a plan, such as ``profile="septic"``, ``via="pass"``, ``speed=[...]``.

        Raises:
            RobotFileError: The arm cannot move so.
            ValueError: The points are no rows, or there is another number of times.
        """
        return cls.from_dict({"robot": robot, **waypoints(points, times), **keys})

    def __repr__(self) -> str:
        names = ", ".join(segment.name for segment in self.trajectory.segments)
        return f"Motion of {self.plan.robot.name}, {self.duration:.6g} s: {shorten(names, 200, placeholder=' ...')}"

    @cached_property
    def trajectory(self) -> Trajectory:
        """Joint variables as functions of time, exact."""
        if self.plan.recording is not None:
            return read_recording(self.plan.recording, self.plan.robot)
        if self.plan.curves:
            (duration,) = self._exact((self.plan.duration,))
            curves = self.plan.curves.items()
            return curves_of([self._followed(f, f"curves, {name}", float(duration)) for name, f in curves], duration)
        hand = Hand(self.plan, self.values, self._exact, self._loaded)
        _ = hand.branches  # also of points that the path does not have
        return trajectory_of(self.plan, hand)

    @cached_property
    def base(self) -> BaseCurve | None:
        """How the base moves; None where it stands."""
        if not self.plan.base:
            return None
        named = zip(PATHS, self.plan.base, strict=True)
        x, y, z, *angles = (self._followed(formula, f"base, {name}", self.duration) for name, formula in named)
        return BaseCurve.of((x, y, z), tuple(angles))

    def _followed(self, formula: Expression, what: str, duration: float) -> Expr:
        (exact,) = self._exact((formula,))
        try:
            return followed(exact.subs(Symbol(TIME_NAME), TIME), duration)
        except QuantityError as error:
            found = f"{what}: {error.found}"
            place = self.plan.places.get(what)
            raise RobotFileError(found, allowed=error.allowed, remedy=error.remedy, location=place) from None

    @cached_property
    def reached(self) -> Reached | None:
        """Where loops without formulas were closed on the way; None where there are none."""
        return functions.reached_of(self.plan.robot)

    @property
    def has_torques(self) -> bool:
        """Whether torques are known: of a robot with links."""
        return self.plan.robot.has_dynamics

    @property
    def duration(self) -> float:
        """How long it lasts [s]."""
        return float(self.trajectory.duration)

    def __call__(self, t: float | Array) -> tuple[Array, Array, Array]:
        """Position, velocity and acceleration.

        Returns:
            q, qd, qdd, (..., n) each [rad or m, per s, per s^2].
        """
        return self.trajectory(t)

    def poses(self, t: float | Array, end: str = "") -> Array:
        """Poses of the end effector in the world frame, (..., 4, 4).

        Args:
            t: Times [s], (...).
            end: Which end of a tree, where that has several.

        Raises:
            QuantityError: A symbol has no number, or there is no such end.
        """
        times, ends = np.asarray(t, dtype=float), self.plan.robot.ends
        robot, places = functions.arm_of(self.plan.robot, ends[0].name if len(ends) == 1 and not end else end)
        computed = Functions(robot, frozenset({"forward_kinematics"}), self.values, reached=self.reached)
        arm = computed("forward_kinematics", self(times)[0][..., list(places)])
        return arm if self.base is None else self.base(times.reshape(-1), 0).reshape(*times.shape, 4, 4) @ arm

    def _check_loops(self, times: Array, fine: Flags, what: str) -> None:
        """Refuse a motion in which loops do not close, or are at a dead point, at some of the times [s]."""
        if self.plan.robot.loops and not fine.all():
            time = float(times[~fine].min())
            found, q = f"the loops of {self.plan.robot.name} {what} at {time:.6g} s", self(time)[0].round(6).tolist()
            raise RobotFileError(found, remedy=f"stay away from q = {q} [rad, m]", location=self.plan.places["robot"])

    @property
    def times(self) -> Array:
        """Times of the samples [s], the end included.

        Raises:
            RobotFileError: There are more than `MOST_SAMPLES`.
        """
        sample, count = self._samples_in(self.duration)
        return np.append(np.arange(count) * sample, self.duration)

    @property
    def sample(self) -> float:
        """Time between two samples [s]."""
        return evaluate(self.plan.sample, self.values)

    def _samples_in(self, duration: float) -> tuple[float, int]:
        """Time between two samples [s], and how many times it fits into a duration, the last one rounded up."""
        sample, robot = self.sample, self.plan.robot
        if (count := duration / sample) > MOST_SAMPLES:
            size = count * 8 * (1 + (4 if robot.has_dynamics else 3) * robot.dof) / 1e9
            found = f"{count:.4g} samples of {duration:.6g} s, {size:.3g} GB"
            allowed, remedy = f"allowed: at most {MOST_SAMPLES} samples", f"write sample: {duration / 1000:.2g} [s]"
            raise RobotFileError(found, allowed=allowed, remedy=remedy, location=self.plan.places["sample"])
        return sample, int(np.ceil(count - 1e-9))

    def torques(self, t: float | Array) -> Array:
        """Torques, (..., n) [N m or N], by inverse dynamics; payload, friction and the motion of the base included.

        Args:
            t: Times [s], (...).

        Raises:
            QuantityError: The robot has no dynamics, or a symbol without a number.
        """
        times = np.asarray(t, dtype=float)
        index = self.trajectory.segment_at(times)
        q, qd, qdd = self.trajectory(times)
        tau = self._loaded(index, q, qd, qdd)
        self._check_loops(times, np.isfinite(tau.sum(axis=-1)), "are at a dead point")
        added = self.base_torques
        return tau if added is None else tau + self._with_payloads(added, times, index, q, qd)

    @property
    def base_torques(self) -> BaseTorques | None:
        """What the motion of the base adds to the torques; None where it stands."""
        return None if self.base is None else BaseTorques(self.plan.robot, self.values, self.base, self.duration)

    def _with_payloads(self, function: Callable[..., Array], t: Array, index: Indices, *states: Array) -> Array:
        """A function of times, states, (..., n), and what is carried, in steps by their index, (...)."""
        payloads = [step.payload for step in self.plan.steps] or [None]
        found: Array | None = None
        for payload in dict.fromkeys(payloads):
            here = np.isin(index, [i for i, other in enumerate(payloads) if other == payload])
            some = function(t[here], *(state[here] for state in states), payload)
            found = np.zeros((*t.shape, *some.shape[1:])) if found is None else found
            found[here] = some
        return np.asarray(found)

    def _loaded(self, index: Indices, q: Array, qd: Array, qdd: Array) -> Array:
        """Torques on a base that stands, in steps by their index, (...), with what these carry."""
        tau = self._functions("inverse_dynamics", q, qd, qdd)
        for i, step in enumerate(self.plan.steps):
            here = index == i
            if step.payload is not None and here.any():
                columns, numbers = zip(*self.payload_columns(step), strict=True)
                regressor = self._functions("regressor", q[here], qd[here], qdd[here])[..., columns]
                tau[here] += regressor @ np.array(numbers)
        return tau

    def payload_columns(self, step: Step) -> tuple[tuple[int, float], ...]:
        """What the tool carries in a segment, as parameters of the link that it is on.

        Returns:
            Columns of the regressor, and the parameters that belong to them; nothing where nothing is carried.
        """
        if step.payload is None:
            return ()
        joint, body = carried_body(self.plan.robot, step.payload, self.values)
        numbers = (body.mass, *body.first_moment, *(getattr(body.inertia, key) for key in INERTIA))
        named = {f"{part}{joint + 1}": number for part, number in zip(LINK_PARTS, numbers, strict=True)}
        return tuple((k, named[name]) for k, name in enumerate(self._functions.standard_parameters) if name in named)

    @cached_property
    def peaks(self) -> tuple[SegmentPeaks, ...]:
        """Largest speeds, accelerations and torques, segment by segment."""

        def _state(times: Array) -> tuple[Array, Array]:
            tau, (q, qd, qdd), base = self.torques(times), self.trajectory(times), self.base_torques
            if base is None:
                return tau, qd
            power = self._with_payloads(base.power, times, self.trajectory.segment_at(times), q, qd, qdd)[..., None]
            # the base is one more drive, of speed one
            return np.append(tau, power, axis=-1), np.append(qd, np.ones_like(power), axis=-1)

        n, found = self.plan.robot.dof, []
        for segment in self.trajectory.segments:
            speeds, accelerations = (tuple(peak(pieces, order) for pieces in segment.joints) for order in (1, 2))
            of_drives: tuple[Load, ...] = ()  # of each joint, and at last of a base that moves
            if self.has_torques:
                count, end = self._samples_in(float(segment.duration))[1], float(segment.start + segment.duration)
                corners = segment.corners if len(segment.corners) <= LEAST_INTERVALS else ()
                of_drives = functions.loads(float(segment.start), end, count, _state, corners)
            found.append(SegmentPeaks(segment, speeds, accelerations, of_drives[:n], *of_drives[n:]))
        return tuple(found)

    @cached_property
    def bounds(self) -> Bounds:
        """What robot and plan allow: `position`, `speed`, `acceleration`, `torque`, each its lowest and highest values.

        Arrays (n,), infinite where nothing limits; symbols without a number do not limit either.
        """
        return bounds_of(self.plan, self.values)

    @cached_property
    def violations(self) -> tuple[Violation, ...]:
        """Limits of robot and plan that the motion exceeds, joint by joint, where it does so most."""
        functions: dict[str, Function] = {
            "position": lambda t: self.trajectory(t)[0],
            "speed": lambda t: self.trajectory(t)[1],
            "acceleration": lambda t: self.trajectory(t)[2],
            **({"torque": self.torques} if self.has_torques else {}),
        }
        limited = {what: function for what, function in functions.items() if np.isfinite(self.bounds[what]).any()}
        within = np.arange(LEAST_INTERVALS) / LEAST_INTERVALS
        places = [float(segment.start) + float(segment.duration) * within for segment in self.trajectory.segments]
        times = np.sort(np.concatenate([self.times, *places]))
        times = times[np.diff(times, prepend=-1.0) > 0]  # np.unique would import numpy.ma
        return exceeded(times, {what: function(times) for what, function in limited.items()}, self.bounds, limited)

    def violations_of(self, run: Run) -> tuple[Violation, ...]:
        """Those that a simulation exceeds.

        Args:
            run: A simulation of this motion.
        """
        return exceeded(run.t, self._compared(run), self.bounds)

    def near_bounds(self, run: Run | None = None) -> Bounds:
        """What of `bounds` the motion, or a simulation of it, comes near, for plots; infinite elsewhere.

        Args:
            run: A simulation of this motion.
        """
        kinds = [joint.is_revolute for joint in self.plan.robot.variables]
        return nearby(self._compared(run), self.bounds, np.array(kinds))

    def _compared(self, run: Run | None) -> Mapping[str, Array]:
        if run is not None:
            return {"position": run.q, "speed": run.qd, "torque": run.tau}
        values = dict(zip(self.bounds, self.trajectory(self.times), strict=False))
        if self.has_torques and np.isfinite(self.bounds["torque"]).any():
            values["torque"] = self.torques(self.times)
        return values

    def simulate(self, *, calls: float | None = None) -> Run:
        """The arm under the plan's control law, from the start of the motion, at the times of the samples.

        Args:
            calls: How often about the generated functions will be called in this process: beyond some hundred
                thousand they are worth a compiler. None for an estimate of this one run.

        Returns:
            Times, positions, velocities, torques and energies.

        Raises:
            QuantityError: The robot has no dynamics, or a symbol without a number.
        """
        from derive.motion.simulation.simulation import period_of, simulate, stages_of

        self._check_dynamics()
        plan, trajectory = self.plan, self.trajectory
        stages = stages_of(plan, trajectory, self.values, calls, self.base_torques)
        start, sticks = trajectory(0.0)[:2], plan.friction == "exact"
        period = period_of(plan, self.values, self.duration)
        return simulate(stages, start, self.times, period, sticks=sticks, jumps=trajectory.jumps)

    def _exact(self, values: tuple[Expression, ...]) -> tuple[Expr, ...]:
        numbers = {**dict(self.plan.robot.parameters), **self.plan.values}
        known = {name: expression_to_sympy(value) for name, value in numbers.items()}
        return tuple(expression_to_sympy(value).subs(known) for value in values)

    @cached_property
    def values(self) -> Mapping[str, float]:
        """Numbers of all symbols that have one."""
        numbers = parameter_values(self.plan.robot)
        numbers |= {name: evaluate(value, numbers) for name, value in self.plan.values.items()}
        return {name: float(value) for name, value in numbers.items()}

    @cached_property
    def _functions(self) -> Functions:
        self._check_dynamics()
        carries = any(step.payload for step in self.plan.steps)
        names = ("inverse_dynamics", "regressor") if carries else ("inverse_dynamics",)
        return Functions(self.plan.robot, frozenset(names), self.values, reached=self.reached)

    def _check_dynamics(self) -> None:
        if not (robot := self.plan.robot).has_dynamics:
            raise QuantityError(f"{robot.name} has no dynamics", remedy="write its links into the robot file")
        functions.check_numbers(free_symbols(robot), self.values, robot.name, self.plan.places["robot"])
