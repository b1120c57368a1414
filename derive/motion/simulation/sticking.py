"""Dry friction that sticks: which joints slip and which stand, and when that changes."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Self

import numpy as np

from derive.arrays import Array, Flags
from derive.motion.simulation.stepping import DIVERGED, Divergence, Law, Plant, Steps, integrated, solver

LONGEST = 2e-2  # longest step: changes of slip and stick are looked for at its end [s]
STEP = 1e-3  # longest time step of `stepped` [s]
SWEEPS = 2000  # most sweeps for the friction of joints that depend on one another
RESTS = 1e-12  # speed against its own direction at which a joint has come to rest [rad/s or m/s]
BREAKS = 1e-11  # what a joint needs beyond its friction to break away, relative to it
BUSY, MOMENT = 12, 1e-6  # so many changes within such a time [s] have no end: time steps lead on


@dataclass(frozen=True)
class Contact:
    """An arm of which some joints slip and others stand."""

    plant: Plant  # the arm
    law: Law  # what the motors do
    way: Array  # which way joints with dry friction slip, 1 or -1; 0 where they stand, or without dry friction, (n,)

    @classmethod
    def at(cls, plant: Plant, law: Law, t: float, q: Array, qd: Array) -> Self | None:
        """What slips after a time at which joints at rest have velocity zero; None where rounding leaves it open."""
        # A joint that is at rest stands where friction can hold it, and slips against its friction otherwise. Which of
        # them do depends on all: accelerations a = a(tau) - B^-1 p with -f_minus <= p <= f_plus, and p is at the bound
        # of the sign of a where a is not zero.
        rough, (ahead, back) = (plant.coulomb > 0).any(axis=0), plant.coulomb
        way, open_ = np.where(rough, np.sign(qd), 0.0), rough & (qd == 0)
        if open_.any():
            # Accelerations without the friction of joints at rest, and the friction that would hold these: a joint
            # that needs all it has slips against it.
            driven = plant.felt(law(t, q, qd) + plant.push, t, q, qd) - plant.dry(way)
            free = plant.functions("forward_dynamics", q, qd, driven)
            held = _complementary(_mobility(plant, q), free, np.where(open_, plant.coulomb, 0.0))[1]
            way = np.where(open_ & (held >= ahead), 1.0, np.where(open_ & (held <= -back), -1.0, way))
        # Confirmed by the equations of motion: a joint that stands with more than its friction breaks away, one that
        # should slip and is not accelerated its way stands.
        most, least = _spared(plant, BREAKS / 2)
        for _ in range(4 * way.size):
            contact = cls(plant, law, way)
            _, qdd, friction = contact.forces(t, q, qd)
            breaks = contact.stands & ((friction > most) | (friction < least))
            stays = open_ & (way * qdd < 0)
            if not (breaks | stays).any():
                return contact
            way = np.where(breaks, np.sign(friction), np.where(stays, 0.0, way))
        return None

    @cached_property
    def stands(self) -> Flags:
        """Whether friction holds a joint, (n,)."""
        return np.asarray((self.plant.coulomb > 0).any(axis=0) & (self.way == 0))

    @cached_property
    def _apart(self) -> tuple[Array, Array]:
        """What makes of an inertia matrix that of the joints that slip, and 1 for each that stands."""
        slips = np.where(self.stands, 0.0, 1.0)
        return np.outer(slips, slips), np.diag(1 - slips)

    def forces(self, t: float, q: Array, qd: Array) -> tuple[Array, Array, Array]:
        """What acts on the joints, qdd, and the friction, that which holds joints that stand included, (n,) each."""
        plant, driven = self.plant, self.law(t, q, qd) + self.plant.push
        friction = plant.dry(self.way)  # of joints that slip
        qdd = plant.functions("forward_dynamics", q, qd, plant.felt(driven, t, q, qd) - friction)
        if self.stands.any():
            # Rows and columns of joints that stand are those of a unit matrix: B_ss qdd_s = pull_s, qdd = 0 elsewhere.
            # What holds them is their row of pull - B qdd.
            inertia, (both, alone) = plant.functions("inertia_matrix", q), self._apart
            pull = inertia @ qdd
            qdd = np.asarray(np.linalg.solve(inertia * both + alone, np.where(self.stands, 0.0, pull)), dtype=float)
            friction = friction + np.where(self.stands, pull - inertia @ qdd, 0.0)
        return driven, qdd, friction

    def rates(self, t: float, state: Array) -> Array:
        """Derivatives of a state by time."""
        n, rates = self.way.size, np.zeros_like(state)
        if (qd := state[n : 2 * n]) @ qd < 4 * n * DIVERGED**2:
            driven, qdd, friction = self.forces(t, state[:n], qd)
            rates[:n], rates[n : 2 * n] = qd, qdd
            rates[2 * n :] = self.plant.ledger(driven, friction, t, state[:n], (qd, qdd))
        return rates

    def margin(self, t: float, state: Array) -> float:
        """Above zero as long as what slips goes on and what stands is held."""
        n = self.way.size
        qd = state[n : 2 * n]
        # A slipping joint has speed its way; a standing one some of its friction to spare. The solver stops at zero.
        found = np.where(self.way != 0, self.way * qd + RESTS, np.inf)
        if self.stands.any():
            friction, (most, least) = self.forces(t, state[:n], qd)[2], _spared(self.plant, BREAKS)
            found = np.where(self.stands, np.minimum(most - friction, friction - least), found)
        return float(found.min())


def exact(plant: Plant, law: Law, state: Array, span: tuple[float, float], times: Array) -> Steps:
    """With Coulomb friction that sticks: |qd| is zero, not small, below the torque of breakaway.

    A solver leads to the time at which a joint that slips comes to rest, or one that stands needs more than friction;
    there it is decided anew which of them slip (Acary and Brogliato, Numerical Methods for Nonsmooth Dynamical Systems,
    2008, chapter 8). Where changes follow one another without end, time steps of `stepped` lead across them.
    """
    n, t = plant.viscous.size, span[0]
    rows: list[Array] = []
    changes: list[float] = []
    divergence = None
    while len(rows) < len(times) and divergence is None:
        # Which joints slip from here on; where changes have no end (Zeno), time steps lead across.
        contact = Contact.at(plant, law, t, state[:n], state[n : 2 * n])
        if contact is None or (len(changes) >= BUSY and t - changes[-BUSY] < MOMENT):
            changes.clear()
            end = min(t + LONGEST, float(times[len(rows)]))
            found, divergence = stepped(plant, law, state, (t, end), np.array([end]))
            if divergence is None:
                t, state = end, found[0]
                rows += [state] if end == times[len(rows)] else []
            continue
        # Smooth motion up to the next change, at which the margin crosses zero.
        wanted = times[len(rows) :]
        span, method = (t, span[1]), solver(contact.rates, state, (t, span[1]))
        got, change, divergence = integrated(contact.rates, state, span, wanted, method, contact.margin, LONGEST)
        rows += list(got)
        if change is not None:
            t, state = change
            changes.append(t)
            slow = contact.way * state[n : 2 * n] <= 2 * RESTS
            state[n : 2 * n][(contact.way != 0) & slow] = 0.0  # what no longer slips its way is at rest
    return np.array(rows).reshape(-1, state.size), divergence


def stepped(plant: Plant, law: Law, state: Array, span: tuple[float, float], times: Array) -> Steps:
    """With Coulomb friction that sticks, by time steps of first order; no chatter stops them.

    A step of time h solves ``qd+ = qd + h qdd(tau) - B^-1 p`` for impulses p of friction with p = h f sign(qd+) where a
    joint slips and |p| <= h f where it sticks, by projected Gauss-Seidel (Moreau's time stepping; Acary and Brogliato,
    Numerical Methods for Nonsmooth Dynamical Systems, 2008).
    """
    n, t = plant.viscous.size, span[0]
    q, qd, done = state[:n], state[n : 2 * n], state[2 * n :]
    rows: list[Array] = []
    for wanted in times:
        steps = max(int(np.ceil((wanted - t) / STEP - 1e-9)), 1)
        h = float(wanted - t) / steps
        for _ in range(steps):
            driven = law(t, q, qd) + plant.push
            # The velocity without friction, then the impulses of friction that agree with the velocity after the step.
            free = qd + h * plant.functions("forward_dynamics", q, qd, plant.felt(driven, t, q, qd))
            after, impulse = _complementary(_mobility(plant, q), free, h * plant.coulomb)
            # Work by the mean velocity of the step, which is exact for impulses in it.
            rates = (qd + after) / 2, (after - qd) / h
            done = done + h * np.array(plant.ledger(driven, impulse / h, t, q, rates))
            q, qd, t = q + h * after, after, t + h
            if not np.all(np.abs(qd) < DIVERGED):
                return np.array(rows).reshape(-1, state.size), Divergence(t, q, qd)
        t = float(wanted)
        rows.append(np.concatenate([q, qd, done]))
    return np.array(rows), None


def _spared(plant: Plant, share: float) -> tuple[Array, Array]:
    """The most and the least friction of joints that stand, and a share more of the larger of both, (n,) each."""
    most = plant.coulomb * (1 + share) + share * (plant.coulomb.max(axis=0) - plant.coulomb)
    return most[0], -most[1]


def _mobility(plant: Plant, q: Array) -> Array:
    """Accelerations by torques, (n, n)."""
    return np.asarray(np.linalg.inv(plant.functions("inertia_matrix", q)))


def _complementary(mobility: Array, free: Array, coulomb: Array) -> tuple[Array, Array]:
    """Velocities and impulses of friction, or accelerations and torques, by projected Gauss-Seidel with B^-1."""
    # coulomb: the largest of them for qd > 0, and against that for qd < 0, (2, n).
    rows, velocity, (most, back) = mobility.tolist(), free.tolist(), coulomb.tolist()
    joints: Sequence[int] = [j for j, pair in enumerate(zip(most, back, strict=True)) if any(pair)]
    friction = [0.0] * len(velocity)
    enough = 1e-14 * max(*most, *back, 1e-300)
    for _ in range(SWEEPS):
        largest = 0.0
        for j in joints:
            # The friction that would stop joint j alone, cut to what it has; v -= B^-1 e_j dp.
            new = min(max(friction[j] + velocity[j] / rows[j][j], -back[j]), most[j])
            if change := new - friction[j]:
                largest, friction[j] = max(largest, abs(change)), new
                for i, row in enumerate(rows):
                    velocity[i] -= row[j] * change
        if largest <= enough:
            break
    # A joint whose friction is not used up stands exactly: its velocity is nothing but rounding.
    held = [-back[j] < friction[j] < most[j] for j in range(len(most))]
    return np.array([0.0 if stands else v for stands, v in zip(held, velocity, strict=True)]), np.array(friction)
