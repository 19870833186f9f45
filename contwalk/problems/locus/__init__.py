"""Curves in two parameters: where special points of solutions go as a second parameter varies."""
