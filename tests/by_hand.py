"""Systems held against the same equations written by hand, at random states, parameters and times."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from contwalk.python_functions import plain
from contwalk.system import System
from contwalk.system.declarations import ParameterValues

# Rounding of a sum of some terms, of the largest of them.
CLOSE = 1e-14


def largest_difference(system: System, by_hand: Callable[..., Sequence[float]], low=0.1, high=2.0) -> float:
    """Rates of a system beside those of `by_hand(t, p, *x)`, which gives for each state its terms.

    Differences are in parts of the largest term.
    """
    random = np.random.default_rng(20)
    worst = 0.0
    for _ in range(20):
        x = random.uniform(low, high, len(system.states))
        p = {name: value * random.uniform(0.8, 1.2) for name, value in system.defaults().items()}
        t = random.uniform(0.0, 10.0)
        values, rates = ParameterValues(**p), np.full(len(x), np.nan)
        plain(system.modes[0].field)(t, x.copy(), values, rates)
        for rate, terms in zip(rates, by_hand(t, values, *x.tolist()), strict=True):
            each = np.atleast_1d(np.asarray(terms, dtype=float))
            worst = max(worst, abs(rate - each.sum()) / max(np.abs(each).max(), 1e-300))
    return worst
