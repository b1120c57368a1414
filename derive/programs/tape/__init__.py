"""Straight-line programs: interned graph, tape, schedule."""
