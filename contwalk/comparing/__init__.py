"""Two databases beside each other: which branches are the same, and what differs on them.

Nothing is computed again and no plugin is run: what is stored is compared within the errors that it claims.
"""
