"""Numbers watched along a path: what they are, and where they pass zero."""
