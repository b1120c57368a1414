"""Areas of the plane: from curves among which a boundary lies to the cells that an arm reaches, and their measures.

The curves cut the plane into cells. Within a cell the number of configurations that reach a place does not change, so
one place inside decides for all of it. Cutting and joining areas is Shapely's work: decision 15 in docs/decisions.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any, TypeAlias

import numpy as np

from derive.arrays import Array, Flags
from derive.errors import DeriveError, optional
from derive.workspace.critical import boundary_candidates
from derive.workspace.point import TURN, Picture, PlaneMap

Region: TypeAlias = Any  # an area of Shapely: polygons with holes, or nothing
CELLS = 400  # parts into which the range of a joint is cut where critical curves are followed
# Corners are rounded to this part of the arm's size, so that curves that meet share a corner; with a hundredth of it
# straight curves that run back on themselves are cut at wrong places, and cells beside them run into one.
_GRID = 1e-8
_THIN = 2e-5  # cells thinner than this part of the arm's size lie between two approximations of one curve
_SLIVER = 1e-3  # of cells thinner than this part of the arm's size nothing is said for themselves
_ROUND = 128  # corners of a quarter of a circle
_SEEDS = 40_000
_SAMPLES = 200_000
AT_A_LIMIT = 0.25  # part of the samples of a joint that lie at one of its limits
_STARTS, _FIRST = 12, 2  # configurations from which it is tried to reach a place
_REACHED = 1e-8  # a place nearer than this part of the arm's size is reached


@dataclass(frozen=True, slots=True)
class Measure:
    """An area or a volume."""

    value: float  # in m^2 or m^3
    error: float  # how much it may be off


@dataclass(frozen=True, eq=False)
class Area:
    """An area whose boundary is known in points."""

    region: Region  # with all points
    coarse: Region  # with half of the points of every curve, which tells how exact the area is
    margin: float = 0.0  # how far the points themselves may be off [m]
    cells: tuple[Region, ...] = ()  # of which it is made, each with one number of postures

    def changed(self, change: Callable[[Region], Region]) -> Area:
        """Another area, found in the same way."""
        return Area(change(self.region), change(self.coarse), self.margin)

    def measured(self, measure: Callable[[Region], float]) -> Measure:
        """A measure of it with its error."""
        fine, coarse = measure(self.region), measure(self.coarse)
        doubt = measure(self.region.buffer(self.margin)) - fine if self.margin else 0.0
        # The limit of two approximations, and their difference as its error.
        return Measure(fine + (fine - coarse) / 3.0, abs(fine - coarse) + abs(doubt))

    @property
    def size(self) -> Measure:
        """Its size [m^2]."""
        return self.measured(lambda region: float(region.area))

    @property
    def volume(self) -> Measure:
        """Of the solid of which it is a section, turned once around the axis [m^3]."""
        # the theorem of Pappus; an empty area has no centroid
        return self.measured(lambda area: 0.0 if area.is_empty else math.tau * float(area.centroid.x * area.area))


def shapely() -> Any:
    """The package that cuts and joins areas."""
    return optional("shapely", "workspaces need Shapely", "handout", DeriveError)


def exact_area(plane: PlaneMap, cells: int = CELLS) -> Area:
    """The area that a map covers, from its critical curves."""
    if len(plane.joints) < 2:  # a line, which may close and yet covers nothing
        return Area(shapely().Polygon(), shapely().Polygon())

    def _reached(faces: Any, parts: int) -> Flags:
        reached = is_reached(plane, _places_inside(faces))
        # Searches may miss a cell: samples inside of it, farther from curves than these may be off, tell.
        margin, missed = plane.point.size * (TURN / parts) ** 2 / 2.0, np.flatnonzero(~reached)
        if missed.size:
            x, y = plane.places(plane.inside(plane.point.random(_SAMPLES, plane.joints, limits=AT_A_LIMIT)))
            for k in missed:
                left, low, right, high = faces[k].bounds
                near = (x > left) & (x < right) & (y > low) & (y < high)
                reached[k] = shapely().contains_xy(faces[k].buffer(-margin), x[near], y[near]).any()
        return reached

    return _area(plane, cells, partial(boundary_candidates, plane), _reached)


def formula_area(plane: PlaneMap, curves: Callable[[int], Array], holds: Callable[[Array], Array]) -> Area:
    """The area that a map covers, where formulas say so."""
    return _area(plane, CELLS, curves, lambda faces, _: holds(_places_inside(faces)))


def _area(plane: PlaneMap, cells: int, curves: Callable[[int], Array], holds: Callable[[Any, int], Any]) -> Area:
    """The area of those cells between curves that belong to it; their corners are off by a rounding."""
    size, found = plane.point.size, []
    for parts in (cells, cells // 2):
        faces = _cells(plane, curves(parts))
        found.append(faces[holds(faces, parts)] if len(faces) else faces)
    fine, coarse = found
    return Area(joined(fine, size), joined(coarse, size), _GRID * size, tuple(fine))


def _cells(plane: PlaneMap, segments: Array) -> Any:
    package, size = shapely(), plane.point.size
    # The axis itself bounds cells of a section.
    if plane.picture is Picture.SECTION and len(segments):
        low, high = segments[..., 1].min() - 0.1 * size, segments[..., 1].max() + 0.1 * size
        segments = np.concatenate([segments, [[[0.0, low], [0.0, high]]]])
    segments = np.round(segments / (_GRID * size)) * (_GRID * size)
    segments = segments[np.any(segments[:, 0] != segments[:, 1], axis=1)]
    if not len(segments):
        return np.array([], dtype=object)
    # Noded on a grid, so that lines cross at shared corners; polygons between them are the cells.
    lines = package.unary_union(package.linestrings(segments), grid_size=_GRID * size)
    faces = package.get_parts(package.polygonize([lines]))
    return faces[2.0 * package.area(faces) > _THIN * size * package.length(faces)]


def _places_inside(faces: Any) -> Array:
    return np.asarray(shapely().get_coordinates(shapely().point_on_surface(faces)).T)


def joined(cells: Any, size: float) -> Region:
    """Cells joined to one area."""
    return closed(shapely().unary_union(cells), 2.0 * _THIN * size) if len(cells) else shapely().Polygon()


def by_number(area: Area, numbers: Callable[[Array], Array], size: float) -> tuple[tuple[int, Region], ...]:
    """The parts of an area whose places are reached in different numbers of postures, the fewest first."""
    if not area.cells:
        return ()
    cells = np.array(area.cells, dtype=object)
    package, found = shapely(), numbers(_places_inside(cells))
    # 2 area/perimeter is the width of a long cell: slivers between two approximations of one curve, which belong to the
    # part beside them.
    thin = 2.0 * package.area(cells) < _SLIVER * size * package.length(cells)
    parts = {int(number): joined(cells[(found == number) & ~thin], size) for number in np.unique(found[~thin])}
    beside: dict[int, list[Region]] = {number: [part] for number, part in parts.items()}
    for cell in cells[thin] if parts else ():
        around = cell.buffer(_SLIVER * size)
        beside[max(parts, key=lambda number: around.intersection(parts[number]).area)].append(cell)
    return tuple((number, joined(members, size)) for number, members in beside.items())


def closed(region: Region, gap: float) -> Region:
    """An area without gaps and slits as thin as the approximation of a curve by segments [m]."""
    return region.buffer(gap, quad_segs=2).buffer(-gap, quad_segs=2)


def is_reached(plane: PlaneMap, places: Array, seeds: int = _SEEDS) -> Flags:
    """Whether the point gets to places of the plane, (2, k) [m], or of space, (3, k)."""
    if not places.shape[1]:
        return np.zeros(0, dtype=bool)
    configurations = plane.point.random(seeds, plane.joints)
    known = plane.places(configurations)
    starts = np.empty((places.shape[1], _STARTS), dtype=int)  # of each place the samples that come closest
    for row, place in zip(starts, places.T, strict=True):
        squared = np.sum((known - place[:, None]) ** 2, axis=0)
        found = np.argpartition(squared, _STARTS)[:_STARTS]
        row[:] = found[np.argsort(squared[found], kind="stable")]
    reached = np.zeros(len(starts), dtype=bool)
    for some in (slice(0, _FIRST), slice(_FIRST, None)):  # most places are reached from the nearest ones
        left = np.flatnonzero(~reached)
        chosen = starts[left, some]
        targets = np.repeat(places[:, left], chosen.shape[1], axis=1)
        distances = plane.nearest(targets, configurations[:, chosen.ravel()])[2].reshape(chosen.shape)
        reached[left] = distances.min(axis=1) <= _REACHED * plane.point.size
    return reached


def dexterous(region: Region, radius: float, revolves: bool) -> Region:
    """Places around which a whole circle, or sphere, lies in what a wrist centre reaches; the radius is a hand's."""
    # A sphere does not meet a part of the outside if that part is farther away than its radius, or lies inside of it as
    # a whole. The outermost part lies inside of none.
    package, whole = shapely(), _whole(region, revolves)
    if radius <= 0.0 or whole.is_empty:
        return region
    parts = [package.Polygon(polygon.exterior) for polygon in package.get_parts(whole)]
    # Inside of the outer boundary by the radius; then each hole takes the places whose circle meets it.
    left = package.unary_union(parts).buffer(-radius, quad_segs=_ROUND)
    for polygon in package.get_parts(whole):
        for ring in polygon.interiors:
            left = left.difference(_around(_whole(package.Polygon(ring), revolves), radius))
    return left.intersection(package.box(0.0, -1e9, 1e9, 1e9)) if revolves else left


def enlarged(region: Region, radius: float, revolves: bool) -> Region:
    """Places at a given distance from some place of an area."""
    around = _around(_whole(region, revolves), radius)
    return around.intersection(shapely().box(0.0, -1e9, 1e9, 1e9)) if revolves else around


def _around(region: Region, radius: float) -> Region:
    """Centres of circles that meet an area and do not hold all of it within."""
    return region.buffer(radius, quad_segs=_ROUND).difference(enclosing(region, radius))


def enclosing(region: Region, radius: float) -> Region:
    """Centres of circles that hold all of an area."""
    package = shapely()
    hull = region.convex_hull
    if package.minimum_bounding_radius(hull) >= radius:
        return package.Polygon()
    discs = [package.Point(corner).buffer(radius, quad_segs=_ROUND) for corner in package.get_coordinates(hull)]
    return package.intersection_all(discs)


def _whole(region: Region, revolves: bool) -> Region:
    """The section of a solid of revolution on both sides of the axis; any other area as it is."""
    if not revolves:
        return region
    return shapely().unary_union([region, shapely().transform(region, lambda points: points * (-1.0, 1.0))])
