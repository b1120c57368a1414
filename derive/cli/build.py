"""``derive build``: from robot files to verified models in a folder each."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from derive.cli.terminal import FAILED, add_shared, explain, positive, print_columns, print_error, print_json, progress

if TYPE_CHECKING:
    from collections.abc import Sequence

    from derive.publish.build import BuildFailure, BuildResult, CheckResult

DESCRIPTION = """\
Derive the equations of each ROBOT, write NumPy, CasADi and LaTeX files to DIR/<robot>/, and compare every generated
function with an independent recursion before the folder is put in place. Without ROBOT, all built-in robots are built.

A folder is replaced as a whole or not at all. Robots that have not changed are not built again; targets that the
folder already holds are kept, and rebuilt where they are out of date.

  derive build my-arm.yaml
  derive build scara-perugia puma560-corke --target numpy,c --jobs 2
  derive build --check --out generated
"""


def configure(parser: argparse.ArgumentParser) -> None:
    """The robots, where to and how."""
    add = parser.add_argument
    add("robots", metavar="ROBOT", nargs="*", help="robot file or built-in robot (default: all built-in robots)")
    add_shared(parser, "folder", default=Path("generated"), help="parent folder (default: generated)")
    add("--target", metavar="NAME", action="append", help="further targets, separated by commas, or all")
    add("--only", action="store_true", help="build only these targets; derive's other files in the folder are removed")
    add("--jobs", metavar="N", type=positive, default=1, help="number of robots built in parallel (default 1)")
    add("--check", action="store_true", help="write nothing; list what is out of date and exit with 1")
    add_shared(parser, "force", help="build again even if nothing has changed")
    add("--effort", choices=("full", "quick"), default="full", help="quick: no search for cheaper programs")
    add_shared(parser, "quiet", "json")


def run(arguments: argparse.Namespace) -> int:
    """Build or check, report, and say by the status whether all went well."""
    from derive.api.build import build_all, stale
    from derive.api.robots import load_all
    from derive.publish.build import BuildFailure, CheckResult
    from derive.publish.targets import targets_named

    targets = [name.strip() for text in arguments.target for name in text.split(",")] if arguments.target else None
    targets_named(targets)
    robots = load_all(arguments.robots or None)
    results: list[BuildResult | BuildFailure] | list[CheckResult | BuildFailure]
    with progress(len(robots), quiet=arguments.quiet or arguments.json) as tell:
        how = {name: getattr(arguments, name) for name in ("only", "effort", "jobs")} | {"progress": tell}
        if arguments.check:
            results = stale(robots, arguments.out, targets=targets, **how)
        else:
            results = build_all(robots, arguments.out, targets=targets, force=arguments.force, **how)
    if arguments.json:
        reports = zip(robots, results, strict=True)
        print_json([result.as_dict() | {"remarks": robot.remarks_as_dicts} for robot, result in reports])
    elif not arguments.quiet:
        _print_report(results)
    status = 0
    for robot, result in zip(robots, results, strict=True):
        if isinstance(result, BuildFailure):
            reason, grave = explain(result.error)
            print_error(reason if getattr(result.error, "location", None) else f"{robot.source}: {reason}")
            status = max(status, grave)
        elif isinstance(result, CheckResult) and not result.is_current:
            status = max(status, FAILED)
    return status


def _print_report(results: Sequence[BuildResult | CheckResult | BuildFailure]) -> None:
    """What was built as a table, and how folders differ from what a build would write, a line each."""
    from derive.publish.build import BuildResult, CheckResult

    built = []
    for result in results:
        if isinstance(result, BuildResult):
            errors = [row.worst for row in result.report.rows] if result.report else []
            state, worst = "unchanged" if result.unchanged else "built", f"{max(errors):.1e}" if errors else "-"
            files, seconds = str(len(result.files)), f"{result.seconds:.1f}"
            built.append((result.robot, state, str(result.folder), files, worst, seconds))
    print_columns(built, ("robot", "status", "folder", "files", "worst error", "seconds") if built else ())
    for result in results:
        for reason in result.report.reasons if isinstance(result, BuildResult) and result.report else ():
            print(f"{result.robot}: {reason}")
        if isinstance(result, CheckResult):
            found = {"stale": result.stale, "missing": result.missing, "not ours any more": result.extra}
            differences = "; ".join(f"{what} {', '.join(names)}" for what, names in found.items() if names)
            print(f"{result.robot}: {f'{differences} in {result.folder}' if differences else 'current'}")
