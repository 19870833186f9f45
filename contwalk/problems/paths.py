"""Straight lines through the space of parameters: what is continued where several change together."""

from __future__ import annotations

from collections.abc import Mapping

# All parameters where it begins, at 0, and where it ends, at 1.
Path = tuple[Mapping[str, float], Mapping[str, float]]


def at_path(parameters: Mapping[str, float], path: Path | None, at: float | None) -> dict[str, float]:
    """Values of all parameters at a position on a path; without a path, the parameters."""
    if path is None:
        return dict(parameters)
    return {name: begin + float(at or 0.0) * (path[1][name] - begin) for name, begin in path[0].items()}
