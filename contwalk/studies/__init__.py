"""From a system to a branch, and back from a stored one: what knows all kinds of problems."""
