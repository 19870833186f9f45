"""Periodic orbits through events: arcs between transitions, with what can go wrong on each."""
