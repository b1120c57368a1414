"""Many configurations: where they are computed, and what is said of all of them together."""
