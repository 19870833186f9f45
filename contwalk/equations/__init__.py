"""Models as text: one grammar of expressions, and plugins written from what has been read by it."""
