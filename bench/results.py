"""The files of results."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

FOLDER = Path(__file__).parent / "results"


def write_json(name: str, content: dict[str, Any], folder: Path = FOLDER) -> None:
    """Write ``name.json``."""
    folder.mkdir(exist_ok=True)
    text = json.dumps(content, indent=1, ensure_ascii=False)
    (folder / f"{name}.json").write_text(text + "\n", encoding="utf-8")


def read_json(name: str, folder: Path = FOLDER) -> dict[str, Any]:
    """Read ``name.json``."""
    content: dict[str, Any] = json.loads((folder / f"{name}.json").read_text(encoding="utf-8"))
    return content
