"""The gallery of the built-in robots, made by derive itself: ``python docs/gallery.py``.

For each robot its figure, its pose T and its web page, written to ``docs/gallery`` (not under version control).
"""

from __future__ import annotations

import contextlib
import io
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

from derive.cli.main import main
from derive.robot.load import catalogue_names
from derive.robot.robot import Robot

GALLERY = Path(__file__).resolve().parent / "gallery"
PAGES = GALLERY / "pages" / "pages"
MOST_COLUMNS = 400
"""Longest row of T that is shown; beyond it the page has it entry by entry."""


def gallery() -> None:
    """Write the page of every robot, and the page that lists them."""
    PAGES.mkdir(parents=True, exist_ok=True)
    names = [name for name in catalogue_names() if not Robot.load(name).coupled]  # these have no figure and sheet yet
    with ProcessPoolExecutor(2) as pool:
        entries = list(pool.map(entry, names))
    listed = "\n".join(entries)
    (GALLERY / "index.md").write_text(
        "# Gallery\n\nThe built-in robots, drawn and derived by `derive` itself.\n\n"
        f"{listed}\n\n```{{toctree}}\n:hidden:\n\n" + "\n".join(names) + "\n```\n",
        encoding="utf-8",
    )


def entry(name: str) -> str:
    """One robot: its figure, its web page and its own page in the gallery; the line that lists it."""
    robot = Robot.load(name)
    run("plot", name, "--force", "--quiet", "-o", str(GALLERY / f"{name}.svg"))
    run("handout", name, "--html", "--force", "--quiet", "--out", str(PAGES))
    pose = "" if robot.is_tree else run("show", name, "T", "--format", "latex").strip()  # a tree has one for each end
    formula = f"$$\n{pose}\n$$\n" if pose and max(map(len, pose.splitlines())) < MOST_COLUMNS else ""
    (GALLERY / f"{name}.md").write_text(
        f"# {name}\n\n{robot.title}\n\n![{name} with its frames]({name}.svg)\n\n{formula}\n"
        f'<a href="../pages/{name}.html">The handout as a page, with an arm that moves</a>\n\n'
        f"```sh\nderive handout {name} --html\n```\n",
        encoding="utf-8",
    )
    return f"- [{name}]({name}.md): {robot.title}"


def run(*arguments: str) -> str:
    """What a command prints.

    Raises:
        SystemExit: The command failed.
    """
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        status = main(arguments)
    if status:
        raise SystemExit(f"derive {' '.join(arguments)}: exit status {status}")
    return printed.getvalue()


if __name__ == "__main__":
    gallery()
