"""Motions of an arm: trajectories, torques, simulation, and what is written of them."""
