"""Random matrices of the form that the equations of orbits of some legs have."""

from __future__ import annotations

import numpy as np

from contwalk.problems.orbit.layout import Layout


def random_matrix(layout: Layout, borders: int, rng: np.random.Generator) -> np.ndarray:
    """DF without a free parameter, or with it and as many borders as make it square (the last rows)."""
    size = layout.size + borders
    matrix = np.zeros((size, size))
    for i in range(layout.legs):
        match, n = layout.matches[i], layout.states[i]
        rows = [*range(match.start, match.stop), layout.guards + i]
        columns = [*range(n.start, n.stop), layout.durations.start + i]
        columns += [*range(layout.drifts.start, layout.drifts.stop), *range(layout.size, size)]
        matrix[np.ix_(rows, columns)] = rng.standard_normal((len(rows), len(columns)))
        if (
            layout.start is not None
        ):  # the starting time of a leg is that of the first and all durations since
            by_time = rng.standard_normal(len(rows))
            first = layout.durations.start
            matrix[np.ix_(rows, [layout.start, *range(first, first + i)])] = by_time[:, None]
        matrix[match, layout.states[(i + 1) % layout.legs]] -= np.eye(match.stop - match.start)
    if layout.sum is not None:
        matrix[layout.sum, layout.durations] = 1.0
    for row in range(layout.held, layout.size):
        matrix[row, layout.states[0]] = rng.standard_normal(layout.sizes[0])
    matrix[layout.size :] = rng.standard_normal((borders, size))
    return matrix
