"""First solutions: orbits from a state, and from a simulation that comes back."""
