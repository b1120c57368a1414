"""A page that holds nothing but the figure."""

from collections.abc import Sequence
from dataclasses import replace

from derive.handouts.page.target import dragging
from derive.handouts.page.viewer import symbol_values, viewer
from derive.handouts.sheet.language import Text
from derive.programs.build import build_program
from derive.programs.optimise.search_policy import Effort
from derive.robot.robot import Robot
from derive.workspace.poses import RobotPoses

FRAME = """<!DOCTYPE html>
<html lang="en"{theme}>
<head><meta charset="utf-8"><title>viewer</title><link rel="icon" href="data:,"><style>{css}</style></head>
<body><main>{html}</main><script>{script}</script></body>
</html>
"""
PAGE_STYLE = "body{margin:1rem;font-family:sans-serif} @media(prefers-color-scheme:dark){body{background:#16181c}}"


def viewer_page(robot: Robot, start: Sequence[float] | None = None, theme: str = "") -> str:
    dragged = dragging(robot, symbol_values(robot, (), assumed(robot)))
    asked = robot if dragged is None else replace(robot, inverse=dragged.task)
    program = build_program(asked, Effort.QUICK, inverse=dragged is not None)
    made = viewer(robot, program, assumed(robot), Text(), start=start, dragged=dragged)
    attribute = f' data-theme="{theme}"' if theme else ""
    return FRAME.format(theme=attribute, css=PAGE_STYLE + made.css, html=made.html, script=made.script)


def assumed(robot: Robot) -> dict[str, float]:
    return {name: value for name, value, _ in RobotPoses(robot).assumed}
