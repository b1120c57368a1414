"""Curves of a picture of the workspace among which its boundary lies: critical curves, and images of joint limits.

A map of two joint variables into a plane folds where its determinant is zero (Burdick, Kinematic analysis and design
of redundant robot manipulators, 1988; Ceccarelli, Fundamentals of Mechanics of Robotic Manipulation, ch. 3). For a
section through an axis about which joint t turns the workspace it is det J of the positioning part, for a view along
the axis z the triple product of z and two columns of J. Both are exact polynomials, and each of their factors is
followed for itself, so that curves that cross or touch are not taken for one. A joint that turns the whole picture adds
the picture's curves at its two limits, and circles through the places that are nearest to and farthest from the axis.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from itertools import combinations

import numpy as np

from derive.algebra.domain import PolynomialDomain
from derive.algebra.factors import Factoring
from derive.algebra.generators import Kind
from derive.algebra.ring import Polynomial, determinant
from derive.arrays import Array
from derive.errors import DeriveError
from derive.mechanics.exact import Kinematics
from derive.robot.evaluate import to_float
from derive.workspace.point import TURN, Picture, PlaneMap

Determinant = Callable[[Array, Array], Array]  # a function of two joint variables, zero where the map folds
MAX_TERMS = 3_000  # determinants with more terms are followed in floats, not as exact factors
_WARP = 0.013  # part of a range by which grid lines are moved off round angles, where a factor may be zero all along
_START = math.sqrt(2.0) - 1.0  # where the grid of a joint that turns all around starts, beyond its lower limit [rad]
_BISECTIONS = 48
_ZOOMS = 45
_ALIKE = 1e-9


def folds(plane: PlaneMap) -> tuple[tuple[Determinant, ...], bool]:
    """The functions whose zeros are the critical curves of a map of two variables."""
    try:
        return tuple(_exact_factors(plane)), True
    except DeriveError:  # too long, or the point has no exact place
        return (partial(_determinant, plane),), False


def _determinant(plane: PlaneMap, u: Array, v: Array) -> Array:
    """Zero where the map folds, of floats."""
    grid = np.broadcast_arrays(u, v)
    _, (first, second) = plane.values(np.stack([part.ravel() for part in grid]))
    return np.asarray((first[0] * second[1] - first[1] * second[0]).reshape(grid[0].shape))


def _exact_factors(plane: PlaneMap) -> Iterator[Determinant]:
    """The factors of det (w, J_u, J_v): w is the column of the joint that turns in a section, else the axis."""
    point, turn = plane.point, plane.point.turn
    domain = PolynomialDomain(point.poses.robot, rates=False, max_terms=MAX_TERMS)
    kinematics = Kinematics(point.poses.robot, domain)
    n, everything = point.poses.robot.n, tuple(range(point.poses.robot.n))
    # The point is the end effector's origin or that of a frame before it: which one, is told by its columns of J_v in
    # floats at three configurations.
    q = point.random(3, everything, seed=5)
    wanted = np.einsum("ij,jkn->ikn", point.axis[0], point.motion(q, everything)[1])
    whole = PlaneMap(point, Picture.SIDE, everything)
    for place in (kinematics.end.position, *(kinematics.frame(i).position for i in range(n, max(n - 4, 0), -1))):
        columns = kinematics.linear_columns(place)
        values = [[_evaluated(entry, domain, whole, *q) for entry in column] for column in columns]
        found = np.stack([[np.broadcast_to(x, q.shape[1:]) for x in column] for column in values], axis=1)
        if np.abs(found - wanted).max() <= 1e-9 * point.size:
            break
    else:
        raise DeriveError("the point is no origin of a frame")
    if plane.picture is Picture.SIDE or turn is None:
        raise DeriveError("the plane of the picture has no exact normal")
    # In a section distances from the axis and heights count, whatever the turn of the first joint does: the picture
    # folds where its column lies in the plane of the others. From above it folds where z does.
    across = columns[turn] if plane.picture is Picture.SECTION else kinematics.axis(turn + 1)
    vectors = [across, *(columns[j] for j in plane.joints)]
    if not (product := determinant([[vector[row] for vector in vectors] for row in range(3)])):
        return
    for factor in Factoring(domain).factors(product):
        if any(domain.derivative(factor.value, j) for j in plane.joints):
            yield partial(_evaluated, factor.value, domain, plane)


def _evaluated(p: Polynomial, domain: PolynomialDomain, plane: PlaneMap, *q: Array) -> Array:
    """A polynomial at the joint variables of a map, given as arrays; those of other joints are zero."""
    values = dict(zip(plane.joints, q, strict=True))
    zero = np.zeros(())
    numbers: list[Array | float] = []
    for index, generator in enumerate(domain.generators):
        if not p.degrees()[index]:
            numbers.append(1.0)
        elif generator.kind in (Kind.SINE, Kind.COSINE):
            # A generator is the sine or cosine of a sum of angles of parallel axes, counted along the first of them.
            members = domain.angles[generator.joint]
            first = domain.directions[members[0]]
            angle = sum((first * domain.directions[m] * values.get(m, zero) for m in members), zero)
            numbers.append(np.sin(angle) if generator.kind is Kind.SINE else np.cos(angle))
        elif generator.kind is Kind.VARIABLE:
            numbers.append(values.get(generator.joint, zero))
        else:
            numbers.append(to_float(generator.expression, plane.point.poses.values))
    total: Array = zero
    for exponents, coefficient in p.terms():
        term: Array | float = float(coefficient)
        for number, exponent in zip(numbers, exponents, strict=True):
            term = term * number**exponent if exponent else term
        total = total + term
    return total


# -- curves in the plane of the picture, as segments (k, 2, 2)


def boundary_candidates(plane: PlaneMap, cells: int) -> Array:
    """Segments among which a picture's boundary lies, their ends exactly on the curves, (segments, 2 ends, 2) [m]."""
    turn = plane.point.turn
    # A circle of the arm's size departs from its chord by r (2 pi/N)^2 / 8: four times as much.
    gap = plane.point.size * (TURN / cells) ** 2 / 2.0
    if turn is None or turn not in plane.joints or plane.picture is not Picture.TOP:
        return _bridged(_curves(plane, cells), gap)
    rest = PlaneMap(plane.point, plane.picture, tuple(j for j in plane.joints if j != turn))
    way = plane.point.ranges[turn]
    # Circles between a polygon inside and one outside: what ends on the circle crosses one of them.
    angles, found = np.linspace(0.0, TURN, 4 * cells + 1), [np.zeros((0, 2, 2))]
    points: Array = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    points[-1] = points[0]
    sides = np.stack([points[:-1], points[1:]], axis=1)
    for radius in _extreme_radii(rest, cells):
        found += [radius * sides, radius / math.cos(math.pi / (4 * cells)) * sides]
    if not way.full:
        curves = _bridged(_curves(rest, cells), gap)
        places = rest.places(rest.point.random(64, rest.joints))
        middle = places.mean(axis=1)
        directions, spread, _ = np.linalg.svd(places - middle[:, None], full_matrices=False)
        # An arm that is seen from its edge has no fold: the line of all its places; more cells do no harm.
        if spread[1] <= _ALIKE * rest.point.size:
            along = 3.0 * rest.point.size * directions[:, 0]
            curves = np.concatenate([curves, [[middle - along, middle + along]]])
        for angle in (way.lower, way.upper):
            c, s = math.cos(angle), math.sin(angle)
            found.append(curves @ np.array([[c, -s], [s, c]]).T)
    return np.concatenate(found)


def _bridged(segments: Array, gap: float) -> Array:
    """With small crosses where a curve turns back, or is nearest to or farthest from the axis."""
    # There it touches another curve, and both are known in points only, which leaves a gap. Lines that lead nowhere
    # bound no cell, so that a cross does no harm elsewhere.
    # Ends of segments by their rounded places: two at an inner point of a curve.
    ends, place = np.unique(np.round(segments.reshape(-1, 2) / (1e-6 * gap)), axis=0, return_inverse=True)
    place = place.reshape(-1, 2)
    order = np.argsort(place.ravel(), kind="stable")
    counts = np.bincount(place.ravel(), minlength=len(ends))
    first = np.cumsum(counts) - counts
    inner = np.flatnonzero(counts == 2)
    one, two = (place[order[first[inner] + k] // 2, 1 - order[first[inner] + k] % 2] for k in range(2))
    at, before, after = (1e-6 * gap * ends[chosen] for chosen in (inner, one, two))
    # Turned back: both neighbours on one side. Extreme radius: both neighbours nearer to, or farther from, the axis.
    back = np.sum((before - at) * (after - at), axis=1) > 0.0
    middle, low, high = (np.hypot(*corner.T) for corner in (at, before, after))
    tips = at[back | ((middle - low) * (middle - high) > 0.0)]
    arms = gap * np.array([[[-1.0, 0.0], [1.0, 0.0]], [[0.0, -1.0], [0.0, 1.0]]])
    return np.concatenate([segments, (tips[:, None, None] + arms).reshape(-1, 2, 2)])


def _curves(plane: PlaneMap, cells: int) -> Array:
    """Critical curves of a map of at most two variables, and the images of the limits."""
    if not plane.joints:
        return np.zeros((0, 2, 2))
    if len(plane.joints) == 1:
        return _image(plane, _joined(_grid(plane, 0, 4 * cells)[None]))
    grids = [_grid(plane, k, cells) for k in range(2)]
    zero_lines = [zeros(factor, grids[0], grids[1], [way.full for way in plane.ranges]) for factor in folds(plane)[0]]
    found = [_image(plane, ends) for ends in zero_lines]
    for held, moved in ((0, 1), (1, 0)):
        for value in () if plane.ranges[held].full else (grids[held][0], grids[held][-1]):
            # Corners are shared with the critical curves.
            on_limit = [ends[moved][ends[held] == value] for ends in zero_lines]
            along = np.unique(np.concatenate([_grid(plane, moved, 4 * cells), *on_limit]))
            q = np.empty((2, len(along)))
            q[held], q[moved] = value, along
            found.append(_image(plane, _joined(q)))
    return np.concatenate(found) if found else np.zeros((0, 2, 2))


def _grid(plane: PlaneMap, variable: int, cells: int) -> Array:
    """Values of a variable from its lower to its upper limit, uneven so that round angles lie between them."""
    way = plane.ranges[variable]
    share = np.linspace(0.0, 1.0, cells + 1)
    share = share + _WARP * np.sin(TURN * share)
    lower, upper = (way.lower + _START, way.lower + _START + TURN) if way.full else (way.lower, way.upper)
    grid: Array = lower + (upper - lower) * share
    grid[-1] = upper
    return grid


def _joined(q: Array) -> Array:
    """Neighbours of a line through configurations: (variables, pairs, 2 ends)."""
    return np.stack([q[:, :-1], q[:, 1:]], axis=2)


def _image(plane: PlaneMap, ends: Array) -> Array:
    """The image of short lines, cut where one passes the axis of a section, (segments, 2 ends, 2) [m]."""
    q = ends.reshape(len(ends), -1)
    segments: Array = plane.values(q)[0].T.reshape(-1, 2, 2)
    if plane.picture is not Picture.SECTION:
        return segments
    # The axis is passed where (x, y) turns by more than a right angle; distances from it add up on both sides.
    x, y = plane.point.motion(q, plane.joints)[0][:2].reshape(2, -1, 2)
    passing = x[:, 0] * x[:, 1] + y[:, 0] * y[:, 1] < 0.0
    near, far = segments[passing, 0], segments[passing, 1]
    share = (near[:, 0] / (near[:, 0] + far[:, 0]))[:, None]
    on_axis = (near + share * (far - near)) * (0.0, 1.0)
    return np.concatenate([segments[~passing], *[np.stack(pair, axis=1) for pair in ((near, on_axis), (on_axis, far))]])


def zeros(function: Determinant, us: Array, vs: Array, closed: Sequence[bool] = (False, False)) -> Array:
    """The curves on which a function of two variables is zero, as short lines: (2 variables, lines, 2 ends)."""
    # The zeros on the lines of a grid are found by bisection; in each cell they are joined, all of them where there are
    # four, which closes every crossing.
    # Grid lines whose ends have different signs, in both directions; joints that turn all around close the grid.
    above = np.array(np.broadcast_to(function(us[:, None], vs[None, :]), (len(us), len(vs))) >= 0.0)
    for axis, is_closed in enumerate(closed):
        if is_closed:
            np.moveaxis(above, axis, 0)[-1] = np.moveaxis(above, axis, 0)[0]
    across, along = np.nonzero(above[1:] != above[:-1]), np.nonzero(above[:, 1:] != above[:, :-1])
    low = np.stack([np.append(us[across[0]], us[along[0]]), np.append(vs[across[1]], vs[along[1]])])
    high = np.stack([np.append(us[across[0] + 1], us[along[0]]), np.append(vs[across[1]], vs[along[1] + 1])])
    sign = np.append(above[across], above[along])
    for _ in range(_BISECTIONS if len(sign) else 0):
        middle = (low + high) / 2
        same = (function(middle[0], middle[1]) >= 0.0) == sign
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    number_across, number_along = np.full((len(us) - 1, len(vs)), -1), np.full((len(us), len(vs) - 1), -1)
    number_across[across] = np.arange(len(across[0]))
    number_along[along] = np.arange(len(along[0])) + len(across[0])
    if closed[1]:
        number_across[:, -1] = number_across[:, 0]
    if closed[0]:
        number_along[-1] = number_along[0]
    # The zeros on the four sides of each cell by their numbers, -1 for none, joined in pairs.
    sides = (number_across[:, :-1], number_across[:, 1:], number_along[:-1], number_along[1:])
    pairs = combinations([side.ravel() for side in sides], 2)
    return ((low + high) / 2)[:, np.concatenate([np.stack([a, b], axis=1)[(a >= 0) & (b >= 0)] for a, b in pairs])]


def _extreme_radii(plane: PlaneMap, cells: int) -> list[float]:
    """Distances from the axis that are smallest or largest among those of configurations nearby."""
    if not plane.joints:
        return [float(np.hypot(*plane.values(np.zeros((0, 1)))[0][:, 0]))]
    grids = [_grid(plane, k, cells)[: -1 if way.full else None] for k, way in enumerate(plane.ranges)]
    q = np.stack([part.ravel() for part in np.meshgrid(*grids, indexing="ij")])
    shape = tuple(len(grid) for grid in grids)
    radius = np.hypot(*plane.values(q)[0]).reshape(shape)
    around = np.stack(np.meshgrid(*[(-1.0, -0.5, 0.0, 0.5, 1.0)] * len(grids), indexing="ij")).reshape(len(grids), -1)
    found: list[float] = []
    for sign in (1.0, -1.0):
        # Configurations of the grid that are nearest (farthest) among their neighbours, refined below.
        lowest = np.ones(shape, dtype=bool)
        for k, way in enumerate(plane.ranges):
            for step in (1, -1):
                beside = np.roll(sign * radius, step, axis=k)
                if not way.full:
                    np.moveaxis(beside, k, 0)[0 if step > 0 else -1] = np.inf  # what was rolled around
                lowest &= sign * radius <= beside + 1e-12 * plane.point.size
        # The smallest of sign*radius around them, by looking around in ever smaller steps.
        near, size = q[:, lowest.ravel()], np.array([[float(np.ptp(g)) / cells] for g in grids])
        rows, best = np.arange(near.shape[1]), np.zeros(near.shape[1])
        for _ in range(_ZOOMS):
            tried = plane.inside((near[:, :, None] + (size * around)[:, None, :]).reshape(len(size), -1))
            distance = np.hypot(*plane.values(tried)[0]).reshape(near.shape[1], -1)
            chosen = np.argmin(sign * distance, axis=1)
            best = distance[rows, chosen]
            near = tried.reshape(len(size), near.shape[1], -1)[:, rows, chosen]
            size = size * 0.6
        found += list(best)
    # Radii of one circle from different configurations are one.
    return sorted({round(r / plane.point.size / _ALIKE) * _ALIKE * plane.point.size for r in found if r > 0.0})
