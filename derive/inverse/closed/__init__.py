"""Elementary equations: which joints follow from a pose one after the other, and the graph of all branches."""
