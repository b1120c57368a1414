r"""What a formula is whose name is the author's own: the quantity of the robot that has its values.

No list of names is long enough: ``p_\text{elbow}``, ``r_w``, ``K_1``, ``{}^T J_4``. So values are compared at random
points: of ways between points, axes, velocities, Jacobians, parts of an energy. This can only say that a formula is
right: a wrong one has the values of nothing, or of another quantity, and is then named as that.
"""

import random
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import suppress
from functools import cache, cached_property
from itertools import combinations, pairwise, permutations, product

import numpy as np
import sympy
from mpmath import findroot

from derive.checking.formulas.branches import SIGN
from derive.checking.formulas.edits import NO_VALUE, float_value
from derive.checking.latex.left import AXES, Left
from derive.checking.latex.matrices import Entry, Table
from derive.checking.latex.poses import WRIST, Poses, names_of_pose
from derive.checking.latex.quantities import own_quantity, slope, turning
from derive.checking.motions import MOST_ACCELERATED, Array, Motions, matrix_value
from derive.lecture.sympy_conversion import Matrix
from derive.model.model import Model
from derive.model.quantities import REGISTRY
from derive.robot.description import IDENTITY
from derive.robot.expression import Call, Expression, Name, Sum, is_constant, names, number, substitute
from derive.robot.names import own_names, velocity_name

_MOTIONS = ("", "velocity of ", "acceleration of ")  # of a point, in the order of derivatives
_POINTS = 2  # random points at which values are compared
_MOST_JOINTS = 8  # of longer arms there are too many ways between points
_CLOSE = 1e-9  # their relative difference where they are equal
_HALVINGS = 60  # of an interval in which a formula changes its sign
_ZERO = 1e-13  # what is left at a root
_STARTS = (0.3, 1.0, 2.5)  # where one looks for the value of a name
_OF_FIGURE = re.compile(r"\|.*\|(?: in xy)?$|angle|pi - angle|direction|inclination|[^ ]+\+[^ ]+$")  # lengths, angles
_PLANES = ((0, 1), (0, 2), (1, 2))  # two coordinates of three

Named = tuple[str, Array]


class _RandomValues(dict[str, float]):
    """A random value for every name, always the same one; of joints small ones, where printed lengths are positive."""

    def __init__(self, point: int, joints: Iterable[str]) -> None:
        super().__init__()
        self._point, self._joints = point, frozenset(joints)

    def __missing__(self, name: str) -> float:
        scale = 0.25 if name in self._joints else 1
        self[name] = scale * random.Random(f"{name} {self._point}").uniform(0.3, 1.7)
        return self[name]


class ByValue:
    """The values of the quantities of a robot at random points, and what has the same ones."""

    def __init__(self, model: Model, poses: Poses | None) -> None:
        self._model, self._robot, self._poses = model, model.robot, poses
        self._joints = {joint.variable for joint in self._robot.joints}
        self._at = [_RandomValues(point, self._joints) for point in range(_POINTS)]
        self._rates = set(map(velocity_name, self._joints))
        cells = (cell for j in self._robot.joints for cell in (j.a, j.d, j.alpha, j.theta))
        self._lengths = {n for cell in cells for n in names(cell)}
        self.motions = Motions(model, self._at)
        self._by_shape = cache(self._grouped)

    @property
    def _readings(self) -> list[Mapping[str, Expression]]:
        """A position is the end effector's, of an arm with a wrist also that of the wrist, until that is settled."""
        if self._poses is None:
            return []
        tried = self._poses.readings[: None if self._model.n > WRIST else 1]
        return [reading.values for reading in ([self._poses.settled] if self._poses.settled else tried)]

    def quantity(self, value: Expression | Table, left: Left | None) -> str:
        """The name of what has these values and may have this name; empty where nothing has, or they say too little."""
        table = value if isinstance(value, Table) else Table(((Entry(value),),))
        formulas = [entry.formula for entry in table.entries]
        used = {name for e in formulas for name in names(e)}
        if len(formulas) == 1 and (sign := next((n for n in used if n.startswith(SIGN)), "")):  # +-arccos, an angle
            formulas, used = [substitute(formulas[0], {sign: number(1)})], used - {sign}
        is_open = any(entry.is_open or entry.unknown for entry in table.entries)
        is_branched = self._robot.is_tree and not (self._robot.coupled and self._model.n <= MOST_ACCELERATED)
        if is_branched or is_open or any(n.startswith(SIGN) for n in used) or self._model.n > _MOST_JOINTS:
            return ""
        readings: list[Mapping[str, Expression]] = self._readings if names_of_pose(*formulas) else [{}]
        moving = self._rates if left is not None and left.dots else self._joints | self._rates
        is_still = not (names_of_pose(*formulas) or used & moving)
        if is_still or (all(map(_says_little, formulas)) and not self._turns_a_link(used, *formulas)):
            return ""
        of_bodies = {n for link in self._robot.links for e in (link.mass, *link.com) for n in names(e)} - self._lengths
        is_dynamic = bool(used & (self._rates | of_bodies))
        # a centre of mass may be at half a length of the table; x_e is that of the end effector
        has_centres = left is not None and left.sub.lower() not in ("", "e", "ee", "end", "tip") and not is_dynamic
        has_centres &= self._robot.has_dynamics and self._model.n <= MOST_ACCELERATED
        for reading, dynamic in product(readings, (is_dynamic, True)[: 1 + has_centres]):
            with suppress(*NO_VALUE):
                read = [substitute(e, reading) for e in formulas] if reading else formulas
                values = [[float_value(e, at) for e in read] for at in (() if names_of_pose(*read) else self._at)]
                labels = self._like(np.array(values).reshape(-1, *table.shape), dynamic)
                # one term with the other sign is a slip as well
                may_turn = len(formulas) > 1 or isinstance(formulas[0], Sum)
                is_free = left is None or len(formulas) > 1
                for label in labels:
                    if (may_turn or label[0] != "-") and (is_free or (left and _may_mean(left, label))):
                        return label
        return ""

    def _like(self, wanted: Array, is_dynamic: bool) -> Iterator[str]:
        """Names of what has these values at the points."""
        for turned in (wanted, wanted.swapaxes(1, 2)) if 1 in wanted.shape[1:] else (wanted,):
            groups = self._by_shape(is_dynamic)
            if len(turned) and turned.shape[1:] in groups and np.abs(turned).max() > _CLOSE:
                labels, known = groups[turned.shape[1:]]
                gaps = np.abs(known - turned) / (1 + np.abs(turned))
                equal = gaps.reshape(len(labels), -1).max(axis=1) < _CLOSE
                yield from (labels[place] for place in np.flatnonzero(equal))

    def solved(self, name: str, zero: Expression) -> str:
        """The length or the angle of the robot that a name is, if a formula with it is zero; empty where it is none."""
        readings: list[Mapping[str, Expression]] = self._readings if names_of_pose(zero) else [{}]
        for reading in [] if self._robot.is_tree else readings:
            read = substitute(zero, reading)
            known = {*names(read)} - {name}
            # theta_2 = pi - alpha says what alpha is
            if known <= self._lengths | self._joints and (known & self._lengths or len(known) > 1):
                for start in _STARTS:
                    with suppress(*NO_VALUE):
                        values = [_root(read, name, {n: at[n] for n in names(read)} | {name: start}) for at in self._at]
                        found = self._like(np.array(values).reshape(_POINTS, 1, 1), False)
                        if label := next(filter(_OF_FIGURE.match, found), ""):
                            return label
        return ""

    def _grouped(self, is_dynamic: bool) -> dict[tuple[int, ...], tuple[list[str], Array]]:
        """All that is known, by shape: names, and values at the points."""
        groups: dict[tuple[int, ...], tuple[list[str], list[Array]]] = {}
        for name, values in self._all(is_dynamic):
            labels, known = groups.setdefault(values.shape[1:], ([], []))
            labels.append(name)
            known.append(values)
        return {shape: (labels, np.array(known)) for shape, (labels, known) in groups.items()}

    def _numbers(self, matrix: Matrix) -> Array:
        return np.array([matrix_value(matrix, at) for at in self._at])

    @cached_property
    def _frames(self) -> list[Array]:
        """Those of the table, and that of the end effector where a tool moves it."""
        last = [self._model.quantity("T")] * (self._robot.tool != IDENTITY)
        return list(map(self._numbers, (*map(self._model.frame, range(self._model.n + 1)), *last)))

    def _points(self, is_dynamic: bool) -> list[tuple[str, int, Array]]:
        """Origins of frames and centres of mass: name, link, place."""
        frames = self._frames
        points = [(f"p[{k}]", min(k, self._model.n), frame[:, :3, 3:]) for k, frame in enumerate(frames)]
        for k, body in enumerate(self._robot.links if is_dynamic else (), 1):
            com = np.array([[[float_value(e, at)] for e in body.com] for at in self._at])
            points.append((f"centre[{k}]", k, frames[k][:, :3, :3] @ com + frames[k][:, :3, 3:]))
        return points

    def _all(self, is_dynamic: bool) -> Iterator[Named]:
        """Transforms, vectors, Jacobians and energies, and what one reads from them."""
        n, robot = self._model.n, self._robot
        if robot.is_tree:  # a chain whose angles are counted from one direction
            yield from self._moved(_MOTIONS[: 1 + 2 * is_dynamic])
            return
        end, frames = self._numbers(self._model.quantity("T")), self._frames
        seen_from = [(f"{k},", f" in the axes of frame {k}", frame) for k, frame in enumerate(frames)]
        starts, points = self._points(is_dynamic=False), self._points(is_dynamic or n <= MOST_ACCELERATED)
        if robot.base != IDENTITY:
            seen_from = [("", "", np.zeros((_POINTS, 4, 4)) + np.eye(4)), *seen_from]
            starts = [("", 0, np.zeros((_POINTS, 3, 1))), *starts]
        else:
            seen_from[0] = ("0,", "", frames[0])
        yield from self._on_links(frames, points)
        if robot.joints[0].is_revolute:  # x along the arm, as (r, 0, z), which the first joint turns
            axes, angle = frames[0][:, :3, :3], self._of_joints(str)[:, :1]
            along = np.cos(angle) * axes[:, :, :1] + np.sin(angle) * axes[:, :, 1:2]
            across = np.cross(axes[:, :, 2:], along, axis=1)
            plane = np.concatenate([along, across, axes[:, :, 2:]], axis=2).swapaxes(1, 2)
            for name, _, point in points:
                yield from _vector(f"{name} in the plane of joint 1", plane @ (point - frames[0][:, :3, 3:]))
        turn = np.array(turning(self._model), dtype=float)
        jacobian = self._numbers(self._model.quantity("J")) @ np.linalg.inv(turn)
        rates = self._of_joints(velocity_name)
        for reference, where, frame in seen_from:
            axes = frame[:, :3, :3].swapaxes(1, 2)
            for k, other in enumerate(frames):
                seen = np.zeros((_POINTS, 4, 4)) + np.eye(4)
                seen[:, :3] = axes @ (other - frame * [0, 0, 0, 1])[:, :3]
                yield from _parts(f"T[{reference}{k}]", seen) if reference != f"{k}," else ()
            for (start, j, a), (stop, k, b) in product(starts, points):
                label = (f"({stop}-{start})" if start else stop) if k >= j else f"-({start}-{stop})"
                yield from _vector(f"{label}{where}", axes @ (b - a)) if start != stop else ()
            for name, link, point in points:
                # v of a point of a link is v of the end effector and omega x the way between them
                linear = jacobian[:, :3] + np.cross(jacobian[:, 3:], point - end[:, :3, 3:], axis=1)
                both = np.concatenate([axes @ linear, axes @ jacobian[:, 3:]], axis=1)
                both[:, :, link:] = 0
                both = both @ turn
                yield from _jacobian(f"J of {name}{where}", both)
                for label, part in _rows(f"velocity of {name}{where}", both @ rates) if is_dynamic else ():
                    yield from _vector(label, part)
        if is_dynamic and n <= MOST_ACCELERATED:
            yield from self._moved(("acceleration of ",))
        if is_dynamic and robot.has_dynamics:
            yield from self._dynamics()
        elif self._poses is not None:
            yield from self._exponentials()
            yield from self._angles()
            yield from self._triangles(points)

    def _moved(self, kinds: tuple[str, ...]) -> Iterator[Named]:
        """Origins of frames and centres of mass, their velocities or accelerations."""
        for k in range(1, self._model.n + 1):
            places = {f"p[{k}]": self._model.frame(k)[:3, 3]}
            places |= {f"centre[{k}]": own_quantity(self._model, f"centre[{k}]")} if self._robot.links else {}
            for name, moved in places.items():
                for kind in _MOTIONS[: _MOTIONS.index(kinds[-1]) + 1]:
                    moved = slope(self._robot, moved, "t") if kind else moved
                    if kind in kinds:
                        yield from _vector(f"{kind}{name}", self._numbers(moved))

    def _of_joints(self, name: Callable[[str], str]) -> Array:
        """A column of values that belong to the joints."""
        return np.array([[[at[name(joint.variable)]] for joint in self._robot.joints] for at in self._at])

    def _angles(self) -> Iterator[Named]:
        """Sums of joint angles that follow each other, and their functions."""
        variables, values = [joint.variable for joint in self._robot.joints], self._of_joints(str)
        for i, j in combinations(range(len(variables) + 1), 2):
            label, angle = "+".join(variables[i:j]), values[:, i:j].sum(axis=1, keepdims=True)
            yield label, angle
            yield from ((f"{f.__name__}({label})", f(angle)) for f in (np.cos, np.sin, np.tan))

    def _turns_a_link(self, used: set[str], e: Expression, *others: Expression) -> bool:
        """Whether a formula is the sum of the angles of joints about parallel axes, up to the last one of these."""
        places = [k for k, joint in enumerate(self._robot.joints) if joint.variable in used and joint.is_revolute]
        if others or not isinstance(e, Sum) or not len(places) == len(used) == len(e.terms) > 1:
            return False
        axes = self._numbers(self._model.quantity("J"))[0, 3:].T
        same = [bool(np.abs(a - b).max() < _CLOSE) for a, b in pairwise(axes)] + [False]
        return places == [*range(places[0], places[-1] + 1)] and all(same[places[0] : places[-1]]) > same[places[-1]]

    def keeps_pose(self, values: Mapping[str, Expression]) -> bool:
        """Whether the end effector stays where it is with other values of some joints."""
        if self._robot.is_tree:
            return False
        pose = self._model.quantity("T")
        used = {name for e in values.values() for name in names(e)} | {*map(str, pose.free_symbols)}
        here = ({name: at[name] for name in used} for at in self._at)
        pairs = ((at, at | {name: float_value(e, at) for name, e in values.items()}) for at in here)
        return all(np.allclose(matrix_value(pose, one), matrix_value(pose, other)) for one, other in pairs)

    def at_home(self, table: Table, left: Left) -> str:
        """The frame on a link, or its place, that a matrix is where all joint variables are zero; empty of others."""
        number, home = re.sub("[^0-9]", "", left.sub) or str(self._model.n), ByValue(self._model, None)
        for at in home._at:
            at.update(dict.fromkeys(self._joints, 0.0))
        if left.dots or len(table.entries) < 3 or any(entry.unknown for entry in table.entries) or self._robot.is_tree:
            return ""
        with suppress(*NO_VALUE):
            values = np.array([[float_value(entry.formula, at) for entry in table.entries] for at in home._at])
            frames = home._on_links(home._frames, home._points(is_dynamic=True))
            known = ((label, part.reshape(_POINTS, -1)) for label, seen in frames for part in (seen, seen[:, :3, 3:]))
            own = (label for label, a in known if a.shape == values.shape and np.allclose(a, values))
            return next((label for label in own if label.endswith(f"link {number}")), "")
        return ""

    def _on_links(self, frames: list[Array], points: list[tuple[str, int, Array]]) -> Iterator[Named]:
        """Frames at places of a link: that of the table, and the one that is parallel to the base at home."""
        zero, links = dict.fromkeys(self._joints, 0.0), map(self._model.frame, range(self._model.n + 1))
        still = [np.array([matrix_value(link, {**at, **zero}) for at in self._at]) for link in links]
        for name, k, place in points:
            for link in {k, min(k + 1, self._model.n)} - {0} if name[0] == "p" else {k}:
                for turn in (np.eye(4), still[link].swapaxes(1, 2)):
                    seen = frames[link].copy()
                    seen[:, :3, :3] = seen[:, :3, :3] @ turn[..., :3, :3]
                    seen[:, :3, 3:] = place
                    yield f"frame at {name}, link {link}", seen

    def _exponentials(self) -> Iterator[Named]:
        """What each joint alone moves, from the home position: e^{[S_1] theta_1}."""
        home = dict.fromkeys(self._joints, 0.0)
        for k, joint in enumerate(self._robot.joints, 1):
            frame, q = self._model.frame(k), joint.variable
            pairs = ((matrix_value(frame, at | home | {q: at[q]}), matrix_value(frame, at | home)) for at in self._at)
            yield from _parts(f"exp of screw {k}", np.array([moved @ np.linalg.inv(still) for moved, still in pairs]))

    def _triangles(self, points: list[tuple[str, int, Array]]) -> Iterator[Named]:
        """How ways are inclined, and the angles between those from one point, with their supplements."""
        for (start, _, a), (stop, _, b) in permutations(points, 2):
            x, y, z = (b - a)[:, :, :, None].swapaxes(0, 1)
            yield f"inclination of {stop}-{start}", np.arctan2(z, np.hypot(x, y))
            yield f"direction of {stop}-{start}", np.arctan2(y, x)
        for name, _, at in points:
            for (one, _, a), (other, _, b) in combinations((point for point in points if point[0] != name), 2):
                ways = [way / np.linalg.norm(way, axis=1, keepdims=True).clip(_CLOSE) for way in (a - at, b - at)]
                cosine = (ways[0] * ways[1]).sum(axis=1, keepdims=True)
                angle, label = np.arccos(cosine.clip(-1, 1)), f"angle {one}, {name}, {other}"
                yield from ((label, angle), (f"pi - {label}", np.pi - angle))
                yield from ((f"cos({label})", cosine), (f"cos(pi - {label})", -cosine))

    def is_singular(self, e: Expression) -> bool:
        """Whether the Jacobian, or its linear part, loses rank wherever a formula of joint variables is zero."""
        if self._robot.is_tree:
            return False

        def stretches(at: Mapping[str, float]) -> list[Array]:
            whole = matrix_value(self._model.quantity("J"), at)
            return [np.linalg.svd(part, compute_uv=False).astype(float) for part in (whole, whole[:3])]

        usual = [values[values > _CLOSE].size for values in stretches(self._at[0])]
        try:
            found = [zip(stretches(root), usual, strict=True) for root in self._roots(e)]
        except NO_VALUE:  # what is not known at one root is not said of all
            return False
        lost = [[s[rank - 1] < _CLOSE for s, rank in pairs if rank] for pairs in found]
        return bool(lost) and any(map(all, zip(*lost, strict=True)))

    def _roots(self, e: Expression) -> Iterator[Mapping[str, float]]:
        """Points where a formula is zero, along each of its joint variables from a random point."""
        for q in sorted(self._joints.intersection(names(e))):

            def at(x: float, q: str = q) -> tuple[float, Mapping[str, float]]:
                values = {name: self._at[0][name] for name in (*own_names(self._robot), *names(e))} | {q: x}
                return float_value(e, values), values

            for low, high in pairwise(np.linspace(-3.1, 3.2, 64)):
                if at(low)[0] * at(high)[0] < 0:
                    for _ in range(_HALVINGS):
                        middle = (low + high) / 2
                        low, high = (low, middle) if at(low)[0] * at(middle)[0] <= 0 else (middle, high)
                    yield at(low)[1]

    def _dynamics(self) -> Iterator[Named]:
        """Inertias, torques and energies of the arm and of each link."""
        rates = self._of_joints(velocity_name)
        whole = self._numbers(self._model.quantity("B"))
        parts, moved = [], 0 * whole
        for k, body in enumerate(self._robot.links, 1):
            linear = self._numbers(self._model.quantity(f"Jv_com[{k}]"))
            mass = np.array([float_value(body.mass, at) for at in self._at])[:, None, None]
            own = mass * linear.swapaxes(1, 2) @ linear
            parts.append((f"[{k}]", self._numbers(self._model.quantity(f"B_link[{k}]")), own))
            moved = moved + own
        for label, inertia, shifted in (("", whole, moved), *parts):
            kinds = (("kinetic", inertia), ("translation", shifted), ("rotation", inertia - shifted))
            yield f"B{label}", inertia
            yield from ((f"{kind}{label}", rates.swapaxes(1, 2) @ matrix @ rates / 2) for kind, matrix in kinds)
            yield from _entries(f"B{label}", inertia)
        yield from _entries("momentum", whole @ rates)
        if self._robot.gravity:
            energy = self._model.quantity("kinetic") + self._model.quantity("potential")
            yield "kinetic + potential", self._numbers(sympy.Matrix([energy]))
        for name in ("g", "friction", "tau"):
            if REGISTRY[name].is_of(self._robot):
                values = self._numbers(self._model.quantity(name))
                yield from ((name, values), *_entries(name, values))


def _root(e: Expression, name: str, at: dict[str, float]) -> float:
    """The value of a name at which a formula is zero, by secants; ValueError where they do not settle."""
    start, steps = (at[name], at[name] * 1.01), {"tol": _ZERO**2, "maxsteps": _HALVINGS}
    return float(findroot(lambda x: float_value(e, at | {name: float(x)}), start, solver="secant", **steps))


def _may_mean(left: Left, label: str) -> bool:
    """Whether a name may be that of a quantity: x is a first coordinate, r_12 an entry, x_2 a coordinate of point 2."""
    axis = re.fullmatch(r"(?:[cCgG]?[0-9]*)([xyz])", left.sub)
    row = AXES.get(axis[1] if axis else left.head.lower(), 0)
    entry = re.fullmatch("[1-3]{2}", left.sub) if left.head in ("r", "R") else None
    place = re.search(r"\[([0-9])(?:,([0-9]))?\]$", label)
    if entry is not None:
        return place is not None and (place[1], place[2]) == tuple(entry[0]) and left.labelled[-1:] in label[:-5]
    if row and (left.labelled or place is None or int(place[1]) != row):
        return False
    point = re.search("[1-9]", left.sub) if row else None
    return point is None or f"{point[0]}]" in label[: place.start() if place else None]


def _says_little(e: Expression) -> bool:
    """Whether a formula is a number, a name, a sum of names or a function of one: an abbreviation."""
    if isinstance(e, Sum):
        return all(isinstance(term, Name) for term in e.terms)
    if isinstance(e, Call):
        return not names_of_pose(e) and all(map(_says_little, e.arguments))
    return isinstance(e, Name) or is_constant(e)


def _entries(name: str, a: Array) -> Iterator[Named]:
    name = f"({name})" if " " in name else name
    for i, j in product(*map(range, a.shape[1:])):
        yield f"{name}[{i + 1}{f',{j + 1}' if a.shape[2] > 1 else ''}]", a[:, i : i + 1, j : j + 1]


def _parts(name: str, seen: Array) -> Iterator[Named]:
    """A transform, its rotation, the plane of both, its columns and its entries."""
    yield from ((name, seen), (name, seen[:, :3]), (name, seen[:, :3, :3]), (name, seen[:, :2, :2]))
    for j in range(4):
        yield from ((f"{name}[{j + 1}]", seen[:, :3, j : j + 1]), (f"{name}[{j + 1}]", seen[:, :, j : j + 1]))
        yield from ((f"{name}[{j + 1}]", seen[:, plane, j : j + 1]) for plane in map(list, _PLANES))
    yield from _entries(name, seen)


def _vector(name: str, a: Array) -> Iterator[Named]:
    """A vector, two of its coordinates, each of them, and lengths with their squares."""
    yield name, a
    yield from _entries(name, a)
    if a.shape[1] > 3:
        return
    for plane in map(list, ((0, 1, 2), *_PLANES)):
        square = (a[:, plane] ** 2).sum(axis=1, keepdims=True)
        label = f"|{name}|" + (f" in {''.join('xyz'[i] for i in plane)}" if len(plane) < 3 else "")
        yield from ((name, a[:, plane]), (label, np.sqrt(square)), (f"{label}^2", square))


def _rows(name: str, a: Array) -> tuple[Named, ...]:
    """Six rows with the linear ones or the angular ones above, and the parts."""
    turned = np.concatenate([a[:, 3:], a[:, :3]], axis=1)
    return (name, a), (name, turned), (f"linear {name}", a[:, :3]), (f"angular {name}", a[:, 3:])


def _jacobian(name: str, a: Array) -> Iterator[Named]:
    yield from _rows(name, a)
    yield from ((name, a[:, list(plane)]) for plane in _PLANES)
    for j in range(a.shape[2]):
        column = f"{name}, column {j + 1}"
        yield from (*_rows(column, a[:, :, j : j + 1]), *((column, a[:, list(p), j : j + 1]) for p in _PLANES))
