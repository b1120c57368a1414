"""Seeds of the hashes of strings, on which nothing may depend."""

import os


def another_hash_seed() -> str:
    """A seed that is surely not this process's, which is random unless ``PYTHONHASHSEED`` is set."""
    return "7" if os.environ.get("PYTHONHASHSEED") != "7" else "99"
