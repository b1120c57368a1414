"""Regressors and base parameters in closed form."""
