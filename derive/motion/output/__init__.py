"""What is written of a motion: table, plot, film, page, code."""
