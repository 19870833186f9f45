"""Coefficients of the methods, with their sources."""
