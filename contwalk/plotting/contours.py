"""Curves of marked values: what has the value there, and the number that is written beside the line."""

from __future__ import annotations

from typing import Any

import numpy as np

from contwalk.branch import Branch
from contwalk.labels import MARK
from contwalk.plotting.quantities import BUILT_IN_OBSERVABLES


def is_contour(branch: Branch) -> bool:
    """Whether nothing happens on a curve but that something has a value."""
    return bool(branch.info.settings["of"] == MARK)


def quantity_of(branch: Branch) -> str:
    """What has a value along a contour."""
    curve: dict[str, Any] = branch.info.settings["curve"]
    if "observable" in curve:
        return str(curve["observable"])
    if "place" in curve:  # of both parameters, counted from the end of the unknowns
        return str(branch.info.free[-1 - curve["place"]])
    return BUILT_IN_OBSERVABLES[0]  # the largest real part, of a pair or a real eigenvalue


def level_of(branch: Branch) -> float:
    """The value along a contour."""
    return float(branch.info.settings["curve"]["level"])


def middle(points: np.ndarray, span: np.ndarray) -> np.ndarray:
    """The point half way along a line, in units of `span`, shape (2,); `points` have the shape (k, 2)."""
    steps = np.linalg.norm(np.diff(points, axis=0) / span, axis=1)
    way = np.concatenate([[0.0], np.cumsum(steps)])
    return np.array([np.interp(0.5 * way[-1], way, points[:, which]) for which in range(2)])
