"""Printed expressions against derived ones, and numeric verification of what was generated."""
