"""Fewer operations for the same values: shared parts, searched for."""
