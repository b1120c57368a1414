"""Closed loops: the positions of passive joints, and how they move."""
