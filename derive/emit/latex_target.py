"""The LaTeX target: ``sheet.tex``, the equations of one robot on paper."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from derive.emit import templating
from derive.emit.escape import latex_text
from derive.emit.handout.dynamics import DynamicsBlocks, DynamicsLayout
from derive.emit.handout.kinematics import KinematicsLayout, constant_frames
from derive.emit.handout.tables import DataPrinter, free_boxes, joint_table, link_equations, parameter_equations
from derive.emit.latex.layout import displays, equation_lines, pack
from derive.emit.latex.metrics import EMPTY
from derive.emit.latex.notation import Notation
from derive.emit.latex.policy import POLICY, SheetPolicy
from derive.emit.latex.printer import LatexPrinter
from derive.emit.latex.quantity import Layouter
from derive.emit.latex.symbols import Symbols
from derive.emit.quantity import Quantities
from derive.emit.source import Source
from derive.emit.target import Target
from derive.robot.robot import Convention, Robot


def render(source: Source) -> dict[str, str]:
    """The files of the target: name -> text."""
    context = sheet_context(source.robot, source.quantities, source.version)
    return {"sheet.tex": templating.render("latex/sheet.tex.jinja", **context)}


TARGET = Target(
    name="latex",
    summary="the equations as a sheet to print, for pdflatex",
    files=("sheet.tex",),
    render=render,
)


LONGEST_WORD = 16
"""Letters of a title's word after which a line may be broken; longer ones are rare, and no line holds forty."""


@dataclass(frozen=True)
class _Parts:
    """What the sections of one sheet share."""

    robot: Robot
    quantities: Quantities
    policy: SheetPolicy
    notation: Notation

    @property
    def symbols(self) -> Symbols:
        return Symbols(self.notation, self.robot.n)

    @property
    def layouter(self) -> Layouter:
        return Layouter(LatexPrinter(self.notation), self.policy, self.symbols.term)


def sheet_context(
    robot: Robot, quantities: Quantities, version: str, policy: SheetPolicy = POLICY
) -> Mapping[str, Any]:
    """Everything that the template prints, as finished LaTeX."""
    parts = _Parts(robot, quantities, policy, Notation.of(robot))
    return {
        "title": breakable_text(robot.title),
        "name": robot.name,
        "digest": robot.digest,
        "short_digest": robot.digest[:16],
        "version": version,
        **_data(parts),
        **_notation(parts),
        **_kinematics(parts),
        **_dynamics(parts),
    }


def breakable_text(text: str) -> str:
    """Escaped text in which even a word without end can be broken."""
    words = ([word[k : k + LONGEST_WORD] for k in range(0, len(word), LONGEST_WORD)] for word in text.split())
    return " ".join("\\allowbreak{}".join(latex_text(part) for part in parts) for parts in words)


def _data(parts: _Parts) -> dict[str, Any]:
    robot = parts.robot
    data = DataPrinter(robot, parts.notation)
    return {
        "standard": robot.convention is Convention.STANDARD,
        "n": robot.n,
        "types": [joint.type.value for joint in robot.joints],
        "table": joint_table(data),
        "frames": constant_frames(data),
        "links": [displays(equation_lines(link_equations(data, link))) for link in robot.links],
        "parameters": displays(equation_lines(parameter_equations(data))),
        "free": displays(pack(free_boxes(data))),
    }


def _notation(parts: _Parts) -> dict[str, Any]:
    notation = parts.notation
    labelled = tuple(notation.labels)
    one = labelled[:1]
    two = labelled[:2] if len(labelled) > 1 else ()
    return {
        "cosine": notation.abbreviation("c", one, EMPTY).tex if one else "",
        "sine": notation.abbreviation("s", one, EMPTY).tex if one else "",
        "angle": notation.glyph(one[0]).box.tex if one else "",
        "cosine_of_sum": notation.abbreviation("c", two, EMPTY).tex if two else "",
        "sum": " + ".join(notation.glyph(name).box.tex for name in two),
        "decimals": notation.decimals,
        "digits": notation.digits,
    }


def _kinematics(parts: _Parts) -> dict[str, Any]:
    layout = KinematicsLayout(parts.robot, parts.quantities, parts.layouter, parts.symbols)
    end = layout.end_effector()
    factors, product = layout.partial_products() if end.omitted else ((), ())
    return {
        "transforms": layout.transforms(),
        "product": displays([layout.product()]),
        "end": end,
        "factors": factors,
        "factor_product": product,
        "jacobian": layout.jacobian(),
    }


def _dynamics(parts: _Parts) -> dict[str, Any]:
    robot = parts.robot
    closed = robot.has_dynamics and robot.n <= parts.policy.closed_form_joints
    layout = DynamicsLayout(robot, parts.quantities, parts.layouter, parts.symbols)
    blocks: DynamicsBlocks | None = layout.blocks() if closed else None
    return {
        "has_dynamics": robot.has_dynamics,
        "closed_form": closed,
        "dynamics": blocks,
        "christoffel": parts.symbols.christoffel_of("i", "j", "k").tex,
    }


