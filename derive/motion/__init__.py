"""Motions of an arm: profiles between points, paths, their torques, simulation and playback."""
