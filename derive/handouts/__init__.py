"""The handout: what stands on it, part by part, before it is set as LaTeX or as a web page."""
