"""Numeric verification of generated code: every function of every target against the independent recursion."""

from __future__ import annotations

from derive.check.verify.pipeline import verify
from derive.check.verify.report import TOLERANCE, Report, Row

__all__ = ["TOLERANCE", "Report", "Row", "verify"]
