"""Explicit Runge-Kutta methods: paths, the same steps again, and their exact derivatives."""
