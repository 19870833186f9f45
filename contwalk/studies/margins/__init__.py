"""How far a motion may be pushed before it is lost."""
