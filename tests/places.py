"""Where things are in the source tree."""

from pathlib import Path

ROOT = Path(__file__).parents[1]
GENERATED = ROOT / "generated"
CORPUS = ROOT / "tests" / "lectures" / "corpus"
