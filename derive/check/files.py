"""Any file that `derive check` understands, by its keys."""

from __future__ import annotations

from pathlib import Path

from derive.check.comparison import FileReport, check_file
from derive.check.corpus_file import corpus_from_bytes
from derive.check.frames_file import NO_ROBOT, check_frames
from derive.check.methods_file import check_methods
from derive.check.recursion_values import SETS
from derive.robot import document
from derive.robot.load import file_bytes
from derive.robot.robot import Robot
from derive.robot.source import read_tree
from derive.robot.wording import quoted


def check_path(path: str) -> tuple[FileReport, Robot]:
    """Compare everything that a file prints, and the robot whose notation it uses.

    Args:
        path: A corpus file with ``robot:``, a file of frames with ``items:``, or one of Newton-Euler equations.

    Raises:
        DeriveError: The file cannot be read.
    """
    source = path if path.isprintable() else quoted(path, 200)
    data = file_bytes(Path(path))
    root = read_tree(data, source)
    if isinstance(root, document.Mapping) and "robot" not in root.entries:
        if "items" in root.entries:
            return check_frames(root, source), NO_ROBOT
        if any(name in root.entries for name in SETS):
            return check_methods(root, source), NO_ROBOT
    file = corpus_from_bytes(data, source)
    return check_file(file), file.robot
