"""From a robot to its handout, part by part."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import groupby

from derive.handouts.parts import dynamics, figure, kinematics, table
from derive.handouts.parts.closure import closure
from derive.handouts.parts.conversion import conversion
from derive.handouts.parts.example import example
from derive.handouts.parts.inverse import inverse
from derive.handouts.parts.jacobian import jacobian
from derive.handouts.parts.newton_euler import newton_euler
from derive.handouts.parts.singularities import singularities
from derive.handouts.sheet.context import Context, poses_of
from derive.handouts.sheet.document import Block, Document, Section
from derive.handouts.sheet.language import text_for
from derive.model.entries import ModelEntries
from derive.model.model import Model
from derive.robot.options.handout import PARTS, HandoutOptions
from derive.robot.robot import Robot
from derive.version import __version__

# Left out where the closed form of the dynamics is not derived.
CLOSED_FORMS = ("link-jacobians", "energies", "christoffel", "coriolis", "skew", "gravity", "motion", "newton-euler")
OF_CHAINS = ("singularities", "newton-euler")  # what a sentence stands for on the sheet of a tree
OF_OWN_VARIABLES = (*OF_CHAINS, "inverse")  # and another one on that of coupled joints
OF_ENDS = ("kinematics", "orientation", "jacobian", "inverse")  # about one end effector: a tree has them for each end


def context_of(robot: Robot, options: HandoutOptions | None = None) -> Context:
    """What the handout of a robot is made from; without options what its file says is shown."""
    chosen, entries = options or robot.handout, ModelEntries(Model(robot))
    return Context(entries, chosen, text_for(chosen.language), poses_of(entries.robot))


def section_of(context: Context, name: str) -> Section | None:
    """One part; None where the robot has nothing to show there."""
    _ = context.text
    links = _("Jacobians of links and motors") if dynamics.has_rotors(context.robot) else _("Jacobians of links")
    parts: dict[str, tuple[str, Callable[[Context], Iterable[Block]]]] = {  # heading, and what makes the content
        "figure": (_("The robot") if context.robot.is_tree else _("The arm"), figure.arm),
        "table": (_("Denavit-Hartenberg table"), table.dh_table),
        "convention": (_("Convention"), figure.convention),
        "parameters": (_("Parameters"), table.parameters),
        "transforms": (_("Transforms between successive frames"), kinematics.transforms),
        "closure": (_("Closed loops"), closure),
        "conversion": (_("The other convention"), conversion),
        "kinematics": (_("End effector"), kinematics.end_effector),
        "orientation": (_("Position and orientation"), kinematics.orientation),
        "jacobian": (_("Geometric Jacobian"), jacobian),
        "singularities": (_("Singularities"), singularities),
        "inverse": (_("Inverse kinematics"), inverse),
        "link-jacobians": (links, dynamics.link_jacobians),
        "energies": (_("Energies"), dynamics.energies),
        "inertia": (_("Inertia matrix"), dynamics.inertia),
        "christoffel": (_("Christoffel symbols"), dynamics.christoffel),
        "coriolis": (_("Coriolis matrix"), dynamics.coriolis),
        "skew": (_("Skew symmetry"), dynamics.skew),
        "gravity": (_("Gravity"), dynamics.gravity),
        "motion": (_("Equations of motion"), dynamics.equations_of_motion),
        "newton-euler": (_("Newton-Euler recursion"), newton_euler),
        "example": (_("Example in numbers"), example),
    }
    title, make = parts[name]
    if name in CLOSED_FORMS and not context.has_closed_dynamics:
        return None
    if name in OF_OWN_VARIABLES and context.robot.coupled:
        return Section(name, title, (context.paragraph("Of coupled joints and closed loops this is left out."),))
    if name in OF_CHAINS and context.robot.is_tree and not context.end:
        return Section(name, title, (context.paragraph("Of a tree this is left out."),))
    blocks = tuple(make(context))
    title = f"{title}: `{context.end}`" if context.end else title
    return Section(name, title, blocks, context.end) if blocks else None


def sections_of(context: Context, names: Sequence[str]) -> Iterator[Section]:
    """Parts in their order; those about one end effector come together for each end of a tree."""
    single = OF_OWN_VARIABLES if context.robot.coupled else ()
    several = [name for name in OF_ENDS if context.ends[0] is not context and name not in single]
    for of_ends, group in groupby(names, several.__contains__):
        parts = tuple(group)
        for own in context.ends if of_ends else (context,):
            yield from (section for name in parts if (section := section_of(own, name)) is not None)


def document(context: Context) -> Document:
    """The handout of a robot: the parts that are asked for, in the order of `PARTS`."""
    _, robot = context.text, context.robot
    # The singularities of a tree are one sentence, before what is said of each end.
    shown = [name for name in PARTS if name in context.options.parts]
    if context.robot.is_tree:
        shown.sort(key=lambda name: PARTS.index("inverse" if name in OF_ENDS else name))
    return Document(
        title=robot.title,
        subtitle="",
        name=robot.name,
        digest=robot.digest,
        footer=_("derive %(version)s, robot file `%(digest)s`", version=__version__, digest=robot.digest[:16]),
        sections=tuple(sections_of(context, shown)),
    )
