"""Drawings as SVG to be put into a web page: readable on light and on dark, with a title for those who cannot see it.

Black becomes the colour of the text around; other lines and letters are mixed with it, so that they stand out from a
dark page too.
"""

from __future__ import annotations

from html import escape

from derive.handouts.figure.drawing import LABEL_SIZE, SCRIPT_SIZE, Color, Drawing, Label, Path, label_runs

_ANCHORS = {-1: "start", 0: "middle", 1: "end"}
_RISE = {-1: 0.0, 0: 0.32, 1: 0.72}
"""Baseline below the anchor, in letter sizes."""

_SHIFT = {0: 0.0, -1: 2.2, 1: -3.2}
"""Baseline of a subscript and a superscript below that of the line [pt]."""

_SERIF = "KaTeX_Main, 'Latin Modern Math', 'Times New Roman', serif"
_FONTS = {"italic": ' font-style="italic"', "upright": "", "mono": ' font-family="monospace"'}


def svg_drawing(drawing: Drawing, scale: float = 1.5) -> str:
    """One ``<svg>`` element.

    Args:
        drawing: What to draw.
        scale: Pixels per point; the element shrinks with a narrow page.
    """
    width, height = _number(drawing.width), _number(drawing.height)
    title = f"<title>{_text(drawing.title)}</title>" if drawing.title else ""
    role = f'role="img" aria-label="{_text(drawing.title)}"' if drawing.title else 'aria-hidden="true"'
    body = "\n".join(
        _path(item, drawing.height) if isinstance(item, Path) else _label(item, drawing.height)
        for item in drawing.items
    )
    style = f"max-width:100%;width:{_number(drawing.width * scale)}px;height:auto"
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" {role} viewBox="0 0 {width} {height}" style="{style}" '
        f'stroke-linejoin="round" stroke-linecap="round" font-family="{_SERIF}" font-size="{_number(LABEL_SIZE)}">'
        f"{title}\n{body}\n</svg>"
    )


def _path(item: Path, height: float) -> str:
    points = " L".join(f"{_number(x)} {_number(height - y)}" for x, y in item.points)
    dashes = ' stroke-dasharray="4 2.5"' if item.dashed else ""
    area = item.fill is not None and item.stroke is not None
    fill = _paint("fill", item.fill, solid=area) if item.fill is not None else 'fill="none"'
    stroke = "" if item.stroke is None else f" {_paint('stroke', item.stroke, solid=area)}"
    width = "" if item.stroke is None else f' stroke-width="{_number(item.width)}"'
    return f'<path d="M{points}{"Z" if item.closed else ""}" {fill}{stroke}{width}{dashes}/>'


def _paint(attribute: str, color: Color, solid: bool = False) -> str:
    """Solid bodies keep their colours on every background."""
    if max(color) == 0.0:
        return f'{attribute}="currentColor"'
    code = "#" + "".join(f"{round(255 * part):02x}" for part in color)
    if solid:
        return f'{attribute}="{code}"'
    return f'{attribute}="{code}" style="{attribute}:color-mix(in srgb,{code} 65%,currentColor)"'


def _label(item: Label, height: float) -> str:
    x, y = item.at[0], height - item.at[1] + _RISE[item.anchor[1]] * LABEL_SIZE
    place = f'x="{_number(x)}" y="{_number(y)}" text-anchor="{_ANCHORS[item.anchor[0]]}"'
    spans, before = [], 0.0
    for run in label_runs(item.latex):
        change, before = _SHIFT[run.shift] - before, _SHIFT[run.shift]  # relative to the run before
        shift = f' dy="{_number(change)}"' if change else ""
        size = f' font-size="{_number(SCRIPT_SIZE)}"' if run.shift else ""
        spans.append(f"<tspan{shift}{size}{_FONTS[run.style]}>{_text(run.text)}</tspan>")
    return f"<text {place} {_paint('fill', item.color)}>{''.join(spans)}</text>"


def _text(text: str) -> str:
    """Escaped, without characters that XML cannot hold."""
    return escape("".join(c if c.isprintable() else " " for c in text))


def _number(value: float) -> str:
    text = f"{value:.2f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text
