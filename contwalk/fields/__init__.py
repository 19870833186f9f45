"""What becomes of a plugin's functions: expressions, exact derivatives, code for any arithmetic.

Rules
-----
1. A plugin's function is *traced* once: it is called with symbols instead of numbers, and every operation it
   performs is recorded in a graph (`expression`, `trace`). A comparison is explored both ways.
2. Derivatives are taken on the graph (`derivative`), so they are exact to rounding and of any order; a
   running error analysis (`rounding`) is another transformation of the same kind.
3. `codegen` writes a graph as straight-line Python, and `kernel` runs that text in the arithmetic asked for:
   floats for speed, `mpmath` numbers where digits matter.
4. Nothing here knows of equilibria, orbits or branches.
"""
