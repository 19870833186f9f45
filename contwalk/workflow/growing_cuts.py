"""Where along a branch orbits come to be cut at times that are chosen, told with the reason."""

from __future__ import annotations

import numpy as np

from contwalk.branch import Branch


def growing_cuts(branch: Branch) -> str:
    """A sentence where orbits that begin in segments of equal duration are cut otherwise later on."""
    settings = branch.info.settings
    if not settings.get("evenly_first"):
        return ""
    from contwalk.problems.orbit.layout import times_chosen  # of branches of smooth orbits alone

    n, m = len(branch.info.states), int(settings["segments"])
    first = branch.unknowns(int(np.argmin(np.abs(branch.points["s"]))))
    others = len(first) - m * n
    if others < 1 or times_chosen(first, n, others - m + 1) is not None:  # it begins with such orbits
        return ""
    chosen = np.array([times_chosen(branch.unknowns(k), n, others) is not None for k in range(len(branch))])
    if not np.any(chosen):
        return ""
    values = branch.points["free"][chosen][:, 0]
    return (
        f"{branch.name}: at {chosen.sum()} of {len(chosen)} points, {branch.info.free[0]} = "
        f"{values.min():.10g} to {values.max():.10g}, orbits are cut where deviations grow: segments of "
        "equal duration, over one of which they came to grow by more than 3e4, would have made steps short."
    )
