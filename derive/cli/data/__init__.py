"""Commands for many configurations: maps, samples, motions that excite, and what a log says."""
