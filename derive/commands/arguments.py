"""Types of command-line arguments; a wrong value is refused with what was found and what is allowed."""

from __future__ import annotations

import argparse


def positive(text: str) -> int:
    """A whole number from 1 on."""
    if not (text.isascii() and text.isdecimal()) or len(text) > 8 or int(text) < 1:
        raise argparse.ArgumentTypeError(f"{text!r} is not a whole number from 1 to 99999999")
    return int(text)


def natural(text: str) -> int:
    """A whole number from 0 on."""
    if not (text.isascii() and text.isdecimal()) or len(text) > 8:
        raise argparse.ArgumentTypeError(f"{text!r} is not a whole number from 0 to 99999999")
    return int(text)


def magnification(text: str) -> float:
    """A number from 0.1 to 10."""
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not 0.1 <= value <= 10.0:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number from 0.1 to 10")
    return value


def sample_count(text: str) -> int:
    """A whole number from 10 to a million."""
    if not (text.isascii() and text.isdecimal()) or len(text) > 7 or not 10 <= int(text) <= 1000000:
        raise argparse.ArgumentTypeError(f"{text!r} is not a whole number from 10 to 1000000")
    return int(text)
