"""C and C++ sources of the harness."""

from pathlib import Path

FOLDER = Path(__file__).parent
