"""contwalk."""
