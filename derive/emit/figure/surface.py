"""Faces in space as areas on the page: the far ones first, those seen from behind left out."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from derive.emit.figure.drawing import Path
from derive.emit.figure.projection import View
from derive.emit.figure.shapes import OUTLINE, Face, shade

_GRAZING = 1e-6


def paint(faces: Sequence[Face], view: View) -> Iterator[Path]:
    """Areas from back to front."""
    seen = []
    for index, face in enumerate(faces):
        normal = None if face.normal is None else view.project(face.normal)
        if normal is not None and normal[2] <= _GRAZING:
            continue
        corners = view.project(face.corners)
        color = shade(face.color, normal)
        points = tuple((float(x), float(y)) for x, y in corners[:, :2])
        edge, width = (OUTLINE, 0.5) if face.edge else (color, 0.3)
        path = Path(points, closed=True, stroke=edge, fill=color, width=width)
        seen.append((round(float(corners[:, 2].mean()), 4), index, path))
    for _, _, path in sorted(seen, key=lambda entry: entry[:2]):
        yield path
