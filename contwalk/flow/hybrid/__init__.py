"""Motions of hybrid machines: arcs, guards, transitions, and the derivative through all of them."""
