"""Names that are allowed, and the one that is meant."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from contwalk.system.declarations import nearest


def closest(name: str, known: Iterable[str]) -> str:
    """As `nearest`, and blind to upper and lower case where nothing is near as written."""
    names = list(known)
    folded = {candidate.lower(): candidate for candidate in reversed(names)}
    match = folded.get(name.lower())
    return f"Did you mean '{match}'?" if match else nearest(name, names)


def allowed(known: Sequence[str], name: str = "") -> str:
    """`Allowed: a, b, c. Did you mean 'b'?`"""
    return f"Allowed: {', '.join(known) or 'none'}. {closest(name, known)}".strip()
