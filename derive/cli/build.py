"""``derive build``: from robot files to verified models in a folder each."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from derive.cli.terminal import positive

if TYPE_CHECKING:
    from collections.abc import Sequence

    from derive.publish.build import BuildFailure, BuildResult, CheckResult
    from derive.robot.robot import Robot


SUMMARY = "derive, generate and verify models; the main job"
DESCRIPTION = """\
Derive the equations of each ROBOT, write NumPy, CasADi and LaTeX files to DIR/<robot>/, and compare every generated
function with an independent recursion before the folder is put in place. Without ROBOT, the whole catalogue is built.

A folder is replaced as a whole or not at all. What has not changed is not built again.
"""


def configure(parser: argparse.ArgumentParser) -> None:
    """The robots, where to and how."""
    add = parser.add_argument
    add("robots", metavar="ROBOT", nargs="*", help="robot file or catalogue name (default: the whole catalogue)")
    add("--out", metavar="DIR", type=Path, default=Path("generated"), help="parent folder (default: generated)")
    add("--target", metavar="NAME", action="append", help="only these targets; may be repeated or comma-separated")
    add("--jobs", metavar="N", type=positive, default=1, help="robots built at once (default 1)")
    add("--check", action="store_true", help="write nothing; list what is stale and exit with 1")
    add("--force", action="store_true", help="build even what has not changed")
    add("--effort", choices=("full", "quick"), help="quick: no search, up to a third more operations")
    add("--quiet", action="store_true", help="no progress and no report")
    add("--json", action="store_true", help="machine-readable report")


def run(arguments: argparse.Namespace) -> int:
    """Build or check, report, and say by the status whether all went well."""
    from derive.cli.terminal import print_json, progress
    from derive.publish.many import build_many, check_many
    from derive.publish.targets import targets_named
    from derive.robot.catalogue import catalogue_names
    from derive.robot.robot import Robot

    targets = _targets(arguments.target)
    targets_named(targets)
    robots = [Robot.load(name) for name in arguments.robots or catalogue_names()]
    with progress(len(robots), quiet=arguments.quiet or arguments.json) as tell:
        work = (robots, arguments.out, targets)
        results: Sequence[BuildResult | CheckResult | BuildFailure]
        if arguments.check:
            results = check_many(*work, jobs=arguments.jobs, effort=arguments.effort, progress=tell)
        else:
            results = build_many(
                *work, jobs=arguments.jobs, force=arguments.force, effort=arguments.effort, progress=tell
            )
    if arguments.json:
        print_json([result.as_dict() for result in results])
    elif not arguments.quiet:
        _report(results)
    return _status(robots, results)


def _targets(given: list[str] | None) -> tuple[str, ...] | None:
    if given is None:
        return None
    return tuple(name.strip() for text in given for name in text.split(","))


def _report(results: Sequence[BuildResult | CheckResult | BuildFailure]) -> None:
    from derive.cli.terminal import print_columns
    from derive.publish.build import BuildResult, CheckResult

    built = [_built_row(result) for result in results if isinstance(result, BuildResult)]
    if built:
        print_columns(built, ("robot", "status", "folder", "files", "worst error", "seconds"))
    for result in results:
        if isinstance(result, CheckResult):
            print("\n".join(_check_lines(result)))


def _built_row(result: BuildResult) -> tuple[str, ...]:
    rows = result.report.rows if result.report else ()
    return (
        result.robot,
        "unchanged" if result.unchanged else "built",
        str(result.folder),
        str(len(result.files)),
        f"{max(row.worst for row in rows):.1e}" if rows else "-",
        f"{result.seconds:.1f}",
    )


def _check_lines(result: CheckResult) -> list[str]:
    if result.is_current:
        return [f"{result.robot}: current"]
    found = {"stale": result.stale, "missing": result.missing, "not ours any more": result.extra}
    differences = [f"{what} {', '.join(names)}" for what, names in found.items() if names]
    return [f"{result.robot}: {'; '.join(differences)} in {result.folder}"]


def _status(robots: Sequence[Robot], results: Sequence[BuildResult | CheckResult | BuildFailure]) -> int:
    """The gravest status; failures are told on standard error, each with the file that it belongs to."""
    from derive.cli.terminal import FAILED, explain, print_error
    from derive.publish.build import BuildFailure, CheckResult

    status = 0
    for robot, result in zip(robots, results, strict=True):
        if isinstance(result, BuildFailure):
            reason, grave = explain(result.error)
            print_error(f"{robot.source}: {reason}")
            status = max(status, grave)
        elif isinstance(result, CheckResult) and not result.is_current:
            status = max(status, FAILED)
    return status
