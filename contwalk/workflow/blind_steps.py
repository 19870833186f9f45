"""Steps of a branch that are shorter than what its solutions are known to."""

from __future__ import annotations

import numpy as np

from contwalk.branch import Branch


def blind_steps(branch: Branch) -> str:
    """A sentence where the way of a branch is noise; empty where no step is that short.

    A step shorter than the error of its ends does not know where it leads: the walk may go to and fro, and
    tests may change their signs for no reason. Special points lie as near to others as they do, and are left
    out.
    """
    special = [point.index for point in branch.special_points]
    walked = np.ones(len(branch), dtype=bool)
    walked[special] = False
    rows = branch.points[walked]
    errors = np.nan_to_num(rows["error"], posinf=0.0)
    known = np.maximum(errors[1:], errors[:-1])
    lengths = np.abs(np.diff(rows["s"]))
    blind = np.flatnonzero((lengths > 0.0) & (lengths < known))
    if not len(blind):
        return ""
    free = branch.info.free[0]
    values = rows["free"][np.concatenate([blind, blind + 1]), 0]
    return (
        f"{branch.name}: {len(blind)} of {len(lengths)} steps, with {free} from {values.min():.10g} to "
        f"{values.max():.10g}, are shorter than what the solutions there are known to "
        f"({known[blind].max():.1e} in the metric of the branch): its way is rounding on them, and special "
        "points may be missed or false. A finer `accuracy`, or a larger `engine: {min_step}`, may help."
    )
