"""Problems: equations F(u, lambda) = 0 whose solutions form branches, and what is special on them.

Rules
-----
1. The continuation engine sees a problem only through `problem.Problem`; it never asks which class it holds.
2. A vector z = (u, lambda) holds the N unknowns and the free parameter last.
3. First derivatives are exact. Special points are solutions of defining systems (`defining_systems`),
   solved by Newton's method in double precision and refined with residuals in extended precision
   (`numerics.refine`).
4. How to leave a special point onto another branch is decided here (`second_direction`), not in the engine.
"""
