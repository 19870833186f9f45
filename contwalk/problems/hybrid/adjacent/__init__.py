"""Orbits at a limit as orbits of adjacent itineraries, and the branches that leave there."""
