"""From a Denavit-Hartenberg table to a verified robot model.

    import derive

    robot = derive.load("scara-perugia")       # or the path of a robot file
    arm = derive.Robot.from_urdf("arm.urdf")   # or a chain of a URDF
    model = derive.Model(robot)                # model.T, model.J, model.B, ... in closed form
    derive.build(robot)                        # verified NumPy, CasADi, C and LaTeX in generated/scara_perugia
    derive.handout(robot, formats=["pdf"])     # the sheet to hand out
    derive.plot(robot, "arm.svg")              # the arm with its frames
    derive.move("scara-pick-and-place", plot="tau.svg")   # a motion: speeds, torques, work
    derive.convert(robot, "modified", "mdh.yaml")         # the table of the other convention
    derive.identify(robot, "log.parquet", "identified.yaml")   # masses, inertias and friction from a log
    derive.sample(robot, "J", number=1e7)                 # extremes and means over random configurations
    derive.check("notes.yaml")                 # printed formulas against derived ones

Functions and classes are imported when they are first used, so that ``import derive`` is cheap.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from derive.version import __version__

if TYPE_CHECKING:
    from derive.api.build import build, build_all, stale, verify
    from derive.api.check import check, check_formula, check_inverse, check_latex
    from derive.api.convert import convert, export, possible
    from derive.api.excite import excite
    from derive.api.handout import fragment, handout
    from derive.api.identify import identify
    from derive.api.importing import import_all, import_tree, import_urdf, verify_import
    from derive.api.map import map
    from derive.api.move import move
    from derive.api.plot import plot
    from derive.api.robots import Robot, catalogue, load
    from derive.api.sample import sample
    from derive.api.style import Style, find_style
    from derive.errors import DeriveError, RobotFileWarning
    from derive.motion.motion import Motion
    from derive.notebook import Model

__all__ = [
    "DeriveError",
    "Model",
    "Motion",
    "Robot",
    "RobotFileWarning",
    "Style",
    "__version__",
    "build",
    "build_all",
    "catalogue",
    "check",
    "check_formula",
    "check_inverse",
    "check_latex",
    "convert",
    "excite",
    "export",
    "find_style",
    "fragment",
    "handout",
    "identify",
    "import_all",
    "import_tree",
    "import_urdf",
    "load",
    "map",
    "move",
    "plot",
    "possible",
    "sample",
    "stale",
    "verify",
    "verify_import",
]

# Public names by where they are defined; none is also that of a subpackage, which would take its place when imported.
_NAMES = {
    "derive.api.build": ("build", "build_all", "stale", "verify"),
    "derive.api.check": ("check", "check_formula", "check_inverse", "check_latex"),
    "derive.api.convert": ("convert", "export", "possible"),
    "derive.api.excite": ("excite",),
    "derive.api.handout": ("fragment", "handout"),
    "derive.api.identify": ("identify",),
    "derive.api.importing": ("import_all", "import_tree", "import_urdf", "verify_import"),
    "derive.api.map": ("map",),
    "derive.api.move": ("move",),
    "derive.api.plot": ("plot",),
    "derive.api.robots": ("Robot", "catalogue", "load"),
    "derive.api.sample": ("sample",),
    "derive.api.style": ("Style", "find_style"),
    "derive.errors": ("DeriveError", "RobotFileWarning"),
    "derive.motion.motion": ("Motion",),
    "derive.notebook": ("Model",),
}
_HOMES = {name: home for home, names in _NAMES.items() for name in names}


def __getattr__(name: str) -> Any:
    """Import a public name on its first use.

    Args:
        name: The name.

    Returns:
        The class or function.

    Raises:
        AttributeError: There is no such public name.
    """
    if name not in _HOMES:
        raise AttributeError(f"module 'derive' has no attribute {name!r}")
    return getattr(import_module(_HOMES[name]), name)


def __dir__() -> list[str]:
    """The public names, imported or not."""
    return sorted(__all__)
