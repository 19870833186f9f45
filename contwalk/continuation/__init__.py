"""Pseudo-arclength continuation: walking along the solutions of F(u, lambda) = 0.

Rules
-----
1. `pseudo_arclength.walk` is an iterator: predict, correct, detect, adapt, yield. It holds no database and no
   queue: these are those of `diagram`.
2. Settings, state and result are separate objects.
3. An outcome is a value (`branch.Outcome`), not an exception; whatever was found before it stays found.
4. A disagreement between tests shortens the step; at the smallest step it is recorded as `unlocated`.
"""
