"""A handout made by hand: every kind of block, and a title that tries to be markup; and a page with a figure alone."""

from dataclasses import replace

from derive.handouts.figure.drawing import Drawing, Label, Path
from derive.handouts.page.viewer import dragging, symbol_values, viewer
from derive.handouts.sheet.document import (
    Blank,
    Block,
    Document,
    Entry,
    Figure,
    Gap,
    Paragraph,
    Rows,
    Section,
    SheetFormula,
    Steps,
    Table,
)
from derive.handouts.sheet.language import Text
from derive.programs.build import build_program
from derive.programs.optimise.search_policy import Effort
from derive.robot.robot import Robot
from derive.workspace.poses import RobotPoses

TITLE = '<script>alert("$1$")</script> & "robot" </title>'

MATRIX = (
    r"\mathbf{A}_{1}^{0} = \begin{bmatrix} c_{1} & -s_{1} & 0 & a_{1}c_{1} \\ s_{1} & c_{1} & 0 & a_{1}s_{1} \\ "
    r"0 & 0 & 1 & 0 \\ 0 & 0 & 0 & 1 \end{bmatrix}"
)
LONG = " + ".join(rf"m_{{{k}}}a_{{{k}}}^{{2}}\dot{{q}}_{{{k}}}" for k in range(1, 30))
ENTRIES = (
    Entry(r"b_{11}", r"m_{1}l_{1}^{2} + 2a_{1}l_{2}m_{2}c_{2}", "m1*l1**2 + 2*a1*l2*m2*cos(q2)"),
    Entry(r"b_{12}", r"a_{1}l_{2}m_{2}\cos q_{2} < 3", "a1*l2*m2*cos(q2) - sin(q1)/3"),
)


def result() -> SheetFormula:
    return SheetFormula(
        rows=(Rows((MATRIX, rf"b_{{11}} = {LONG}")),),
        named=(r"\sigma_{1} = \frac{1}{2}m_{1}c_{12}",),
        omitted=(r"b_{33} \colon\ 12\,345\text{ terms}",),
        note="The matrix is symmetric.",
        function="inertia_matrix",
        entries=lambda: ENTRIES,
        blanks=(r"\mathbf{B}",),
    )


def drawing() -> Drawing:
    arm = Path(((20.0, 20.0), (80.0, 90.0), (170.0, 60.0)), width=3.0)
    return Drawing(200.0, 120.0, (arm, Label((80.0, 95.0), "a_{1}", (0, -1))), "A planar arm")


def blocks() -> tuple[Block, ...]:
    steps = Steps("How the energy of link $1$ is found", (Paragraph("First $v_{1}$."), Rows((r"\dot{q}_{1}^{2}",))))
    table = Table(("", r"$\vartheta_i$", "unit"), (("1", r"$q_{1} + \frac{\pi}{2}$", "rad"), ("2 < 3", "$d_2$", "m")))
    return (
        Paragraph("The matrix $B$ comes from `inertia_matrix(q)`, where $a < b$ & <b>nothing</b> is markup."),
        Figure(drawing(), "The arm at $q = 0$."),
        table,
        result(),
        steps,
        Blank("1.", "Find $b_{11}$ and $b_{12}$.", "(2 points)", (Gap(r"b_{11}", 3.0), Gap("", 2.0))),
    )


def document(*extra: Section, title: str = TITLE) -> Document:
    sections = (Section("inertia", "Inertia matrix $B(q)$", blocks()), *extra)
    return Document(title, "Exercise", "hostile", "ab" * 32, "derive 9.9.9 `abab`", sections)


FRAME = """<!DOCTYPE html>
<html lang="en"{theme}>
<head><meta charset="utf-8"><title>viewer</title><link rel="icon" href="data:,"><style>{css}</style></head>
<body><main>{html}</main><script>{script}</script></body>
</html>
"""
PAGE_STYLE = "body{margin:1rem;font-family:sans-serif} @media(prefers-color-scheme:dark){body{background:#16181c}}"


def viewer_page(robot: Robot, theme: str = "") -> str:
    dragged = dragging(robot, symbol_values(robot, (), assumed(robot)))
    asked = robot if dragged is None else replace(robot, inverse=dragged.task)
    program = build_program(asked, Effort.QUICK, inverse=dragged is not None)
    made = viewer(robot, program, assumed(robot), Text(), dragged=dragged)
    attribute = f' data-theme="{theme}"' if theme else ""
    return FRAME.format(theme=attribute, css=PAGE_STYLE + made.css, html=made.html, script=made.script)


def assumed(robot: Robot) -> dict[str, float]:
    return {name: value for name, value, _ in RobotPoses(robot).assumed}
