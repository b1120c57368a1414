"""Printed formulas against derived ones.

How a printed formula travels: `files` tells files apart and reads them with `reading` (YAML) and the shorthand into
`printed` data, or hands them to `frames_file` or `methods_file`, which read and compare on their own. LaTeX goes by
`latex_typography` (what only moves ink), `latex_equations` (displays, sides) and `latex_pieces` (entries), `latex_left`
and `latex_meanings` (what left sides name, and its value), `latex_formula` and `latex_grammar`; `latex_check` compares
it. `comparison` and `solutions` (inverse kinematics) ask `model.equality` whether a formula is right and keep the
answer as `findings`. `findings.judge` says same form, equal or wrong; for a wrong one `diagnosis` tries at every place
every single change (`edits`) until one repairs it. `report` writes verdicts as text, plain data and Markdown.
"""
