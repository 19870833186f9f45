"""A diagram: which branches are walked, in which order, and what is made of them.

Rules
-----
1. A branch follows from its start alone, whoever walks it and how often: the order of the queue decides what
   is stored, and `--jobs` and `--resume` give the same bits.
2. Each branch is walked by `continuation`; here it is opened, recognised, imaged, left, or followed.
3. What happens is told as events (`events`), which studies store.
"""
