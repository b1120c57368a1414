"""Trajectories as functions of time: pieces, peaks, limits, recordings."""
