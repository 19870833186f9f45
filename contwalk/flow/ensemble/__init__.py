"""Many motions at once, in threads."""
