"""Printed formulas against derived ones.

`files` tells files apart; corpus files become `formulas.printed` data by `formulas.reading`, LaTeX goes by `latex` and
solutions of the inverse kinematics by `inverse`. `model.equality` says whether a formula is right, `formulas.findings`
keeps that, `formulas.diagnosis` tries the changes of `formulas.edits` until one repairs it, and `report` writes it.
"""
