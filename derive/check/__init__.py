"""Printed formulas against derived ones."""
