"""Formats of figures, by the suffixes of their files."""

from __future__ import annotations

from pathlib import Path

FORMATS = (".png", ".svg", ".pdf", ".pgf")


def unknown_format(path: Path) -> str | None:
    """What is wrong with a figure's file name, in words; None where its suffix is a format.

    Parameters
    ----------
    path : Path
        The suffix may be in upper or lower case.
    """
    suffix = path.suffix.lower()
    return None if suffix in FORMATS else f"the format {suffix or '(no suffix)'} is not known"


def allowed_formats() -> str:
    """The formats there are, as a remedy says them."""
    return f"Allowed: {', '.join(FORMATS)}."
