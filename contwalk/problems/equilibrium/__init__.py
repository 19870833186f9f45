"""Equilibria: their equations, their special points, and where their branches end."""
