"""What a verification found."""

from __future__ import annotations

from dataclasses import dataclass

TOLERANCE = 1e-9
"""Largest relative error of a generated function; rounding leaves about 1e-14, a wrong term 1e-3 and more."""


@dataclass(frozen=True, slots=True)
class Row:
    """One generated function.

    Attributes:
        target: Name of the target, ``numpy``, ``casadi`` or ``c``.
        function: Name of the function.
        samples: Number of values compared, over all ways of calling.
        worst: Worst relative error.
        note: Why values were left out, if any were.
    """

    target: str
    function: str
    samples: int
    worst: float
    note: str = ""


@dataclass(frozen=True, slots=True)
class Report:
    """All functions of all targets.

    Attributes:
        robot: Name of the robot.
        seed: Seed of the random configurations and parameters.
        rows: One per target and function.
        left_out: Files that were not verified since there is no C compiler.
    """

    robot: str
    seed: int
    rows: tuple[Row, ...]
    left_out: tuple[str, ...] = ()

    @property
    def worst(self) -> float:
        """Worst relative error of all functions."""
        return max((row.worst for row in self.rows), default=0.0)

    def as_dict(self) -> dict[str, object]:
        """Plain data, for JSON."""
        return {
            "robot": self.robot,
            "seed": self.seed,
            "tolerance": TOLERANCE,
            "worst": self.worst,
            "left_out": list(self.left_out),
            "rows": [
                {"target": r.target, "function": r.function, "samples": r.samples, "worst": r.worst, "note": r.note}
                for r in self.rows
            ],
        }
