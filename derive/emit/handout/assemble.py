"""From the context of a robot to its handout: the parts that are asked for, in their order."""

from __future__ import annotations

from collections.abc import Callable

from derive.emit.handout.context import Context
from derive.emit.handout.document import Document, Section
from derive.emit.handout.languages import text_for
from derive.emit.handout.parts import (
    christoffel,
    convention,
    coriolis,
    energies,
    example,
    figure,
    gravity,
    inertia,
    jacobian,
    kinematics,
    link_jacobians,
    motion,
    newton_euler,
    orientation,
    parameters,
    singularities,
    skew,
    table,
    transforms,
)
from derive.emit.source import Source
from derive.robot.handout import PARTS, HandoutOptions

Part = Callable[[Context], Section | None]

_SECTIONS: dict[str, Part] = {
    "figure": figure.section,
    "table": table.section,
    "convention": convention.section,
    "parameters": parameters.section,
    "transforms": transforms.section,
    "kinematics": kinematics.section,
    "orientation": orientation.section,
    "jacobian": jacobian.section,
    "singularities": singularities.section,
    "link-jacobians": link_jacobians.section,
    "energies": energies.section,
    "inertia": inertia.section,
    "christoffel": christoffel.section,
    "coriolis": coriolis.section,
    "skew": skew.section,
    "gravity": gravity.section,
    "motion": motion.section,
    "newton-euler": newton_euler.section,
    "example": example.section,
}


def context_of(source: Source, options: HandoutOptions | None = None) -> Context:
    """What the handout of a built robot is made from.

    Args:
        source: The robot with its derived quantities.
        options: What is shown; None for what the robot file says.

    Raises:
        TargetError: There is no message catalogue for the language.
    """
    chosen = options or source.robot.handout
    return Context(
        robot=source.robot,
        quantities=source.quantities,
        options=chosen,
        text=text_for(chosen.language),
        version=source.version,
        poses=source.poses,
        numbers=source.numbers,
    )


def document(context: Context) -> Document:
    """The handout of a robot."""
    _ = context.text
    robot = context.robot
    digest = robot.digest[:16]
    footer = _("derive %(version)s, robot file `%(digest)s`", version=context.version, digest=digest)
    wanted = [part for part in PARTS if part in context.options.parts]
    sections = (section_of(context, part) for part in wanted)
    return Document(
        title=robot.title,
        subtitle="",
        name=robot.name,
        language=context.text.language,
        digest=robot.digest,
        version=context.version,
        footer=footer,
        sections=tuple(section for section in sections if section is not None),
    )


def section_of(context: Context, part: str) -> Section | None:
    """One part; None where the robot has nothing to show there."""
    return _SECTIONS[part](context)
