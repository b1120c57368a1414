"""The area that a map of many joint variables covers, found by following its boundary from places that are not reached.

Cells of a grid that hold a sample are reached. From them the search goes on to their neighbours, from the
configurations that are known there, until every neighbour is either reached or known with its distance from what is
reached: a distance function outside of the area. Its level line one cell away runs around the area, around each hole
too, and the nearest place that is reached from each of its points lies on the boundary itself.
"""

import numpy as np

from derive.arrays import Array, Flags, Indices
from derive.workspace.point import PlaneMap
from derive.workspace.region import AT_A_LIMIT, Area, closed, is_reached, shapely

CELLS = 200  # cells along the arm's size: 0.5 % of the reach each
_SAMPLES_PER_CELL = 10
_KEPT = 3  # configurations that are remembered for a cell
_TRIED = 6  # configurations from which it is tried to come nearer to a node
_LAYERS = 3  # cells around the area in which the distance from it is known
_DOUBT = 0.05  # part of a cell by which the boundary may be off; where it is known it is less than 0.01
_SETTLED = 1e-3  # part of a cell by which a distance shrinks where it matters to its neighbours
_REACHED = 1e-6
_NEIGHBOURS = tuple((i, j) for i in (-1, 0, 1) for j in (-1, 0, 1) if (i, j) != (0, 0))


class _Cells:
    """A grid that goes on so far beyond samples of the picture [m]; for each node configurations that come near it."""

    def __init__(self, plane: PlaneMap, cells: int, far: float = 0.0) -> None:
        self.plane = plane
        self.width = plane.point.size / cells
        q = plane.point.random(_SAMPLES_PER_CELL * cells**2, plane.joints, limits=AT_A_LIMIT)
        places = plane.places(q)
        margin = (_LAYERS + 2) * self.width + far
        self.origin = places.min(axis=1) - margin
        self.shape = tuple(np.ceil((places.max(axis=1) + margin - self.origin) / self.width).astype(int) + 1)
        self.reached = np.zeros(self.shape, dtype=bool)
        self.tried_again = np.zeros(self.shape, dtype=bool)
        self.distance = np.full(self.shape, np.inf)
        self.known = np.full((_KEPT, len(plane.joints), *self.shape), np.nan)
        at = np.rint((places - self.origin[:, None]) / self.width).astype(int)
        for kept in range(_KEPT):  # of the samples near a node the last one written stays: a different one each time
            order = np.random.default_rng(kept).permutation(q.shape[1])
            self.known[kept][:, at[0, order], at[1, order]] = q[:, order]

    def places(self, nodes: Array | Indices) -> Array:
        """Where nodes are, by rows and columns, (2, k), whole or not."""
        return np.asarray(self.origin[:, None] + self.width * nodes)

    def starts(self, nodes: Indices, best: bool = False) -> tuple[Indices, Array]:
        """Configurations known at nodes and around them: those nearest to each node, or the best of every neighbour."""
        rows, found = [], []
        for i, j in ((0, 0), *_NEIGHBOURS):
            a, b = np.clip(nodes[0] + i, 0, self.shape[0] - 1), np.clip(nodes[1] + j, 0, self.shape[1] - 1)
            for kept in range(1 if best else _KEPT):
                q = self.known[kept][:, a, b]
                good = ~np.isnan(q[0])
                rows.append(np.flatnonzero(good))
                found.append(q[:, good])
        row, q = np.concatenate(rows), np.concatenate(found, axis=1)
        order = np.argsort(np.sum((self.plane.places(q) - self.places(nodes)[:, row]) ** 2, axis=0), kind="stable")
        nearest = order[_rank(row[order]) < (len(_NEIGHBOURS) + 1 if best else _TRIED)]
        return row[nearest], q[:, nearest]

    def visit(self, nodes: Indices, best: bool = False) -> Flags:
        """Finds out how far nodes are from what is reached, remembers configurations, and says which are reached."""
        rows, starts = self.starts(nodes, best)
        q, _, distance = self.plane.nearest(self.places(nodes)[:, rows], starts)
        order = np.argsort(distance, kind="stable")
        rows, q, distance = rows[order], q[:, order], distance[order]
        rank = _rank(rows)
        for kept in range(_KEPT):
            mine = rank == kept
            self.known[kept][:, nodes[0, rows[mine]], nodes[1, rows[mine]]] = q[:, mine]
        first = rank == 0
        at = nodes[:, rows[first]]
        self.distance[at[0], at[1]] = np.minimum(self.distance[at[0], at[1]], distance[first])
        reached: Flags = self.distance[nodes[0], nodes[1]] <= _REACHED * self.plane.point.size
        self.reached[nodes[0], nodes[1]] |= reached
        return reached

    def settle(self) -> None:
        """Tries at each node outside what is best at its neighbours, until no distance shrinks."""
        # Where two kinds of postures meet, all that a node remembers may be of the kind that ends at a limit before it.
        outside = ~self.reached & (self.distance < _LAYERS * self.width)
        fresh = outside
        while fresh.any():
            before = self.distance[fresh]
            self.visit(np.stack(np.nonzero(fresh)), best=True)
            shrunk = np.zeros(self.shape, dtype=bool)
            shrunk[fresh] = self.distance[fresh] < before - _SETTLED * self.width
            fresh = _grown(shrunk, 1) & outside

    def try_again(self, nodes: Indices) -> Flags:
        """Looks for configurations that reach nodes, (2, k), far from those known around, as behind a narrow limit."""
        reached = is_reached(self.plane, self.places(nodes))
        self.tried_again[nodes[0], nodes[1]] = True
        self.reached[nodes[0], nodes[1]] |= reached
        self.distance[nodes[0, reached], nodes[1, reached]] = 0.0
        return reached


def _rank(rows: Indices) -> Indices:
    """For each entry of a list how many equal ones stand before it."""
    order = np.argsort(rows, kind="stable")
    rank = np.empty(len(rows), dtype=int)
    rank[order] = np.arange(len(rows)) - np.searchsorted(rows[order], rows[order])
    return rank


def refined_area(plane: PlaneMap, cells: int = CELLS) -> Area:
    """The area that a map of any number of joint variables covers, to a cell of a grid."""
    package = shapely()
    grid, far = _Cells(plane, cells), plane.point.size / 4.0
    _spread(grid)
    # What is reached so near to the grid's edge may go on beyond: samples of many joints seldom stretch the arm.
    while grid.reached[2:-2, 2:-2].sum() < grid.reached.sum():
        grid, far = _Cells(plane, cells, far), 2.0 * far
        _spread(grid)
    grid.settle()
    from contourpy import contour_generator

    # The level line of the distance one cell away goes around the area and around every hole.
    outside = np.where(grid.reached, 0.0, np.minimum(grid.distance, (_LAYERS + 1) * grid.width))
    lines = contour_generator(z=outside.T).lines(grid.width)
    rings, areas = [], []
    for line in lines:  # the nearest places that are reached from its points: (k, 2) on the boundary
        nodes = np.asarray(line, dtype=float).T
        rows, starts = grid.starts(np.rint(nodes).astype(int), best=True)
        _, found, distance = plane.nearest(grid.places(nodes)[:, rows], starts)
        order = np.lexsort((distance, rows))
        rings.append(found[:, order[np.r_[True, np.diff(rows[order]) > 0]]].T)
    for every in (1, 2):
        area = package.Polygon()
        parts = [package.make_valid(package.Polygon(ring[::every])) for ring in rings if len(ring) > 8]
        # Rings inside of rings are holes: the largest first, each one turns inside into outside.
        for part in sorted(parts, key=lambda part: -float(part.area)):
            area = area.symmetric_difference(part)
        areas.append(closed(area, 0.05 * grid.width))
    return Area(areas[0], areas[1], _DOUBT * grid.width)


def _spread(cells: _Cells) -> None:
    """Goes from the nodes near samples to their neighbours until the area and a border around it are known."""
    sampled = ~np.isnan(cells.known[0, 0])
    cells.reached = ~_grown(~sampled, 1)  # with samples all around
    cells.distance[cells.reached] = 0.0
    cells.visit(np.stack(np.nonzero(sampled & ~cells.reached)))
    for layer in range(_LAYERS):
        while True:
            todo = np.stack(np.nonzero(_grown(cells.reached, layer + 1) & np.isinf(cells.distance)))
            # The area grows as long as neighbours are reached; then its border is tried from configurations far away.
            if todo.shape[1] and cells.visit(todo).any():
                continue
            border = np.stack(np.nonzero(_grown(cells.reached, 1) & ~cells.reached & ~cells.tried_again))
            if layer or not border.shape[1] or not cells.try_again(border).any():
                break


def _grown(area: Flags, layers: int) -> Flags:
    """An area of a grid with so many layers of cells around it."""
    for _ in range(layers):
        padded = np.pad(area, 1)
        rows, columns = area.shape
        parts = [padded[1 + i : 1 + i + rows, 1 + j : 1 + j + columns] for i, j in ((0, 0), *_NEIGHBOURS)]
        area = np.any(parts, axis=0)
    return area
