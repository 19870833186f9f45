"""Python in few lines: systems from functions and SymPy, and diagrams in one call."""
