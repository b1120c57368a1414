"""Which texts may be a symbol."""

from __future__ import annotations

import re

from derive.robot.document import Document, Path
from derive.robot.limits import FILE_LIMITS
from derive.robot.parser import NOT_SYMBOLS, RESERVED_NAMES
from derive.robot.wording import quoted

_SYMBOL = re.compile(rf"[A-Za-z][A-Za-z0-9_]{{0,{FILE_LIMITS.name_length - 1}}}")


def check_symbol(document: Document, path: Path, name: str) -> None:
    """Refuse a name that is not ``[A-Za-z][A-Za-z0-9_]*``, too long, or means something else.

    Raises:
        RobotFileError: At the place of the name.
    """
    if name in RESERVED_NAMES or name.casefold() in NOT_SYMBOLS:
        raise document.error(path, f"'{name}' cannot be a symbol", "it has a meaning of its own", "use another name")
    if _SYMBOL.fullmatch(name) is None:
        raise document.error(
            path,
            f"{quoted(name)} is not a name",
            f"allowed: a letter A-Z or a-z, then letters, digits and _, at most {FILE_LIMITS.name_length} characters",
        )
