"""A computed path."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

# From this share of stability-limited steps on, steps that are taken again from elsewhere are made so many
# times finer.
STEADY, FINER = 0.1, 1.25
# What drivers answer, in their order, and that there is no room for another step.
STATUS = ("ok", "not_finite", "too_many_steps", "step_too_small")
FULL = 4


class ErrorControl(NamedTuple):
    """How long steps may be.

    Parameters
    ----------
    tolerance : float
        Bound of each step's estimated error: root mean square over the states, in units of `weights`.
    weights : ndarray, shape (n,)
        Typical magnitudes of the states.
    max_steps : int
        After which the path ends, wherever it is.
    far_out : bool
        Whether a path goes on where roundings of its state are larger than the tolerance, with errors as
        small as they allow: where a motion runs towards a pole. Explicit methods only; else it ends there,
        one way or another.
    """

    tolerance: float
    weights: np.ndarray
    max_steps: int = 100_000
    far_out: bool = False


class Tangents(NamedTuple):
    """Derivatives of a start that are carried along its path.

    Parameters
    ----------
    start : ndarray, shape (n, q)
    sources : sequence of int, length q
        For each column the parameter column of the field that drives it, or -1.
    """

    start: np.ndarray
    sources: Sequence[int] | np.ndarray


@dataclass(frozen=True, eq=False)
class Path:
    """Steps of a flow.

    Parameters
    ----------
    times : ndarray, shape (s + 1,)
        Ends of the steps; falling in a path backwards in time.
    states : ndarray, shape (s + 1, n)
    evaluations : int
        Evaluations of the field, those of rejected steps included.
    rejected : int
        Steps that were tried and found too long.
    stiff_fraction : float
        Share of the steps whose length was limited by stability and not by accuracy.
    status : str
        "ok": the path arrived. Otherwise it ends where it could not go on: "not_finite", "too_many_steps",
        "step_too_small".
    """

    times: np.ndarray
    states: np.ndarray
    evaluations: int
    rejected: int
    stiff_fraction: float
    status: str

    @classmethod
    def grown(
        cls,
        march: Callable[[np.ndarray, np.ndarray], int],
        t0: float,
        x0: Sequence[float] | np.ndarray,
        room: int,
        counted: Callable[[], tuple[int, int, int, int]],
        states: int | None = None,
    ) -> tuple[Path, np.ndarray]:
        """The path that a driver writes, given more room until it needs no more, and its vectors.

        Parameters
        ----------
        march : callable
            Writes on into times and vectors, shapes (s,) and (s, m); its answer is a number of STATUS, or
            FULL.
        t0 : float
        x0 : ndarray, shape (m,)
        room : int
            Steps that there is room for at first.
        counted : callable
            How many steps were made, evaluations, rejected steps, and steps that stability has limited.
        states : int, optional
            How many of a vector are the states; all by default.
        """
        times, nodes = np.empty(room + 1), np.empty((room + 1, len(x0)))
        times[0], nodes[0] = t0, x0
        while (answer := march(times, nodes)) == FULL:
            times = np.concatenate([times, np.empty(len(times))])
            nodes = np.concatenate([nodes, np.empty_like(nodes)])
        steps, evaluations, rejected, stiff = counted()
        own = times[: steps + 1].copy(), nodes[: steps + 1, :states].copy()
        return cls(*own, evaluations, rejected, stiff / max(steps, 1), STATUS[answer]), nodes

    @property
    def steady(self) -> np.ndarray:
        """Ends of steps that may be taken again from other starts, shape (s + 1,) or longer.

        They are shorter where stability limits them.

        There the control of the error holds an explicit method on the brink, and where the field is a little
        stiffer a deviation would grow from step to step.
        """
        if self.stiff_fraction <= STEADY:
            return self.times
        count = len(self.times) - 1
        finer = np.linspace(0.0, count, int(np.ceil(FINER * count)) + 1)
        return np.interp(finer, np.arange(count + 1.0), self.times)
