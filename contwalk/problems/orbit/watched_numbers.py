"""Numbers watched along a leg, with their rates over the leg's own time.

The rate of h(t, x) is h_t + h_x r, where r is what the leg's field gives there. So what is compiled for a
guard is the guard alone, however much there is to its field.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from contwalk.flow import CompiledField, Field


class Watched:
    """Some numbers along a leg, as maps of the state at an instant: each value, followed by its rate.

    Parameters
    ----------
    field : callable
        What makes the leg's field.
    columns : int
        Number of the leg's own scalars.
    map_ : Field
        Of the states and their rates, these after those.
    jumps : bool
        Whether one of them may jump.
    """

    def __init__(
        self, field: Callable[[], CompiledField], columns: int, map_: Field, jumps: bool = False
    ) -> None:
        self._field, self._columns, self._map = field, columns, map_
        self.jumps = jumps

    def along(
        self, times: np.ndarray, states: np.ndarray, values: np.ndarray, rates: np.ndarray | None = None
    ) -> np.ndarray:
        """Values and rates at instants in 0..1, shape (k, 2 g); `rates` of the states where they are known.

        `values` are what the leg's functions depend on, as `Piece.values` gives it.
        """
        if rates is None:
            field = self._field()
            rates = field.along(times, states, field.constants(values))
        return self._map.along(times, np.concatenate([states, rates], axis=1), self._map.constants(values))

    def __call__(self, time: float, x: np.ndarray, values: np.ndarray) -> np.ndarray:
        """Values and rates at one instant, shape (2 g,)."""
        return self.along(np.array([time]), np.asarray(x)[None], values)[0]

    def differentiated(
        self, time: float, x: np.ndarray, moved: np.ndarray, values: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Values and rates, and their derivatives; `moved`, shape (n, q), are those of the state.

        The last of the q columns are the leg's own.
        """
        field, k = self._field(), self._columns
        c, n = field.constants(values), len(x)
        rates, by = field.linearized(time, x, c)
        changed = by[:, :n] @ moved
        changed[:, -k:] += by[:, n:]
        own = self._map.constants(values)
        given = np.concatenate([x, rates])
        values_there, slopes = self._map.linearized(time, given, own)
        total = slopes[:, : 2 * n] @ np.concatenate([moved, changed])
        total[:, -k:] += slopes[:, 2 * n :]
        return values_there, total
