"""Periodic orbits: the problem, and what belongs to it alone."""
