"""Frames, Jacobians, energies, B, C, g and Newton-Euler over any scalar type; knows no output."""
