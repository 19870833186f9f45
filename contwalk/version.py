"""The version of contwalk, as the package says it."""

__version__ = "0.1.0"
