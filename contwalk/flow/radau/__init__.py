"""Radau IIA collocation for stiff flows: paths, the same steps again, and their exact derivatives."""
