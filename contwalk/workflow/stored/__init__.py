"""Stored points and orbits as what they were: integrated once more, displaced, begun from."""
