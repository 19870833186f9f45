"""Steps of a branch that are shorter than what its solutions are known to."""

from __future__ import annotations

import numpy as np

from contwalk.branch import Branch
from contwalk.numerics.linear import EPSILON


def blind_steps(branch: Branch) -> str:
    """A sentence where the way of a branch is noise; empty where no step is that short.

    A step shorter than the error of its ends does not know where it leads: the walk may go to and fro, and
    tests may change their signs for no reason. Special points lie as near to others as they do, and are left
    out.
    """
    special = [point.index for point in branch.special_points]
    walked = np.ones(len(branch), dtype=bool)
    walked[special] = False
    places = np.flatnonzero(walked)
    rows = branch.points[places]
    errors = np.nan_to_num(rows["error"], posinf=0.0)
    known = np.maximum(errors[1:], errors[:-1])
    lengths = np.abs(np.diff(rows["s"]))
    blind = np.flatnonzero((lengths > 0.0) & (lengths < known))
    if not len(blind):
        return ""
    free, ends = branch.info.free[0], np.concatenate([blind, blind + 1])
    values = rows["free"][ends, 0]
    sentence = (
        f"{branch.name}: {len(blind)} of {len(lengths)} steps, with {free} from {values.min():.10g} to "
        f"{values.max():.10g}, are shorter than what the solutions there are known to "
        f"({known[blind].max():.1e} in the metric of the branch): its way is rounding on them, and special "
        "points may be missed or false. "
    )
    return sentence + (
        _tiny(branch, places[ends]) or "A finer `accuracy`, or a larger `engine: {min_step}`, may help."
    )


def _tiny(branch: Branch, places: np.ndarray) -> str:
    """What states of one sign are not known to their own size along orbits, rows of these numbers (k,); empty
    if none.

    Errors of steps are in units of how far a state moves: half a float's digits below, none is its own.
    """
    small = {}
    for state in branch.info.states:
        if f"min:{state}" in branch.info.observables:
            low, high = (branch[f"{side}:{state}"][places] for side in ("min", "max"))
            of_one_sign = (low > 0.0) | (high < 0.0)
            least, most = (end(np.abs(low), np.abs(high))[of_one_sign] for end in (np.minimum, np.maximum))
            share = float(np.min(least / most, initial=1.0))
            if share < np.sqrt(EPSILON):
                small[state] = share
    if not small:
        return ""
    first, each = next(iter(small)), (f"{state} returns from {share:.1e}" for state, share in small.items())
    return (
        f"{' and '.join(each)} of its largest size, and errors of steps are in units of that: if it grows in "
        "proportion to itself, what it grows to again is not known. Then take logarithms as states: of log "
        f"|{first}| the rate is that of {first} over {first}."
    )
