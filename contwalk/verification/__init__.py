"""Whether a stored result is right: each record recomputed from its own words, with nothing of the engine."""
