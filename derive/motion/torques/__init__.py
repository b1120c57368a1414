"""Torques, work and loads along a motion."""
