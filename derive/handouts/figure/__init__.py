"""Figures of an arm: a scene in space, its projection on paper, and the ways to write a drawing."""
