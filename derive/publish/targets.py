"""All targets, one row each; the command line, the manifest and the README page of a robot derive from it."""

from collections.abc import Iterable

from derive.errors import TargetError, near_miss
from derive.targets.c import TARGET as C
from derive.targets.casadi import C_TARGET as CASADI_C
from derive.targets.casadi import TARGET as CASADI
from derive.targets.javascript import TARGET as JAVASCRIPT
from derive.targets.native import TARGET as NATIVE
from derive.targets.numpy import TARGET as NUMPY
from derive.targets.octave import TARGET as OCTAVE
from derive.targets.readme import TARGET as README
from derive.targets.target import Source, Target


def _sheet(source: Source) -> dict[str, str]:
    # SymPy takes as long to import as a sheet to render: it is imported where that is done, beside the search.
    from derive.handouts.render import generated_sheet

    return generated_sheet(source.robot)


LATEX = Target("latex", "the equations as a sheet to print, for pdflatex", ("sheet.tex",), _sheet, needs_program=False)

# By name, in the order in which they are written.
TARGETS: dict[str, Target] = {
    target.name: target for target in (NUMPY, CASADI, CASADI_C, C, NATIVE, JAVASCRIPT, OCTAVE, LATEX, README)
}
EVERY = "all"  # what the user says for all of them


def targets_named(
    names: Iterable[str] | None = None,  # what the user says, `EVERY` for all; None for what a build writes unasked
    present: Iterable[str] = (),
    *,
    only: bool = False,
) -> tuple[Target, ...]:
    """Targets by name beside those of a usual build, those that they require, and those that are there already."""
    usual = {name for name, target in TARGETS.items() if target.default}
    wanted = set(usual if names is None else [names] if isinstance(names, str) else names)
    if EVERY in wanted:
        wanted = wanted - {EVERY} | TARGETS.keys()
    if (unknown := sorted(wanted - TARGETS.keys())) or not wanted:
        found = f"unknown target {unknown[0]!r}" if unknown else "no target"
        remedy = near_miss(unknown[0], TARGETS) if unknown else ""
        raise TargetError(found, allowed=f"targets are {', '.join(TARGETS)}, and {EVERY}", remedy=remedy)
    if not only:
        wanted |= usual | (TARGETS.keys() & set(present))
    wanted |= {needed for name in wanted for needed in TARGETS[name].requires}
    return tuple(target for name, target in TARGETS.items() if name in wanted)
