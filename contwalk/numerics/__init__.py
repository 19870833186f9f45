"""Numerical methods that know nothing of problems: linear algebra, refinement, bracketing."""
