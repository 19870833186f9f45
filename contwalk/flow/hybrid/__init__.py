"""Motions of hybrid machines: segments, guards, transitions, and the derivative through all of them."""
