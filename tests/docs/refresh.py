"""Writes what commands print now into the pages: ``python -m tests.docs.refresh README.md docs/*.md``.

Only what no longer agrees is rewritten, so ``...`` stays where a page has it on purpose.
"""

import sys
import tempfile
from pathlib import Path

from tests.docs.console import Block, Command, agrees, blocks, commands, environment, run


def refreshed(block: Block, folder: Path, variables: dict[str, str]) -> str:
    return "".join(_shown(command, *run(command, folder, variables)) for command in commands(block))


def _shown(command: Command, printed: list[str], status: int) -> str:
    output = command.output if agrees(command.output, printed) else [line.rstrip() for line in printed]
    note = [f"[exit status {status}]"] if status else []
    return "".join(f"{line}\n" for line in (f"$ {command.text}", *output, *note))


def refresh(page: Path) -> None:
    """Run the blocks of one page in order, in an empty folder."""
    text = page.read_text(encoding="utf-8")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        variables = environment(folder / "path")
        (folder / "work").mkdir()
        for block in blocks(page):
            if block.file:
                (folder / "work" / block.file).write_text(block.body, encoding="utf-8")
            if block.language == "console":
                text = text.replace(block.body, refreshed(block, folder / "work", variables), 1)
    page.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    for argument in sys.argv[1:]:
        refresh(Path(argument))
