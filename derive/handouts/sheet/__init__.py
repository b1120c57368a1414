"""The sheet as data: document, formulas, language, budget, and its writer in LaTeX."""
